//! Measured campaigns: CSV files of a test rig, described by one TOML file.
//!
//! ```toml
//! version = 1
//!
//! [[run]]                      # a time series: every column a channel
//! file = "run_01.csv"          # from this file's folder; a header row names the columns
//! columns = { time_s = "t", acceleration_y = { column = "az", unit = "g", subtract = 1.0 }, normal_force = "Fz_N" }
//! wheel = { radius_m = 0.14, width_m = 0.15, lug_count = 28, lug_height_m = 0.015 }
//! load_n = 100.0
//! speed_m_s = 0.014
//! slip_ratio = 0.1             # commanded; or rim_speed_m_s
//! terrain = "ST"
//!
//! [table]                      # steady means: every row a run
//! file = "means.csv"
//! columns = { drawbar_pull = { column = "Fx [kN]", unit = "kN", sd = "sd [kN]", n = "samples" } }
//! wheel = { radius_m = 0.14, width_m = 0.15 }
//! slip_ratio = { column = "slip [%]", unit = "%" }
//! ```
//!
//! A cell becomes `(cell - subtract) · scale · unit`: `subtract` is in the column's unit and 0
//! unless given, `scale` is 1, `unit` the channel's own. A column without `unit` whose header, or
//! the row of units below it, states another one is refused. A channel that is not among the known
//! [`CHANNELS`](crate::trace::CHANNELS) needs its `unit` and is carried along.
//!
//! Every attribute of a run may be left out: `id` (else `run_000000`, counted), `wheel`,
//! `load_n`, `speed_m_s`, `slip_ratio` or `rim_speed_m_s` [m/s], `slope_deg` (above 0 uphill; level
//! where left out), `terrain`, `class`, `repeat`, `day`, `notes`. Unknown numbers are NaN, as
//! are missing cells of a channel, and the spread of a mean. `lug_count = 0` or `lug_height_m = 0` is a
//! smooth wheel; lugs that are not counted are unknown, and so is their `lug_thickness_m` where it is left
//! out, which only `identify` uses. A plate in place of a wheel has
//! `plate_diameter_m`, or `plate_length_m` and `plate_width_m`. On a slope, `mass_kg` of the wheel is
//! what the force sensors carry of its own weight. In a `[table]` an attribute is a value for all rows or
//! a `{ column = "..." }`.
//!
//! Slip is by the rim's radius. Of a rig that counts it otherwise, `slip_radius = "tips"` takes the radius of
//! the lugs' tips, `"shear"` that at which soil shears off the lugs, and `slip_zero = "torque"` a slip that is
//! 0 where the torque is; the import counts it by the rim and notes it.
//!
//! # How a file is written
//!
//! | key | default |
//! |---|---|
//! | `delimiter` | a comma; `";"`, `"\t"`, `"\|"`; `" "` for any number of blanks |
//! | `decimal` | a point; beside other delimiters the first fraction decides, a comma is noted |
//! | `encoding` | UTF-8, or by the byte order mark; noted where it is another |
//! | `skip_lines` | 0: lines before the header that are no comments |
//! | `header_rows` | 1, and the rows below it without a number, which are noted |
//! | `names` | those of the header, or of a comment with as many cells, which is noted |
//! | `rows` | all; `{ trial = 3, slip = { min = 0, max = 0.6 }, day = ["a", "b"], wheel = { not = 2 } }` |
//!
//! Empty lines and those that begin with `#` are no data. Gzip is unpacked. A file that is no text
//! is refused by what it is.
//!
//! # Times
//!
//! Times come from `time_s`, with units from ns to d, ISO dates with or without zone, dates in a
//! stated `format` (`strftime`), hours, minutes and seconds, or durations as pandas writes them.
//! `add = { column = "nsecs", unit = "ns" }` joins a second column (seconds and nanoseconds, date and
//! time of day) without losing digits; `wraps_at` continues a counter. Where times count from long
//! ago, the first row is the run's zero. Or the rows have a `sample_rate_hz`, and no times.
//!
//! Times need not be printed exactly: even rows with jitter are taken as they are, a clock that wanders
//! is put on an even grid with a note, equal stamps, lost rows and uneven times are refused (the
//! criteria stand in `csv/clock.rs`). `resample_hz` interpolates uneven rows linearly to that
//! rate; its cost is noted: share of interpolated values, longest step bridged, loss of amplitude,
//! folding. Gaps longer than `longest_gap_s` (three usual steps) stay empty.
//!
//! # Several files of one run
//!
//! ```toml
//! [[run]]
//! id = "asphalt_02"
//! wheel = { radius_m = 0.165, width_m = 0.12 }
//! [[run.source]]               # one file, with all keys of a file
//! file = "imu.csv"
//! columns = { time_s = "time", acceleration_y = { column = "az", subtract = 9.81 } }
//! [[run.source]]
//! file = "wheels.csv"
//! offset_s = 0.02              # added to its times; 0 unless given
//! columns = { time_s = "time", wheel_speed = { column = "w", unit = "rpm" } }
//! ```
//!
//! Channels keep the rates of their files. A `wheel_speed` (rad/s, deg/s, rpm; or a speed of the rim,
//! which is divided by `radius_m`) is summed up to a `wheel_angle` where none was measured: it turns as
//! the wheel did, and its zero is not that of a lug
//! ([`angle_zero_unknown`](crate::trace::RunAttributes::angle_zero_unknown)).
//!
//! What was taken for granted or done to the data stands in the run's
//! [`import_notes`](crate::trace::RunAttributes::import_notes).

