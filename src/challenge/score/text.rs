//! Scores as a text.

use super::{OfEffect, Score, Scores, Single};
use crate::challenge::order::{Family, Set};
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
                "cases for calibration: no score of theirs tells of quality"
            )?;
        }
        writeln!(f, "{:<46}{:>9}{:>20}{:>6}  should be", "", "", "95 %", "n")?;
        for (name, score, shown, goal) in self.lines() {
            let (value, interval) = (value(score, shown), interval(score, shown));
            writeln!(
                f,
                "{name:<46}{value:>9}{interval:>20}{:>6}  {goal}",
                score.n
            )?;
        }
        self.write_weak(f)
    }
}

impl Scores {
    fn lines(&self) -> Vec<Line<'_>> {
        use Shown::{Number, Percent};
        let Self {
            nothing,
            own_form,
            other_form,
            left_out,
            pairs,
            unknown,
            ..
        } = self;
        let line = |name: &str, score, shown, goal| (name.to_owned(), score, shown, goal);
        let mut lines = vec![
            line(
                "C0 none or parameter",
                &nothing.cleared,
                Percent,
                "95 % or more",
            ),
            line(
                "C0 an effect named",
                &nothing.false_attribution,
                Percent,
                "",
            ),
        ];
        lines.extend(of_single(Set::C1, own_form));
        lines.extend(of_single(Set::C2, other_form));
        lines.extend([
            line(
                "C1 less C2, up to equivalence",
                &self.c1_less_c2,
                Percent,
                "10 % or less",
            ),
            line("C3 unknown", &left_out.unknown, Percent, ""),
            line("C3 located where it shows", &left_out.located, Percent, ""),
            line("C4 one named", &pairs.one_named, Percent, "90 % or more"),
            line("C4 both named", &pairs.both_named, Percent, "60 % or more"),
            line(
                "unknown: area under the curve",
                &unknown.auroc,
                Number,
                "0.90 or more",
            ),
            line("unknown: F1", &unknown.f1, Number, ""),
            line(
                "probability of the right answer",
                &self.probability_on_truth,
                Number,
                "0.75 or more",
            ),
            line(
                "expected calibration error",
                &self.calibration_error,
                Number,
                "0.05 or less",
            ),
            line("time of a diagnosis [s]", &self.seconds, Number, ""),
        ]);
        lines
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
            let share = value(&effect.top1_equivalent, Shown::Percent);
            writeln!(
                f,
                "  {:<22}{share:>8}  taken for {partner}; the run to make: {run}",
                effect.effect
            )?;
        }
        Ok(())
    }
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
        line("among the three likeliest", &single.top3, Percent, ""),
        line(
            "size of a set of equivalents",
            &single.set_size,
            Number,
            "2 or less",
        ),
        line("undecided", &single.undecided, Percent, ""),
        line(
            "error of magnitude over its scale",
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
            "intervals that hold the magnitude",
            &single.magnitude_covered,
            Percent,
            "",
        ),
        line(
            "closed, over an oracle's",
            &single.closed,
            Number,
            "0.8 or more",
        ),
    ]);
    lines
}

fn value(score: &Score, shown: Shown) -> String {
    score
        .value
        .map_or("-".to_owned(), |value| written(value, shown))
}

fn interval(score: &Score, shown: Shown) -> String {
    let Some([low, high]) = score.ci95 else {
        return "-".to_owned();
    };
    format!("{} to {}", written(low, shown), written(high, shown))
}

fn written(value: f64, shown: Shown) -> String {
    match shown {
        Shown::Percent => format!("{:.1} %", 100.0 * value),
        Shown::Number => format!("{value:.2}"),
    }
}
