//! Time series: every column a channel.

use super::source::{Measure, Rows, Source, only_for_means};
use super::{Misplaced, condition};
use crate::quantity::RangeError;
use crate::trace::{Channel, Trace};
use std::path::Path;

/// How far [periods] a time may lie off its place among equally spaced ones.
///
/// Printed times are rounded: 3 kHz to the microsecond by 0.2 %, 300 Hz to the millisecond by 15 %.
/// A missing row moves times by half a period or more.
const JITTER: f64 = 0.2;

/// How far [-] a rate from a time column may lie off a whole one that it is taken for.
const WHOLE: f64 = 1.0e-6;

/// The run that `source` describes, with its id where one is given.
pub(super) fn read(
    source: Source<'_>,
    folder: &Path,
) -> Result<(Option<String>, Trace), Misplaced> {
    let (id, attributes) = condition::of_run(source)?;
    let mut rows = source.open(folder)?;
    let names = source.channels()?;
    let measures = names.iter().map(|name| {
        let column = source
            .column(name)
            .and_then(|column| only_for_means(&column));
        column.map_err(|message| source.fault(&format!("columns.{name}"), message))?;
        source.measure(name, rows.header())
    });
    let measures = measures.collect::<Result<Vec<_>, _>>()?;
    let clock = Clock::of(source, &rows)?;
    let mut times = Vec::new();
    let mut samples = vec![Vec::new(); measures.len()];
    let header = rows.header().clone();
    while let Some(row) = rows.next_row()? {
        for (measure, samples) in measures.iter().zip(&mut samples) {
            let value = measure.value(&header, &row);
            let at = |message| source.fault(&format!("columns.{}", measure.name), message);
            samples.push(value.map_err(at)?);
        }
        if let Clock::Column(time) = &clock {
            let at = |message| source.fault("columns.time_s", message);
            times.push((time.value(&header, &row).map_err(at)?, row.line()));
        }
    }
    if samples[0].is_empty() {
        return Err(rows.nothing());
    }
    let (start, sample_rate) = match clock {
        Clock::Rate(rate) => (0.0, rate),
        Clock::Column(_) => start_and_rate(header.file(), &times)
            .map_err(|message| source.fault("columns.time_s", message))?,
    };
    let channels = measures.into_iter().zip(samples);
    let channels = channels.map(|(Measure { name, unit, .. }, samples)| Channel {
        name,
        unit,
        sample_rate,
        start,
        samples,
    });
    let trace = Trace {
        attributes,
        channels: channels.collect(),
        ..Trace::default()
    };
    Ok((id, trace))
}

/// What tells the time of a row.
enum Clock {
    Column(Measure),
    /// Rows a second [Hz].
    Rate(f64),
}

impl Clock {
    fn of(source: Source<'_>, rows: &Rows<'_>) -> Result<Self, Misplaced> {
        let has_time = source.table.columns.contains_key("time_s");
        match (has_time, source.table.sample_rate_hz) {
            (true, None) => Ok(Self::Column(source.measure("time_s", rows.header())?)),
            (false, Some(rate)) => match RangeError::positive("sample rate", "Hz", rate) {
                Ok(rate) => Ok(Self::Rate(rate)),
                Err(error) => Err(source.fault("sample_rate_hz", error.to_string())),
            },
            (true, Some(_)) => {
                let message = "columns.time_s tells the rate already; keep one of the two";
                Err(source.fault("sample_rate_hz", message))
            }
            (false, None) => {
                let message = "nothing tells the time: map time_s, or give sample_rate_hz";
                Err(source.fault("columns", message))
            }
        }
    }
}

/// A row's time [s] and line.
type Stamp = (f64, u64);

