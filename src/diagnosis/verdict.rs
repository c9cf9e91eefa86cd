//! The answer: probabilities of causes, and what they come to. A pure function of a judgement.
//!
//! - *Verdict*: the kind of cause with at least half of the probability; `undecided` where no kind has it, or where no
//!   single cause of the kind has it.
//! - *Set*: the causes of which one is the true one nine times of ten, by conformal prediction on rigs of the layout.
//! - *Mechanism*: what most of the probability of effects has in common, where no single one is likely enough.

use super::candidate::Candidate;
use super::inference::{Judgement, SelfTest};
use super::next_run::NextRun;
use super::rigs::Part;
use super::screen::Screened;
use crate::gap::{Cell, Condition};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Probability [-] from which on a cause is named.
const NAMED: f64 = 0.5;
/// Coverage on rigs of the layout [-] below which nothing is named.
const LEAST_COVERAGE: f64 = 0.8;

/// What explains the measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Answer {
    /// Nothing is wrong.
    None,
    /// Parameters are off.
    Parameter,
    /// An effect is missing, one of a set that cannot be distinguished.
    Effect,
    /// Two effects are missing.
    Effects,
    /// Something that no effect makes.
    Unknown,
    /// No cause is likely enough.
    Undecided,
}

impl Answer {
    /// Its name, also that of its probability; an effect's probability has the effect's own.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Parameter => "parameter",
            Self::Effect => "effect",
            Self::Effects => "effects",
            Self::Unknown => "unknown",
            Self::Undecided => "undecided",
        }
    }
}

/// An effect that may be the cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspect {
    /// Name with the channel.
    pub name: String,
    /// Probability [-] that it is there, alone or with another.
    pub probability: f64,
    /// Magnitude where it is there, in `unit`.
    pub magnitude: f64,
    /// Unit of the magnitude.
    pub unit: &'static str,
    /// 95 % interval of the magnitude, in `unit`.
    pub ci95: [f64; 2],
    /// Effects that these runs cannot distinguish from it.
    pub equivalent_to: Vec<String>,
    /// Distance from the neutral magnitude that shows itself with three deviations, in `unit`, or
    /// the magnitude itself where the neutral one is infinite; none where none does.
    pub detectable: Option<f64>,
    /// Share [-] of its signature that parameters absorb.
    pub absorbed: f64,
}

/// A parameter as recalibrated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recalibrated {
    /// Its name.
    pub name: String,
    /// Distance from the scenario's value [prior standard deviations].
    pub offset: f64,
    /// Standard deviation of that.
    pub deviation: f64,
}

/// Where something is left that parameters do not explain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Located {
    /// In which condition.
    pub condition: Condition,
    /// In which cell.
    pub cell: Cell,
    /// Measured less predicted \[deviations\].
    pub deviations: f64,
}

/// What likely effects have in common.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mechanism {
    /// Where they act: a channel's sensor, or the motion of wheel, drive, rig and ground.
    pub of: String,
    /// Probability [-] that the cause acts there.
    pub probability: f64,
}

/// Where an effect acts: the motion, or the sensor of the `channel` on which it sits, all sensors where that is empty.
pub fn place_of(changes_motion: bool, channel: &str) -> String {
    match (changes_motion, channel) {
        (true, _) => "the motion of wheel, drive, rig and ground".to_owned(),
        (false, "") => "all sensors".to_owned(),
        (false, channel) => format!("the sensor of {channel}"),
    }
}

/// The answer with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// What explains the measurements.
    pub verdict: Answer,
    /// The effect or effects of the answer, each with what is equivalent to it.
    pub named: Vec<Vec<String>>,
    /// Probability [-] of `none`, `parameter`, `unknown`, each effect and each pair (`e+f`) tried; they sum to one.
    pub probabilities: BTreeMap<String, f64>,
    /// Causes of which one is the true one nine times of ten, likeliest first.
    pub set: Vec<String>,
    /// What likely effects have in common; none where effects are unlikely.
    pub mechanism: Option<Mechanism>,
    /// Likeliest first.
    pub effects: Vec<Suspect>,
    /// Parameters beside the effects of the answer.
    pub parameters: Vec<Recalibrated>,
    /// Parameters recalibrated without any effect.
    pub recalibration: Vec<Recalibrated>,
    /// Strongest cells of what recalibration leaves.
    pub located: Vec<Located>,
    /// The run that best discriminates between the two likeliest effects, where the answer is open.
    pub next_run: Option<NextRun>,
    /// Why the answer is less sure than it could be.
    pub reasons: Vec<String>,
}

