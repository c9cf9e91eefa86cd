//! Scores of the probabilities themselves, over all cases.
//!
//! Log score and Brier score are proper: they are best for whoever states the probabilities that hold. The error of
//! calibration is not, and is above zero for a perfect answerer too, since the shares of few cases scatter. What such an
//! answerer would score is therefore subtracted.

use super::interval::Score;
use super::judged::Judged;
use crate::challenge::order::Set;
use crate::quantity::Seed;
use crate::statistics::mean;
use rand::RngExt;
use serde::Serialize;

/// Classes of probability for the calibration error.
const CLASSES: usize = 10;

/// Answers of a perfectly calibrated answerer that are drawn for each case.
const DRAWS: usize = u128::BITS as usize;

/// Scores of stated probabilities.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Probabilities {
    /// Mean logarithm of the probability of the right answer [-], no probability being below 0.001.
    pub log_score: Score,
    /// Mean sum of squared differences of probabilities from the truth's, 0 to 2 [-].
    pub brier_score: Score,
    /// Calibration error less that of an answerer whose stated probabilities hold; 0 where that is larger [-].
    pub calibration_error: Score,
    /// Mean probability of the right answer in C0 and C1.
    pub of_nothing_and_own_form: Score,
    /// Share of 90 % sets that contain the right answer.
    pub set_coverage: Score,
    /// Median size of these sets.
    pub set_size: Score,
    /// Share of 95 % intervals in C1 and C2 that cover the true magnitude.
    pub magnitude_covered: Score,
    /// How often the most probable answer is right, by its probability: ten equal classes from 0 to 1.
    pub reliability: Vec<Reliability>,
}

/// Cases whose most probable answer has a probability in one class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reliability {
    /// Mean of the stated probabilities [-]; none without cases.
    pub stated: Option<f64>,
    /// Share that is right.
    pub right: Score,
}

/// The most probable answer of a case.
struct Likeliest {
    probability: f64,
    is_right: bool,
    /// Whether it is right, bit by bit, for an answerer whose probabilities hold.
    if_calibrated: u128,
}

impl Probabilities {
    pub(super) fn of(cases: &[Judged]) -> Self {
        let simple = |case: &&Judged| case.is_of(Set::C0) || case.is_of(Set::C1);
        let simple = cases.iter().filter(simple);
        let sets = || cases.iter().filter_map(Judged::prediction_set);
        let magnitudes = cases.iter().filter_map(|it| it.magnitude()?.is_covered);
        let likeliest = likeliest(cases);
        Self {
            log_score: Score::mean(cases.iter().map(Judged::log_score)),
            brier_score: Score::mean(cases.iter().map(Judged::brier_score)),
            calibration_error: Score::of(&likeliest, debiased),
            of_nothing_and_own_form: Score::mean(simple.map(Judged::probability_on_truth)),
            set_coverage: Score::share(sets().map(|set| set.is_right)),
            set_size: Score::median(sets().map(|set| set.size as f64)),
            magnitude_covered: Score::share(magnitudes),
            reliability: (0..CLASSES)
                .map(|class| Reliability::of(&likeliest, class))
                .collect(),
        }
    }
}

impl Reliability {
    fn of(cases: &[Likeliest], class: usize) -> Self {
        let within = || cases.iter().filter(|case| case.class() == class);
        Self {
            stated: mean(within().map(|case| case.probability)),
            right: Score::share(within().map(|case| case.is_right)),
        }
    }
}

impl Likeliest {
    /// Its class of probability.
    fn class(&self) -> usize {
        ((self.probability * CLASSES as f64) as usize).min(CLASSES - 1)
    }
}

/// Mean difference between stated probability and share of right answers, in ten equal classes.
pub(super) fn calibration_error(cases: &[Judged]) -> Score {
    Score::of(&likeliest(cases), |drawn| {
        (!drawn.is_empty()).then(|| error(drawn, |it| it.is_right))
    })
}

fn likeliest(cases: &[Judged]) -> Vec<Likeliest> {
    let of = |(number, case): (u64, &Judged)| {
        let labels = case.labels();
        let (label, probability) = labels.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut rng = Seed(0).rng("calibrated answers", number);
        let draw = |bits: u128, _| bits << 1 | u128::from(rng.random::<f64>() < *probability);
        Some(Likeliest {
            probability: *probability,
            is_right: *label == case.label(),
            if_calibrated: (0..DRAWS).fold(0, draw),
        })
    };
    (0..).zip(cases).filter_map(of).collect()
}

fn error(cases: &[&Likeliest], is_right: impl Fn(&Likeliest) -> bool) -> f64 {
    let mut classes = [0.0; CLASSES];
    for case in cases {
        classes[case.class()] += case.probability - f64::from(u8::from(is_right(case)));
    }
    let off: f64 = classes.into_iter().map(f64::abs).sum();
    off / cases.len() as f64
}

/// The error less its mean over the draws. A case that a bootstrap draws twice counts twice in both.
fn debiased(cases: &[&Likeliest]) -> Option<f64> {
    let of_draw = |draw: usize| error(cases, |it| it.if_calibrated >> draw & 1 == 1);
    let expected = mean((0..DRAWS).map(of_draw))?;
    let found = (!cases.is_empty()).then(|| error(cases, |it| it.is_right))?;
    Some((found - expected).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Answers with probabilities from 0.3 to 1 of which each is right with `share` of its probability.
    fn answers(count: u64, share: f64) -> Vec<Likeliest> {
        let answer = |number| {
            let mut rng = Seed(7).rng("answers", number);
            let probability: f64 = rng.random_range(0.3..1.0);
            let is_right = rng.random::<f64>() < share * probability;
            let draw = |bits: u128, _| bits << 1 | u128::from(rng.random::<f64>() < probability);
            Likeliest {
                probability,
                is_right,
                if_calibrated: (0..DRAWS).fold(0, draw),
            }
        };
        (0..count).map(answer).collect()
    }

    #[test]
    fn a_calibrated_answerer_of_a_hundred_cases_has_an_error_by_chance_that_is_subtracted() {
        let answers = answers(100, 1.0);
        let answers: Vec<&Likeliest> = answers.iter().collect();
        let raw = error(&answers, |it| it.is_right);
        let debiased = debiased(&answers).unwrap();
        // Seven classes of 14 cases: 0.8 times the root of 0.2 / 14.
        assert!((0.05..0.16).contains(&raw), "{raw}");
        assert!(debiased < 0.03, "{debiased}");
    }

    #[test]
    fn reliability_is_the_share_right_beside_the_probability_stated() {
        let answers = answers(4000, 0.7);
        let class = Reliability::of(&answers, 8);
        let stated = class.stated.unwrap();
        assert!((0.84..0.86).contains(&stated), "{stated}");
        // 0.7 of 0.85, of some 570 cases: 0.02.
        let right = class.right.value.unwrap();
        assert!((0.53..0.66).contains(&right), "{right}");
        let empty = Reliability::of(&answers, 1);
        assert_eq!((empty.stated, empty.right.n), (None, 0));
    }

    #[test]
    fn who_is_right_less_often_than_stated_keeps_that_error() {
        let answers = answers(2000, 0.7);
        let answers: Vec<&Likeliest> = answers.iter().collect();
        // 0.3 of a mean probability of 0.65, and 0.02 are by chance.
        let debiased = debiased(&answers).unwrap();
        assert!((0.15..0.22).contains(&debiased), "{debiased}");
        assert_eq!(super::debiased(&[]), None);
    }
}
