//! From the coordinates of the layers to the pixels of the map, across the antimeridian where need be.

use super::raster::Relief;
use crate::grid::GeoTransform;

/// The map's frame: a relief drawn `width` times `height` pixels large.
pub(super) struct Frame {
    transform: GeoTransform,
    /// Pixels a column and pixels a row.
    scale: (f64, f64),
    pub(super) width: u32,
    pub(super) height: u32,
    period_x: Option<f64>,
    /// Range of x on the map.
    range_x: (f64, f64),
    /// Range of y on the map.
    range_y: (f64, f64),
    /// Width and height in pixels of the rim in which the relief's outermost cells have their centres; where it
    /// comes back to itself eastwards there is none at its sides.
    rim: (f64, f64),
}

/// A point on the map in pixels.
pub(super) type Pixel = (f32, f32);

/// Lines go on this far beyond the frame, so that their ends do not show.
const MARGIN_PX: f64 = 40.0;

impl Frame {
    /// The frame of a relief.
    pub(super) fn new(relief: &Relief, width: u32, height: u32) -> Self {
        let (rows, cols) = (relief.rows as f64, relief.cols as f64);
        let corners = [(0.0, 0.0), (0.0, cols), (rows, 0.0), (rows, cols)];
        let corners = corners.map(|(row, col)| relief.transform.centre(row - 0.5, col - 0.5));
        let scale = (f64::from(width) / cols, f64::from(height) / rows);
        let period_x = relief.period_x.filter(|p| *p > 0.0 && p.is_finite());
        let range_x = range(corners.map(|c| c.0));
        let is_round = period_x.is_some_and(|period| range_x.1 - range_x.0 > period * (1.0 - 0.5 / cols));
        let rim = |scale: f64| (0.75 * scale).max(1.0);
        Self {
            transform: relief.transform,
            scale,
            width,
            height,
            period_x,
            range_x,
            range_y: range(corners.map(|c| c.1)),
            rim: (if is_round { f64::NEG_INFINITY } else { rim(scale.0) }, rim(scale.1)),
        }
    }

    /// Lines across the map at whole multiples of `step` units, as their coordinate and their pixel along the edge:
    /// those of equal x, then those of equal y; none on a rotated map.
    pub(super) fn multiples(&self, step: f64) -> [Vec<(f64, f32)>; 2] {
        if !self.transform.is_axis_parallel() || step <= 0.0 || !step.is_finite() {
            return [Vec::new(), Vec::new()];
        }
        let values = |(low, high): (f64, f64)| {
            let first = (low / step).ceil();
            (0..100).map(move |k| (first + f64::from(k)) * step).take_while(move |v| *v <= high)
        };
        [
            values(self.range_x).map(|x| (x, self.pixel(x, self.range_y.0).0 as f32)).collect(),
            values(self.range_y).map(|y| (y, self.pixel(self.range_x.0, y).1 as f32)).collect(),
        ]
    }

    /// Units of the coordinates in so many pixels, along the axis where they are more.
    pub(super) fn units(&self, pixels: f64) -> f64 {
        let x = (self.range_x.1 - self.range_x.0) / f64::from(self.width);
        let y = (self.range_y.1 - self.range_y.0) / f64::from(self.height);
        x.max(y) * pixels
    }

    fn pixel(&self, x: f64, y: f64) -> (f64, f64) {
        let (row, col) = self.transform.pixel(x, y);
        (col * self.scale.0, row * self.scale.1)
    }

    /// Whole periods to add to x so that the range from `low` to `high` meets the map.
    fn copies(&self, low: f64, high: f64) -> Vec<f64> {
        let Some(period) = self.period_x else { return vec![0.0] };
        let first = ((self.range_x.0 - high) / period).ceil();
        let last = ((self.range_x.1 - low) / period).floor();
        // A raster of more than a few turns is a wrong georeference: it is drawn, but not for ever.
        (0..8).map(|k| first + f64::from(k)).take_while(|&k| k <= last).map(|k| k * period).collect()
    }

    /// Where a point lies on the map; `None` outside of it.
    pub(super) fn point(&self, x: f64, y: f64) -> Option<Pixel> {
        self.copies(x, x).into_iter().map(|shift| self.pixel(x + shift, y)).find_map(|(px, py)| {
            let inside = (0.0..=f64::from(self.width)).contains(&px) && (0.0..=f64::from(self.height)).contains(&py);
            inside.then_some((px as f32, py as f32))
        })
    }

    /// At which sides of the map a pixel lies on the centres of the outermost cells.
    fn sides(&self, (x, y): (f64, f64)) -> [bool; 4] {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        [x < self.rim.0, width - x < self.rim.0, y < self.rim.1, height - y < self.rim.1]
    }

    /// Whether a pixel on the map is where the relief was cut off.
    pub(super) fn is_on_rim(&self, (x, y): Pixel) -> bool {
        self.sides((f64::from(x), f64::from(y))).contains(&true)
    }

