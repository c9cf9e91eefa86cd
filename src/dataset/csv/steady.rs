//! Steady means: every row a run.

use super::description;
use super::sheet::{Header, Row};
use super::slip_origin;
use super::source::{Measure, Source};
use super::{Misplaced, condition};
use crate::trace::{Mean, Trace};
use std::path::Path;

/// A quantity of every row: its mean, its spread, and the column of its count.
struct Quantity {
    mean: Measure,
    sd: Spread,
    n: Option<usize>,
}

/// Standard deviations in the mean's own unit.
enum Spread {
    Unknown,
    /// In this column.
    Column(usize),
    /// The same in every row.
    Constant(f64),
}

/// The runs that `source` describes, each with its id where one is given.
pub(super) fn read(
    source: Source<'_>,
    folder: &Path,
) -> Result<Vec<(Option<String>, Trace)>, Misplaced> {
    if source.table.sample_rate_hz.is_some() {
        let message = "the rows of a [table] are runs, not samples; time series go to a [[run]]";
        return Err(source.fault("sample_rate_hz", message));
    }
    if source.table.columns.contains_key("time_s") {
        let message = "the rows of a [table] are runs, not samples; time series go to a [[run]]";
        return Err(source.fault("columns.time_s", message));
    }
    let of_series = ["source", "resample_hz", "longest_gap_s", "offset_s"];
    let table = source.table;
    let given = [
        !table.source.is_empty(),
        table.resample_hz.is_some(),
        table.longest_gap_s.is_some(),
        table.offset_s.is_some(),
    ];
    if let Some((key, _)) = of_series.iter().zip(given).find(|(_, given)| *given) {
        return Err(source.fault(key, format!("{key} belongs to time series, to a [[run]]")));
    }
    let mut rows = source.open(folder)?;
    let header = rows.header().clone();
    let quantities = source.channels()?.into_iter();
    let quantities = quantities.map(|name| quantity(source, name, &header));
    let quantities = quantities.collect::<Result<Vec<_>, _>>()?;
    let mut runs = Vec::new();
    while let Some(row) = rows.next_row()? {
        let (id, attributes) = condition::of_row(source, &header, row)?;
        let mut means = Vec::new();
        for quantity in &quantities {
            let at = |message| source.fault(&format!("columns.{}", quantity.mean.name), message);
            means.extend(mean(quantity, &header, row).map_err(at)?);
        }
        let mut trace = Trace {
            attributes,
            means,
            ..Trace::default()
        };
        slip_origin::count_by_rim(source, &mut trace)?;
        runs.push((id, trace));
    }
    if runs.is_empty() {
        return Err(rows.nothing());
    }
    header.note_decimal(table.decimal.is_some());
    for (_, trace) in &mut runs {
        trace.attributes.import_notes = source.notes.all();
    }
    Ok(runs)
}

fn quantity(source: Source<'_>, name: &str, header: &Header) -> Result<Quantity, Misplaced> {
    let mean = source.measure(name, header)?;
    let at = |message| source.fault(&format!("columns.{name}"), message);
    let column = source.column(name).map_err(at)?;
    let place = |name: &Option<String>| name.as_ref().map(|name| header.column(name)).transpose();
    let sd = match &column.sd {
        None => Ok(Spread::Unknown),
        Some(description::Spread::Constant(sd)) => Ok(Spread::Constant(*sd)),
        Some(description::Spread::Column(name)) => header.column(name).map(Spread::Column),
    };
    Ok(Quantity {
        mean,
        sd: sd.map_err(at)?,
        n: place(&column.n).map_err(at)?,
    })
}

/// The mean in a row; none where it was not measured.
fn mean(quantity: &Quantity, header: &Header, row: &Row) -> Result<Option<Mean>, String> {
    let Quantity { mean, sd, n } = quantity;
    let number = |column: &Option<usize>| match column {
        Some(column) => header.number(row, *column),
        None => Ok(f64::NAN),
    };
    let value = mean.value(header, row)?;
    let sd = mean.spread(match sd {
        Spread::Unknown => f64::NAN,
        Spread::Column(column) => header.number(row, *column)?,
        Spread::Constant(sd) => *sd,
    });
    if sd < 0.0 {
        return Err(format!(
            "{}: a standard deviation is 0 or more, got {sd}",
            header.place(row)
        ));
    }
    let n = match number(n)? {
        n if n.is_nan() => 0,
        n if n.fract() == 0.0 && n >= 0.0 => n as u64,
        n => return Err(format!("{}: n must be a count, got {n}", header.place(row))),
    };
    let Measure { name, unit, .. } = mean.clone();
    Ok(value.is_finite().then_some(Mean {
        name,
        unit,
        value,
        sd,
        n,
    }))
}
