//! Specification of a trial: cases, number, grounds and seed.

use super::{ChallengeError, GROUNDS};
use crate::quantity::{RangeError, Seed};
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A set of cases with the same question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Set {
    /// Nothing withheld: a third with parameters far in the tails, a sixth with doubled variability
    /// of the terrain.
    C0,
    /// One effect in the catalogue's own form, at its low, typical or high magnitude.
    C1,
    /// The same in another form.
    C2,
    /// One effect that is excluded from the diagnosis: the right answer is unknown.
    C3,
    /// Two effects.
    C4,
}

impl Set {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::C0, Self::C1, Self::C2, Self::C3, Self::C4];

    /// Its name in files.
    pub fn as_str(self) -> &'static str {
        ["C0", "C1", "C2", "C3", "C4"][self as usize]
    }
}

impl fmt::Display for Set {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What cases are for. A case that temperatures or thresholds of a diagnosis were set on must never
/// be scored, so each family has seeds of its own: the two uppermost bits are `11` for scoring and
/// `01` for calibration, and everybody else's seeds have been smaller ([`Family::of`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// To score a diagnosis.
    Scoring,
    /// To set what a diagnosis does not know: magnitudes follow the catalogue's priors.
    Calibration,
}

/// The bit that a scoring seed has and a calibration seed has not.
const SCORING: u64 = 1 << 63;
/// The bit that both have and the seeds of others have not.
const TRIAL: u64 = 1 << 62;

impl Family {
    /// The seed of case `number` of the trial that `master` begins.
    pub fn seed(self, master: Seed, number: u64) -> Seed {
        let drawn: u64 = self.rng(master, "seed", number).random();
        let family = match self {
            Self::Scoring => SCORING,
            Self::Calibration => 0,
        };
        Seed((drawn & !(SCORING | TRIAL)) | TRIAL | family)
    }

    /// The seed of the runs that measure the noise of a ground; its uppermost bits are `10`, so that it is no case's.
    pub(super) fn oracle_seed(self, master: Seed, ground: &str) -> Seed {
        let drawn: u64 = self.rng(master, &format!("oracle {ground}"), 0).random();
        Seed((drawn & !TRIAL) | SCORING)
    }

    /// The family that a seed belongs to; none where it is no case's.
    pub fn of(seed: Seed) -> Option<Self> {
        match (seed.0 & TRIAL != 0, seed.0 & SCORING != 0) {
            (false, _) => None,
            (true, true) => Some(Self::Scoring),
            (true, false) => Some(Self::Calibration),
        }
    }

    /// The stream of one purpose of a case.
    pub(super) fn rng(self, master: Seed, purpose: &str, number: u64) -> rand_chacha::ChaCha8Rng {
        let family = match self {
            Self::Scoring => "scoring",
            Self::Calibration => "calibration",
        };
        master.rng(&format!("challenge {family} {purpose}"), number)
    }
}

/// Sets of one family.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Selection {
    /// What the cases are for.
    pub family: Family,
    /// The sets, each once, in their order.
    pub sets: Vec<Set>,
}

impl Selection {
    /// All cases for scoring.
    pub fn all() -> Self {
        Self {
            family: Family::Scoring,
            sets: Set::ALL.to_vec(),
        }
    }

    /// Cases to set a diagnosis with: of all kinds, but in no effect's other form, on which
    /// nothing may be set.
    pub fn calibration() -> Self {
        Self {
            family: Family::Calibration,
            sets: vec![Set::C0, Set::C1, Set::C3, Set::C4],
        }
    }
}

/// Reads names of sets with commas between them, `all` or `calibration`.
impl FromStr for Selection {
    type Err = ChallengeError;

    fn from_str(text: &str) -> Result<Self, ChallengeError> {
        match text {
            "all" => return Ok(Self::all()),
            "calibration" => return Ok(Self::calibration()),
            _ => {}
        }
        let named = |name: &str| {
            let set = Set::ALL.into_iter().find(|set| set.as_str() == name);
            set.ok_or_else(|| ChallengeError::NoSet(name.to_owned()))
        };
        let mut sets: Vec<Set> = text.split(',').map(named).collect::<Result<_, _>>()?;
        sets.sort();
        sets.dedup();
        Ok(Self {
            family: Family::Scoring,
            sets,
        })
    }
}

/// What a trial is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Which sets.
    pub selection: Selection,
    /// How many cases at most, balanced over sets, effects and magnitudes; all where not given.
    pub cases: Option<usize>,
    /// Names of the grounds, of [`GROUNDS`].
    pub grounds: Vec<String>,
    /// Duration \[s\] of every run, and the longest lead-in; the design's where not given.
    pub duration: Option<f64>,
    /// Whether effects are sealed without their detectability, which on gravel takes longer than the campaigns.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub without_detectability: bool,
    /// Where all randomness comes from.
    pub seed: Seed,
}

impl Order {
    /// # Errors
    /// `NoGround` for a ground that is none; `Duration` for one that is not positive.
    pub fn check(&self) -> Result<(), ChallengeError> {
        if let Some(duration) = self.duration {
            RangeError::positive("duration", "s", duration)?;
        }
        let unknown = |ground: &&String| !GROUNDS.contains(&ground.as_str());
        match self.grounds.iter().find(unknown) {
            Some(ground) => Err(ChallengeError::NoGround(ground.clone())),
            None if self.grounds.is_empty() => Err(ChallengeError::NoGround(String::new())),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn calibration_cases_scoring_cases_and_everybody_else_never_share_a_seed() {
        let mut seen = BTreeSet::new();
        for family in [Family::Scoring, Family::Calibration] {
            for master in [0, 1, u64::MAX] {
                for number in 0..500 {
                    let seed = family.seed(Seed(master), number);
                    assert_eq!(Family::of(seed), Some(family));
                    assert!(seed.0 >= TRIAL);
                    assert!(seen.insert(seed.0), "{family:?} {master} {number}");
                }
            }
        }
        let oracle = Family::Scoring.oracle_seed(Seed(1), "hard");
        for seed in [0, 1, 228_499, TRIAL - 1, oracle.0] {
            assert_eq!(Family::of(Seed(seed)), None);
        }
    }

    #[test]
    fn a_selection_is_read_from_its_name_and_nothing_is_set_on_other_forms() {
        let sets = |text: &str| text.parse::<Selection>().unwrap();
        assert_eq!(sets("all"), Selection::all());
        assert_eq!(sets("C2").sets, [Set::C2]);
        assert_eq!(sets("C3,C0").sets, [Set::C0, Set::C3]);
        let calibration = sets("calibration");
        assert_eq!(calibration.family, Family::Calibration);
        assert!(!calibration.sets.contains(&Set::C2));
        let error = "C9".parse::<Selection>().unwrap_err().to_string();
        assert!(error.contains("there is no set `C9`"), "{error}");
    }
}
