//! Which effects are taken for which, and how large an effect has to be to be found.

use super::interval::Score;
use super::judged::Judged;
use crate::challenge::answer::{Answer, Verdict};
use crate::challenge::order::Set;
use crate::challenge::truth::Hidden;
use crate::statistics::mean;
use serde::Serialize;
use std::collections::BTreeMap;

/// Ends of classes of magnitude over detection limit [-].
const POWERS: [f64; 8] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, f64::INFINITY];

/// Below this share [-] an effect's weakness is published with its partner.
const WEAK: f64 = 0.6;

/// Numbers of truths (rows) and answers (columns).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Matrix {
    /// Truths.
    pub rows: Vec<String>,
    /// Answers.
    pub columns: Vec<String>,
    /// A row a truth.
    pub values: Vec<Vec<f64>>,
}

/// Hits among cases whose magnitude over the detection limit lies in a class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Power {
    /// Lower end of the class [-].
    pub low: f64,
    /// Upper end [-]; none where it has none.
    pub high: Option<f64>,
    /// Share of cases that were named, up to equivalence, in the catalogue's own form.
    pub own: Score,
    /// The same in another form.
    pub other: Score,
}

/// How one effect fared in C1 and C2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfEffect {
    /// Its name without channel.
    pub effect: String,
    /// Share of cases in which it was named.
    pub top1: Score,
    /// The same up to equivalence.
    pub top1_equivalent: Score,
    /// Whether that is below 60 %.
    pub is_weak: bool,
    /// What was answered instead most often.
    pub partner: Option<String>,
    /// The next run recommended most often.
    pub next_run: Option<String>,
}

/// The column of effects that are no case's truth.
const ANOTHER: &str = "another effect";

/// Cases by truth and answer, effects without their channels; cases of two effects are not in it.
pub(super) fn confusion(cases: &[Judged]) -> Matrix {
    let effects = effects(cases);
    let rows = named(&effects, &["nothing"], &[Verdict::Unknown.name()]);
    let columns = named(
        &effects,
        &["nothing"],
        &[
            ANOTHER,
            "two effects",
            Verdict::Unknown.name(),
            Verdict::Undecided.name(),
            "failed",
        ],
    );
    let answered = |case: &Judged| {
        let word = case
            .answer
            .as_ref()
            .map_or("failed".to_owned(), |it| it.word());
        let place = |word: &str| columns.iter().position(|column| column == word);
        place(&word).or_else(|| place(ANOTHER))
    };
    let row = |row: &String| {
        let mut counts = vec![0.0; columns.len()];
        let of_row = cases
            .iter()
            .filter(|case| truth_of(case).as_ref() == Some(row));
        for place in of_row.filter_map(answered) {
            counts[place] += 1.0;
        }
        counts
    };
    Matrix {
        values: rows.iter().map(row).collect(),
        rows,
        columns,
    }
}

/// Mean absolute cosine [-] between projected signatures of effects, over the answers that state it: at 1
/// they cannot be isolated.
pub(super) fn isolability(cases: &[Judged]) -> Matrix {
    let answers: Vec<&Answer> = cases.iter().filter_map(|it| it.answer.as_ref()).collect();
    let mut cosines: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for answer in answers {
        let names = &answer.compared.candidates;
        for (a, row) in names.iter().zip(&answer.isolability) {
            for (b, cosine) in names.iter().zip(row) {
                let known = cosines.entry((a, b)).or_default();
                known.extend(cosine.map(f64::abs));
            }
        }
    }
    let mut names: Vec<String> = cosines.keys().map(|(a, _)| (*a).to_owned()).collect();
    names.dedup();
    let value = |a: &String, b: &String| {
        let found = cosines.get(&(a.as_str(), b.as_str()));
        found
            .and_then(|found| mean(found.iter().copied()))
            .unwrap_or(0.0)
    };
    let row = |a: &String| names.iter().map(|b| value(a, b)).collect();
    Matrix {
        values: names.iter().map(row).collect(),
        columns: names.clone(),
        rows: names,
    }
}