/// What effects a verdict rests on, in the numbers of the candidates.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Effects with their sizes: those named, else the likeliest.
    pub effects: Vec<Part>,
}

/// Effects of an explanation, and its probability.
struct Explanation {
    effects: Vec<Part>,
    probability: f64,
}

/// Most probable single effect or pair.
fn likeliest(judgement: &Judgement) -> Explanation {
    let sizes = &judgement.opinion.evidence.sizes;
    let single = judgement.effects.iter().copied().enumerate();
    let single = single.max_by(|a, b| a.1.total_cmp(&b.1));
    let pair = judgement.pairs.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    match (single, pair) {
        (Some((_, p)), Some((pair, of_pair))) if *of_pair > p => {
            let parts = pair.effects.into_iter().zip(pair.sizes);
            let parts = parts.map(|(candidate, size)| Part { candidate, size });
            Explanation {
                effects: parts.collect(),
                probability: *of_pair,
            }
        }
        (Some((candidate, probability)), _) => Explanation {
            effects: vec![Part {
                candidate,
                size: sizes[candidate].middle,
            }],
            probability,
        },
        (None, _) => Explanation {
            effects: Vec::new(),
            probability: 0.0,
        },
    }
}

impl Chosen {
    /// The likeliest effect or effects.
    pub fn of(judgement: &Judgement) -> Self {
        Self {
            effects: likeliest(judgement).effects,
        }
    }
}

/// What a verdict is made of.
pub struct Grounds<'a> {
    /// Effects that were tried.
    pub candidates: &'a [Candidate],
    /// What can be seen of them, in their order.
    pub screen: &'a [Screened],
    /// Judgement of the model.
    pub judgement: &'a Judgement,
    /// What may be expected of it.
    pub self_test: &'a SelfTest,
}

