//! From evidence and votes to probabilities.
//!
//! Given that one cause of the candidates or none is there, the probability of cause `k` is
//!
//! ```text
//! p_k ∝ π_k exp(a_k e_k + b_k g_k + c_k v_k + d_k),
//! e_k = −ln(1 + (L − L_k) / B),   g_k = ln(1 + max(L_k − L_0, 0)),   v_k = ln(share of votes + ε)
//! ```
//!
//! with the log evidence `L_k`, the largest `L`, that without effects `L_0`, and base rates `π`. The logarithms keep a misfit
//! that no emulator of a real rig avoids from being taken for certainty. How far evidence and votes can be relied on differs
//! from effect to effect, as the scatter along what effects show does: the weights `a_k` to `d_k` are normally distributed
//! about those that all causes share. Whether the cause is none of the candidates, and whether there are two
//! effects, are decided by logistic regressions on misfits and votes; for the former, rigs are judged without the cause
//! that they have.

use super::evidence::{Evidence, Pair};
use super::logistic::{Example, Logistic, softmax};
use crate::diagnosis::rigs::Row;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// `B`.
const BEND: f64 = 30.0;
/// `ε`: a vote that no tree casts.
const NO_VOTE: f64 = 3.0e-3;
/// Weights with which `p_k` is close to `π_k exp(L_k)`.
const UNTRAINED: [f64; 4] = [BEND, 0.0, 0.0, 0.0];
/// Folds of rigs.
const FOLDS: u64 = 4;
/// Standard deviation of the weights of a cause about the shared ones.
const WEIGHT_SCATTER: f64 = 1.0;
/// Pairs that share the probability of two effects.
const PAIRS: usize = 20;

/// How often causes are met before anything is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BaseRates {
    /// Neither effects nor parameters off.
    pub none: f64,
    /// Parameters off.
    pub parameter: f64,
    /// One effect.
    pub effect: f64,
    /// Two effects.
    pub effects: f64,
    /// Something that is no candidate.
    pub unknown: f64,
}

impl Default for BaseRates {
    fn default() -> Self {
        Self {
            none: 0.05,
            parameter: 0.12,
            effect: 0.65,
            effects: 0.10,
            unknown: 0.08,
        }
    }
}

impl BaseRates {
    fn nothing_per_effect(&self) -> f64 {
        (self.none + self.parameter) / self.effect
    }
}

/// Both estimates of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Opinion {
    /// Of the emulator.
    pub evidence: Evidence,
    /// Of the trees: no effect first.
    pub votes: Vec<f64>,
    /// Numbers that the evidence rests on.
    pub scores: usize,
}

/// An opinion on a rig that had no part in it.
#[derive(Debug)]
pub struct Calibrating<'a> {
    /// The opinion.
    pub opinion: Opinion,
    /// The rig.
    pub row: &'a Row,
}

/// Trained weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pool {
    causes: Logistic,
    unknown: Logistic,
    pairs: Logistic,
    /// Probability from which on a cause is in the conformal set.
    threshold: f64,
}

/// What a campaign comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Probability that nothing differs.
    pub none: f64,
    /// That only parameters differ.
    pub parameter: f64,
    /// That it is none of the candidates.
    pub unknown: f64,
    /// Of each effect alone.
    pub effects: Vec<f64>,
    /// Of each pair.
    pub pairs: Vec<(Pair, f64)>,
    /// Probability from which on a cause is in the set that holds the true one nine times of ten.
    pub threshold: f64,
    /// What it rests on.
    pub opinion: Opinion,
}

impl Judgement {
    /// Probability that an effect is there, alone or with another.
    pub fn presence(&self, effect: usize) -> f64 {
        let pairs = self.pairs.iter();
        let with = pairs.filter(|(pair, _)| pair.effects.contains(&effect));
        self.effects[effect] + with.map(|(_, p)| p).sum::<f64>()
    }
}

/// How the weights of a pool are found.
#[derive(Debug, Clone, Copy)]
pub struct Trainer {
    /// Number of candidates.
    pub effects: usize,
    /// Whether the weights of causes are trained; otherwise the evidence is taken at its word.
    pub has_trained_weights: bool,
}

