//! Answers beside the truth, in numbers.
//!
//! | score | what it is |
//! |---|---|
//! | `C0.cleared` | share of cases without effect that are answered `none` or `parameter` |
//! | `C0.false_attribution` | share of them in which an effect is named |
//! | `top1` | share of cases in which the verdict names the true effect on its channel, and no other; undecided is a miss, as a failed diagnosis is |
//! | `top1_equivalent` | the same where the true effect is in the set of effects that the answer cannot tell from the one it names |
//! | `top3` | share in which effects are named and the true one is among the three likeliest |
//! | `set_size` | median size of the sets named |
//! | `probability_on_truth` | mean probability of the right answer (`none` and `parameter` together, `unknown` in C3, the pair in C4) |
//! | `magnitude_error` | median of error over the distance of the typical magnitude from neutral, where the effect is named; `magnitude_error_relative` over that of the true one |
//! | `magnitude_covered` | share of 95 % intervals that hold the true magnitude |
//! | `closed` | mean share of the gap closed where the effect is named. The gap is counted down to the floor of repeats, which the true effect at its true magnitude reaches: the share is one over that of an oracle |
//! | `C3.unknown`, `C3.located` | share answered `unknown`; of these the share that is located in a channel in which the effect shows |
//! | `unknown.auroc`, `unknown.f1` | how well the probability of `unknown`, and that verdict, tell C3 from all others |
//! | `c1_less_c2` | `top1_equivalent` of C1 less that of C2, over effects that have another form |
//! | `calibration_error` | expected error of the likeliest answer's probability, in ten equal classes |
//! | `C4.one_named`, `C4.both_named` | share of pairs of which one effect, or both, are named, up to equivalence |
//! | `seconds` | median time of a diagnosis |
//!
//! Every score has its number of cases and a 95 % interval: see [`Score`].

mod interval;
mod judged;
mod tables;
mod text;

pub use interval::Score;
pub use tables::{Matrix, OfEffect, Power};

use super::ChallengeError;
use super::answer::Verdict;
use super::answering::{has_failed, known, seconds};
use super::folder::{self, Campaigns};
use super::order::{Family, Set};
use super::truth::{Level, Rig};
use interval::mean;
use judged::Judged;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Classes of probability for the calibration error.
const CLASSES: usize = 10;

/// Cases without effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nothing {
    /// Share answered `none` or `parameter`.
    pub cleared: Score,
    /// Share in which an effect is named.
    pub false_attribution: Score,
    /// Share answered `undecided`.
    pub undecided: Score,
    /// `cleared` by how the rig differs from its scenario.
    pub by_rig: BTreeMap<Rig, Score>,
    /// Mean probability of `none` and `parameter`.
    pub probability_on_truth: Score,
}

/// Cases of one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Single {
    /// Share named.
    pub top1: Score,
    /// Share named up to equivalence.
    pub top1_equivalent: Score,
    /// Share among the three likeliest.
    pub top3: Score,
    /// Median size of a set named.
    pub set_size: Score,
    /// Share answered `undecided`.
    pub undecided: Score,
    /// `top1_equivalent` by magnitude.
    pub by_level: BTreeMap<Level, Score>,
    /// Mean probability of the effect.
    pub probability_on_truth: Score,
    /// Mean probability of the effect and what is equivalent to it.
    pub probability_on_set: Score,
    /// Median error over the scale of the effect [-].
    pub magnitude_error: Score,
    /// Median error over the true magnitude [-].
    pub magnitude_error_relative: Score,
    /// Share of intervals that hold the true magnitude.
    pub magnitude_covered: Score,
    /// Mean share of the gap closed.
    pub closed: Score,
}

/// Cases of an effect that the diagnosis was not told of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// Share answered `unknown`.
    pub unknown: Score,
    /// Share of these located where the effect shows.
    pub located: Score,
    /// Share in which an effect is named.
    pub false_attribution: Score,
    /// Mean probability of `unknown`.
    pub probability_on_truth: Score,
}

/// Cases of two effects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pairs {
    /// Share with one effect named at least.
    pub one_named: Score,
    /// Share with both named.
    pub both_named: Score,
    /// Mean probability of the pair.
    pub probability_on_truth: Score,
}

/// How well the unknown is told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unknown {
    /// Area under the curve of hits against false alarms.
    pub auroc: Score,
    /// Harmonic mean of precision and recall of the verdict.
    pub f1: Score,
}

