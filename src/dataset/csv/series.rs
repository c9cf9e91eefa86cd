//! Time series: the files of a run, joined by time.
//!
//! Each file has its own rate; they share a common zero of time. That is the zero of the files' clocks, to
//! which `offset_s` adds the known delay of a file. Where clocks count from 1970 or another distant date, the
//! first row of the first file is the zero, so that no digit is lost to the date. A file with a rate and no
//! times begins at the run's zero.

use super::clock::short;
use super::moment::Origin;
use super::notes::last_part;
use super::record::{self, Record};
use super::slip_origin;
use super::source::Source;
use super::{Misplaced, condition};
use crate::trace::{Channel, Trace, turned_along};
use std::path::Path;

/// Times [s] beyond which a clock's own zero is replaced: beyond it a double resolves too few digits.
const LONG_AGO: f64 = 1.0e6;

/// The run that `source` describes, with its id where one is given.
pub(super) fn read(
    source: Source<'_>,
    folder: &Path,
) -> Result<(Option<String>, Trace), Misplaced> {
    let (id, mut attributes) = condition::of_run(source)?;
    let mut channels = joined(source, records(source, folder)?)?;
    if let Some(angle) = turning(&channels) {
        let rate = short(angle.sample_rate);
        channels.push(angle);
        attributes.angle_zero_unknown = true;
        let note = format!(
            "wheel_angle is the integral of wheel_speed at {rate} Hz: where a lug points down is \
             not known"
        );
        source.notes.of_run(note);
    }
    let mut trace = Trace {
        attributes,
        channels,
        ..Trace::default()
    };
    slip_origin::count_by_rim(source, &mut trace)?;
    trace.attributes.import_notes = source.notes.all();
    Ok((id, trace))
}

/// The records of all files of a run.
fn records(source: Source<'_>, folder: &Path) -> Result<Vec<Record>, Misplaced> {
    let files = &source.table.source;
    if files.is_empty() {
        return Ok(vec![record::read(source, folder)?]);
    }
    if let Some(key) = source.table.key_of_file() {
        let message = format!("{key} belongs to one file; write it in [[run.source]]");
        return Err(source.fault(key, message));
    }
    let mut records = Vec::new();
    for (index, table) in files.iter().enumerate() {
        let key = format!("{}.source.{index}", source.key);
        let file = Source {
            table,
            key: &key,
            ..source
        };
        if let Some(key) = table.key_of_run() {
            let message = format!("{key} belongs to the run and not to one of its files");
            return Err(file.fault(key, message));
        }
        super::check_channels(file)?;
        records.push(record::read(file, folder)?);
    }
    Ok(records)
}

/// The channels of all files, in the run's time.
fn joined(source: Source<'_>, records: Vec<Record>) -> Result<Vec<Channel>, Misplaced> {
    let zero = zero(source, &records);
    let mut channels: Vec<Channel> = Vec::new();
    let mut extents: Vec<Extent> = Vec::new();
    for (index, record) in records.into_iter().enumerate() {
        let at = |key: &str, message: String| match source.table.source.len() {
            0 => source.fault(key, message),
            _ => source.fault(&format!("source.{index}.{key}"), message),
        };
        let start = record.origin.map_or(0.0, |origin| origin.since(zero)) + record.offset;
        let end = record
            .channels
            .iter()
            .map(Channel::duration)
            .fold(start, |a, d| a.max(start + d));
        if let Some(Extent {
            file: other,
            time: [from, to],
        }) = extents.first()
            && (end < *from || *to < start)
        {
            let own = record.origin.map_or(0.0, Origin::seconds);
            return Err(at(
                "file",
                format!(
                    "{} runs from {start} s to {end} s, {other} from {from} s to {to} s: their \
                     clocks have no common zero (its own first time is {own} s); state offset_s, \
                     which is added to the times of a file",
                    record.file
                ),
            ));
        }
        extents.push(Extent {
            file: record.file,
            time: [start, end],
        });
        for channel in record.channels {
            if channels.iter().any(|known| known.name == channel.name) {
                let message = format!(
                    "an earlier file of this run has {} too; leave it out here, or carry it along \
                     under another name",
                    channel.name
                );
                return Err(at(&format!("columns.{}", channel.name), message));
            }
            channels.push(Channel { start, ..channel });
        }
    }
    if extents.len() > 1 {
        note_extents(source, &extents);
    }
    Ok(channels)
}

/// The run's zero of time.
fn zero(source: Source<'_>, records: &[Record]) -> Origin {
    let with_clock = records
        .iter()
        .find_map(|record| Some((record, record.origin?)));
    match with_clock {
        Some((record, origin)) if origin.seconds().abs() > LONG_AGO => {
            let note = format!("time 0 is the first row, {}", origin.text(record.is_date));
            source.notes.add(&record.file, &note);
            origin
        }
        _ => Origin::default(),
    }
}

/// The time [s] that a file covers.
struct Extent {
    file: String,
    time: [f64; 2],
}

fn note_extents(source: Source<'_>, extents: &[Extent]) {
    let files = extents.iter().map(
        |Extent {
             file,
             time: [start, end],
         }| format!("{} from {start:.3} s to {end:.3} s", last_part(file)),
    );
    let files: Vec<String> = files.collect();
    let offsets = source
        .table
        .source
        .iter()
        .any(|file| file.offset_s.is_some());
    let clocks = if offsets {
        "clocks as offset_s sets them"
    } else {
        "clocks taken as one, no offset_s"
    };
    let note = format!("joined by time: {}; {clocks}", files.join(", "));
    source.notes.of_run(note);
}

/// The wheel's angle summed up from its speed, where it was not measured.
fn turning(channels: &[Channel]) -> Option<Channel> {
    if channels.iter().any(|channel| channel.name == "wheel_angle") {
        return None;
    }
    let speed = channels
        .iter()
        .find(|channel| channel.name == "wheel_speed")?;
    Some(Channel {
        name: "wheel_angle".to_owned(),
        unit: "rad".to_owned(),
        ..turned_along(speed, 1.0)
    })
}