    /// The parts of a line but those that run along the outermost cells: there the relief was cut, and no ridge is.
    pub(super) fn line_within(&self, path: &[(f64, f64)]) -> Vec<Vec<Pixel>> {
        let is_along = |w: &[Pixel]| {
            let [a, b] = [w[0], w[1]].map(|(x, y)| self.sides((f64::from(x), f64::from(y))));
            a.iter().zip(&b).any(|(a, b)| *a && *b)
        };
        let mut parts = Vec::new();
        for line in self.line(path) {
            let mut rest = line.as_slice();
            while let Some(end) = rest.windows(2).position(is_along) {
                let part = &rest[..=end];
                parts.extend((part.len() > 1).then(|| part.to_vec()));
                rest = &rest[end + 1..];
            }
            parts.extend((rest.len() > 1).then(|| rest.to_vec()));
        }
        parts
    }

    /// The parts of a line that lie on the map, or just beyond its edge.
    pub(super) fn line(&self, path: &[(f64, f64)]) -> Vec<Vec<Pixel>> {
        let mut parts = Vec::new();
        for run in path.split(|(x, y)| !(x.is_finite() && y.is_finite())) {
            let run = self.unrolled(run);
            let low = run.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
            let high = run.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
            for shift in self.copies(low, high) {
                let pixels: Vec<(f64, f64)> = run.iter().map(|&(x, y)| self.pixel(x + shift, y)).collect();
                self.clip(&self.unstreaked(&pixels), &mut parts);
            }
        }
        parts
    }

    /// The line with its jumps across the antimeridian undone: each vertex as near to the last as it can be.
    fn unrolled(&self, path: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let Some(period) = self.period_x else { return path.to_vec() };
        let mut out = Vec::with_capacity(path.len());
        let mut last: Option<f64> = None;
        for &(x, y) in path {
            let x = last.map_or(x, |last| x - ((x - last) / period).round() * period);
            out.push((x, y));
            last = Some(x);
        }
        out
    }

    /// The line cut where one step is out of all proportion: the seam of a projection of which no period is known.
    fn unstreaked(&self, pixels: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let length = |w: &[(f64, f64)]| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1);
        let mut steps: Vec<f64> = pixels.windows(2).map(length).collect();
        if self.period_x.is_some() || steps.len() < 3 {
            return vec![pixels.to_vec()];
        }
        let middle = steps.len() / 2;
        let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let limit = (20.0 * median).max(f64::from(self.width) / 2.0);
        let mut parts = vec![Vec::new()];
        for (i, &pixel) in pixels.iter().enumerate() {
            if i > 0 && length(&[pixels[i - 1], pixel]) > limit {
                parts.push(Vec::new());
            }
            parts.last_mut().expect("there is a first part").push(pixel);
        }
        parts
    }

    fn clip(&self, lines: &[Vec<(f64, f64)>], parts: &mut Vec<Vec<Pixel>>) {
        for line in lines {
            let mut open: Vec<Pixel> = Vec::new();
            for step in line.windows(2) {
                let Some((from, to)) = self.clipped(step[0], step[1]) else {
                    parts.extend((open.len() > 1).then(|| std::mem::take(&mut open)));
                    open.clear();
                    continue;
                };
                let (from, to) = ((from.0 as f32, from.1 as f32), (to.0 as f32, to.1 as f32));
                if open.last() != Some(&from) {
                    parts.extend((open.len() > 1).then(|| std::mem::take(&mut open)));
                    open = vec![from];
                }
                open.push(to);
            }
            parts.extend((open.len() > 1).then_some(open));
        }
    }

    /// The part of a segment within the frame and its margin (Liang and Barsky 1984).
    fn clipped(&self, a: (f64, f64), b: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let (right, bottom) = (f64::from(self.width) + MARGIN_PX, f64::from(self.height) + MARGIN_PX);
        for (rate, room) in [(-dx, a.0 + MARGIN_PX), (dx, right - a.0), (-dy, a.1 + MARGIN_PX), (dy, bottom - a.1)] {
            if rate == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if rate < 0.0 {
                enter = enter.max(room / rate);
            } else {
                leave = leave.min(room / rate);
            }
        }
        let at = |t: f64| {
            if t == 0.0 {
                a
            } else if t == 1.0 {
                b
            } else {
                (a.0 + t * dx, a.1 + t * dy)
            }
        };
        (enter < leave).then(|| (at(enter), at(leave)))
    }
}

