//! Every hypothesis, fitted alike and ranked by what it says of held-out conditions.
//!
//! The score of a fit is the sum of its log predictive densities of every condition given the
//! others, less what its freedom costs (log evidence less log likelihood at the best fit), of which
//! held-out conditions have already paid one for each number determined. A fit that is right thus
//! scores its evidence; one that does not carry over to other conditions loses more. No effect raises the
//! score by more than the likelihood. Scores over a temperature plus log priors are the refit's probabilities.
//! The louder a gap, the more an error of a few per cent in what is predicted of it decides, so the temperature
//! grows with the best score over recalibration's. With the forest's probabilities they form a logarithmic pool
//! (Genest and Zidek 1986, Stat. Sci. 1:114-135), so that a disagreement leaves none sure.

use super::check::Check;
use super::fit::{Fit, Problem};
use super::forest::Forest;
use super::form;
use super::hypothesis::Hypothesis;
use super::product::log_sum;
use super::responses::Candidate;
use super::screen::Screen;
use super::unknown;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Effects that may be one of a pair, and partners tried for each.
const PAIRED: (usize, usize) = (4, 3);
/// Log score [-] over recalibration's from which on the form of an effect can be told.
const TOLD: f64 = 3.0;

/// A hypothesis with its probability.
#[derive(Debug)]
pub(super) struct Ranked {
    pub hypothesis: Hypothesis,
    /// What it says of held-out conditions, less the cost of its freedom [-].
    pub log_score: f64,
    /// Logarithm of the probability [-] after pooling: the probability itself may be too small for a
    /// number, and yet all that is left.
    pub log_probability: f64,
    /// By the refit alone, and by the forest.
    pub engines: [f64; 2],
    /// How well it predicts; none for the unknown.
    pub check: Option<Check>,
}

/// All hypotheses, likeliest first, and their fits.
#[derive(Debug)]
pub(super) struct Ranking {
    pub ranked: Vec<Ranked>,
    pub fits: Vec<Fit>,
}

impl Ranking {
    pub fn new(problem: Problem, forest: &Forest) -> Self {
        // All are held against the spread that recalibration leaves.
        let freest = Hypothesis::freest(problem.emulator);
        let fits = fits(problem, Some(&Fit::new(problem, freest)));
        let calibration = problem.calibration;
        let mut scores: Vec<(Hypothesis, f64, Option<Check>)> = fits
            .iter()
            .map(|fit| {
                let check = Check::of(problem, fit);
                (fit.hypothesis.clone(), score(fit), Some(check))
            })
            .collect();
        let plain = fits.iter().filter(|fit| is_plain(fit));
        let recalibrated = largest(plain.clone().map(score));
        let free: Vec<f64> = plain.map(|fit| unknown::score(problem, fit)).collect();
        let unknown = log_sum(free.iter().copied()) - libm::log(free.len() as f64);
        scores.push((Hypothesis::Unknown, unknown, None));
        let priors = log_priors(problem, scores.iter().map(|(h, ..)| h));
        let gain = largest(scores.iter().map(|(_, score, _)| *score)) - recalibrated;
        let temperature = calibration.temperature + calibration.gain_error * gain;
        let logs: Vec<f64> = scores
            .iter()
            .zip(&priors)
            .map(|((_, score, _), prior)| score / temperature + prior)
            .collect();
        let by_refit = normalised(&logs);
        let by_forest = by_forest(problem, forest, &scores, &priors);
        let share = calibration.forest_share;
        let pooled: Vec<f64> = by_refit
            .iter()
            .zip(&by_forest)
            .map(|(refit, forest)| (1.0 - share) * refit + share * forest)
            .collect();
        let pooled = normalised(&pooled);
        let mut ranked: Vec<Ranked> = scores
            .into_iter()
            .enumerate()
            .map(|(number, (hypothesis, log_score, check))| Ranked {
                hypothesis,
                log_score,
                log_probability: pooled[number],
                engines: [by_refit[number], by_forest[number]].map(libm::exp),
                check,
            })
            .collect();
        ranked.sort_by(|a, b| b.log_probability.total_cmp(&a.log_probability));
        Self { ranked, fits }
    }

