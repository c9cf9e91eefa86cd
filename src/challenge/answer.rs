//! What a diagnosis answered, as far as it is scored.

use super::truth::effect_of;
pub use crate::diagnosis::Answer as Verdict;
use serde::Deserialize;
use std::collections::BTreeMap;

/// An effect that may be the cause.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Suspect {
    /// Name, with its channel where it has one.
    pub name: String,
    /// Magnitude in the catalogue's unit.
    pub magnitude: Option<f64>,
    /// 95 % interval of the magnitude; open where there is no number.
    pub ci95: Option<[Option<f64>; 2]>,
    /// Effects that the runs cannot distinguish from it.
    #[serde(default)]
    pub equivalent_to: Vec<String>,
}

/// Detectability of an effect.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Screened {
    /// Name, with its channel where it has one.
    pub name: String,
    /// Distance from the neutral magnitude that could just be detected; the magnitude itself where
    /// the neutral one is infinite.
    pub detectable: Option<f64>,
}

/// What was compared.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct Compared {
    /// Names of the effects that were tried.
    #[serde(default)]
    pub candidates: Vec<String>,
}

/// Share of the gap that an explanation closes.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Closed {
    /// The share [-].
    pub value: Option<f64>,
}

/// Where the cause acts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Mechanism {
    /// The sensor of a channel, or the motion.
    pub of: String,
}

/// The JSON of `diagnose`; keys that are not scored are not read.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Answer {
    /// What explains the measurements.
    pub verdict: Verdict,
    /// Probability [-] of `none`, `parameter`, `unknown`, each effect and each pair (`e+f`).
    pub probabilities: BTreeMap<String, f64>,
    /// Causes of which one is the true one nine times of ten, as in `probabilities`; empty where none are stated.
    #[serde(default)]
    pub set: Vec<String>,
    /// Where the cause acts, whatever it is; none where that is not stated.
    pub mechanism: Option<Mechanism>,
    /// Likeliest first.
    #[serde(default)]
    pub effects: Vec<Suspect>,
    /// The effect or effects of the verdict, each with what is equivalent to it.
    #[serde(default)]
    pub named: Vec<Vec<String>>,
    /// Share of the gap that the likeliest explanation closes.
    pub closed: Option<Closed>,
    /// Strongest cells of what is left.
    #[serde(default)]
    pub located: Vec<serde_json::Value>,
    /// The most informative next run.
    pub next_run: Option<serde_json::Value>,
    /// Detectability of every effect tested.
    #[serde(default)]
    pub screen: Vec<Screened>,
    /// What was compared.
    #[serde(default)]
    pub compared: Compared,
    /// Cosines of the projected signatures of the effects tried, row by row.
    #[serde(default)]
    pub isolability: Vec<Vec<Option<f64>>>,
}

impl Answer {
    /// How many effects the verdict names.
    fn count(&self) -> usize {
        match self.verdict {
            Verdict::Effect => 1,
            Verdict::Effects => 2,
            _ => 0,
        }
    }

    /// What the verdict names: a set of equivalent effects each, the one meant first. Where the
    /// answer has no `named`, its likeliest effects are meant.
    pub(super) fn sets(&self) -> Vec<Vec<String>> {
        if !self.named.is_empty() {
            return self.named.iter().take(self.count()).cloned().collect();
        }
        let suspects = self.effects.iter().take(self.count());
        let set = |it: &Suspect| {
            let own = std::iter::once(it.name.clone());
            own.chain(it.equivalent_to.iter().cloned()).collect()
        };
        suspects.map(set).collect()
    }

    /// The effect that the verdict names alone.
    pub(super) fn single(&self) -> Option<String> {
        let sets = self.sets();
        match (self.verdict, sets.first()) {
            (Verdict::Effect, Some(set)) => set.first().cloned(),
            _ => None,
        }
    }

    /// Probability [-] of a name; 0 where it has none.
    pub(super) fn probability(&self, name: &str) -> f64 {
        self.probabilities.get(name).copied().unwrap_or(0.0)
    }

    /// Probability [-] of two effects together, in either order.
    pub(super) fn probability_of_pair(&self, [a, b]: [&str; 2]) -> f64 {
        self.probability(&format!("{a}+{b}")) + self.probability(&format!("{b}+{a}"))
    }

    /// Probability [-] that nothing but parameters differs.
    pub(super) fn probability_of_nothing(&self) -> f64 {
        self.probability(Verdict::None.name()) + self.probability(Verdict::Parameter.name())
    }

    /// What was found of an effect.
    pub(super) fn suspect(&self, name: &str) -> Option<&Suspect> {
        self.effects.iter().find(|suspect| suspect.name == name)
    }

    /// What the verdict comes to in a word: an effect without its channel, or the verdict.
    pub(super) fn word(&self) -> String {
        match (self.verdict, self.single()) {
            (Verdict::Effect, Some(name)) => effect_of(&name).to_owned(),
            (Verdict::None | Verdict::Parameter, _) => "nothing".to_owned(),
            (Verdict::Effect | Verdict::Effects, _) => "two effects".to_owned(),
            (verdict, _) => verdict.name().to_owned(),
        }
    }

    /// The most informative next run, in words.
    pub(super) fn further_run(&self) -> Option<String> {
        let next = self.next_run.as_ref()?;
        let run = next.get("run").unwrap_or(next);
        run.as_str().map(str::to_owned)
    }
}