/// All scores of a trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scores {
    /// What the cases are for; calibration cases tell nothing of quality. None without cases.
    pub family: Option<Family>,
    /// Cases published.
    pub cases: usize,
    /// Cases with an answer.
    pub answered: usize,
    /// Cases in which the diagnosis failed: misses.
    pub failed: usize,
    /// Cases that nobody was asked about yet; they are in no score.
    pub unanswered: usize,
    /// Nothing withheld.
    #[serde(rename = "C0")]
    pub nothing: Nothing,
    /// Effects in the catalogue's form.
    #[serde(rename = "C1")]
    pub own_form: Single,
    /// Effects in another form.
    #[serde(rename = "C2")]
    pub other_form: Single,
    /// Effects left out.
    #[serde(rename = "C3")]
    pub left_out: LeftOut,
    /// Two effects.
    #[serde(rename = "C4")]
    pub pairs: Pairs,
    /// C3 against all others.
    pub unknown: Unknown,
    /// `top1_equivalent` of C1 less that of C2.
    pub c1_less_c2: Score,
    /// Mean probability of the right answer over all cases.
    pub probability_on_truth: Score,
    /// Expected calibration error.
    pub calibration_error: Score,
    /// Median time of a diagnosis [s].
    pub seconds: Score,
    /// Number of cases by truth and answer.
    pub confusion: Matrix,
    /// Mean probability of answers by truth.
    pub isolability: Matrix,
    /// Hits against magnitude over detection limit.
    pub power: Vec<Power>,
    /// Every effect.
    pub effects: Vec<OfEffect>,
}

/// Opens the truth of the trial in `folder` and counts.
///
/// # Errors
/// `TruthAltered` where a truth is not the one sealed, `CampaignAltered` where a run file is not the
/// one published, `File` and `Content` where something cannot be read.
pub fn score(folder: &Path) -> Result<Scores, ChallengeError> {
    let campaigns = Campaigns::open(folder)?;
    let answers = folder::answers(folder);
    let mut judged = Vec::new();
    for posed in &campaigns.manifest.cases {
        campaigns.check(posed)?;
        let truth = folder::unsealed(folder, posed)?;
        let answer = known(&answers, posed);
        if answer.is_some() || has_failed(&answers, posed) {
            judged.push(Judged {
                truth,
                answer,
                seconds: seconds(&answers, posed),
            });
        }
    }
    Ok(Scores::of(&judged, campaigns.manifest.cases.len()))
}

impl Scores {
    fn of(judged: &[Judged], cases: usize) -> Self {
        let answered = judged.iter().filter(|case| case.answer.is_some()).count();
        let of = |set: Set| -> Vec<&Judged> { judged.iter().filter(|it| it.is_of(set)).collect() };
        Self {
            family: judged.first().map(|case| case.truth.family),
            cases,
            answered,
            failed: judged.len() - answered,
            unanswered: cases - judged.len(),
            nothing: Nothing::of(&of(Set::C0)),
            own_form: Single::of(&of(Set::C1)),
            other_form: Single::of(&of(Set::C2)),
            left_out: LeftOut::of(&of(Set::C3)),
            pairs: Pairs::of(&of(Set::C4)),
            unknown: Unknown::of(judged),
            c1_less_c2: c1_less_c2(judged),
            probability_on_truth: probability_on_truth(judged.iter()),
            calibration_error: calibration_error(judged),
            seconds: Score::median(judged.iter().filter_map(|case| case.seconds)),
            confusion: tables::confusion(judged),
            isolability: tables::isolability(judged),
            power: tables::power(judged),
            effects: tables::of_effects(judged),
        }
    }
}

fn share(cases: &[&Judged], is_hit: impl Fn(&Judged) -> bool) -> Score {
    Score::share(cases.iter().map(|case| is_hit(case)))
}

fn probability_on_truth<'j>(cases: impl Iterator<Item = &'j Judged>) -> Score {
    Score::mean(cases.map(Judged::probability_on_truth))
}

impl Nothing {
    fn of(cases: &[&Judged]) -> Self {
        let of_rig = |rig: Rig| {
            let own = cases.iter().filter(|case| case.truth.rig == rig);
            (rig, Score::share(own.map(|case| case.is_cleared())))
        };
        Self {
            cleared: share(cases, Judged::is_cleared),
            false_attribution: share(cases, Judged::is_blaming),
            undecided: share(cases, |case| case.is(Verdict::Undecided)),
            by_rig: [Rig::Plain, Rig::Tails, Rig::Variable].map(of_rig).into(),
            probability_on_truth: probability_on_truth(cases.iter().copied()),
        }
    }
}

impl Single {
    fn of(cases: &[&Judged]) -> Self {
        let sets = cases.iter().map(|case| case.set().len());
        let magnitudes: Vec<_> = cases.iter().filter_map(|case| case.magnitude()).collect();
        let of_level = |level: Level| {
            let is_it = |case: &&&Judged| case.hidden().is_some_and(|it| it.level == Some(level));
            let own = cases.iter().filter(is_it);
            (
                level,
                Score::share(own.map(|case| case.is_named_up_to_equivalence())),
            )
        };
        let closed = cases
            .iter()
            .filter(|case| case.is_named_up_to_equivalence());
        let closed = closed.filter_map(|case| case.answer.as_ref()?.closed?.value);
        Self {
            top1: share(cases, Judged::is_named),
            top1_equivalent: share(cases, Judged::is_named_up_to_equivalence),
            top3: share(cases, Judged::is_in_first_three),
            set_size: Score::median(sets.filter(|size| *size > 0).map(|size| size as f64)),
            undecided: share(cases, |case| case.is(Verdict::Undecided)),
            by_level: Level::ALL.map(of_level).into(),
            probability_on_truth: probability_on_truth(cases.iter().copied()),
            probability_on_set: Score::mean(cases.iter().map(|it| it.probability_on_set())),
            magnitude_error: Score::median(magnitudes.iter().map(|it| it.of_typical)),
            magnitude_error_relative: Score::median(magnitudes.iter().map(|it| it.of_true)),
            magnitude_covered: Score::share(magnitudes.iter().filter_map(|it| it.is_covered)),
            closed: Score::mean(closed),
        }
    }
}

