//! One file of a time series: every column a channel.

use super::Misplaced;
use super::clock::{Clock, Stamp, Times};
use super::moment::{Moments, Origin};
use super::resampling::Resampling;
use super::source::{Measure, Rows, Source, finite, only_for_means};
use crate::quantity::RangeError;
use crate::trace::{Channel, unwrapped};
use std::path::Path;

/// Content of one file.
pub(super) struct Record {
    pub(super) file: String,
    /// Channels, whose times count from the first row.
    pub(super) channels: Vec<Channel>,
    /// Time of the first row by the file's own clock; `None` where only the rate is known.
    pub(super) origin: Option<Origin>,
    pub(super) is_date: bool,
    /// What the campaign adds to the times [s].
    pub(super) offset: f64,
}

/// What gives the time of a row.
enum Timing {
    Columns(Moments),
    /// Rows a second [Hz].
    Rate(f64),
}

/// The file that `source` describes, in `folder`.
pub(super) fn read(source: Source<'_>, folder: &Path) -> Result<Record, Misplaced> {
    let mut rows = source.open(folder)?;
    let measures = measures(source, &rows)?;
    let offset = finite("offset_s", source.table.offset_s.unwrap_or(0.0))
        .map_err(|message| source.fault("offset_s", message))?;
    let mut timing = Timing::of(source, &rows)?;
    let table = columns(source, &mut rows, &measures, &mut timing)?;
    let header = rows.header();
    header.note_decimal(source.table.decimal.is_some());
    let file = header.file().to_owned();
    let channels = |rate: f64, samples: Vec<Vec<f64>>| {
        let channels = measures.iter().cloned().zip(samples);
        let channel = |(Measure { name, unit, .. }, samples)| Channel {
            name,
            unit,
            sample_rate: rate,
            start: 0.0,
            samples,
        };
        channels.map(channel).collect()
    };
    let moments = match timing {
        Timing::Rate(rate) => {
            return Ok(Record {
                file,
                channels: channels(rate, table.samples),
                origin: None,
                is_date: false,
                offset,
            });
        }
        Timing::Columns(moments) => moments,
    };
    for note in moments.notes() {
        header.notes().add(&file, &note);
    }
    let times = Times {
        file: &file,
        origin: moments.origin().seconds(),
        count: moments.count(),
        rows: &table.times,
    };
    let (rate, resampling) = rate(source, times)?;
    let samples = match resampling {
        None => table.samples,
        Some(resampling) => resampled(&measures, &resampling, table.samples),
    };
    Ok(Record {
        channels: channels(rate, samples),
        origin: Some(moments.origin()),
        is_date: moments.is_date(),
        offset,
        file,
    })
}

fn measures(source: Source<'_>, rows: &Rows<'_>) -> Result<Vec<Measure>, Misplaced> {
    let names = source.channels()?.into_iter();
    let measures = names.map(|name| {
        let column = source.column(name);
        let column = column.and_then(|column| only_for_means(&column));
        column.map_err(|message| source.fault(&format!("columns.{name}"), message))?;
        source.measure(name, rows.header())
    });
    measures.collect()
}

/// The columns of a file: a channel's values each, and the times of rows.
struct Columns {
    samples: Vec<Vec<f64>>,
    times: Vec<Stamp>,
}

fn columns(
    source: Source<'_>,
    rows: &mut Rows<'_>,
    measures: &[Measure],
    timing: &mut Timing,
) -> Result<Columns, Misplaced> {
    let mut table = Columns {
        samples: vec![Vec::new(); measures.len()],
        times: Vec::new(),
    };
    let header = rows.header().clone();
    while let Some(row) = rows.next_row()? {
        for (measure, samples) in measures.iter().zip(&mut table.samples) {
            let at = |message| source.fault(&format!("columns.{}", measure.name), message);
            samples.push(measure.value(&header, row).map_err(at)?);
        }
        if let Timing::Columns(moments) = timing {
            let at = |message| source.fault("columns.time_s", message);
            let time = moments.read(&header, row).map_err(at)?;
            let line = row.line();
            table.times.push(Stamp { time, line });
        }
    }
    if table.samples[0].is_empty() {
        Err(rows.nothing())
    } else {
        Ok(table)
    }
}

impl Timing {
    fn of(source: Source<'_>, rows: &Rows<'_>) -> Result<Self, Misplaced> {
        let table = source.table;
        let has_time = table.columns.contains_key("time_s");
        if let Some(key) = [
            ("resample_hz", table.resample_hz.is_some() && !has_time),
            (
                "longest_gap_s",
                table.longest_gap_s.is_some() && table.resample_hz.is_none(),
            ),
        ]
        .into_iter()
        .find_map(|(key, is_alone)| is_alone.then_some(key))
        {
            let needed = if key == "resample_hz" {
                "times: map time_s"
            } else {
                "resample_hz"
            };
            return Err(source.fault(key, format!("{key} needs {needed}")));
        }
        match (has_time, table.sample_rate_hz) {
            (true, None) => {
                let moments = Moments::of(source, rows.header());
                let at = |message| source.fault("columns.time_s", message);
                moments.map(Self::Columns).map_err(at)
            }
            (false, Some(rate)) => positive(source, "sample_rate_hz", rate).map(Self::Rate),
            (true, Some(_)) => {
                let message = "columns.time_s already determines the rate; give one of the two";
                Err(source.fault("sample_rate_hz", message))
            }
            (false, None) => {
                let message = "the time is unknown: map time_s, or give sample_rate_hz";
                Err(source.fault("columns", message))
            }
        }
    }
}

fn positive(source: Source<'_>, key: &str, value: f64) -> Result<f64, Misplaced> {
    let (name, unit) = match key {
        "longest_gap_s" => ("longest gap", "s"),
        "resample_hz" => ("resampling rate", "Hz"),
        _ => ("sample rate", "Hz"),
    };
    RangeError::positive(name, unit, value).map_err(|error| source.fault(key, error.to_string()))
}

/// Rate [Hz] of the channels, and what brings the rows to it where they are uneven.
fn rate(source: Source<'_>, times: Times<'_>) -> Result<(f64, Option<Resampling>), Misplaced> {
    let note = |note: &str| source.notes.add(times.file, note);
    if let Some(rate) = source.table.resample_hz {
        let rate = positive(source, "resample_hz", rate)?;
        let longest = source.table.longest_gap_s;
        let longest = longest
            .map(|gap| positive(source, "longest_gap_s", gap))
            .transpose()?;
        let at = |message| source.fault("resample_hz", message);
        let resampling = Resampling::new(times, rate, longest).map_err(at)?;
        note(&resampling.note());
        return Ok((rate, Some(resampling)));
    }
    let at = |message| source.fault("columns.time_s", message);
    let clock = Clock::of(times).map_err(at)?;
    if let Some(text) = clock.note() {
        note(&text);
    }
    match clock {
        Clock::Even { rate, .. } => Ok((rate, None)),
        Clock::Wandering { rate, .. } => {
            let resampling = Resampling::new(times, rate, None).map_err(at)?;
            note(&resampling.note());
            Ok((rate, Some(resampling)))
        }
    }
}

fn resampled(
    measures: &[Measure],
    resampling: &Resampling,
    samples: Vec<Vec<f64>>,
) -> Vec<Vec<f64>> {
    let channels = measures.iter().zip(samples);
    let even = channels.map(|(measure, samples)| match measure.name.as_str() {
        "wheel_angle" => resampling.apply(&unwrapped(&samples)),
        _ => resampling.apply(&samples),
    });
    even.collect()
}