fn range(values: [f64; 4]) -> (f64, f64) {
    (values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// A line without steps below `least_px`, its corners cut twice (Chaikin 1974): paths of cells lose their stairs.
pub(super) fn smoothed(line: &[Pixel], least_px: f32) -> Vec<Pixel> {
    let mut points: Vec<Pixel> = Vec::with_capacity(line.len());
    for &point in line {
        if points.last().is_none_or(|last| (point.0 - last.0).hypot(point.1 - last.1) >= least_px) {
            points.push(point);
        }
    }
    // The ends stay where they are: peaks and saddles are drawn there.
    if let (Some(&end), true) = (line.last(), points.len() > 1) {
        *points.last_mut().expect("it has two points") = end;
    } else {
        points.extend(line.last());
    }
    for _ in 0..2 {
        if points.len() < 3 {
            break;
        }
        let mut cut = Vec::with_capacity(2 * points.len());
        cut.push(points[0]);
        for w in points.windows(2) {
            let at = |t: f32| (w[0].0 + t * (w[1].0 - w[0].0), w[0].1 + t * (w[1].1 - w[0].1));
            cut.extend([at(0.25), at(0.75)]);
        }
        cut.push(points[points.len() - 1]);
        points = cut;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world() -> Frame {
        let t = GeoTransform([-180.0, 10.0, 0.0, 90.0, 0.0, -10.0]);
        let mut relief = Relief::new(18, 36, vec![0.0; 648], t, None).unwrap();
        relief.period_x = Some(360.0);
        Frame::new(&relief, 360, 180)
    }

    #[test]
    fn lines_across_the_antimeridian_do_not_streak() {
        let frame = world();
        for path in [[(179.0, 10.0), (-179.0, 10.0)], [(179.0, 10.0), (181.0, 10.0)], [(-181.0, 10.0), (-179.0, 10.0)]]
        {
            let parts = frame.line(&path);
            assert_eq!(parts.len(), 2, "one at each edge: {parts:?}");
            for part in parts {
                assert!(part.windows(2).all(|w| (w[0].0 - w[1].0).abs() < 3.0), "{part:?}");
            }
        }
    }

    #[test]
    fn seams_of_unknown_projections_are_cut() {
        let mut frame = world();
        frame.period_x = None;
        let path: Vec<(f64, f64)> = [176.0, 177.0, 178.0, 179.0, -179.0, -178.0].map(|x| (x, 0.0)).to_vec();
        let parts = frame.line(&path);
        assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [4, 2]);
        assert_eq!(frame.line(&[(-170.0, 0.0), (170.0, 0.0)]).len(), 1, "a single long line is meant");
    }

    #[test]
    fn points_are_found_whichever_way_round() {
        let frame = world();
        assert_eq!(frame.point(0.0, 0.0), Some((180.0, 90.0)));
        assert_eq!(frame.point(370.0, 0.0), Some((190.0, 90.0)));
        assert_eq!(frame.point(0.0, 91.0), None);
        assert_eq!(frame.point(f64::NAN, 0.0), None);
    }

    #[test]
    fn far_and_broken_lines_are_clipped() {
        let mut frame = world();
        frame.period_x = None;
        let parts = frame.line(&[(-1e12, 0.0), (1e12, 0.0)]);
        assert!(parts[0].iter().all(|p| p.0.abs() < 500.0), "{parts:?}");
        assert!(frame.line(&[(500.0, 0.0), (600.0, 0.0)]).is_empty());
        let broken = [(0.0, 0.0), (5.0, 0.0), (f64::NAN, 0.0), (7.0, 0.0), (9.0, 0.0)];
        assert_eq!(frame.line(&broken).len(), 2);
        assert!(frame.line(&[]).is_empty() && frame.line(&[(0.0, 0.0)]).is_empty());
    }

    #[test]
    fn lines_along_the_cut_are_left_out() {
        let relief = Relief::new(10, 10, vec![0.0; 100], GeoTransform::PIXELS, None).unwrap();
        let frame = Frame::new(&relief, 100, 100);
        let path = [(4.5, -4.5), (4.5, -0.5), (6.5, -0.5), (9.5, -0.5), (9.5, -3.5), (7.5, -3.5)];
        let parts = frame.line_within(&path);
        assert_eq!(parts, [vec![(45.0, 45.0), (45.0, 5.0)], vec![(95.0, 35.0), (75.0, 35.0)]]);
        assert!(frame.is_on_rim((45.0, 5.0)) && !frame.is_on_rim((45.0, 15.0)));
        let world = world();
        assert!(!world.is_on_rim((0.5, 90.0)) && world.is_on_rim((0.5, 3.0)), "only the poles");
    }

    #[test]
    fn smoothing_keeps_the_ends() {
        let stairs: Vec<Pixel> = (0..20_usize).map(|i| ((i / 2 * 4) as f32, (i.div_ceil(2) * 4) as f32)).collect();
        let smooth = smoothed(&stairs, 1.0);
        assert_eq!((smooth[0], smooth[smooth.len() - 1]), (stairs[0], stairs[19]));
        let dense: Vec<Pixel> = (0..100).map(|i| (i as f32 * 0.1, 0.0)).collect();
        assert!(smoothed(&dense, 1.0).len() < 60);
        assert_eq!(smoothed(&[(1.0, 1.0), (1.1, 1.0)], 1.0), [(1.0, 1.0), (1.1, 1.0)]);
    }
}