impl LeftOut {
    fn of(cases: &[&Judged]) -> Self {
        let told = cases.iter().filter(|case| case.is(Verdict::Unknown));
        Self {
            unknown: share(cases, |case| case.is(Verdict::Unknown)),
            located: Score::share(told.map(|case| case.is_located())),
            false_attribution: share(cases, Judged::is_blaming),
            probability_on_truth: probability_on_truth(cases.iter().copied()),
        }
    }
}

impl Pairs {
    fn of(cases: &[&Judged]) -> Self {
        Self {
            one_named: share(cases, |case| case.named_of_pair() >= 1),
            both_named: share(cases, |case| case.named_of_pair() == 2),
            probability_on_truth: probability_on_truth(cases.iter().copied()),
        }
    }
}

impl Unknown {
    fn of(cases: &[Judged]) -> Self {
        let told = cases.iter().filter_map(|case| {
            let answer = case.answer.as_ref()?;
            Some((case.is_of(Set::C3), answer.probability("unknown")))
        });
        let told: Vec<(bool, f64)> = told.collect();
        let verdicts = cases.iter();
        let verdicts = verdicts.map(|case| (case.is_of(Set::C3), case.is(Verdict::Unknown)));
        let verdicts: Vec<(bool, bool)> = verdicts.collect();
        Self {
            auroc: Score::of(&told, auroc),
            f1: Score::of(&verdicts, f1),
        }
    }
}

/// Probability [-] that one of the true is told more than one of the others; ties count half.
fn auroc(told: &[&(bool, f64)]) -> Option<f64> {
    let mut sorted = told.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut below = 0;
    let mut wins = 0.0;
    for ties in sorted.chunk_by(|a, b| a.1 == b.1) {
        let hits = ties.iter().filter(|(is_true, _)| *is_true).count();
        let others = ties.len() - hits;
        wins += hits as f64 * (f64::from(below) + 0.5 * others as f64);
        below += u32::try_from(others).ok()?;
    }
    let hits = told.iter().filter(|(is_true, _)| *is_true).count();
    let pairs = hits as f64 * f64::from(below);
    (pairs > 0.0).then(|| wins / pairs)
}

/// Harmonic mean of precision and recall; none where there is nothing to find.
fn f1(verdicts: &[&(bool, bool)]) -> Option<f64> {
    let count = |wanted: (bool, bool)| verdicts.iter().filter(|it| ***it == wanted).count() as f64;
    let [hit, missed, false_alarm] = [(true, true), (true, false), (false, true)].map(count);
    (hit + missed > 0.0).then(|| 2.0 * hit / (2.0 * hit + missed + false_alarm))
}

fn c1_less_c2(cases: &[Judged]) -> Score {
    let others = cases.iter().filter(|case| case.is_of(Set::C2));
    let others: Vec<&str> = others
        .filter_map(|it| Some(it.hidden()?.effect()))
        .collect();
    let both: Vec<(Set, bool)> = cases
        .iter()
        .filter(|case| case.is_of(Set::C1) || case.is_of(Set::C2))
        .filter(|case| {
            case.hidden()
                .is_some_and(|it| others.contains(&it.effect()))
        })
        .map(|case| (case.truth.set, case.is_named_up_to_equivalence()))
        .collect();
    Score::of(&both, |drawn| {
        let hits = |set: Set| {
            let own = drawn.iter().filter(|(of, _)| *of == set);
            mean(own.map(|(_, hit)| f64::from(u8::from(*hit))))
        };
        Some(hits(Set::C1)? - hits(Set::C2)?)
    })
}

fn calibration_error(cases: &[Judged]) -> Score {
    let told = cases.iter().filter_map(|case| {
        let labels = case.labels();
        let (label, probability) = labels.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((*probability, *label == case.label()))
    });
    let told: Vec<(f64, bool)> = told.collect();
    Score::of(&told, |drawn| {
        let mut classes = [(0.0, 0.0); CLASSES];
        for (probability, is_right) in drawn {
            let class = ((probability * CLASSES as f64) as usize).min(CLASSES - 1);
            classes[class].0 += probability;
            classes[class].1 += f64::from(u8::from(*is_right));
        }
        let off: f64 = classes
            .iter()
            .map(|(told, right)| (told - right).abs())
            .sum();
        (!drawn.is_empty()).then(|| off / drawn.len() as f64)
    })
}