impl Trainer {
    /// The weights that predict the causes of these rigs best.
    pub fn fit(self, rigs: &[&Calibrating]) -> Pool {
        let rates = BaseRates::default();
        let single = |rig: &&&Calibrating| rig.row.effects.len() < 2;
        let weights = Weights::of(rigs, self.effects);
        let total = rigs.len() as f64;
        let examples = rigs.iter().filter(single).map(|rig| Example {
            features: causes(&rig.opinion),
            class: class(rig.row),
            weight: weights.of_kind(rig.row) * total,
        });
        let causes = if self.has_trained_weights {
            Logistic::fit_by_class(&examples.collect::<Vec<_>>(), WEIGHT_SCATTER)
        } else {
            Logistic::with_weights(UNTRAINED.to_vec())
        };
        let pairs = rigs.iter().map(|rig| Example {
            features: binary(pair_features(&rig.opinion)),
            class: usize::from(rig.row.effects.len() > 1),
            weight: weights.of_kind(rig.row) * total,
        });
        let known = rigs.iter().map(|rig| Example {
            features: binary(unknown_features(&rig.opinion, None)),
            class: 0,
            weight: weights.of_kind(rig.row) * total * (1.0 - rates.unknown),
        });
        let removed = rigs.iter().filter(single).filter_map(|rig| {
            let own = rig.row.effects.first()?.candidate;
            let share = weights.of_row(rig.row) / weights.effects();
            Some(Example {
                features: binary(unknown_features(&rig.opinion, Some(own))),
                class: 1,
                weight: share * total * rates.unknown,
            })
        });
        Pool {
            causes,
            unknown: Logistic::fit(&known.chain(removed).collect::<Vec<_>>()),
            pairs: Logistic::fit(&pairs.collect::<Vec<_>>()),
            threshold: 0.0,
        }
    }

    /// What each rig comes to by weights of the other folds of rigs.
    pub fn cross_fitted(self, rigs: &[&Calibrating]) -> Vec<Judgement> {
        let rates = BaseRates::default();
        let folds = (0..FOLDS).into_par_iter().map(|fold| {
            let is_other = |rig: &&&Calibrating| rig.row.rig % FOLDS != fold;
            let others: Vec<&Calibrating> = rigs.iter().filter(is_other).copied().collect();
            self.fit(&others)
        });
        let pools: Vec<Pool> = folds.collect();
        let judged = rigs.iter().map(|rig| {
            let pool = &pools[(rig.row.rig % FOLDS) as usize];
            pool.judge(rig.opinion.clone(), &rates)
        });
        judged.collect()
    }
}

impl Pool {
    /// With another threshold of the conformal set.
    pub fn with_threshold(self, threshold: f64) -> Self {
        Self { threshold, ..self }
    }

    /// Probabilities of all causes.
    pub fn judge(&self, opinion: Opinion, rates: &BaseRates) -> Judgement {
        let count = opinion.evidence.effects.len();
        let usual = BaseRates::default();
        let known = self.causes.probabilities(&causes(&opinion));
        let known = reweighted(
            known,
            rates.nothing_per_effect() / usual.nothing_per_effect(),
        );
        let odds = |share: f64| share / (1.0 - share);
        let moved = |probability: f64, from: f64, to: f64| {
            let odds = odds(probability) * odds(to) / odds(from);
            if odds.is_finite() {
                odds / (1.0 + odds)
            } else {
                probability
            }
        };
        let of = |logistic: &Logistic, features| logistic.probabilities(&binary(features))[1];
        let unknown = of(&self.unknown, unknown_features(&opinion, None));
        let unknown = moved(unknown, usual.unknown, rates.unknown);
        let share = |rates: &BaseRates| rates.effects / (1.0 - rates.unknown);
        let paired = of(&self.pairs, pair_features(&opinion));
        let paired = match count {
            0 | 1 => 0.0,
            _ => (1.0 - unknown) * moved(paired, share(&usual), share(rates)),
        };
        let single = (1.0 - unknown - paired).max(0.0);
        let nothing = single * known[0];
        let log_ratio = opinion.evidence.parameters_over_nominal;
        let of_nominal =
            rates.none / (rates.none + rates.parameter * libm::exp(log_ratio.min(700.0)));
        Judgement {
            none: nothing * of_nominal,
            parameter: nothing * (1.0 - of_nominal),
            unknown,
            effects: known[1..].iter().map(|p| single * p).collect(),
            pairs: self.of_pairs(&opinion, paired),
            threshold: self.threshold,
            opinion,
        }
    }

    fn of_pairs(&self, opinion: &Opinion, probability: f64) -> Vec<(Pair, f64)> {
        let best = opinion.evidence.pairs.iter().take(PAIRS);
        let best: Vec<&Pair> = best.collect();
        let Some(first) = best.first() else {
            return Vec::new();
        };
        let shared = &self.causes.shared;
        let none = opinion.evidence.none;
        let logs = best.iter().map(|pair| {
            let loss = bent(0.5 * (pair.misfit - first.misfit));
            let gain = gained(0.5 * (none - pair.misfit));
            [loss, gain].iter().zip(shared).map(|(x, w)| x * w).sum()
        });
        let shares = softmax(logs.collect());
        let pairs = best.iter().zip(shares);
        pairs
            .map(|(pair, share)| (**pair, probability * share))
            .collect()
    }
}

