//! Scores of the answers against the truth.
//!
//! | score | definition |
//! |---|---|
//! | `C0.cleared` | share of cases without effect that are answered `none` or `parameter` |
//! | `C0.false_attribution` | share of them in which an effect is named |
//! | `top1` | share of cases in which the verdict names the true effect on its channel, and no other; undecided is a miss, as a failed diagnosis is |
//! | `top1_equivalent` | the same where the true effect is in the equivalence set of the one named |
//! | `top3` | share in which effects are named and the true one is among the three likeliest |
//! | `set_size` | median size of the sets named |
//! | `probability_on_truth` | mean probability of the right answer (`none` and `parameter` together, `unknown` in C3, the pair in C4) |
//! | `magnitude_error` | median of error over the distance of the typical magnitude from neutral, where the effect is named; `magnitude_error_relative` over that of the true one |
//! | `magnitude_covered` | share of 95 % intervals that cover the true magnitude |
//! | `closed` | mean share of the gap closed where the effect is named. The gap is measured above the floor of repeats, which the true effect at its true magnitude reaches: the share is one over that of an oracle |
//! | `C3.unknown`, `C3.located` | share answered `unknown`; of these the share that is located in a channel in which the effect shows |
//! | `unknown.auroc`, `unknown.f1` | how well the probability of `unknown`, and that verdict, discriminate C3 from all others |
//! | `c1_less_c2` | `top1_equivalent` of C1 less that of C2, over effects that have another form |
//! | `calibration_error` | expected error of the likeliest answer's probability, in ten equal classes |
//! | `probabilities` | log score, Brier score, debiased calibration error, 90 % sets: see [`Probabilities`] |
//! | `detectability` | C1 and C2 by classes of `d'`, C3 and C4 from 6 on: see [`ByDetectability`]; `detectability_beside_parameters` by the `d'` for unknown parameters |
//! | `C4.one_named`, `C4.both_named` | share of pairs of which one effect, or both, are named, up to equivalence |
//! | `seconds` | median time of a diagnosis |
//!
//! Every score has its number of cases and a 95 % interval: see [`Score`].

mod detectability;
mod interval;
mod judged;
mod probabilities;
mod tables;
mod text;

pub use detectability::{ByClass, ByDetectability, Detected, OfClass};
pub use interval::Score;
pub use probabilities::{Probabilities, Reliability};
pub use tables::{Matrix, OfEffect, Power};

use super::ChallengeError;
use super::answer::Verdict;
use super::answering::{has_failed, known, seconds};
use super::folder::{self, Campaigns};
use super::order::{Family, Set};
use super::truth::{Level, Rig};
use crate::statistics::mean;
use judged::Judged;
use probabilities::calibration_error;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

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
    /// Share of intervals that cover the true magnitude.
    pub magnitude_covered: Score,
    /// Mean share of the gap closed.
    pub closed: Score,
}

/// Cases of an effect that is excluded from the diagnosis.
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

/// Detection of unknown effects.
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
    /// Purpose of the cases; calibration cases give no score of quality. `None` without cases.
    pub family: Option<Family>,
    /// Cases published.
    pub cases: usize,
    /// Cases with an answer.
    pub answered: usize,
    /// Cases in which the diagnosis failed: misses.
    pub failed: usize,
    /// Cases without an answer yet; they are in no score.
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
    /// Scores of the probabilities.
    pub probabilities: Probabilities,
    /// By `d'` for an oracle with known parameters.
    pub detectability: ByDetectability,
    /// By `d'` where only the distribution of the parameters is given.
    pub detectability_beside_parameters: ByDetectability,
    /// Cases of C1 and C2 with their `d'`.
    pub detections: Vec<Detected>,
    /// Median time of a diagnosis \[s\].
    pub seconds: Score,
    /// Number of cases by truth and answer.
    pub confusion: Matrix,
    /// Mean probability of answers by truth.
    #[serde(rename = "told")]
    pub posterior: Matrix,
    /// Mean absolute cosine between projected signatures of effects, over the answers that state it.
    pub isolability: Matrix,
    /// Hits against magnitude over detection limit.
    pub power: Vec<Power>,
    /// Every effect.
    pub effects: Vec<OfEffect>,
}

