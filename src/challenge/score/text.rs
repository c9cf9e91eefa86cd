//! Scores as a text.

use super::{ByDetectability, OfEffect, Score, Scores, Single};
use crate::challenge::order::{Family, Set};
use crate::table::{Cell, Column, Table};
use std::fmt;

/// How a score is written.
#[derive(Debug, Clone, Copy)]
enum Shown {
    Percent,
    Number,
}

/// A line of the text.
struct Line<'a> {
    name: String,
    score: &'a Score,
    shown: Shown,
    /// What it should be.
    goal: &'static str,
}

/// Lines under a heading.
struct Group<'a> {
    heading: &'static str,
    lines: Vec<Line<'a>>,
}

impl Line<'_> {
    fn cells(&self) -> Vec<Cell> {
        let Self { score, shown, .. } = *self;
        vec![
            Cell::Text(format!("  {}", self.name)),
            value(score, shown),
            interval(score, shown),
            Cell::Count(score.n as u64),
            Cell::text(self.goal),
        ]
    }
}

impl Group<'_> {
    fn rows(&self) -> Vec<Vec<Cell>> {
        // An empty number leaves its column one of numbers.
        let blank = || Cell::Written(String::new(), 0.0);
        let heading = Cell::text(self.heading);
        let heading = vec![heading, blank(), blank(), blank(), Cell::text("")];
        let lines = self.lines.iter().map(Line::cells);
        std::iter::once(heading).chain(lines).collect()
    }
}

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
        let rows = self.groups().into_iter().flat_map(|group| group.rows());
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
    /// The headline, then probabilities, then all scores.
    fn groups(&self) -> Vec<Group<'_>> {
        let mut groups = Vec::new();
        let [known, beside] = [&self.detectability, &self.detectability_beside_parameters];
        let headings = [
            (known, "detectability d' of 6 or more"),
            (beside, "d' of 6 or more beside unknown parameters"),
        ];
        for (scores, heading) in headings {
            if scores.is_known() {
                let lines = headline(scores);
                groups.push(Group { heading, lines });
            }
        }
        groups.push(Group {
            heading: "probabilities",
            lines: self.lines_of_probabilities(),
        });
        if known.is_known() {
            groups.push(Group {
                heading: "by detectability d'",
                lines: lines_of_classes(known),
            });
        }
        groups.push(Group {
            heading: "all cases, whatever their detectability",
            lines: self.lines_of_sets(),
        });
        groups
    }

    fn lines_of_probabilities(&self) -> Vec<Line<'_>> {
        use Shown::{Number, Percent};
        let all = &self.probabilities;
        vec![
            line(
                "probability of the correct answer, C0 and C1",
                &all.of_nothing_and_own_form,
                Number,
                "0.78 or more",
            ),
            line(
                "probability of the correct answer, all",
                &self.probability_on_truth,
                Number,
                "0.68 or more",
            ),
            line("log score", &all.log_score, Number, ""),
            line("Brier score", &all.brier_score, Number, ""),
            line(
                "calibration error, debiased",
                &all.calibration_error,
                Number,
                "0.03 or less",
            ),
            line(
                "expected calibration error",
                &self.calibration_error,
                Number,
                "",
            ),
            line(
                "90 % sets that hold the cause",
                &all.set_coverage,
                Percent,
                "87 to 93 %",
            ),
            line("size of the 90 % sets", &all.set_size, Number, ""),
            line(
                "C1 and C2 magnitude within its 95 % interval",
                &all.magnitude_covered,
                Percent,
                "92 to 97 %",
            ),
        ]
    }

    fn lines_of_sets(&self) -> Vec<Line<'_>> {
        use Shown::{Number, Percent};
        let percent = |name, score, goal| line(name, score, Percent, goal);
        let Self {
            nothing,
            left_out,
            pairs,
            ..
        } = self;
        let mut lines = vec![
            percent("C0 none or parameter", &nothing.cleared, "95 % or more"),
            percent(
                "C0 an effect named",
                &nothing.false_attribution,
                "2 % or less",
            ),
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
            percent("C4 one named", &pairs.one_named, ""),
            percent("C4 both named", &pairs.both_named, ""),
            line(
                "unknown: area under the curve",
                &self.unknown.auroc,
                Number,
                "",
            ),
            line("unknown: F1", &self.unknown.f1, Number, ""),
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

fn line<'s>(
    name: impl Into<String>,
    score: &'s Score,
    shown: Shown,
    goal: &'static str,
) -> Line<'s> {
    Line {
        name: name.into(),
        score,
        shown,
        goal,
    }
}

fn headline(scores: &ByDetectability) -> Vec<Line<'_>> {
    let percent = |name, score, goal| line(name, score, Shown::Percent, goal);
    let [own, other] = [&scores.own_form, &scores.other_form].map(|it| &it.headline);
    vec![
        percent("C1 named", &own.top1_equivalent, "92 % or more"),
        percent("C2 named", &other.top1_equivalent, "65 % or more"),
        percent(
            "C2 named or its mechanism stated",
            &other.effect_or_mechanism,
            "80 % or more",
        ),
        line(
            "C3 area under the curve of unknown",
            &scores.unknown,
            Shown::Number,
            "0.85 or more",
        ),
        percent("C4 one named", &scores.one_named, "90 % or more"),
        percent("C4 both named", &scores.both_named, "50 % or more"),
    ]
}

/// Below the first end only the probability counts.
fn lines_of_classes(scores: &ByDetectability) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    for (set, by_class) in [(Set::C1, &scores.own_form), (Set::C2, &scores.other_form)] {
        for class in &by_class.classes {
            let range = match class.high {
                Some(high) => format!("{} to {high}", class.low),
                None => format!("{} or more", class.low),
            };
            if class.low > 0.0 {
                let name = format!("{set} {range}: named");
                lines.push(line(name, &class.top1_equivalent, Shown::Percent, ""));
            }
            let name = format!("{set} {range}: log score");
            lines.push(line(name, &class.log_score, Shown::Number, ""));
        }
    }
    lines
}

fn of_single(set: Set, single: &Single) -> Vec<Line<'_>> {
    use Shown::{Number, Percent};
    let levels = single.by_level.values();
    let names = ["low", "typical", "high"].map(|level| format!("   at {level} magnitude"));
    let levels = names.into_iter().zip(levels);
    let levels = levels.map(|(name, score)| line(name, score, Percent, ""));
    let line = |name: &str, score, shown, goal| line(format!("{set} {name}"), score, shown, goal);
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