/// Mean probability [-] that answers (columns) have where something else (rows) is true.
pub(super) fn posterior(cases: &[Judged]) -> Matrix {
    let effects = effects(cases);
    let rows = named(&effects, &["nothing"], &[Verdict::Unknown.name()]);
    let columns = rows.clone();
    let row = |row: &String| -> Vec<f64> {
        let of_row: Vec<&Judged> = cases
            .iter()
            .filter(|case| truth_of(case).as_ref() == Some(row))
            .collect();
        let probabilities: Vec<BTreeMap<String, f64>> =
            of_row.iter().map(|it| by_effect(it)).collect();
        let mean_of = |column: &String| {
            let values = probabilities
                .iter()
                .map(|it| it.get(column).copied().unwrap_or(0.0));
            mean(values).unwrap_or(0.0)
        };
        columns.iter().map(mean_of).collect()
    };
    Matrix {
        values: rows.iter().map(row).collect(),
        rows,
        columns,
    }
}

/// Hits against magnitude over detection limit.
pub(super) fn power(cases: &[Judged]) -> Vec<Power> {
    let share = |set: Set, [low, high]: [f64; 2]| {
        let of_set = cases.iter().filter(|case| case.is_of(set));
        let within = of_set.filter(|it| it.power().is_some_and(|it| low <= it && it < high));
        Score::share(within.map(Judged::is_named_up_to_equivalence))
    };
    let ends = POWERS.windows(2).map(|ends| [ends[0], ends[1]]);
    ends.map(|[low, high]| Power {
        low,
        high: high.is_finite().then_some(high),
        own: share(Set::C1, [low, high]),
        other: share(Set::C2, [low, high]),
    })
    .collect()
}

/// Every effect of C1 and C2.
pub(super) fn of_effects(cases: &[Judged]) -> Vec<OfEffect> {
    let of_effect = |effect: String| {
        let own: Vec<&Judged> = singles(cases)
            .filter(|case| case.hidden().is_some_and(|it| it.effect() == effect))
            .collect();
        let top1_equivalent = Score::share(own.iter().map(|it| it.is_named_up_to_equivalence()));
        let answers = own.iter().filter_map(|case| case.answer.as_ref());
        let instead = answers.clone().map(|answer| answer.word());
        OfEffect {
            top1: Score::share(own.iter().map(|it| it.is_named())),
            is_weak: top1_equivalent.value.is_some_and(|share| share < WEAK),
            top1_equivalent,
            partner: most_frequent(instead.filter(|word| *word != effect)),
            next_run: most_frequent(answers.filter_map(|answer| answer.further_run())),
            effect,
        }
    };
    effects(cases).into_iter().map(of_effect).collect()
}

fn singles(cases: &[Judged]) -> impl Iterator<Item = &Judged> {
    cases
        .iter()
        .filter(|case| case.is_of(Set::C1) || case.is_of(Set::C2))
}

/// Effects of C1 and C2 without channels, each once, in the order of their letters.
fn effects(cases: &[Judged]) -> Vec<String> {
    let mut names: Vec<String> = singles(cases)
        .filter_map(|case| Some(case.hidden()?.effect().to_owned()))
        .collect();
    names.sort();
    names.dedup();
    names
}

fn named(effects: &[String], before: &[&str], after: &[&str]) -> Vec<String> {
    let before = before.iter().map(|name| (*name).to_owned());
    let after = after.iter().map(|name| (*name).to_owned());
    before.chain(effects.iter().cloned()).chain(after).collect()
}

/// The row of a case; none for two effects.
fn truth_of(case: &Judged) -> Option<String> {
    match (case.truth.set, case.hidden()) {
        (Set::C0, _) => Some("nothing".to_owned()),
        (Set::C3, _) => Some(Verdict::Unknown.name().to_owned()),
        (Set::C1 | Set::C2, hidden) => hidden.map(|it: &Hidden| it.effect().to_owned()),
        (Set::C4, _) => None,
    }
}

/// Probabilities of an answer, those of an effect's channels together.
fn by_effect(case: &Judged) -> BTreeMap<String, f64> {
    let mut by_effect = BTreeMap::new();
    for (label, probability) in case.labels() {
        if !label.contains('+') {
            let effect = label.split('.').next().unwrap_or(&label).to_owned();
            *by_effect.entry(effect).or_insert(0.0) += probability;
        }
    }
    by_effect
}

/// The most frequent; the first in the order of letters where several are.
fn most_frequent(words: impl Iterator<Item = String>) -> Option<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for word in words {
        *counts.entry(word).or_default() += 1;
    }
    let most = counts.values().copied().max()?;
    counts
        .into_iter()
        .find(|(_, count)| *count == most)
        .map(|(word, _)| word)
}