    /// The fit of a hypothesis.
    pub fn fit(&self, hypothesis: &Hypothesis) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.hypothesis == *hypothesis)
    }
}

fn largest(scores: impl Iterator<Item = f64>) -> f64 {
    scores.fold(f64::NEG_INFINITY, f64::max)
}

pub(super) fn score(fit: &Fit) -> f64 {
    let held_out: f64 = fit
        .held_out
        .iter()
        .map(|held_out| held_out.log_density)
        .sum();
    (held_out + fit.occam + fit.determined).min(fit.most) + fit.forms
}

/// None, parameters, every effect, and pairs of those that the first fits leave, each held against
/// its own variances or those of `another`, each in the form that says most.
pub(super) fn fits(problem: Problem, another: Option<&Fit>) -> Vec<Fit> {
    let mut plain = vec![Hypothesis::None];
    // Without parameters there is nothing to recalibrate.
    if !problem.emulator.parameters.is_empty() {
        plain.push(Hypothesis::Parameter);
    }
    let plain = plain.into_par_iter();
    let mut fits: Vec<Fit> = plain
        .map(|hypothesis| Fit::beside(problem, (hypothesis, form::OWN), another))
        .collect();
    let candidates = 0..problem.emulator.candidates.len();
    let singles = candidates.map(|effect| Hypothesis::Effects(vec![effect]));
    fits.extend(in_forms(problem, singles.collect(), (&fits, another)));
    fits.extend(in_forms(problem, pairs(problem, &fits), (&fits, another)));
    fits
}

/// Fits of explanations by effects, each in the form that says most, beside the `simpler` ones.
fn in_forms(
    problem: Problem,
    hypotheses: Vec<Hypothesis>,
    (simpler, another): (&[Fit], Option<&Fit>),
) -> Vec<Fit> {
    let recalibrated = largest(simpler.iter().filter(|fit| is_plain(fit)).map(score));
    let hypotheses = hypotheses.into_par_iter();
    hypotheses
        .map(|hypothesis| {
            let fit = |likeness: f64| {
                let fit = Fit::beside(problem, (hypothesis.clone(), likeness), another);
                bounded(problem, fit, simpler)
            };
            let near = fit(form::NEAR);
            if score(&near) < recalibrated + TOLD {
                return near;
            }
            match hypothesis.effects().len() {
                1 => likeliest(&form::ALONE, fit, near),
                _ => likeliest(&form::PAIRED, fit, near),
            }
        })
        .collect()
}

/// The form of a fit that says most, with what all say together.
fn likeliest(forms: &[(f64, f64)], fit: impl Fn(f64) -> Fit, near: Fit) -> Fit {
    let mut near = Some(near);
    let fits = forms.iter().map(|(likeness, prior)| {
        let known = near.take_if(|near| near.likeness == *likeness);
        let fit = known.unwrap_or_else(|| fit(*likeness));
        (libm::log(*prior) + score(&fit), fit)
    });
    let fits: Vec<(f64, Fit)> = fits.collect();
    let together = log_sum(fits.iter().map(|(log, _)| *log));
    let best = fits.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (_, mut best) = best.expect("a form");
    best.forms = together - score(&best);
    best
}

fn is_plain(fit: &Fit) -> bool {
    fit.hypothesis.effects().is_empty()
}

/// The best effects, each with the partners that the screen says would explain most of what it leaves.
fn pairs(problem: Problem, fits: &[Fit]) -> Vec<Hypothesis> {
    let singles = fits.iter();
    let singles = singles.filter_map(|fit| Some((fit, *fit.hypothesis.effects().first()?)));
    let mut singles: Vec<(&Fit, usize)> = singles.collect();
    singles.sort_by(|a, b| score(b.0).total_cmp(&score(a.0)));
    let mut pairs: Vec<Hypothesis> = singles
        .into_iter()
        .take(PAIRED.0)
        .flat_map(|(fit, effect)| partners(problem, fit, effect))
        .collect();
    pairs.sort();
    pairs.dedup();
    pairs
}