/// Time of the first row [s] and rows a second [Hz] of equally spaced rows of `file`.
fn start_and_rate(file: &str, times: &[Stamp]) -> Result<(f64, f64), String> {
    let [(start, _), .., (end, _)] = *times else {
        let way_out = "give sample_rate_hz instead of time_s";
        return Err(format!("one row of {file} does not tell a rate; {way_out}"));
    };
    if let Some((_, line)) = times.iter().find(|(time, _)| !time.is_finite()) {
        return Err(format!("{file}:{line}: this row has no time"));
    }
    let backward = times.windows(2).find(|pair| pair[1].0 <= pair[0].0);
    if let Some([(before, _), (time, line)]) = backward {
        return Err(format!(
            "{file}:{line}: time {time} s follows {before} s; times must grow. If the file holds \
             several runs, pick one with rows = {{ ... }}"
        ));
    }
    let period = (end - start) / (times.len() - 1) as f64;
    let off = |(i, (time, _)): (usize, &Stamp)| {
        let expected = start + i as f64 * period;
        ((time - expected) / period).abs() > JITTER
    };
    let rate = 1.0 / period;
    let tells_rate = rate.is_finite() && rate > 0.0;
    if !tells_rate || times.iter().enumerate().any(off) {
        return Err(uneven(file, times));
    }
    let whole = rate.round();
    let is_whole = (rate / whole - 1.0).abs() < WHOLE;
    Ok((start, if is_whole { whole } else { rate }))
}

/// The row whose step differs most from the usual one, in words.
fn uneven(file: &str, times: &[Stamp]) -> String {
    let step = |pair: &[Stamp]| pair[1].0 - pair[0].0;
    let mut steps: Vec<f64> = times.windows(2).map(step).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps[steps.len() / 2];
    let unusual = times.windows(2).max_by(|a, b| {
        let off = |pair| (step(pair) - usual).abs();
        off(a).total_cmp(&off(b))
    });
    let (line, unusual) = unusual.map_or((0, usual), |pair| (pair[1].1, step(pair)));
    format!(
        "{file}:{line}: {unusual:.6} s after the row before, {usual:.6} s elsewhere; rows must be \
         equally spaced to a fifth of that: put rows with empty cells in a gap, or resample"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(times: impl Iterator<Item = f64>) -> Vec<Stamp> {
        times.zip(2..).collect()
    }

    #[test]
    fn a_rate_is_read_from_rounded_times_and_is_whole_where_it_can_be() {
        let rounded = |rate: f64, digits: f64| {
            let times = (0..3_000).map(|i| (f64::from(i) / rate * digits).round() / digits);
            start_and_rate("a.csv", &stamps(times)).unwrap()
        };
        assert_eq!(rounded(500.0, 1.0e3), (0.0, 500.0));
        // 300 Hz to the millisecond: the last time is rounded by 0.3 ms of 9997 ms.
        let (start, rate) = rounded(300.0, 1.0e3);
        assert!(
            start == 0.0 && (rate / 300.0 - 1.0).abs() < 4.0e-5,
            "{rate}"
        );
        let late = stamps((0..100).map(|i| 12.5 + f64::from(i) * 0.05));
        assert_eq!(start_and_rate("a.csv", &late), Ok((12.5, 20.0)));
    }

    #[test]
    fn one_row_missing_among_thousands_is_found_wherever_it_is() {
        for missing in [1, 700, 2_500, 4_998] {
            let times = (0..5_000).filter(|i| *i != missing);
            let times = stamps(times.map(|i| f64::from(i) * 0.002));
            let error = start_and_rate("a.csv", &times).unwrap_err();
            let place = format!("a.csv:{}: 0.004000 s after", missing + 2);
            assert!(error.starts_with(&place), "{error}");
        }
    }

    #[test]
    fn times_that_stop_or_are_missing_are_refused_at_their_line() {
        let cases = [
            (vec![0.0, 1.0, 1.0], "a.csv:4: time 1 s follows 1 s"),
            (vec![0.0, f64::NAN, 2.0], "a.csv:3: this row has no time"),
            (vec![0.0], "one row of a.csv does not tell a rate"),
            (vec![], "one row of a.csv"),
        ];
        for (times, message) in cases {
            let error = start_and_rate("a.csv", &stamps(times.into_iter())).unwrap_err();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
