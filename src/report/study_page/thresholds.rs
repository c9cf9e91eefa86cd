//! How far the limits of Eq. (55) to (58) hold.

use super::{Drawing, Shown};
use crate::report::page::{Cell, Figure, Section, Table};
use crate::report::threshold_figure;
use crate::study::thresholds::tally::{Empirical, Tally};
use crate::study::thresholds::{Part, Statement, ThresholdScore};

impl Shown for ThresholdScore {
    fn stem(&self) -> Option<&'static str> {
        Some("thresholds")
    }

    /// The share of windows above the paper's limits, the first of each equation.
    fn answer(&self) -> String {
        let mut equations: Vec<&str> = Vec::new();
        let first = shown(self).filter(|statement| {
            let is_first = !equations.contains(&statement.equation);
            equations.push(statement.equation);
            is_first
        });
        let shares = first.map(|statement| {
            let [value, low, high] = statement.parts[0].tally.violations.percent();
            format!(
                "{} {value:.1} % [{low:.1}, {high:.1}] by {}",
                statement.equation, statement.quantity
            )
        });
        let shares: Vec<String> = shares.collect();
        if shares.is_empty() {
            return format!(
                "In none of {} windows of multi-lugged wheels did every lug touch.",
                self.windows
            );
        }
        format!(
            "Of {} windows in which every lug touched, these shares exceed the paper's limits on multi-lugged wheels: \
             {}.",
            self.all_touched,
            shares.join("; ")
        )
    }

    /// Tallies, figures, and tallies by swept key.
    fn sections(&self) -> Vec<Section> {
        if shown(self).next().is_none() {
            return vec![validity(self)];
        }
        let figures = shown(self).map(|statement| {
            let caption = format!(
                "{} {}: {}.",
                statement.equation, statement.name, statement.quantity
            );
            Figure::new(threshold_figure(statement, &self.axes), caption)
        });
        let drawn = Section::new("Windows relative to the paper's limits").prose(
            "Every window over its limit, multi-lugged wheels; figures of the other limits and wheels are in the \
             folder of the study.",
        );
        let swept = Table::of(
            columns(["name", "by", "value"]),
            shown(self).flat_map(by_sweep),
        );
        let swept = swept.captioned("The paper's limits by swept key, multi-lugged wheels");
        let swept = Section::new("Dependence on the swept keys").table(swept);
        vec![validity(self), figures.fold(drawn, Section::figure), swept]
    }

    /// A figure of every limit: `thresholds_<limit>.svg`, `..._olig.svg` of wheels of few lugs.
    fn drawings(&self) -> Vec<Drawing> {
        let drawing = |statement: &Statement| {
            let kind = if statement.multi_lugged { "" } else { "_olig" };
            let file = format!("thresholds_{}{kind}.svg", statement.name);
            Drawing::new(file, threshold_figure(statement, &self.axes))
        };
        self.statements.iter().map(drawing).collect()
    }
}

/// The limits as the paper states them, for its wheels of many lugs.
fn shown(score: &ThresholdScore) -> impl Iterator<Item = &Statement> {
    let statements = score.statements.iter();
    statements.filter(|statement| statement.multi_lugged && statement.is_the_papers())
}

/// A row every limit.
fn validity(score: &ThresholdScore) -> Section {
    let limits = Table::of(
        columns(["name", "equation", "wheels"]),
        score.statements.iter().map(of_all),
    );
    let meanings = Table::of(["name", "what is limited", "the limit"], meanings(score));
    Section::new("Validity of the limits")
        .prose(format!(
            "In {} of {} windows the true class is ALCT: at least 90 % of the lugs touch. These are compared with \
             the limits, those of displacements only where 90 % also touch without slip. 99 % / limit is the 99 \
             % quantile of value over limit: 1 is a limit just reached, 0.1 a loose one.",
            score.all_touched, score.windows
        ))
        .table(limits.captioned(
            "Every limit. Shares have Wilson's 95 % interval, which assumes independent windows",
        ))
        .table(meanings.captioned("Definitions of the names"))
        .table(empirical(score))
}

/// All windows of a limit.
fn of_all(statement: &Statement) -> Vec<Cell> {
    let [name, wheels] = names(statement);
    let first = [name, statement.equation, wheels].map(Cell::text);
    let tally = tally(&statement.parts[0].tally);
    first.into_iter().chain(tally).collect()
}

/// A row every entry of a sweep.
fn by_sweep(statement: &Statement) -> impl Iterator<Item = Vec<Cell>> {
    let parts = statement.parts.iter().filter(|part| part.by != "all");
    parts.map(
        |Part {
             by,
             value,
             tally: of,
         }| {
            let names = [&statement.name, by].map(Cell::text);
            let first = names.into_iter().chain([Cell::toml(value)]);
            first.chain(tally(of)).collect()
        },
    )
}

/// What every limit is about; one of wheels of few lugs has a row of its own where it differs.
fn meanings(score: &ThresholdScore) -> Vec<Vec<Cell>> {
    let mut known: Vec<[&str; 3]> = Vec::new();
    for statement in &score.statements {
        let meaning = [&*statement.name, &*statement.quantity, statement.limit];
        if !known.contains(&meaning) {
            known.push(meaning);
        }
    }
    let rows = known.into_iter();
    rows.map(|meaning| meaning.map(Cell::text).to_vec())
        .collect()
}

/// Limits from the windows themselves; empty where no run was repeated.
fn empirical(score: &ThresholdScore) -> Table {
    let row = |statement: &Statement| {
        let Empirical {
            quantile,
            ci95: [low, high],
            n,
            exceeded,
        } = statement.empirical?;
        let end = |end: Option<f64>| end.map_or("–".to_owned(), |end| format!("{end:.2}"));
        let limit = format!("{quantile:.2} [{}, {}]", end(low), end(high));
        let [name, wheels] = names(statement).map(Cell::text);
        Some(vec![
            name,
            wheels,
            Cell::Count(n as u64),
            Cell::Written(limit, quantile),
            Cell::Count(exceeded.n),
            Cell::share(&exceeded),
        ])
    };
    let columns = [
        "name",
        "wheels",
        "even repeats",
        "99 % / limit",
        "odd repeats",
        "above it",
    ];
    Table::of(columns, score.statements.iter().filter_map(row)).captioned(
        "Empirical limits: 99 % quantile of value over limit in the even repeats, and windows of the odd ones above it",
    )
}

fn names(statement: &Statement) -> [&str; 2] {
    let wheels = if statement.multi_lugged {
        "multi-lugged"
    } else {
        "few-lugged"
    };
    [&statement.name, wheels]
}

fn columns(first: [&'static str; 3]) -> impl Iterator<Item = &'static str> {
    let quantiles = ["median", "95 %", "99 %", "largest", "limit"];
    let names = first.into_iter().chain(["windows"]).chain(quantiles);
    names.chain(["99 % / limit", "above the limit"])
}

fn tally(tally: &Tally) -> [Cell; 8] {
    let [low, high] = tally.bound;
    let limit = if high - low < 0.005 {
        format!("{low:.2}")
    } else {
        format!("{low:.2} to {high:.2}")
    };
    let number = |value: f64| Cell::Written(format!("{value:.2}"), value);
    [
        Cell::Count(tally.n as u64),
        number(tally.median),
        number(tally.q95),
        number(tally.q99),
        number(tally.largest),
        Cell::Written(limit, high),
        number(tally.tightness),
        Cell::share(&tally.violations),
    ]
}
