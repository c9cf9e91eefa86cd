//! What may be expected of a layout, from rigs that had no part in what judges them.

use super::pool::{Calibrating, Judgement, Weights};
use crate::diagnosis::rigs::{Part, Row};
use serde::{Deserialize, Serialize};

/// Share of true causes that conformal sets are to hold.
pub const COVERAGE: f64 = 0.9;
/// Bins of the calibration error.
const BINS: usize = 10;
/// Sizes from which on an effect's power is counted: from half-way between low and high.
const LARGE: f64 = 0.5;

/// How often an effect is found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectPower {
    /// Its name.
    pub name: String,
    /// Rigs with it, alone.
    pub rigs: usize,
    /// Share of them in which it is the likeliest cause.
    pub right: f64,
    /// The same where its size is in the upper half; none without such rigs.
    pub right_where_large: Option<f64>,
}

/// Scores on rigs of the layout with known causes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SelfTest {
    /// Rigs.
    pub rigs: usize,
    /// Campaigns of them.
    pub campaigns: usize,
    /// Share whose likeliest cause is the true one.
    pub right: f64,
    /// Mean probability of the true cause.
    pub probability_of_truth: f64,
    /// Share in which an effect that is not there has a probability above one half.
    pub falsely_named: f64,
    /// Mean difference between stated probability and observed frequency of the likeliest cause.
    pub calibration_error: f64,
    /// Share of conformal sets that hold the true cause, with thresholds from other rigs.
    pub coverage: f64,
    /// Probability from which on a cause is in the set.
    pub threshold: f64,
    /// Effect by effect, in the order of the candidates.
    pub effects: Vec<EffectPower>,
}

/// One campaign as judged.
struct Judged {
    rig: u64,
    weight: f64,
    truth: f64,
    likeliest: f64,
    is_right: bool,
    is_false: bool,
}

impl SelfTest {
    /// Of rigs and what they come to.
    pub fn of(
        rigs: &[&Calibrating],
        judgements: &[Judgement],
        count: usize,
        names: &[String],
    ) -> Self {
        let effects = names.len();
        let weights = Weights::of(rigs, effects);
        let mut powers = vec![Counts::default(); effects];
        let judged: Vec<Judged> = rigs
            .iter()
            .zip(judgements)
            .map(|(rig, judgement)| {
                let judged = judged(judgement, rig.row, weights.of_kind(rig.row));
                if let [part] = rig.row.effects[..] {
                    powers[part.candidate].add(part, judged.is_right);
                }
                judged
            })
            .collect();
        let total: f64 = judged.iter().map(|it| it.weight).sum();
        let mean = |of: &dyn Fn(&Judged) -> f64| {
            judged.iter().map(|it| it.weight * of(it)).sum::<f64>() / total
        };
        let share = |is: bool| if is { 1.0 } else { 0.0 };
        Self {
            rigs: count,
            campaigns: judged.len(),
            right: mean(&|it| share(it.is_right)),
            probability_of_truth: mean(&|it| it.truth),
            falsely_named: mean(&|it| share(it.is_false)),
            calibration_error: calibration_error(&judged, total),
            coverage: coverage(&judged),
            threshold: quantile(judged.iter().collect()),
            effects: names
                .iter()
                .zip(&powers)
                .map(|(name, it)| it.power(name))
                .collect(),
        }
    }
}

fn judged(judgement: &Judgement, row: &Row, weight: f64) -> Judged {
    let truth = &row.effects[..];
    let nothing = judgement.none + judgement.parameter;
    let is_pair = |effects: [usize; 2]| {
        let mut parts = truth.iter();
        truth.len() == 2 && parts.all(|part| effects.contains(&part.candidate))
    };
    let of_truth = match truth {
        [] => nothing,
        [part] => judgement.effects[part.candidate],
        _ => {
            let pairs = judgement.pairs.iter();
            let own = pairs.filter(|(pair, _)| is_pair(pair.effects));
            own.map(|(_, p)| p).sum()
        }
    };
    let effects = judgement.effects.iter().copied();
    let pairs = judgement.pairs.iter().map(|(_, p)| *p);
    let likeliest = effects
        .chain(pairs)
        .fold(nothing.max(judgement.unknown), f64::max);
    let is_there = |effect: usize| truth.iter().any(|part| part.candidate == effect);
    let mut effects = 0..judgement.effects.len();
    Judged {
        rig: row.rig,
        weight,
        truth: of_truth,
        likeliest,
        is_right: of_truth >= likeliest,
        is_false: effects.any(|effect| !is_there(effect) && judgement.presence(effect) > 0.5),
    }
}

/// Weighted quantile of the truth's probability that leaves the coverage above it.
fn quantile(mut judged: Vec<&Judged>) -> f64 {
    let total: f64 = judged.iter().map(|it| it.weight).sum();
    judged.sort_by(|a, b| a.truth.total_cmp(&b.truth));
    let mut below = 0.0;
    for it in judged {
        below += it.weight;
        if below > (1.0 - COVERAGE) * total {
            return it.truth;
        }
    }
    0.0
}

/// Weighted share of truths in sets whose threshold comes from the other half of the rigs.
fn coverage(judged: &[Judged]) -> f64 {
    let covered = [0, 1].map(|half| {
        let (own, others): (Vec<&Judged>, Vec<&Judged>) =
            judged.iter().partition(|it| it.rig % 2 == half);
        let threshold = quantile(others);
        let covered = own.into_iter().filter(|it| it.truth >= threshold);
        covered.map(|it| it.weight).sum::<f64>()
    });
    let total: f64 = judged.iter().map(|it| it.weight).sum();
    covered.iter().sum::<f64>() / total
}

fn calibration_error(judged: &[Judged], total: f64) -> f64 {
    let mut bins = [[0.0; 3]; BINS];
    for it in judged {
        let bin = ((it.likeliest * BINS as f64) as usize).min(BINS - 1);
        bins[bin][0] += it.weight * it.likeliest;
        bins[bin][1] += if it.is_right { it.weight } else { 0.0 };
        bins[bin][2] += it.weight;
    }
    let errors = bins.iter().map(|[stated, right, _]| (stated - right).abs());
    errors.sum::<f64>() / total
}

#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    all: usize,
    right: usize,
    large: usize,
    right_large: usize,
}

impl Counts {
    fn add(&mut self, part: Part, is_right: bool) {
        self.all += 1;
        self.right += usize::from(is_right);
        if part.size >= LARGE {
            self.large += 1;
            self.right_large += usize::from(is_right);
        }
    }

    fn power(&self, name: &str) -> EffectPower {
        EffectPower {
            name: name.to_owned(),
            rigs: self.all,
            right: self.right as f64 / self.all.max(1) as f64,
            right_where_large: (self.large > 0)
                .then(|| self.right_large as f64 / self.large as f64),
        }
    }
}
