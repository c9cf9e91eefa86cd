//! The statements as text for reading.

use super::statement::{Part, Statement, ThresholdScore};
use super::tally::{Empirical, QUANTILES, Tally};
use crate::table::{Cell, Table};
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

/// A table for each kind of wheels, one row a statement.
fn summary(f: &mut fmt::Formatter<'_>, statements: &[Statement]) -> fmt::Result {
    for group in statements.chunk_by(|a, b| a.multi_lugged == b.multi_lugged) {
        let rows = group
            .iter()
            .map(|Statement { name, parts, .. }| row([name], &parts[0].tally));
        write!(f, "{}\n{}", kind(&group[0]), text([""], rows.collect()))?;
    }
    Ok(())
}

fn kind(statement: &Statement) -> &'static str {
    if statement.multi_lugged {
        "multi-lugged wheels"
    } else {
        "few-lugged wheels (the rim touches flat ground between lugs)"
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
        let rows = self
            .parts
            .iter()
            .map(|Part { by, value, tally }| row([by, value], tally));
        f.write_str(&text(["by", ""], rows.collect()))?;
        self.empirical
            .iter()
            .try_for_each(|limit| empirical(f, limit))
    }
}

/// A table of tallies, whose `first` columns name their windows.
fn text<const N: usize>(first: [&str; N], rows: Vec<Vec<Cell>>) -> String {
    let names = first.into_iter().chain(["n"]).chain(QUANTILES);
    let names = names.chain(["99 %/limit", "above the limit"]);
    Table::of(names, rows).to_text(2)
}

fn row<const N: usize>(first: [&str; N], tally: &Tally) -> Vec<Cell> {
    let mut cells: Vec<Cell> = first.map(Cell::text).to_vec();
    cells.extend(tally.cells("-"));
    cells.push(Cell::Text(tally.violations.to_string()));
    cells
}

fn empirical(f: &mut fmt::Formatter<'_>, limit: &Empirical) -> fmt::Result {
    let end = |end: Option<f64>| end.map_or("-".to_owned(), |end| format!("{end:.2}"));
    let [low, high] = limit.ci95.map(end);
    writeln!(
        f,
        "  empirical: 99 % of {} windows (even repeats) stay below {:.2} [{low}, {high}] times the \
         limit;\n             of the {} others (odd repeats) exceed that {}",
        limit.n, limit.quantile, limit.exceeded.n, limit.exceeded
    )
}