/// The cause of a rig with one effect or none.
pub fn class(row: &Row) -> usize {
    row.effects.first().map_or(0, |part| part.candidate + 1)
}

/// Weights by which rigs are met as often as their causes are.
pub struct Weights {
    counts: Vec<f64>,
    pairs: f64,
    rates: BaseRates,
}

impl Weights {
    /// Of these rigs.
    pub fn of(rigs: &[&Calibrating], effects: usize) -> Self {
        let mut counts = vec![0.0; effects + 1];
        let mut pairs = 0.0;
        for rig in rigs {
            match rig.row.effects.len() {
                0 | 1 => counts[class(rig.row)] += 1.0,
                _ => pairs += 1.0,
            }
        }
        Self {
            counts,
            pairs,
            rates: BaseRates::default(),
        }
    }

    /// Causes that rigs have.
    fn effects(&self) -> f64 {
        self.counts[1..]
            .iter()
            .filter(|count| **count > 0.0)
            .count() as f64
    }

    /// Of a row with one effect or none: every cause weighs 1 in all.
    pub fn of_row(&self, row: &Row) -> f64 {
        1.0 / self.counts[class(row)].max(1.0)
    }

    /// Of any row: as often as its kind of cause is met; one in all.
    pub fn of_kind(&self, row: &Row) -> f64 {
        let BaseRates {
            none,
            parameter,
            effect,
            effects,
            ..
        } = self.rates;
        let sum = none + parameter + effect + effects;
        let share = match row.effects.len() {
            0 => (none + parameter) * self.of_row(row),
            1 => effect * self.of_row(row) / self.effects(),
            _ => effects / self.pairs.max(1.0),
        };
        share / sum
    }
}

fn bent(loss: f64) -> f64 {
    -libm::log1p(loss.max(0.0) / BEND)
}

fn gained(gain: f64) -> f64 {
    libm::log1p(gain.max(0.0))
}

/// Features of none and of each effect.
fn causes(opinion: &Opinion) -> Vec<Vec<f64>> {
    let Opinion {
        evidence, votes, ..
    } = opinion;
    let none = -0.5 * evidence.none;
    let best = evidence.effects.iter().copied().fold(none, f64::max);
    let logs = std::iter::once(&none).chain(&evidence.effects);
    let features = logs.zip(votes).map(|(log, vote)| {
        let vote = libm::log(vote + NO_VOTE);
        vec![bent(best - log), gained(log - none), vote, 1.0]
    });
    features.collect()
}

/// Probabilities where the first is met this much more often.
fn reweighted(mut probabilities: Vec<f64>, factor: f64) -> Vec<f64> {
    probabilities[0] *= factor;
    let sum: f64 = probabilities.iter().sum();
    probabilities.iter_mut().for_each(|p| *p /= sum);
    probabilities
}

/// Features of a yes against none of a no.
fn binary(features: Vec<f64>) -> Vec<Vec<f64>> {
    vec![vec![0.0; features.len()], features]
}

/// How badly candidates explain, and how undecided trees are.
fn unknown_features(opinion: &Opinion, removed: Option<usize>) -> Vec<f64> {
    let Opinion {
        evidence,
        votes,
        scores,
    } = opinion;
    let is_kept = |effect: &usize| Some(*effect) != removed;
    let kept = (0..evidence.misfits.len()).filter(is_kept);
    let single = kept.fold(evidence.none, |best, e| best.min(evidence.misfits[e]));
    let is_left = |pair: &&Pair| removed.is_none_or(|removed| !pair.effects.contains(&removed));
    let pairs = evidence.pairs.iter().filter(is_left);
    let pair = pairs.map(|pair| pair.misfit).fold(single, f64::min);
    let left: f64 = 1.0 - removed.map_or(0.0, |removed| votes[removed + 1]);
    let others = votes.iter().enumerate();
    let others = others.filter(|(place, _)| Some(*place) != removed.map(|it| it + 1));
    let most = others
        .map(|(_, vote)| vote / left.max(NO_VOTE))
        .fold(0.0, f64::max);
    let scores = *scores as f64;
    vec![
        1.0,
        libm::log(single / scores),
        libm::log(pair / scores),
        libm::log(most + NO_VOTE),
    ]
}

/// How much better two effects explain than one, and one than none.
fn pair_features(opinion: &Opinion) -> Vec<f64> {
    let evidence = &opinion.evidence;
    let single = evidence
        .misfits
        .iter()
        .copied()
        .fold(evidence.none, f64::min);
    let pairs = evidence.pairs.iter().map(|pair| pair.misfit);
    let pair = pairs.fold(single, f64::min);
    vec![
        1.0,
        libm::log1p(single - pair),
        libm::log1p(evidence.none - single),
        libm::log(pair / opinion.scores as f64),
    ]
}
