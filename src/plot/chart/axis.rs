//! Round numbers along an axis.

/// Round numbers from 0 to the first one at or beyond `end`, in steps of 1, 2, 2.5 or 5 times a power of ten, so that
/// there are at most `most` steps.
///
/// For an `end` that is not positive, a single step to 1.
pub(super) fn ticks_to(end: f64, most: u32) -> Vec<f64> {
    if !(end > 0.0 && end.is_finite()) {
        return vec![0.0, 1.0];
    }
    let least = end / f64::from(most.max(1));
    let power = 10.0_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|&s| s >= least * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0 * power);
    let steps = (end / step * (1.0 - 1e-9)).ceil().max(1.0) as u32;
    (0..=steps).map(|i| f64::from(i) * step).collect()
}

/// A tick as text: as few decimals as tell it apart, thousands set off with a thin space.
pub(super) fn tick_text(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    let (sign, digits) = text.strip_prefix('-').map_or(("", text), |digits| ("\u{2212}", digits));
    let whole = digits.split('.').next().unwrap_or(digits).len();
    if whole <= 4 {
        return format!("{sign}{digits}");
    }
    let mut grouped = String::from(sign);
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && i < whole && (whole - i).is_multiple_of(3) {
            grouped.push('\u{2009}');
        }
        grouped.push(c);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers() {
        let texts = |end, most| ticks_to(end, most).into_iter().map(tick_text).collect::<Vec<_>>().join(" ");
        assert_eq!(texts(1.0, 5), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(texts(2000.0, 4), "0 500 1000 1500 2000");
        assert_eq!(texts(30.0, 3), "0 10 20 30");
        assert_eq!(texts(0.37, 4), "0 0.1 0.2 0.3 0.4");
        assert_eq!(texts(72.0, 4), "0 20 40 60 80");
        assert_eq!(texts(0.0, 4), "0 1");
        assert_eq!(tick_text(-12_000.0), "\u{2212}12\u{2009}000");
    }
}
