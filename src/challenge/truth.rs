//! The true effects of a campaign, and their seal.
//!
//! The seal is the SHA-256 of the truth's file, byte by byte, so that `sha256sum` verifies it. The file
//! includes a salt: few truths are possible, and without it the hash could be found by exhaustive search.

use super::order::{Family, Set};
use crate::effects::{Application, EffectError, Form};
use crate::quantity::{Seed, hexadecimal};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Which of an effect's frozen magnitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Seldom less in practice.
    Low,
    /// Typical.
    Typical,
    /// Seldom more in practice.
    High,
}

impl Level {
    /// All of them, as a seat lists its magnitudes.
    pub const ALL: [Self; 3] = [Self::Low, Self::Typical, Self::High];
}

/// How a rig differs from its scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rig {
    /// As rigs do: every parameter within a standard deviation.
    Plain,
    /// Two parameters at 2 to 2.5 standard deviations.
    Tails,
    /// With a terrain that varies twice as much.
    Variable,
}

/// A number of the scenario that was changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Edit {
    /// Its key, as in `terrain.sand.soil.cohesion`.
    pub key: String,
    /// Its value \[SI\].
    pub value: f64,
}

/// An effect that the scenario has not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Name, with its channel where it has one.
    pub name: String,
    /// Magnitude, in `unit`.
    pub magnitude: f64,
    /// Unit of the magnitude.
    pub unit: String,
    /// The law it follows.
    pub form: Form,
    /// Which frozen magnitude it is; none where it was drawn from the prior.
    pub level: Option<Level>,
    /// Standard deviations `d'` [-] by which the effect alone moves the statistics of the campaign, for an oracle with
    /// known parameters; none where it was not or could not be computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detectability: Option<f64>,
    /// The same where only the distribution of the parameters is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detectability_beside_parameters: Option<f64>,
}

impl Hidden {
    /// It, to be simulated.
    ///
    /// # Errors
    /// Those of [`Application::new`] and [`Application::in_form`].
    pub fn application(&self) -> Result<Application, EffectError> {
        Application::new(&self.name, self.magnitude)?.in_form(self.form)
    }

    /// Its name without the channel.
    pub fn effect(&self) -> &str {
        effect_of(&self.name)
    }
}

/// The name of an effect without its channel.
pub(super) fn effect_of(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// What was done to make a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The case.
    pub case: String,
    /// What it is for.
    pub family: Family,
    /// The set it belongs to.
    pub set: Set,
    /// The ground.
    pub ground: String,
    /// How the rig differs from its scenario.
    pub rig: Rig,
    /// What that comes to.
    pub edits: Vec<Edit>,
    /// Effects excluded from the scenario.
    pub effects: Vec<Hidden>,
    /// Where ground and noise come from.
    pub seed: Seed,
    /// Random bits, in hexadecimal digits.
    pub salt: String,
}

impl Truth {
    /// Effects that a diagnosis of the case is not to know.
    pub fn without(&self) -> Vec<String> {
        match self.set {
            Set::C3 => self
                .effects
                .iter()
                .map(|it| it.effect().to_owned())
                .collect(),
            _ => Vec::new(),
        }
    }

    /// The same without what was computed of it.
    pub(super) fn as_drawn(&self) -> Self {
        let mut drawn = self.clone();
        for hidden in &mut drawn.effects {
            hidden.detectability = None;
            hidden.detectability_beside_parameters = None;
        }
        drawn
    }

    /// Its file, which is what is sealed.
    pub fn text(&self) -> String {
        let text =
            serde_json::to_string_pretty(self).expect("a truth holds finite numbers and names");
        text + "\n"
    }

    /// The truth in a file's `text`; none where that is not what `seal` was put on.
    pub fn open(text: &str, seal: &str) -> Option<Self> {
        if sha256(text.as_bytes()) != seal {
            return None;
        }
        serde_json::from_str(text).ok()
    }
}

/// SHA-256 in hexadecimal digits.
pub(super) fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> Truth {
        Truth {
            case: "case_0001".to_owned(),
            family: Family::Scoring,
            set: Set::C3,
            ground: "sand".to_owned(),
            rig: Rig::Plain,
            edits: vec![Edit {
                key: "wheel.friction".to_owned(),
                value: 0.1 + 0.2,
            }],
            effects: vec![Hidden {
                name: "gain_error.drawbar_pull".to_owned(),
                magnitude: 0.05,
                unit: "-".to_owned(),
                form: Form::Own,
                level: Some(Level::Typical),
                detectability: Some(6.25),
                detectability_beside_parameters: Some(2.5),
            }],
            seed: Seed(u64::MAX),
            salt: "00ff".to_owned(),
        }
    }

    #[test]
    fn a_seal_opens_with_the_truth_and_its_salt_alone() {
        let sealed = truth();
        let seal = sha256(sealed.text().as_bytes());
        assert_eq!(Truth::open(&sealed.text(), &seal), Some(sealed.clone()));
        let mut other_salt = sealed.clone();
        other_salt.salt = "00fe".to_owned();
        assert_eq!(Truth::open(&other_salt.text(), &seal), None);
        let mut other_magnitude = sealed.clone();
        other_magnitude.effects[0].magnitude = 0.050_000_000_000_000_01;
        assert_eq!(Truth::open(&other_magnitude.text(), &seal), None);
    }

    #[test]
    fn a_truth_that_was_sealed_without_a_detectability_opens_as_it_was() {
        let older = truth().as_drawn();
        let text = older.text();
        assert!(!text.contains("detectability"), "{text}");
        assert_eq!(Truth::open(&text, &sha256(text.as_bytes())), Some(older));
    }

    #[test]
    fn sha256_is_that_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), abc);
    }

    #[test]
    fn an_effect_is_left_out_on_all_its_channels_and_in_its_own_set_only() {
        let mut case = truth();
        assert_eq!(case.without(), ["gain_error"]);
        case.set = Set::C1;
        assert!(case.without().is_empty());
    }
}