/// Opens the truth of the trial in `folder` and counts the answers.
///
/// # Errors
/// `TruthAltered` where a truth is not the one sealed, `CampaignAltered` where a run file is not the
/// one published, `QuestionAltered` where another effect was left out than the truth has it, `Unanswered`
/// where nothing was diagnosed yet, `File` and `Content` where something cannot be read.
pub fn score(folder: &Path) -> Result<Scores, ChallengeError> {
    let campaigns = Campaigns::open(folder)?;
    let answers = folder::answers(folder);
    let mut judged = Vec::new();
    for posed in &campaigns.manifest.cases {
        campaigns.check(posed)?;
        let truth = folder::unsealed(folder, posed)?;
        if truth.without() != posed.without {
            return Err(ChallengeError::QuestionAltered(posed.case.clone()));
        }
        let answer = known(&answers, posed);
        if answer.is_some() || has_failed(&answers, posed) {
            judged.push(Judged {
                truth,
                answer,
                seconds: seconds(&answers, posed),
            });
        }
    }
    if judged.is_empty() {
        return Err(ChallengeError::Unanswered(folder.to_path_buf()));
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
            probabilities: Probabilities::of(judged),
            detectability: ByDetectability::of(judged, |it| it.detectability),
            detectability_beside_parameters: ByDetectability::of(judged, |it| {
                it.detectability_beside_parameters
            }),
            detections: detectability::detections(judged),
            seconds: Score::median(judged.iter().filter_map(|case| case.seconds)),
            confusion: tables::confusion(judged),
            posterior: tables::posterior(judged),
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
        let unknown = cases.iter().filter(|case| case.is(Verdict::Unknown));
        Self {
            unknown: share(cases, |case| case.is(Verdict::Unknown)),
            located: Score::share(unknown.map(|case| case.is_located())),
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
        let (left_out, others): (Vec<&Judged>, Vec<&Judged>) =
            cases.iter().partition(|case| case.is_of(Set::C3));
        let verdicts = cases.iter().map(|case| Detection {
            is_positive: case.is_of(Set::C3),
            score: case.is(Verdict::Unknown),
        });
        let verdicts: Vec<Detection<bool>> = verdicts.collect();
        Self {
            auroc: auroc_against(&left_out, &others),
            f1: Score::of(&verdicts, f1),
        }
    }
}

/// A case of a binary test, and what the test says of it.
struct Detection<S> {
    is_positive: bool,
    score: S,
}

/// Area under the curve by which the probability of `unknown` discriminates cases from others.
fn auroc_against(cases: &[&Judged], others: &[&Judged]) -> Score {
    let scored = |cases: &[&Judged], is_positive| -> Vec<Detection<f64>> {
        let answers = cases.iter().filter_map(|case| case.answer.as_ref());
        let scored = answers.map(|answer| Detection {
            is_positive,
            score: answer.probability(Verdict::Unknown.name()),
        });
        scored.collect()
    };
    let mut all = scored(cases, true);
    all.extend(scored(others, false));
    Score::of(&all, auroc)
}

/// Probability [-] that a positive case has a higher score than a negative one; ties count half (area under
/// the ROC curve).
fn auroc(cases: &[&Detection<f64>]) -> Option<f64> {
    let mut sorted = cases.to_vec();
    sorted.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut below = 0;
    let mut wins = 0.0;
    for ties in sorted.chunk_by(|a, b| a.score == b.score) {
        let hits = ties.iter().filter(|case| case.is_positive).count();
        let others = ties.len() - hits;
        wins += hits as f64 * (f64::from(below) + 0.5 * others as f64);
        below += u32::try_from(others).ok()?;
    }
    let hits = cases.iter().filter(|case| case.is_positive).count();
    let pairs = hits as f64 * f64::from(below);
    (pairs > 0.0).then(|| wins / pairs)
}

/// Harmonic mean of precision and recall; none where there is nothing to find.
fn f1(cases: &[&Detection<bool>]) -> Option<f64> {
    let count = |is_positive, score| {
        let counted = cases.iter();
        counted
            .filter(|case| case.is_positive == is_positive && case.score == score)
            .count() as f64
    };
    let [hit, missed, false_alarm] = [count(true, true), count(true, false), count(false, true)];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::answer::Answer;
    use crate::challenge::cases::draw;
    use crate::challenge::design::Design;
    use crate::challenge::order::{Order, Selection};
    use crate::challenge::truth::Truth;
    use crate::quantity::Seed;
    use rand::RngExt;
    use serde_json::{Value, json};

    fn truths(count: usize) -> Vec<Truth> {
        let grounds = ["sand", "hard"].map(str::to_owned).to_vec();
        let read = |ground: &String| Design::of(ground, None).unwrap().unwrap();
        let designs: Vec<Design> = grounds.iter().map(read).collect();
        let order = Order {
            selection: Selection::all(),
            cases: Some(count),
            grounds,
            duration: None,
            without_detectability: false,
            seed: Seed(3),
        };
        draw(&order, &designs).unwrap()
    }

    fn scores(truths: &[Truth], answer: impl Fn(&Truth) -> Value) -> Scores {
        let judged: Vec<Judged> = truths
            .iter()
            .map(|truth| Judged {
                answer: Some(serde_json::from_value::<Answer>(answer(truth)).unwrap()),
                seconds: Some(10.0),
                truth: truth.clone(),
            })
            .collect();
        Scores::of(&judged, truths.len())
    }

    fn suspects(truth: &Truth) -> Vec<Value> {
        let suspect = |hidden: &crate::challenge::truth::Hidden| {
            let m = hidden.magnitude;
            json!({"name": hidden.name, "magnitude": m, "ci95": [0.9 * m, null]})
        };
        truth.effects.iter().map(suspect).collect()
    }

    /// An oracle.
    fn perfect(truth: &Truth) -> Value {
        let names: Vec<&str> = truth.effects.iter().map(|it| it.name.as_str()).collect();
        let (verdict, label) = match truth.set {
            Set::C0 => ("parameter", "parameter".to_owned()),
            Set::C1 | Set::C2 => ("effect", names[0].to_owned()),
            Set::C3 => ("unknown", "unknown".to_owned()),
            Set::C4 => ("effects", names.join("+")),
        };
        let application = truth.effects.first().map(|it| it.application().unwrap());
        let channel = application.map_or("", |it| it.effect().signature.channels[0]);
        let screen: Vec<Value> = names
            .iter()
            .map(|name| json!({"name": name, "detectable": 1.0e-9}))
            .collect();
        json!({
            "verdict": verdict, "probabilities": {&label: 1.0}, "effects": suspects(truth), "set": [label],
            "closed": {"value": 1.0, "ci95": [0.9, 1.0]}, "screen": screen,
            "located": [{"condition": "ST", "cell": format!("{channel}/time/mean"), "deviations": 9.0}],
        })
    }

    #[test]
    fn an_oracle_has_every_score() {
        let scores = scores(&truths(150), perfect);
        let is = |score: &Score, value: f64| {
            let found = score.value.unwrap();
            assert!(
                score.n > 0 && (found - value).abs() < 1.0e-12,
                "{found} for {value}"
            );
        };
        is(&scores.nothing.cleared, 1.0);
        is(&scores.nothing.false_attribution, 0.0);
        for single in [&scores.own_form, &scores.other_form] {
            is(&single.top1, 1.0);
            is(&single.top1_equivalent, 1.0);
            is(&single.top3, 1.0);
            is(&single.set_size, 1.0);
            is(&single.undecided, 0.0);
            is(&single.magnitude_error, 0.0);
            is(&single.magnitude_covered, 1.0);
            is(&single.closed, 1.0);
        }
        is(&scores.left_out.unknown, 1.0);
        is(&scores.left_out.located, 1.0);
        is(&scores.pairs.both_named, 1.0);
        is(&scores.unknown.auroc, 1.0);
        is(&scores.unknown.f1, 1.0);
        is(&scores.c1_less_c2, 0.0);
        is(&scores.probability_on_truth, 1.0);
        is(&scores.calibration_error, 0.0);
        is(&scores.probabilities.log_score, 0.0);
        is(&scores.probabilities.brier_score, 0.0);
        is(&scores.probabilities.calibration_error, 0.0);
        is(&scores.probabilities.set_coverage, 1.0);
        is(&scores.probabilities.set_size, 1.0);
        is(&scores.seconds, 10.0);
        assert!(scores.effects.iter().all(|effect| !effect.is_weak));
        let diagonal = |row: usize| scores.confusion.values[row][row];
        let hits: f64 = (0..scores.confusion.rows.len() - 1).map(diagonal).sum();
        let singles = scores.nothing.cleared.n + scores.own_form.top1.n + scores.other_form.top1.n;
        assert_eq!(hits, singles as f64);
    }

    #[test]
    fn who_never_sees_anything_is_right_where_there_is_nothing_and_nowhere_else() {
        let truths = truths(150);
        let scores = scores(
            &truths,
            |_| json!({"verdict": "none", "probabilities": {"none": 1.0}}),
        );
        let nothing = truths.iter().filter(|truth| truth.set == Set::C0).count() as f64;
        let share = nothing / truths.len() as f64;
        assert_eq!(scores.nothing.cleared.value, Some(1.0));
        assert_eq!(scores.own_form.top1_equivalent.value, Some(0.0));
        assert_eq!(scores.own_form.top3.value, Some(0.0));
        assert_eq!(scores.own_form.set_size.n, 0);
        assert_eq!(scores.pairs.one_named.value, Some(0.0));
        assert_eq!(scores.left_out.unknown.value, Some(0.0));
        // No probability of the unknown is larger than another.
        assert_eq!(scores.unknown.auroc.value, Some(0.5));
        assert_eq!(scores.unknown.f1.value, Some(0.0));
        assert!((scores.probability_on_truth.value.unwrap() - share).abs() < 1.0e-12);
        let near = |score: &Score, value: f64| (score.value.unwrap() - value).abs() < 1.0e-12;
        // Nowhere else has the truth any probability: 0.001 counts instead. All that is wrong is so twice.
        let missed = 1.0 - share;
        assert!(near(
            &scores.probabilities.log_score,
            missed * 1.0e-3_f64.ln()
        ));
        assert!(near(&scores.probabilities.brier_score, 2.0 * missed));
        // These answers state no sets.
        assert_eq!(scores.probabilities.set_coverage.n, 0);
        assert!((scores.calibration_error.value.unwrap() - (1.0 - share)).abs() < 1.0e-12);
        assert!(scores.effects.iter().all(|effect| effect.is_weak));
        assert!(
            scores
                .effects
                .iter()
                .all(|it| it.partner.as_deref() == Some("nothing"))
        );
    }

    #[test]
    fn a_guess_is_right_as_often_as_chance() {
        let truths = truths(400);
        let names: Vec<String> = truths
            .iter()
            .flat_map(|truth| truth.effects.iter().map(|hidden| hidden.name.clone()))
            .collect();
        let scores = scores(&truths, |truth| {
            let mut rng = truth.seed.rng("guess", 0);
            // Among ten names, of which one is the truth where there is one.
            let mut choice: Vec<&String> = names.iter().take(9).collect();
            choice.extend(truth.effects.first().map(|hidden| &hidden.name));
            let guess = choice[rng.random_range(0..choice.len())];
            let unknown: f64 = rng.random();
            json!({
                "verdict": "effect", "effects": [{"name": guess, "magnitude": 1.0}],
                "probabilities": {guess: 1.0 - unknown, "unknown": unknown},
            })
        });
        let near = |score: &Score, chance: f64, sd: f64| {
            let found = score.value.unwrap();
            assert!((found - chance).abs() < 4.0 * sd, "{found} for {chance}");
        };
        let n = scores.own_form.top1.n as f64;
        // A truth that is also among the nine adds to its chance a little.
        near(&scores.own_form.top1, 0.11, (0.1_f64 * 0.9 / n).sqrt());
        let hits = scores.left_out.unknown.n as f64;
        near(&scores.unknown.auroc, 0.5, (1.0 / (12.0 * hits)).sqrt());
        assert_eq!(scores.nothing.false_attribution.value, Some(1.0));
    }

    #[test]
    fn undecided_and_failed_diagnoses_are_misses() {
        let truths = truths(60);
        let undecided = scores(&truths, |truth| {
            json!({
                "verdict": "undecided", "effects": suspects(truth),
                "probabilities": {"undecided": 0.6},
            })
        });
        assert_eq!(undecided.own_form.top3.value, Some(0.0));
        assert_eq!(undecided.own_form.undecided.value, Some(1.0));
        assert_eq!(undecided.nothing.cleared.value, Some(0.0));
        let failed = truths.iter().map(|truth| Judged {
            truth: truth.clone(),
            answer: None,
            seconds: None,
        });
        let failed = Scores::of(&failed.collect::<Vec<_>>(), truths.len() + 5);
        assert_eq!((failed.failed, failed.unanswered), (60, 5));
        assert_eq!(failed.own_form.top1.value, Some(0.0));
        assert_eq!(failed.nothing.cleared.value, Some(0.0));
        assert_eq!(failed.seconds.value, None);
    }

    #[test]
    fn an_effect_in_the_set_of_another_counts_up_to_equivalence_only() {
        let scores = scores(&truths(60), |truth| {
            let names: Vec<&str> = truth.effects.iter().map(|it| it.name.as_str()).collect();
            let name = names.first().copied().unwrap_or("slope");
            json!({
                "verdict": "effect", "probabilities": {"else": 0.7, name: 0.3},
                "effects": [{"name": "else", "magnitude": 1.0, "equivalent_to": names}],
                "next_run": {"run": "in reverse", "between": ["else", name]},
            })
        });
        assert_eq!(scores.own_form.top1.value, Some(0.0));
        assert_eq!(scores.own_form.top1_equivalent.value, Some(1.0));
        assert_eq!(scores.own_form.set_size.value, Some(2.0));
        let mean = scores.own_form.probability_on_truth.value.unwrap();
        // The mean of equal numbers, but for rounding.
        assert!((mean - 0.3).abs() < 1.0e-12, "{mean}");
        // A set with both effects of a pair names one of them.
        assert_eq!(scores.pairs.one_named.value, Some(1.0));
        assert_eq!(scores.pairs.both_named.value, Some(0.0));
        let effect = &scores.effects[0];
        assert_eq!(effect.partner.as_deref(), Some("else"));
        assert_eq!(effect.next_run.as_deref(), Some("in reverse"));
        // Answers that are no case's truth are in the matrix too.
        let columns = &scores.confusion.columns;
        let another = columns
            .iter()
            .position(|it| it == "another effect")
            .unwrap();
        for row in &scores.confusion.values {
            let cases: f64 = row.iter().sum();
            assert_eq!(row[another], cases);
        }
        let cases: f64 = scores.confusion.values.iter().flatten().sum();
        assert!(cases > 30.0, "{cases}");
    }

    #[test]
    fn power_is_relative_to_the_detection_limit() {
        let twice = |truth: &Truth| {
            let mut answer = perfect(truth);
            let half = truth.effects.iter().map(|hidden| {
                let seat = hidden.application().unwrap().seat();
                let detectable = if seat.neutral.is_finite() {
                    (hidden.magnitude - seat.neutral).abs() / 3.0
                } else {
                    hidden.magnitude * 3.0
                };
                json!({"name": hidden.name, "detectable": detectable})
            });
            answer["screen"] = half.collect();
            answer
        };
        let scores = scores(&truths(100), twice);
        for class in &scores.power {
            let expected = if class.low == 2.0 {
                scores.own_form.top1.n
            } else {
                0
            };
            assert_eq!(class.own.n, expected, "{}", class.low);
        }
    }

    #[test]
    fn a_case_counts_in_the_class_of_its_detectability_and_a_pair_in_that_of_its_weaker_effect() {
        let mut truths = truths(150);
        for truth in &mut truths {
            for (place, hidden) in truth.effects.iter_mut().enumerate() {
                hidden.detectability = match (truth.set, hidden.level) {
                    (Set::C1, Some(Level::Low)) => None,
                    (Set::C1, Some(Level::Typical)) => Some(5.99),
                    (Set::C1, _) => Some(6.0),
                    (Set::C2, _) => Some(40.0),
                    (Set::C3, _) => Some(2.0),
                    (_, _) => Some(7.0 - 2.0 * place as f64),
                };
            }
        }
        let scores = scores(&truths, perfect);
        let counts = |by_class: &ByClass| -> Vec<usize> {
            let classes = by_class.classes.iter().chain([&by_class.headline]);
            classes.map(|class| class.top1.n).collect()
        };
        let of = |set: Set, level: Option<Level>| {
            let is_it = |truth: &&Truth| {
                let own = truth.effects.first().and_then(|it| it.level);
                truth.set == set && (level.is_none() || own == level)
            };
            truths.iter().filter(is_it).count()
        };
        let [typical, high] = [Level::Typical, Level::High].map(|it| of(Set::C1, Some(it)));
        let own = &scores.detectability.own_form;
        assert_eq!(counts(own), [0, typical, high, 0, high]);
        assert_eq!(own.headline.top1_equivalent.value, Some(1.0));
        assert_eq!(own.headline.log_score.value, Some(0.0));
        let other = of(Set::C2, None);
        let found = counts(&scores.detectability.other_form);
        assert_eq!(found, [0, 0, 0, other, other]);
        // One effect of each pair has a d' of 5, and no excluded effect reaches 6.
        assert_eq!(scores.detectability.both_named.n, 0);
        assert_eq!(scores.detectability.unknown.value, None);
        assert!(!scores.detectability_beside_parameters.is_known());
        let text = scores.to_string();
        for words in [
            "d' of 6 or more",
            "C1 3 to 6: named",
            "C1 0 to 3: log score",
        ] {
            assert!(text.contains(words), "{text}");
        }
        assert!(!text.contains("beside unknown parameters"), "{text}");
    }

    #[test]
    fn where_a_cause_acts_is_half_an_answer() {
        let mut truths = truths(100);
        let effects = truths.iter_mut().flat_map(|truth| &mut truth.effects);
        effects.for_each(|hidden| hidden.detectability_beside_parameters = Some(8.0));
        let scores = scores(&truths, |truth| {
            let effect = truth.effects.first().map(|it| it.application().unwrap());
            let place = effect.map(|it| {
                let changes_motion = it.effect().stage == crate::effects::Stage::Physics;
                crate::diagnosis::place_of(changes_motion, it.seat().channel)
            });
            json!({
                "verdict": "undecided", "probabilities": {"unknown": 1.0},
                "mechanism": place.map(|it| json!({"of": it, "probability": 0.9})),
            })
        });
        let headline = &scores.detectability_beside_parameters.other_form.headline;
        assert_eq!(headline.effect_or_mechanism.value, Some(1.0));
        assert_eq!(headline.top1_equivalent.value, Some(0.0));
    }

    #[test]
    fn an_area_under_the_curve_is_the_share_of_pairs_in_order() {
        let case = |is_positive, score| Detection { is_positive, score };
        let scored = [
            case(true, 0.9),
            case(true, 0.4),
            case(false, 0.4),
            case(false, 0.1),
            case(false, 0.6),
        ];
        // 0.9 beats three; 0.4 beats one, ties one, loses one.
        let area = auroc(&scored.iter().collect::<Vec<_>>()).unwrap();
        assert!((area - 4.5 / 6.0).abs() < 1.0e-12, "{area}");
        assert_eq!(auroc(&[&case(true, 0.5)]), None);
    }
}
