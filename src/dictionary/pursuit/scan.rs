//! Looks through scores for those that could be the best.

/// Values looked at together.
const LANES: usize = 16;

/// What scores are compared by: their size, or, unless `SIGNED`, how far they are above 0.
#[inline(always)]
fn rank<const SIGNED: bool>(score: f32) -> f32 {
    if SIGNED { score.abs() } else { score }
}

/// The largest rank of a score, at least 0.
#[inline(always)]
pub(super) fn largest<const SIGNED: bool>(scores: &[f32]) -> f32 {
    let mut most = [0.0f32; LANES];
    let (whole, rest) = scores.as_chunks::<LANES>();
    for scores in whole {
        for lane in 0..LANES {
            let size = rank::<SIGNED>(scores[lane]);
            most[lane] = if size > most[lane] { size } else { most[lane] };
        }
    }
    let most = most.into_iter().fold(0.0, f32::max);
    rest.iter().fold(most, |most, score| most.max(rank::<SIGNED>(*score)))
}

/// Calls `found` for each position whose score has at least a rank, in rising order.
#[inline(always)]
pub(super) fn reaching<const SIGNED: bool>(scores: &[f32], least: f32, mut found: impl FnMut(usize)) {
    let (whole, rest) = scores.as_chunks::<LANES>();
    for (chunk, scores) in whole.iter().enumerate() {
        let mut any = false;
        for score in scores {
            any |= rank::<SIGNED>(*score) >= least;
        }
        if any {
            for (lane, score) in scores.iter().enumerate() {
                if rank::<SIGNED>(*score) >= least {
                    found(chunk * LANES + lane);
                }
            }
        }
    }
    for (i, score) in rest.iter().enumerate() {
        if rank::<SIGNED>(*score) >= least {
            found(whole.len() * LANES + i);
        }
    }
}

/// What is known of gains `c² / l`: estimates of `c` and `l`, how far they can be off, and the least `l` that counts.
#[derive(Clone, Copy)]
pub(super) struct Uncertain {
    /// Greatest error of `c`.
    pub(super) c: f32,
    /// Greatest error of `l`.
    pub(super) l: f32,
    /// Gains with a true `l` below this do not count.
    pub(super) least: f32,
}

/// Roundings of the few steps below, with room.
const SLACK: f32 = 1e-5;

impl Uncertain {
    /// A gain that `c² / l` surely reaches.
    #[inline(always)]
    fn low(&self, c: f32, l: f32) -> f32 {
        let size = c.abs() - self.c;
        let size = if size > 0.0 { size } else { 0.0 };
        let gain = size * size / (l + self.l);
        if l - self.l > self.least { gain } else { 0.0 }
    }

    /// A gain that `c² / l` surely does not exceed.
    #[inline(always)]
    fn high(&self, c: f32, l: f32) -> f32 {
        let size = c.abs() + self.c;
        let left = l - self.l;
        let left = if left > self.least { left } else { self.least };
        if l + self.l < self.least { -1.0 } else { size * size / left }
    }

    /// Calls `found` for each position that could have the largest gain, in rising order.
    #[inline(always)]
    pub(super) fn contenders(&self, c: &[f32], l: &[f32], mut found: impl FnMut(usize)) {
        let mut most = [0.0f32; LANES];
        let ((whole_c, rest_c), (whole_l, rest_l)) = (c.as_chunks::<LANES>(), l.as_chunks::<LANES>());
        for (c, l) in whole_c.iter().zip(whole_l) {
            for lane in 0..LANES {
                let gain = self.low(c[lane], l[lane]);
                most[lane] = if gain > most[lane] { gain } else { most[lane] };
            }
        }
        let most = most.into_iter().fold(0.0, f32::max);
        let most = rest_c.iter().zip(rest_l).fold(most, |most, (&c, &l)| most.max(self.low(c, l)));
        let least = most * (1.0 - SLACK);
        for (chunk, (c, l)) in whole_c.iter().zip(whole_l).enumerate() {
            let mut any = false;
            for lane in 0..LANES {
                any |= self.high(c[lane], l[lane]) >= least;
            }
            if any {
                for lane in 0..LANES {
                    if self.high(c[lane], l[lane]) >= least {
                        found(chunk * LANES + lane);
                    }
                }
            }
        }
        for (i, (&c, &l)) in rest_c.iter().zip(rest_l).enumerate() {
            if self.high(c, l) >= least {
                found(whole_c.len() * LANES + i);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn scans_are_those_of_plain_loops(scores in prop::collection::vec(-9i8..9, 0..70), least in 0u8..9) {
            let scores: Vec<f32> = scores.into_iter().map(f32::from).collect();
            prop_assert_eq!(largest::<true>(&scores), scores.iter().fold(0.0, |m: f32, s| m.max(s.abs())));
            prop_assert_eq!(largest::<false>(&scores), scores.iter().fold(0.0, |m: f32, &s| m.max(s)));
            let mut found = vec![];
            reaching::<false>(&scores, f32::from(least), |i| found.push(i));
            let plain: Vec<usize> = (0..scores.len()).filter(|&i| scores[i] >= f32::from(least)).collect();
            prop_assert_eq!(found, plain);
            let mut found = vec![];
            reaching::<true>(&scores, f32::from(least), |i| found.push(i));
            let plain: Vec<usize> = (0..scores.len()).filter(|&i| scores[i].abs() >= f32::from(least)).collect();
            prop_assert_eq!(found, plain);
        }

        #[test]
        fn the_best_is_among_the_contenders(
            truth in prop::collection::vec((-1.0f64..1.0, 0.0f64..1.0), 1..60),
            errors in prop::collection::vec((-1.0f64..=1.0, -1.0f64..=1.0), 60),
            (off_c, off_l) in (0.0f64..0.01, 0.0f64..0.01),
        ) {
            let uncertain = Uncertain { c: (off_c * 1.001) as f32 + 1e-7, l: (off_l * 1.001) as f32 + 1e-7, least: 1e-4 };
            let c: Vec<f32> = truth.iter().zip(&errors).map(|(t, e)| (t.0 + e.0 * off_c) as f32).collect();
            let l: Vec<f32> = truth.iter().zip(&errors).map(|(t, e)| (t.1 + e.1 * off_l) as f32).collect();
            let gain = |i: usize| truth[i].0 * truth[i].0 / truth[i].1;
            let counted = (0..truth.len()).filter(|&i| truth[i].1 >= 1e-4);
            let mut found = vec![];
            uncertain.contenders(&c, &l, |i| found.push(i));
            if let Some(best) = counted.max_by(|&a, &b| gain(a).total_cmp(&gain(b))) {
                prop_assert!(found.contains(&best));
            }
        }
    }
}