fn partners(problem: Problem, fit: &Fit, effect: usize) -> Vec<Hypothesis> {
    let projected = Screen::beside(problem, fit).projected();
    let equivalent = problem.calibration.equivalent;
    let mut others: Vec<(usize, f64)> = (0..problem.emulator.candidates.len())
        .filter(|&other| other != effect && projected.cosine(other, effect).abs() <= equivalent)
        .map(|other| (other, projected.score_beside(other, effect)))
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    let pair = |(other, _): &(usize, f64)| {
        Hypothesis::Effects(vec![effect.min(*other), effect.max(*other)])
    };
    others.iter().take(PAIRED.1).map(pair).collect()
}

/// A fit that scores no more over one with an effect less than that effect adds to the likelihood: the rest is
/// chance of what was simulated where each ended. Effects of no size gained ten of log score by it.
fn bounded(problem: Problem, mut fit: Fit, simpler: &[Fit]) -> Fit {
    let effects = fit.hypothesis.effects().iter();
    for (effect, gain) in effects.zip(&fit.gains) {
        let others = fit.hypothesis.without(*effect, problem.emulator);
        let without = simpler.iter().find(|other| other.hypothesis == others);
        fit.most = fit.most.min(without.map_or(f64::INFINITY, score) + gain);
    }
    fit
}

/// Causes share their prior alike, and the channels of a cause its share: a wrong gain of one of six
/// channels is no likelier than a wrong encoder. Pairs share theirs among all that there could be.
fn log_priors<'h>(problem: Problem, hypotheses: impl Iterator<Item = &'h Hypothesis>) -> Vec<f64> {
    let [none, parameter, single, pair, unknown] = problem.calibration.priors;
    let shares = shares(&problem.emulator.candidates);
    let alone: f64 = shares.iter().map(|share| share * share).sum();
    let prior = |hypothesis: &Hypothesis| match hypothesis {
        Hypothesis::None => none,
        Hypothesis::Parameter => parameter,
        Hypothesis::Unknown => unknown,
        Hypothesis::Effects(effects) => match effects[..] {
            [a, b] => 2.0 * pair * shares[a] * shares[b] / (1.0 - alone),
            _ => single * effects.iter().map(|one| shares[*one]).product::<f64>(),
        },
    };
    hypotheses
        .map(|hypothesis| libm::log(prior(hypothesis)))
        .collect()
}

/// Share [-] of each candidate in what all have together.
fn shares(candidates: &[Candidate]) -> Vec<f64> {
    let mut channels = BTreeMap::<&str, f64>::new();
    for candidate in candidates {
        *channels.entry(candidate.cause()).or_default() += 1.0;
    }
    let causes = channels.len() as f64;
    let shares = candidates.iter();
    shares
        .map(|candidate| 1.0 / (causes * channels[candidate.cause()]))
        .collect()
}

/// Log probabilities by the forest; a pair stands between its effects, as one tree sees one cause.
fn by_forest(
    problem: Problem,
    forest: &Forest,
    scores: &[(Hypothesis, f64, Option<Check>)],
    priors: &[f64],
) -> Vec<f64> {
    let votes = forest.probabilities(problem);
    let vote = |hypothesis: &Hypothesis| {
        let place = forest.hypotheses.iter().position(|h| h == hypothesis);
        place.map_or(f64::MIN_POSITIVE, |place| votes[place])
    };
    let of = |hypothesis: &Hypothesis| match hypothesis {
        Hypothesis::Effects(pair) if pair.len() == 2 => {
            let votes = pair
                .iter()
                .map(|&effect| vote(&Hypothesis::Effects(vec![effect])));
            votes.sum::<f64>()
        }
        single => vote(single),
    };
    let logs: Vec<f64> = scores
        .iter()
        .zip(priors)
        .map(|((hypothesis, ..), prior)| libm::log(of(hypothesis)) + prior)
        .collect();
    normalised(&logs)
}

fn normalised(logs: &[f64]) -> Vec<f64> {
    let sum = log_sum(logs.iter().copied());
    logs.iter().map(|log| log - sum).collect()
}
