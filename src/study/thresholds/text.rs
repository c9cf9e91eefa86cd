//! The statements as text for reading.

use super::statement::{Part, Statement, ThresholdScore};
use super::tally::{Empirical, Tally};
use crate::recognition::confusion::Share;
use std::fmt;

impl fmt::Display for ThresholdScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            windows,
            all_touched,
            statements,
            ..
        } = self;
        writeln!(
            f,
            "{windows} windows, every lug touched on {all_touched}; these are held to the limits, for \
             displacements\nwhere every lug touches also without slip. 99 %/bound is the 99 % quantile \
             of value over bound.\nShares have Wilson's 95 % interval, which takes windows for independent."
        )?;
        statements
            .iter()
            .try_for_each(|statement| write!(f, "\n{statement}"))
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.multi_lugged {
            "multi-lugged"
        } else {
            "olig-lugged"
        };
        let Self {
            equation,
            quantity,
            limit,
            ..
        } = self;
        writeln!(f, "{equation} {kind} wheels: {quantity}\n  limit: {limit}")?;
        let named = self.parts.iter().map(|part| part.value.len());
        let width = named.max().unwrap_or_default().max("all".len()) + 2;
        writeln!(
            f,
            "  {:width$}{:>5}{:>9}{:>9}{:>9}{:>9}{:>15}{:>12}  above the limit",
            "", "n", "median", "95 %", "99 %", "largest", "limit", "99 %/limit"
        )?;
        for group in self.parts.chunk_by(|a, b| a.by == b.by) {
            if group[0].by != "all" {
                writeln!(f, "  by {}", group[0].by)?;
            }
            for part in group {
                part_line(f, part, width)?;
            }
        }
        self.empirical
            .iter()
            .try_for_each(|limit| empirical(f, limit))
    }
}

fn part_line(f: &mut fmt::Formatter<'_>, part: &Part, width: usize) -> fmt::Result {
    let name = if part.by == "all" { "all" } else { &part.value };
    let Tally {
        n,
        median,
        q95,
        q99,
        largest,
        bound: [low, high],
        tightness,
        violations,
    } = part.tally;
    let numbers = [median, q95, q99, largest].map(|value| format!("{value:>9.2}"));
    let bound = if high - low < 0.005 {
        format!("{low:.2}")
    } else {
        format!("{low:.2}-{high:.2}")
    };
    writeln!(
        f,
        "  {name:width$}{n:>5}{}{bound:>15}{tightness:>12.2}  {}",
        numbers.concat(),
        share(&violations)
    )
}

fn empirical(f: &mut fmt::Formatter<'_>, limit: &Empirical) -> fmt::Result {
    let end = |end: Option<f64>| end.map_or("-".to_owned(), |end| format!("{end:.2}"));
    let [low, high] = limit.ci95.map(end);
    writeln!(
        f,
        "  empirical: 99 % of {} windows (even repeats) stay below {:.2} [{low}, {high}] times the \
         limit;\n             of the {} others (odd repeats) exceed that {}",
        limit.n,
        limit.quantile,
        limit.exceeded.n,
        share(&limit.exceeded)
    )
}

fn share(share: &Share) -> String {
    let Share {
        value,
        ci95: [low, high],
        ..
    } = share;
    format!("{value:.3} [{low:.3}, {high:.3}]")
}
