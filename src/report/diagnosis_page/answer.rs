//! The answer in a sentence, what it rests on, and what to measure next.

use super::DiagnosisReport;
use super::shrinkage;
use super::words::{self, listed, p_value, percent};
use crate::diagnosis::{Answer, Diagnosis, Suspect, Verdict};
use crate::report::page::Section;
use crate::table::four_digits;

/// The answer with its probability.
pub fn sentence(report: &DiagnosisReport) -> String {
    let Diagnosis { verdict, .. } = report.diagnosis;
    match verdict.verdict {
        Answer::None => format!(
            "The scenario {} explains these runs without any change (probability {}).",
            report.name,
            percent(verdict.probability(Answer::None))
        ),
        Answer::Parameter => parameter(verdict),
        Answer::Effect | Answer::Effects => effects(report.diagnosis),
        Answer::Unknown => {
            let place = verdict.located.first().map_or(String::new(), |strongest| {
                format!(
                    " It shows most in the {} at {}.",
                    words::cell(&strongest.cell),
                    strongest.condition
                )
            });
            format!(
                "The cause is none of the effects in the catalogue (probability {}).{place}",
                percent(verdict.probability(Answer::Unknown))
            )
        }
        Answer::Undecided => undecided(verdict),
    }
}

/// With what else is likely, where most of the probability is others'.
fn parameter(verdict: &Verdict) -> String {
    let [parameter, none] =
        [Answer::Parameter, Answer::None].map(|answer| verdict.probability(answer));
    let others = if parameter + none < 0.5 {
        format!(
            " Nothing else is probable enough to be named.{}",
            likeliest(
                verdict,
                &[Answer::Undecided, Answer::Parameter, Answer::None]
            )
        )
    } else {
        String::new()
    };
    format!(
        "Recalibrated parameters explain the difference without an effect (probability {}; probability of no \
         difference {}).{others}",
        percent(parameter),
        percent(none)
    )
}

/// Probability of all explanations with an effect of each set.
fn probability_of_sets(verdict: &Verdict) -> f64 {
    let explains = |name: &&String| {
        let effects: Vec<&str> = name.split('+').collect();
        verdict.named.iter().all(|set| {
            let mut own = set.iter();
            own.any(|effect| effects.contains(&&**effect))
        })
    };
    let all = verdict.probabilities.iter();
    all.filter(|(name, _)| explains(name)).map(|(_, p)| p).sum()
}

/// How the probability of one effect is made up, where it can have a second one beside it.
fn beside_others(verdict: &Verdict) -> String {
    let [set] = verdict.named.as_slice() else {
        return String::new();
    };
    let alone: f64 = set
        .iter()
        .filter_map(|name| verdict.probabilities.get(name))
        .sum();
    let beside = probability_of_sets(verdict) - alone;
    if beside < LEAST_STATED {
        return String::new();
    }
    format!(
        " (alone {}, together with a second effect {})",
        percent(alone),
        percent(beside)
    )
}

/// Probability [-] below which a part of one is not stated.
const LEAST_STATED: f64 = 0.01;

fn effects(diagnosis: &Diagnosis) -> String {
    let Diagnosis {
        verdict, closed, ..
    } = diagnosis;
    let sets: Vec<String> = verdict.named.iter().map(|set| listed(set, "or")).collect();
    let subject = match sets.len() {
        1 => "An effect is",
        _ => "Two effects are",
    };
    let strengths = verdict.named.iter().filter_map(|set| {
        let name = set.first()?;
        let suspect = verdict.effects.iter().find(|it| it.name == *name)?;
        let title = words::effect(name).map_or("", |effect| effect.title);
        Some(format!("{name} = {} ({title})", magnitude(suspect)))
    });
    let strengths: Vec<String> = strengths.collect();
    let closes = closed.map_or(String::new(), |closed| {
        let explanation = "The most probable explanation";
        format!(" {}.", shrinkage::of_the_gap(&closed, explanation))
    });
    format!(
        "{subject} missing: {}, with probability {}{}. Best estimate: {}.{closes}",
        sets.join("; and "),
        percent(probability_of_sets(verdict)),
        beside_others(verdict),
        strengths.join("; ")
    )
}

