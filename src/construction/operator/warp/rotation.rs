//! Sine and cosine that are the same everywhere, which the system's mathematical libraries are not.

/// Radians in a degree.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Cosine and sine of an angle in degrees; exact for multiples of 90.
///
/// Taylor series up to the 17th power of at most 45 degrees: the first term left out is below 1e-18.
pub(in crate::construction) fn rotation(degrees: f64) -> (f64, f64) {
    // The remainder of floats is exact.
    let turn = degrees % 360.0;
    let quarter = (turn / 90.0 + 0.5).floor();
    let x = (turn - 90.0 * quarter) * DEGREE;
    let s = x * x;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for n in (1..=8).rev() {
        let n = f64::from(n);
        // Horner's rule on 1 - s / (m (m + 1)) (1 - ...).
        sine = -s / ((2.0 * n) * (2.0 * n + 1.0)) * (1.0 + sine);
        cosine = -s / ((2.0 * n - 1.0) * (2.0 * n)) * (1.0 + cosine);
    }
    let (sine, cosine) = (x * (1.0 + sine), 1.0 + cosine);
    match (quarter as i64).rem_euclid(4) {
        0 => (cosine, sine),
        1 => (-sine, cosine),
        2 => (-cosine, -sine),
        _ => (sine, -cosine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library_and_is_exact_at_right_angles() {
        for i in -4000..4000 {
            let degrees = f64::from(i) * 0.37;
            let (cosine, sine) = rotation(degrees);
            let (s, c) = degrees.to_radians().sin_cos();
            assert!((cosine - c).abs() < 1e-14 && (sine - s).abs() < 1e-14, "{degrees}: {cosine} {sine}, {c} {s}");
        }
        assert_eq!(rotation(90.0), (0.0, 1.0));
        assert_eq!(rotation(-180.0), (-1.0, 0.0));
        assert_eq!(rotation(720.0), (1.0, 0.0));
        let (cosine, sine) = rotation(30.0);
        assert!((sine - 0.5).abs() < 1e-16 && (cosine * cosine - 0.75).abs() < 1e-15);
    }
}
