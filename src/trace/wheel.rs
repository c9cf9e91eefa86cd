//! The wheel or plate of a run, as far as it was stated.

use std::fmt;

/// The lugs of a wheel: how many, and how high, as far as they are known.
///
/// An unknown count is not a count of 0: a wheel of which only the height of its lugs was published has
/// lugs, and a wheel of which nothing was stated may have them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lugs {
    /// Number of lugs; 0 on a smooth wheel, `None` where it is unknown.
    pub count: Option<u32>,
    /// Height \[m\]; NaN where it is unknown.
    pub height: f64,
}

impl Lugs {
    /// The lugs that `count` and `height` \[m\] of a file or campaign mean: height 0 is a smooth wheel
    /// also where no count is stated, and a smooth wheel's lugs have no height.
    pub fn stated(count: Option<u32>, height: f64) -> Self {
        match count {
            None if height == 0.0 => Self::NONE,
            Some(0) => Self::NONE,
            count => Self { count, height },
        }
    }

    /// Those of a smooth wheel.
    pub const NONE: Self = Self {
        count: Some(0),
        height: 0.0,
    };

    /// These, with what is unknown of them taken from `other` lugs.
    #[must_use]
    pub fn completed(self, other: Self) -> Self {
        let height = if self.height.is_nan() {
            other.height
        } else {
            self.height
        };
        Self {
            count: self.count.or(other.count),
            height,
        }
    }

    /// Whether the wheel is known to be smooth.
    pub fn are_none(&self) -> bool {
        self.count == Some(0)
    }
}

impl fmt::Display for Lugs {
    /// In words, the height to a hundredth of a millimetre.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let height = (self.height * 1.0e5).round() / 1.0e2;
        match self.count {
            Some(0) => f.write_str("no lugs"),
            Some(count) if height.is_nan() => write!(f, "{count} lugs, height not given"),
            Some(count) => write!(f, "{count} lugs of {height} mm"),
            None if height > 0.0 => write!(f, "lugs of {height} mm, count not given"),
            None => f.write_str("lugs not given"),
        }
    }
}

/// A plate that is pressed into the soil in place of a wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Plate {
    /// A round plate.
    Disc {
        /// Diameter \[m\].
        diameter: f64,
    },
    /// A rectangular plate.
    Rectangle {
        /// Longer or equal side \[m\].
        length: f64,
        /// Shorter or equal side \[m\].
        width: f64,
    },
}

impl Plate {
    /// The plate of two sides \[m\], in any order.
    pub fn rectangle(sides: [f64; 2]) -> Self {
        Self::Rectangle {
            length: sides[0].max(sides[1]),
            width: sides[0].min(sides[1]),
        }
    }

    /// Area \[m²\].
    pub fn area(&self) -> f64 {
        match *self {
            Self::Disc { diameter } => 0.25 * std::f64::consts::PI * diameter * diameter,
            Self::Rectangle { length, width } => length * width,
        }
    }

    /// `b` \[m\] of `k_c/b + k_φ`: the shorter side, of a round plate its radius.
    ///
    /// # Reference
    /// Wong, *Theory of Ground Vehicles*, section 2.4.
    pub fn smaller_dimension(&self) -> f64 {
        match *self {
            Self::Disc { diameter } => 0.5 * diameter,
            Self::Rectangle { width, .. } => width,
        }
    }
}

impl fmt::Display for Plate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |length: f64| (length * 1.0e5).round() / 1.0e2;
        match *self {
            Self::Disc { diameter } => write!(f, "plate of {} mm diameter", shown(diameter)),
            Self::Rectangle { length, width } => {
                write!(f, "plate of {} by {} mm", shown(length), shown(width))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_count_of_lugs_is_not_a_smooth_wheel() {
        let words = |count, height| Lugs::stated(count, height).to_string();
        assert_eq!(words(None, 0.005), "lugs of 5 mm, count not given");
        assert_eq!(words(None, f64::NAN), "lugs not given");
        assert_eq!(words(Some(28), 0.015), "28 lugs of 15 mm");
        assert_eq!(words(Some(28), f64::NAN), "28 lugs, height not given");
        assert_eq!(words(Some(0), 0.015), "no lugs");
        assert_eq!(words(None, 0.0), "no lugs");
        assert!(Lugs::stated(None, 0.0).are_none() && !Lugs::stated(None, 0.005).are_none());
    }

    #[test]
    fn the_smaller_dimension_is_the_shorter_side_or_the_radius() {
        let rectangle = Plate::rectangle([0.05, 0.2]);
        assert_eq!(rectangle.to_string(), "plate of 200 by 50 mm");
        assert!((rectangle.area() - 0.01).abs() < 1e-15);
        assert_eq!(rectangle.smaller_dimension(), 0.05);
        let disc = Plate::Disc { diameter: 0.06 };
        assert_eq!(disc.smaller_dimension(), 0.03);
        assert!((disc.area() - 2.827_433e-3).abs() < 1e-9);
    }
}