/// A magnitude with its interval and unit.
fn magnitude(suspect: &Suspect) -> String {
    let [low, high] = suspect.ci95.map(four_digits);
    let unit = words::unit(suspect.unit);
    let value = four_digits(suspect.magnitude);
    format!("{value} [{low}, {high}] {unit}")
        .trim_end()
        .to_owned()
}

fn undecided(verdict: &Verdict) -> String {
    let next = match &verdict.next_run {
        Some(next) => format!(" The most informative next run is {}.", next.run),
        None => String::new(),
    };
    let likely = likeliest(verdict, &[Answer::Undecided]);
    format!("These runs do not identify what differs.{likely}{next}")
}

/// The three likeliest explanations but these, where any has one per cent.
fn likeliest(verdict: &Verdict, but: &[Answer]) -> String {
    let all = verdict.probabilities.iter();
    let mut likeliest: Vec<(&String, f64)> = all
        .map(|(name, p)| (name, *p))
        .filter(|(name, p)| but.iter().all(|it| it.name() != *name) && *p > 0.01)
        .collect();
    likeliest.sort_by(|a, b| b.1.total_cmp(&a.1));
    let named = likeliest.iter().take(3);
    let named: Vec<String> = named
        .map(|(name, p)| format!("{name} ({})", percent(*p)))
        .collect();
    match &named[..] {
        [] => String::new(),
        [one] => format!(" Most probable is {one}."),
        _ => format!(" Most probable are {}.", listed(&named, "and")),
    }
}

/// Tests, reasons and caveats.
pub fn rests_on(diagnosis: &Diagnosis) -> Section {
    let Diagnosis {
        global,
        verdict,
        caveats,
        compared,
        ..
    } = diagnosis;
    let runs: usize = compared.conditions.iter().map(|it| it.runs).sum();
    let count = compared.conditions.len();
    let mut facts = vec![
        (
            "compared".to_owned(),
            format!(
                "{runs} measured runs in {count} conditions, judged by {} random rigs; effects tried: {}, \
                 parameters that may move: {}",
                compared.rigs,
                compared.candidates.len(),
                compared.parameters.len()
            ),
        ),
        (
            "test of equality".to_owned(),
            format!(
                "all statistics together {}, strongest statistic {}; the least attainable with so few runs is \
                 {:.3}",
                p_value(global.energy.p),
                p_value(global.strongest.p),
                global.least_p
            ),
        ),
    ];
    let fact = |name: &str, text: &String| (name.to_owned(), text.clone());
    facts.extend(verdict.reasons.iter().map(|it| fact("limitation", it)));
    facts.extend(caveats.iter().map(|it| fact("caveat", it)));
    Section::new("Basis of the answer").facts(facts)
}

/// The most informative next run.
pub fn next_run(diagnosis: &Diagnosis) -> Section {
    let verdict = &diagnosis.verdict;
    let section = Section::new("Recommended next run");
    if let Some(next) = &verdict.next_run {
        let [first, second] = &next.between;
        let [without, with] = next.separation.map(|it| format!("{it:.2}"));
        return section.answer(format!("A run {}.", next.run)).prose(format!(
            "There {first} and {second}, at the magnitudes that explain these runs, differ by {with} standard \
             deviations per statistic, in the best of the present runs by {without}. The candidates are all runs that differ \
             from a measured one in one setting (direction, load, speed, slip, lugs)."
        ));
    }
    let words = match verdict.verdict {
        Answer::Unknown => {
            "No next run can be recommended, because the cause is none of the effects in the catalogue. Repeat \
             the condition with the largest remainder and change one setting at a time."
        }
        Answer::Undecided => {
            "No run was found that discriminates between the causes. More repeats and a second load, speed or \
             slip reduce the uncertainty of every answer."
        }
        _ => {
            "No further run is needed to discriminate between the causes. A repeat at a condition \
             that was not measured yet would check it."
        }
    };
    section.prose(words)
}
