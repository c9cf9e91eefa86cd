//! Parts of the method that a study leaves out, to tell what each is worth.

use super::calibration::Calibration;
use super::plan::Plan;
use std::fmt;
use std::str::FromStr;

/// A part of the method to do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ablation {
    /// Parameters stay at the scenario's values.
    Recalibration,
    /// Explanations are ranked by their evidence on all conditions, each of which their fits have seen.
    HeldOut,
    /// Refits alone give probabilities.
    Forest,
}

/// A text that names no part of the method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no part of the method is called `{0}`; there are recalibration, held-out, forest")]
pub struct NoSuchPart(String);

impl Ablation {
    const ALL: [Self; 3] = [Self::Recalibration, Self::HeldOut, Self::Forest];

    fn as_str(self) -> &'static str {
        match self {
            Self::Recalibration => "recalibration",
            Self::HeldOut => "held-out",
            Self::Forest => "forest",
        }
    }

    pub(super) fn of_plan(self, plan: &mut Plan) {
        if self == Self::Recalibration {
            plan.slopes.clear();
        }
    }

    pub(super) fn of_calibration(self, calibration: &mut Calibration) {
        match self {
            Self::Recalibration => {}
            Self::HeldOut => calibration.held_out = false,
            Self::Forest => calibration.forest_share = 0.0,
        }
    }
}

impl fmt::Display for Ablation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for Ablation {
    type Err = NoSuchPart;

    fn from_str(text: &str) -> Result<Self, NoSuchPart> {
        let mut all = Self::ALL.into_iter();
        all.find(|part| part.as_str() == text)
            .ok_or_else(|| NoSuchPart(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_a_name_by_which_it_is_found() {
        for part in Ablation::ALL {
            assert_eq!(part.to_string().parse(), Ok(part));
        }
        let unknown = "luck".parse::<Ablation>().unwrap_err().to_string();
        assert!(
            Ablation::ALL
                .iter()
                .all(|part| unknown.contains(part.as_str()))
        );
    }
}