impl Grounds<'_> {
    /// The verdict; parameters, places and the next run are for the caller to add.
    pub fn verdict(&self) -> Verdict {
        let probabilities = self.probabilities();
        let (verdict, effects) = self.answer();
        let named = effects.iter().map(|effect| self.alike(*effect));
        Verdict {
            named: named.collect(),
            set: self.set(&probabilities),
            mechanism: self.mechanism(),
            effects: self.suspects(),
            parameters: Vec::new(),
            recalibration: Vec::new(),
            located: Vec::new(),
            next_run: None,
            reasons: self.reasons(),
            probabilities,
            verdict,
        }
    }

    fn is_trusted(&self) -> bool {
        self.self_test.coverage >= LEAST_COVERAGE
    }

    /// The answer, and the effects that it names.
    fn answer(&self) -> (Answer, Vec<usize>) {
        let judgement = self.judgement;
        let nothing = judgement.none + judgement.parameter;
        if !self.is_trusted() {
            return (Answer::Undecided, Vec::new());
        }
        if nothing >= NAMED {
            let answer = if judgement.none > judgement.parameter {
                Answer::None
            } else {
                Answer::Parameter
            };
            return (answer, Vec::new());
        }
        if judgement.unknown >= NAMED {
            return (Answer::Unknown, Vec::new());
        }
        let likeliest = likeliest(judgement);
        if likeliest.probability >= NAMED {
            let effects = likeliest.effects.iter().map(|part| part.candidate);
            let effects: Vec<usize> = effects.collect();
            let answer = match effects.len() {
                1 => Answer::Effect,
                _ => Answer::Effects,
            };
            return (answer, effects);
        }
        // An effect that is there in most of the probability, alone or with any other.
        let present = (0..judgement.effects.len())
            .max_by(|a, b| judgement.presence(*a).total_cmp(&judgement.presence(*b)));
        match present.filter(|effect| judgement.presence(*effect) >= NAMED) {
            Some(effect) => (Answer::Effect, vec![effect]),
            None => (Answer::Undecided, Vec::new()),
        }
    }

    /// An effect and all that cannot be distinguished from it.
    fn alike(&self, effect: usize) -> Vec<String> {
        let screened = &self.screen[effect];
        let others = screened.equivalent.iter().map(|(name, _)| name.clone());
        std::iter::once(screened.name.clone())
            .chain(others)
            .collect()
    }

    fn probabilities(&self) -> BTreeMap<String, f64> {
        let judgement = self.judgement;
        let plain = [
            (Answer::None, judgement.none),
            (Answer::Parameter, judgement.parameter),
            (Answer::Unknown, judgement.unknown),
        ];
        let plain = plain.map(|(answer, p)| (answer.name().to_owned(), p));
        let name = |effect: usize| self.screen[effect].name.clone();
        let effects = judgement.effects.iter().enumerate();
        let effects = effects.map(|(effect, p)| (name(effect), *p));
        let pairs = judgement.pairs.iter().map(|(pair, p)| {
            let names = pair.effects.map(name);
            (names.join("+"), *p)
        });
        plain.into_iter().chain(effects).chain(pairs).collect()
    }

    fn set(&self, probabilities: &BTreeMap<String, f64>) -> Vec<String> {
        let mut order: Vec<(&String, f64)> =
            probabilities.iter().map(|(name, p)| (name, *p)).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        let within = order.iter().enumerate().filter(|(place, (_, p))| {
            // The likeliest cause is never left out.
            *place == 0 || *p >= self.judgement.threshold
        });
        within.map(|(_, (name, _))| (*name).clone()).collect()
    }

    fn mechanism(&self) -> Option<Mechanism> {
        let mut places: BTreeMap<String, f64> = BTreeMap::new();
        for (effect, candidate) in self.candidates.iter().enumerate() {
            let of = place_of(candidate.changes_motion(), candidate.seat.channel);
            *places.entry(of).or_default() += self.judgement.presence(effect);
        }
        let likeliest = places.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let likely = likeliest.filter(|(_, probability)| *probability >= NAMED);
        likely.map(|(of, probability)| Mechanism {
            of,
            probability: probability.min(1.0),
        })
    }

    fn suspects(&self) -> Vec<Suspect> {
        let sizes = &self.judgement.opinion.evidence.sizes;
        let suspect = |(place, candidate): (usize, &Candidate)| {
            let screened = &self.screen[place];
            let ends = sizes[place].interval.map(|size| candidate.magnitude(size));
            Suspect {
                name: screened.name.clone(),
                probability: self.judgement.presence(place),
                magnitude: candidate.magnitude(sizes[place].middle),
                unit: candidate.seat.unit,
                ci95: [ends[0].min(ends[1]), ends[0].max(ends[1])],
                equivalent_to: self.alike(place).split_off(1),
                detectable: screened.detectable,
                absorbed: screened.absorbed,
            }
        };
        let mut suspects: Vec<Suspect> = self.candidates.iter().enumerate().map(suspect).collect();
        suspects.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        suspects
    }

    fn reasons(&self) -> Vec<String> {
        let mut reasons = Vec::new();
        if !self.is_trusted() {
            reasons.push(format!(
                "on rigs of this layout with known causes the set contains the true one in {:.0} % only: no \
                 cause is named",
                100.0 * self.self_test.coverage
            ));
        }
        reasons
    }
}

impl Verdict {
    /// Probability [-] of an answer that names no effect; 0 where it has none.
    pub fn probability(&self, answer: Answer) -> f64 {
        let known = self.probabilities.get(answer.name());
        known.copied().unwrap_or_default()
    }

    /// The two likeliest effects, where the answer leaves open which it is.
    pub fn open_between(&self) -> Option<[&Suspect; 2]> {
        let is_open = self.verdict == Answer::Undecided
            || self.set.len() > 1
            || self.named.iter().any(|set| set.len() > 1);
        match &self.effects[..] {
            [first, second, ..] if is_open => Some([first, second]),
            _ => None,
        }
    }
}