mod clock;
mod condition;
mod description;
mod file_kind;
mod gap;
mod lead;
mod line_ends;
mod moment;
mod notes;
mod number;
mod record;
mod resampling;
mod selection;
mod series;
mod sheet;
mod slip_origin;
mod source;
mod steady;
mod text;
mod unit;

use super::check_name;
use crate::document::{Document, Fault, Misfit, check_version};
use crate::trace::Trace;
use description::{CampaignTable, Given, SourceTable};
pub use gap::Gap;
use gap::Gaps;
use notes::Notes;
use source::Source;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The version of campaign files that this program reads.
const VERSION: i64 = 1;

/// A campaign file, its CSV files not yet read.
#[derive(Debug)]
pub struct Campaign {
    path: PathBuf,
    text: String,
    table: CampaignTable,
    gaps: Gaps,
}

/// Why a campaign cannot be imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// The file cannot be read.
    #[error("cannot read campaign {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The text is no campaign, or a CSV file does not match it.
    #[error(transparent)]
    Invalid(#[from] Fault),
}

/// An error, with the dotted key in the campaign that it refers to.
#[derive(Debug)]
struct Misplaced {
    key: String,
    message: String,
}

impl Campaign {
    /// Reads a campaign file.
    ///
    /// # Errors
    /// `Unreadable` where there is no such text file; `Invalid` points at the line of the first
    /// fault: text that is not TOML, unknown or missing keys, values of the wrong type.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, CampaignError> {
        let path = path.as_ref().to_owned();
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(source) => return Err(CampaignError::Unreadable { path, source }),
        };
        let table =
            read(&text).map_err(|misfit| Fault::new(&path.display().to_string(), &text, misfit))?;
        Ok(Self {
            path,
            text,
            table,
            gaps: Gaps::default(),
        })
    }

    /// The runs with their ids, in the order of the file, each read from its CSV file on demand.
    ///
    /// # Errors
    /// `Invalid` refers to the line of the campaign that a CSV file does not match, or whose value is outside
    /// its range; for an invalid cell, with its file, line and column.
    pub fn runs(&self) -> impl Iterator<Item = Result<(String, Trace), CampaignError>> + '_ {
        let series = self.table.runs.iter().enumerate();
        let series = series.map(|(index, table)| vec![self.series(index, table)]);
        let steady = self.table.table.iter().map(|table| self.steady(table));
        let mut ids = HashSet::new();
        let runs = series.chain(steady).flatten().enumerate();
        runs.map(move |(number, run)| {
            let Run { id, key, trace } = run.map_err(|misplaced| self.fault(misplaced))?;
            let id = id.unwrap_or_else(|| format!("run_{number:06}"));
            let fault = |message: String| {
                self.fault(Misplaced {
                    key: format!("{key}.id"),
                    message,
                })
            };
            check_name("run id", &id).map_err(fault)?;
            if !ids.insert(id.clone()) {
                let message =
                    format!("an earlier run has the id {id:?}; leave id out to number them, or write several files of one run as [[run.source]]");
                return Err(fault(message));
            }
            Ok((id, trace))
        })
    }

    /// The CSV files, in the order in which the campaign names them.
    pub fn files(&self) -> Vec<PathBuf> {
        let tables = self.table.runs.iter().chain(&self.table.table);
        let sources = tables.flat_map(|table| std::iter::once(table).chain(&table.source));
        let files = sources.map(|source| &source.file);
        let named = files.filter(|file| !file.as_os_str().is_empty());
        named.map(|file| self.folder().join(file)).collect()
    }

    /// Cells without a number in the columns read so far: they count as not measured.
    pub fn gaps(&self) -> Vec<Gap> {
        self.gaps.all()
    }

    fn series(&self, index: usize, table: &SourceTable) -> Result<Run, Misplaced> {
        let key = format!("run.{index}");
        let notes = Notes::default();
        let source = self.source(table, &key, &notes);
        check_channels(source)?;
        let (id, trace) = series::read(source, self.folder())?;
        Ok(Run { id, key, trace })
    }

    fn steady(&self, table: &SourceTable) -> Vec<Result<Run, Misplaced>> {
        let key = "table";
        let notes = Notes::default();
        let source = self.source(table, key, &notes);
        let read = check_channels(source).and_then(|()| steady::read(source, self.folder()));
        let run = |(id, trace)| {
            let key = key.to_owned();
            Ok(Run { id, key, trace })
        };
        match read {
            Ok(runs) => runs.into_iter().map(run).collect(),
            Err(misplaced) => vec![Err(misplaced)],
        }
    }

    fn source<'a>(&'a self, table: &'a SourceTable, key: &'a str, notes: &'a Notes) -> Source<'a> {
        let radius = match table.wheel.radius_m {
            Some(Given::Number(radius)) => Some(radius),
            _ => None,
        };
        Source {
            table,
            key,
            gaps: &self.gaps,
            notes,
            radius,
        }
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    fn fault(&self, Misplaced { key, message }: Misplaced) -> CampaignError {
        let place = Document::parse(&self.text).map_or(0..0, |document| document.place(&key));
        let misfit = Misfit { place, message };
        Fault::new(&self.path.display().to_string(), &self.text, misfit).into()
    }
}

/// A run that was read.
struct Run {
    id: Option<String>,
    /// Dotted key of the part of the campaign it comes from.
    key: String,
    trace: Trace,
}

fn read(text: &str) -> Result<CampaignTable, Misfit> {
    let document = Document::parse(text)?;
    check_version(&document, "campaign", VERSION)?;
    let table: CampaignTable = document.read()?;
    if table.runs.is_empty() && table.table.is_none() {
        return Err(Misfit {
            place: document.place("version"),
            message: "no runs; describe a time series in [[run]] or steady means in [table]"
                .to_owned(),
        });
    }
    Ok(table)
}

/// Refuses names and units of channels that cannot be stored.
fn check_channels(source: Source<'_>) -> Result<(), Misplaced> {
    for name in source.table.columns.keys() {
        let at = |message| source.fault(&format!("columns.{name}"), message);
        check_name("channel", name).map_err(at)?;
        let unit = source.column(name).map_err(at)?.unit.unwrap_or_default();
        if unit.contains('\0') {
            return Err(at("a unit must not hold a NUL character".to_owned()));
        }
    }
    Ok(())
}
