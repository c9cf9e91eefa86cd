//! What may explain a gap.

use super::emulator::Emulator;
use super::verdict::Answer;

/// Names of explanations without effects.
pub(super) const NONE: &str = Answer::None.name();
pub(super) const PARAMETER: &str = Answer::Parameter.name();
pub(super) const UNKNOWN: &str = Answer::Unknown.name();

/// An explanation, effects by their place among the candidates.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Hypothesis {
    /// Nothing is wrong: parameters at the middle of their priors.
    None,
    /// Parameters only.
    Parameter,
    /// One effect or two, with the parameters as they may be.
    Effects(Vec<usize>),
    /// Differences of no known form.
    Unknown,
}

/// Spreads of all parameters [prior standard deviations] and how probable each is: none moved, all
/// but right, as the prior says, far in its tails.
const SCALES: [(f64, f64); 4] = [(0.0, 0.3), (0.3, 0.2), (1.0, 0.35), (3.0, 0.15)];
/// The same of one parameter alone, shared alike among them.
const ALONE: [(f64, f64); 2] = [(1.0, 0.3), (3.0, 0.15)];

/// How far parameters may be from the middle of their priors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    /// Of each parameter [prior standard deviations]; 0 where it does not move.
    pub spreads: Vec<f64>,
    /// How probable that is [-].
    pub probability: f64,
}

impl Hypothesis {
    /// What explains without effects: parameters, where there are any.
    pub fn freest(emulator: &Emulator) -> Self {
        match emulator.parameters.is_empty() {
            true => Self::None,
            false => Self::Parameter,
        }
    }

    /// The same without one of its effects.
    pub fn without(&self, effect: usize, emulator: &Emulator) -> Self {
        let others = self.effects().iter().filter(|other| **other != effect);
        match others.copied().collect::<Vec<_>>() {
            none if none.is_empty() => Self::freest(emulator),
            others => Self::Effects(others),
        }
    }

    /// Its effects.
    pub fn effects(&self) -> &[usize] {
        match self {
            Self::Effects(effects) => effects,
            _ => &[],
        }
    }

    /// Its name in results.
    pub fn name(&self, emulator: &Emulator) -> String {
        match self {
            Self::None => NONE.to_owned(),
            Self::Parameter => PARAMETER.to_owned(),
            Self::Unknown => UNKNOWN.to_owned(),
            Self::Effects(effects) => {
                let names = effects.iter().map(|&e| &*emulator.candidates[e].name);
                names.collect::<Vec<_>>().join("+")
            }
        }
    }

    /// How far so many parameters may be off, with probabilities that sum to one.
    pub fn scales(&self, parameters: usize) -> Vec<Scale> {
        let allowed = |scale: f64| match self {
            Self::None => scale == 0.0,
            Self::Parameter => scale > 0.0,
            _ => parameters > 0 || scale == 0.0,
        };
        let all = SCALES.into_iter().filter(|(s, _)| allowed(*s));
        let mut scales: Vec<Scale> = all
            .map(|(spread, probability)| Scale {
                spreads: vec![spread; parameters],
                probability,
            })
            .collect();
        if *self == Self::Parameter {
            for place in 0..parameters {
                scales.extend(ALONE.map(|(spread, probability)| {
                    let mut spreads = vec![0.0; parameters];
                    spreads[place] = spread;
                    Scale {
                        spreads,
                        probability: probability / parameters as f64,
                    }
                }));
            }
        }
        let sum: f64 = scales.iter().map(|scale| scale.probability).sum();
        for scale in &mut scales {
            scale.probability /= sum;
        }
        scales
    }
}
