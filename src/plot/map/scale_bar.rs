//! The scale bar: a round length that fits the room.

use super::text::grouped;

/// A length to draw, and what to write at it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScaleBar {
    /// The length on the ground.
    pub(super) length_m: f64,
    /// The length on the picture.
    pub(super) width_px: f64,
    /// Number of fields of black and white.
    pub(super) fields: u32,
    /// Unit of the labels: its name and metres.
    unit: (&'static str, f64),
}

impl ScaleBar {
    /// The longest bar of 1, 2 or 5 times a power of ten that is at most `room_px` wide; `None` without a scale.
    pub(super) fn fit(m_per_px: f64, room_px: f64) -> Option<Self> {
        let room_m = m_per_px * room_px;
        if !(room_m > 0.0 && room_m.is_finite()) {
            return None;
        }
        let power = room_m.log10().floor() as i32;
        // One power more, as a logarithm may round either way.
        let (digit, power) = (power - 1..=power + 1)
            .flat_map(|p| [1, 2, 5].map(|digit| (digit, p)))
            .rfind(|&(digit, p)| f64::from(digit) * 10_f64.powi(p) <= room_m * (1.0 + 1e-9))?;
        let length_m = f64::from(digit) * 10_f64.powi(power);
        let unit = if length_m >= 1000.0 {
            ("km", 1000.0)
        } else if length_m >= 1.0 {
            ("m", 1.0)
        } else if length_m >= 0.01 {
            ("cm", 0.01)
        } else {
            ("mm", 0.001)
        };
        let fields = if digit == 5 { 5 } else { 4 };
        Some(Self { length_m, width_px: length_m / m_per_px, fields, unit })
    }

    /// What to write at the end of the bar.
    pub(super) fn label(&self) -> String {
        let amount = self.length_m / self.unit.1;
        let text = if amount >= 1.0 { grouped(amount) } else { format!("{amount}") };
        format!("{text} {}", self.unit.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_as_long_as_the_room_allows() {
        for i in 0..400 {
            let m_per_px = 1e-4 * 1.07_f64.powi(i);
            let bar = ScaleBar::fit(m_per_px, 200.0).unwrap();
            assert!(bar.width_px <= 200.0 * 1.000_001 && bar.width_px > 200.0 / 2.5 * 0.999, "{bar:?}");
            let digit = bar.length_m / 10_f64.powf(bar.length_m.log10().floor() + 1e-12);
            let digit = if digit > 9.99 { digit / 10.0 } else { digit };
            assert!([1.0, 2.0, 5.0].iter().any(|d| (digit / d - 1.0).abs() < 1e-6), "{bar:?}");
        }
    }

    #[test]
    fn labels_have_a_unit_that_suits() {
        let label = |m_per_px: f64| ScaleBar::fit(m_per_px, 200.0).unwrap().label();
        assert_eq!(label(25.0), "5 km");
        assert_eq!(label(9000.0), "1\u{202F}000 km");
        assert_eq!(label(1.0), "200 m");
        assert_eq!(label(0.0031), "50 cm");
        assert_eq!(label(5.0), "1 km");
    }

    #[test]
    fn no_scale_no_bar() {
        assert_eq!(ScaleBar::fit(0.0, 200.0), None);
        assert_eq!(ScaleBar::fit(f64::NAN, 200.0), None);
    }
}
