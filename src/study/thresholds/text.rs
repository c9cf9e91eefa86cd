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
            "{windows} windows, {all_touched} of them truly ALCT: nine in ten lugs or more touched. These are held \
             to\nthe limits; to those of displacements where nine in ten touch also without slip. 99 %/limit \
             is\nthe 99 % quantile of value over limit. Shares have Wilson's 95 % interval, which takes \
             windows\nfor independent.\n"
        )?;
        summary(f, statements)?;
        statements
            .iter()
            .try_for_each(|statement| write!(f, "\n{statement}"))
    }
}

/// One line a statement.
fn summary(f: &mut fmt::Formatter<'_>, statements: &[Statement]) -> fmt::Result {
    let named = statements.iter().map(|statement| statement.name.len());
    let width = named.max().unwrap_or_default() + 2;
    for group in statements.chunk_by(|a, b| a.multi_lugged == b.multi_lugged) {
        writeln!(f, "{}", kind(&group[0]))?;
        header(f, width)?;
        for Statement { name, parts, .. } in group {
            row(f, name, &parts[0].tally, width)?;
        }
    }
    Ok(())
}

fn kind(statement: &Statement) -> &'static str {
    if statement.multi_lugged {
        "multi-lugged wheels"
    } else {
        "olig-lugged wheels"
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            equation,
            quantity,
            limit,
            ..
        } = self;
        writeln!(
            f,
            "{name} {equation}, {}: {quantity}\n  limit: {limit}",
            kind(self)
        )?;
        let named = self.parts.iter().map(|part| part.value.len());
        let width = named.max().unwrap_or_default().max("all".len()) + 2;
        header(f, width)?;
        for group in self.parts.chunk_by(|a, b| a.by == b.by) {
            if group[0].by != "all" {
                writeln!(f, "  by {}", group[0].by)?;
            }
            for part in group {
                row(f, name_of(part), &part.tally, width)?;
            }
        }
        self.empirical
            .iter()
            .try_for_each(|limit| empirical(f, limit))
    }
}

fn name_of(part: &Part) -> &str {
    if part.by == "all" { "all" } else { &part.value }
}

fn header(f: &mut fmt::Formatter<'_>, width: usize) -> fmt::Result {
    writeln!(
        f,
        "  {:width$}{:>5}{:>9}{:>9}{:>9}{:>9}{:>15}{:>12}  above the limit",
        "", "n", "median", "95 %", "99 %", "largest", "limit", "99 %/limit"
    )
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, tally: &Tally, width: usize) -> fmt::Result {
    let Tally {
        n,
        median,
        q95,
        q99,
        largest,
        bound: [low, high],
        tightness,
        violations,
    } = *tally;
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
