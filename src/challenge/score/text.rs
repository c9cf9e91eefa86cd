//! Scores as a text.

use super::{OfEffect, Score, Scores, Single};
use crate::challenge::order::{Family, Set};
use crate::table::{Cell, Column, Table};
use std::fmt;

/// How a score is written.
#[derive(Debug, Clone, Copy)]
enum Shown {
    Percent,
    Number,
}

/// A line of the text: name, score, how it is written, what it should be.
type Line<'a> = (String, &'a Score, Shown, &'static str);

impl fmt::Display for Scores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            cases,
            answered,
            failed,
            unanswered,
            ..
        } = self;
        writeln!(
            f,
            "{cases} cases: {answered} answered, {failed} failed, {unanswered} to be answered"
        )?;
        if self.family == Some(Family::Calibration) {
            writeln!(
                f,
                "cases for calibration: their scores do not measure quality"
            )?;
        }
        let rows = self.lines().into_iter().map(|(name, score, shown, goal)| {
            let n = Cell::Count(score.n as u64);
            let numbers = [value(score, shown), interval(score, shown), n];
            let name = std::iter::once(Cell::Text(name));
            name.chain(numbers).chain([Cell::text(goal)]).collect()
        });
        let table = Table {
            columns: Column::named(["", "", "95 %", "n", "should be"]),
            rows: rows.collect(),
            ..Table::default()
        };
        f.write_str(&table.to_text(0))?;
        self.write_weak(f)
    }
}

impl Scores {
    /// Scores by set, then over all cases.
    fn lines(&self) -> Vec<Line<'_>> {
        let mut lines = self.lines_of_sets();
        lines.extend(self.lines_of_all());
        lines
    }

    fn lines_of_sets(&self) -> Vec<Line<'_>> {
        let percent = |name, score, goal| line(name, score, Shown::Percent, goal);
        let Self {
            nothing,
            left_out,
            pairs,
            ..
        } = self;
        let mut lines = vec![
            percent("C0 none or parameter", &nothing.cleared, "95 % or more"),
            percent("C0 an effect named", &nothing.false_attribution, ""),
        ];
        lines.extend(of_single(Set::C1, &self.own_form));
        lines.extend(of_single(Set::C2, &self.other_form));
        lines.extend([
            percent(
                "C1 minus C2, up to equivalence",
                &self.c1_less_c2,
                "10 % or less",
            ),
            percent("C3 unknown", &left_out.unknown, ""),
            percent("C3 located in an affected channel", &left_out.located, ""),
            percent("C4 one named", &pairs.one_named, "90 % or more"),
            percent("C4 both named", &pairs.both_named, "60 % or more"),
        ]);
        lines
    }

    fn lines_of_all(&self) -> [Line<'_>; 5] {
        let number = |name, score, goal| line(name, score, Shown::Number, goal);
        [
            number(
                "unknown: area under the curve",
                &self.unknown.auroc,
                "0.90 or more",
            ),
            number("unknown: F1", &self.unknown.f1, ""),
            number(
                "probability of the correct answer",
                &self.probability_on_truth,
                "0.75 or more",
            ),
            number(
                "expected calibration error",
                &self.calibration_error,
                "0.05 or less",
            ),
            number("time of a diagnosis [s]", &self.seconds, ""),
        ]
    }

    fn write_weak(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let weak: Vec<&OfEffect> = self.effects.iter().filter(|it| it.is_weak).collect();
        if weak.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "\nnamed in fewer than 60 % of their cases, up to equivalence:"
        )?;
        for effect in weak {
            let [partner, run] =
                [&effect.partner, &effect.next_run].map(|word| word.as_deref().unwrap_or("-"));
            let share = value(&effect.top1_equivalent, Shown::Percent).written();
            writeln!(
                f,
                "  {:<22}{share:>8}  confused with {partner}; recommended run: {run}",
                effect.effect
            )?;
        }
        Ok(())
    }
}

fn line<'s>(name: &str, score: &'s Score, shown: Shown, goal: &'static str) -> Line<'s> {
    (name.to_owned(), score, shown, goal)
}

fn of_single(set: Set, single: &Single) -> Vec<Line<'_>> {
    use Shown::{Number, Percent};
    let levels = single.by_level.values();
    let goals = ["", "85 % or more", "95 % or more"];
    let names = ["low", "typical", "high"].map(|level| format!("   at {level} magnitude"));
    let levels = names.into_iter().zip(levels).zip(goals);
    let levels = levels.map(|((name, score), goal)| (name, score, Percent, goal));
    let line = |name: &str, score, shown, goal| (format!("{set} {name}"), score, shown, goal);
    let mut lines = vec![
        line("named", &single.top1, Percent, ""),
        line(
            "named, up to equivalence",
            &single.top1_equivalent,
            Percent,
            "",
        ),
    ];
    lines.extend(levels);
    lines.extend([
        line("among the three most probable", &single.top3, Percent, ""),
        line(
            "size of the equivalence set",
            &single.set_size,
            Number,
            "2 or less",
        ),
        line("undecided", &single.undecided, Percent, ""),
        line(
            "magnitude error over the typical magnitude",
            &single.magnitude_error,
            Percent,
            "15 % or less",
        ),
        line(
            "... over the true magnitude",
            &single.magnitude_error_relative,
            Percent,
            "",
        ),
        line(
            "magnitude within its 95 % interval",
            &single.magnitude_covered,
            Percent,
            "",
        ),
        line(
            "closed share over that of the true effect",
            &single.closed,
            Number,
            "0.8 or more",
        ),
    ]);
    lines
}

fn value(score: &Score, shown: Shown) -> Cell {
    let cell = |value| Cell::Written(written(value, shown), value);
    score.value.map(cell).into()
}

fn interval(score: &Score, shown: Shown) -> Cell {
    let cell = |[low, high]: [f64; 2]| {
        let text = format!("{} to {}", written(low, shown), written(high, shown));
        Cell::Written(text, low)
    };
    score.ci95.map(cell).into()
}

fn written(value: f64, shown: Shown) -> String {
    match shown {
        Shown::Percent => format!("{:.1} %", 100.0 * value),
        Shown::Number => format!("{value:.2}"),
    }
}
