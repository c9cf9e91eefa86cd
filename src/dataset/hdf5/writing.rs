//! Runs to a file, one after another.

use super::reason;
use super::scale;
use super::{
    ClassWindowRow, ContactRow, FORMAT, FORMAT_VERSION, ProfileRow, RunFileError, TalliedWindowRow,
    Word,
};
use crate::dataset::Provenance;
use crate::dataset::check_name;
use crate::trace::wheel::{Lugs, Plate};
use crate::trace::{Channel, ClassWindow, LugTally, Mean, RunAttributes, Trace, Truth};
use crate::whole_file::{self, WholeFile};
use ::hdf5::file::LibraryVersion;
use ::hdf5::filters::deflate_available;
use ::hdf5::plist::group_create::LinkPhaseChange;
use ::hdf5::types::VarLenUnicode;
use ::hdf5::{Dataset, DatasetBuilder, File, Group, H5Type, Location, Result};
use std::collections::HashSet;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Elements in a compressed chunk: 64 KiB of single precision.
const CHUNK: usize = 16_384;

/// zlib level: higher ones take twice the time for a hundredth of the size.
const DEFLATE: u8 = 1;

/// How an HDF5 file begins.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Writes a run file, run by run.
///
/// The file is written under a temporary name and renamed in [`finish`](Self::finish), so a file under the
/// target's name is always complete, and an existing one is not replaced before. A writer that is dropped, or
/// that failed, leaves no file.
#[derive(Debug)]
pub struct RunFileWriter {
    target: PathBuf,
    /// Closed before `whole`, which removes it if need be: fields drop in order.
    file: Option<File>,
    whole: WholeFile,
    runs: HashSet<String>,
}

impl RunFileWriter {
    /// Starts a file that will be named `path`.
    ///
    /// # Errors
    /// `Write` where the folder does not exist or cannot be written to, the disk is full, or a file
    /// of another kind has the name; `Unfit` for a provenance with a NUL character.
    pub fn create(path: impl AsRef<Path>, provenance: &Provenance) -> super::Outcome<Self> {
        let target = path.as_ref().to_owned();
        let (whole, file) = begin(&target, FORMAT, provenance)?;
        group(&file, "runs").map_err(|error| RunFileError::write(&target, reason(&error)))?;
        Ok(Self {
            target,
            file: Some(file),
            whole,
            runs: HashSet::new(),
        })
    }

    /// Adds a run under `id`.
    ///
    /// # Errors
    /// `Unfit` for an id, channel or mean whose name is taken or cannot be a name, a text with a
    /// NUL character, or a sample rate that is not positive; the file goes on without the run.
    /// `Write` where the disk is full; the file is then lost.
    pub fn add(&mut self, id: &str, trace: &Trace) -> super::Outcome<()> {
        check(id, trace).map_err(|reason| unfit(&self.target, id, reason))?;
        if self.runs.contains(id) {
            let reason = "the file already has a run of this id".to_owned();
            return Err(unfit(&self.target, id, reason));
        }
        let Some(file) = &self.file else {
            return Err(RunFileError::write(&self.target, "an earlier run failed"));
        };
        if let Err(error) = write_run(file, id, trace) {
            self.file = None;
            return Err(RunFileError::write(&self.target, reason(&error)));
        }
        self.runs.insert(id.to_owned());
        Ok(())
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// `Write` where the disk is full, an earlier run failed, or the name cannot be taken.
    pub fn finish(mut self) -> super::Outcome<()> {
        let Some(file) = self.file.take() else {
            return Err(RunFileError::write(&self.target, "an earlier run failed"));
        };
        complete(file, self.whole, &self.target)
    }
}

/// Begins a file of `format` that will be named `target`: the file to be, and what HDF5 has open.
pub(super) fn begin(
    target: &Path,
    format: &str,
    provenance: &Provenance,
) -> super::Outcome<(WholeFile, File)> {
    let Provenance {
        scenario,
        seed,
        created_by,
    } = provenance;
    for text in scenario.iter().chain([created_by]) {
        check_text(text).map_err(|reason| unfit(target, "/", reason))?;
    }
    if is_of_another_kind(target) {
        return Err(RunFileError::write(target, "it is no HDF5 file"));
    }
    let whole = WholeFile::begin(target).map_err(|error| io_error(target, &error))?;
    let write = || {
        let file = File::with_options()
            .with_fapl(|fapl| fapl.libver_bounds(LibraryVersion::V18, LibraryVersion::V18))
            .with_fcpl(|fcpl| fcpl.obj_track_times(false))
            .create(whole.part())?;
        set_text(&file, "format", format)?;
        set(&file, "format_version", FORMAT_VERSION)?;
        set_text(&file, "created_by", created_by)?;
        if let Some(scenario) = scenario {
            set_text(&file, "scenario", scenario)?;
        }
        if let Some(seed) = seed {
            set(&file, "seed", seed.0)?;
        }
        Ok(file)
    };
    let file = write().map_err(|error| RunFileError::write(target, reason(&error)))?;
    Ok((whole, file))
}

/// Whether a scenario or a table has the name, which would be lost under a run file.
fn is_of_another_kind(target: &Path) -> bool {
    let mut first = Vec::new();
    let read = std::fs::File::open(target)
        .and_then(|file| file.take(SIGNATURE.len() as u64).read_to_end(&mut first));
    read.is_ok() && !first.is_empty() && first != SIGNATURE
}

/// Closes a file and gives it its name.
pub(super) fn complete(file: File, whole: WholeFile, target: &Path) -> super::Outcome<()> {
    let closed = file.flush().and_then(|()| file.close());
    closed.map_err(|error| RunFileError::write(target, reason(&error)))?;
    whole.finish().map_err(|error| io_error(target, &error))
}

fn io_error(target: &Path, error: &io::Error) -> RunFileError {
    RunFileError::write(target, whole_file::reason(error))
}

fn unfit(target: &Path, id: &str, reason: String) -> RunFileError {
    RunFileError::Unfit {
        path: target.to_owned(),
        id: id.to_owned(),
        reason,
    }
}

/// The reason why `trace` cannot be stored.
fn check(id: &str, trace: &Trace) -> Result<(), String> {
    check_name("run id", id)?;
    let attributes = &trace.attributes;
    let units = trace.channels.iter().map(|channel| &channel.unit);
    let units = units.chain(trace.means.iter().map(|mean| &mean.unit));
    for text in units.chain([&attributes.day, &attributes.notes]) {
        check_text(text)?;
    }
    check_names(
        "channel",
        trace.channels.iter().map(|channel| &channel.name),
    )?;
    check_names("mean", trace.means.iter().map(|mean| &mean.name))?;
    if let Some(truth) = &trace.truth {
        check_names("terrain parameter", truth.parameters.keys())?;
    }
    for Channel {
        name, sample_rate, ..
    } in &trace.channels
    {
        if !(sample_rate.is_finite() && *sample_rate > 0.0) {
            return Err(format!(
                "sample rate [Hz] of channel {name} must be above 0 and finite, got {sample_rate}"
            ));
        }
    }
    Ok(())
}

fn check_names<'a>(what: &str, names: impl Iterator<Item = &'a String>) -> Result<(), String> {
    let mut seen = HashSet::new();
    for name in names {
        check_name(what, name)?;
        if !seen.insert(name) {
            return Err(format!("{what} {name:?} is there twice"));
        }
    }
    Ok(())
}

fn check_text(text: &str) -> Result<(), String> {
    if text.contains('\0') {
        return Err(format!(
            "a text must not hold a NUL character, got {text:?}"
        ));
    }
    Ok(())
}

fn write_run(file: &File, id: &str, trace: &Trace) -> Result<()> {
    let run = group(&file.group("runs")?, id)?;
    write_attributes(&run, &trace.attributes)?;
    let channels = channel_group(&run)?;
    for channel in &trace.channels {
        let dataset = write_channel(&channels, channel)?;
        if let Some(steadiness) = trace.steadiness(&channel.name) {
            set_text(&dataset, "steadiness", steadiness.name())?;
            if let Some(rate) = steadiness.rate() {
                set(&dataset, "drift_per_s", rate)?;
            }
        }
    }
    scale::write_times(&channels, &trace.channels)?;
    if !trace.means.is_empty() {
        let means = group(&run, "means")?;
        for mean in &trace.means {
            write_mean(&means, mean)?;
        }
    }
    match &trace.truth {
        Some(truth) => write_truth(&group(&run, "truth")?, truth),
        None => Ok(()),
    }
}

fn write_attributes(run: &Group, attributes: &RunAttributes) -> Result<()> {
    let RunAttributes {
        wheel_radius,
        wheel_width,
        lug_count,
        lug_height,
        lug_thickness,
        wheel_mass,
        plate,
        slope_deg,
        load,
        speed,
        slip_ratio,
        terrain,
        class,
        repeat,
        day,
        notes,
        physics_rate,
        angle_zero_unknown,
        import_notes,
    } = attributes;
    set(run, "wheel_radius_m", *wheel_radius)?;
    set(run, "wheel_width_m", *wheel_width)?;
    let lugs = Lugs::stated(*lug_count, *lug_height);
    if let Some(count) = lugs.count {
        set(run, "lug_count", count)?;
    }
    set(run, "lug_height_m", lugs.height)?;
    write_known(run, "lug_thickness_m", *lug_thickness)?;
    let slope = Some(*slope_deg).filter(|slope| *slope != 0.0);
    write_known(run, "wheel_mass_kg", *wheel_mass)?;
    write_known(run, "slope_deg", slope)?;
    write_plate(run, *plate)?;
    set(run, "load_n", *load)?;
    set(run, "speed_m_s", *speed)?;
    set(run, "slip_ratio", *slip_ratio)?;
    set_text(run, "terrain", terrain.map_or("", |label| label.as_str()))?;
    set_text(run, "class", class.map_or("", |class| class.as_str()))?;
    set(run, "repeat", *repeat)?;
    set_text(run, "day", day)?;
    set_text(run, "notes", notes)?;
    write_known(run, "physics_rate_hz", *physics_rate)?;
    if *angle_zero_unknown {
        set_text(run, "wheel_angle_zero", "unknown")?;
    }
    if !import_notes.is_empty() {
        set_text(run, "import_notes", &import_notes.join("\n"))?;
    }
    Ok(())
}

/// Writes a number that a run may be without.
fn write_known(run: &Group, name: &str, value: Option<f64>) -> Result<()> {
    value.map_or(Ok(()), |value| set(run, name, value))
}

fn write_plate(run: &Group, plate: Option<Plate>) -> Result<()> {
    match plate {
        None => Ok(()),
        Some(Plate::Disc { diameter }) => set(run, "plate_diameter_m", diameter),
        Some(Plate::Rectangle { length, width }) => {
            set(run, "plate_length_m", length)?;
            set(run, "plate_width_m", width)
        }
    }
}

fn write_channel(channels: &Group, channel: &Channel) -> Result<Dataset> {
    let Channel {
        name,
        unit,
        sample_rate,
        start,
        samples,
    } = channel;
    // A chunk that is lost reads as a gap.
    let table = table(channels, samples.len()).fill_value(f64::NAN);
    let dataset = if channel.is_single_precision() {
        let samples: Vec<f32> = samples.iter().map(|&sample| sample as f32).collect();
        table
            .fill_value(f32::NAN)
            .with_data(&samples)
            .create(name.as_str())?
    } else {
        table.with_data(samples).create(name.as_str())?
    };
    set_text(&dataset, "unit", unit)?;
    set_text(&dataset, "units", unit)?;
    set(&dataset, "sample_rate_hz", *sample_rate)?;
    set(&dataset, "start_s", *start)?;
    Ok(dataset)
}

fn write_mean(means: &Group, mean: &Mean) -> Result<()> {
    let Mean {
        name,
        unit,
        value,
        sd,
        n,
    } = mean;
    let builder = means.new_dataset::<f64>().obj_track_times(false);
    let dataset = builder.create(name.as_str())?;
    dataset.write_scalar(value)?;
    set_text(&dataset, "unit", unit)?;
    set(&dataset, "sd", *sd)?;
    set(&dataset, "n", *n)
}

fn write_truth(location: &Group, truth: &Truth) -> Result<()> {
    let contacts = truth.contacts.iter().map(|contact| ContactRow {
        lug: contact.lug,
        start_s: contact.start,
        end_s: contact.end,
        entered: contact.entered.into(),
    });
    let profile = truth
        .profile
        .iter()
        .map(|&[x, height]| ProfileRow { x, height });
    write_table(location, "contacts", &contacts.collect::<Vec<_>>())?;
    write_class_windows(location, &truth.class_windows)?;
    write_table(location, "profile", &profile.collect::<Vec<_>>())?;
    if truth.at_limit.any() {
        set(location, "carriage_at_limit", truth.at_limit.carriage)?;
        set(location, "motor_at_limit", truth.at_limit.motor)?;
    }
    let parameters = group(location, "parameters")?;
    for (name, value) in &truth.parameters {
        set(&parameters, name, *value)?;
    }
    Ok(())
}

/// The class windows; with the counts of lugs where all have them.
fn write_class_windows(location: &Group, windows: &[ClassWindow]) -> Result<()> {
    let name = "class_windows";
    let plain = windows.iter().map(|window| {
        Ok(ClassWindowRow {
            start_s: window.start,
            end_s: window.end,
            class: word(window.class.as_str())?,
            terrain: word(window.terrain.as_str())?,
        })
    });
    let plain = plain.collect::<Result<Vec<_>>>()?;
    let tallies: Option<Vec<LugTally>> = windows.iter().map(|window| window.lugs).collect();
    let Some(tallies) = tallies else {
        write_table(location, name, &plain)?;
        return Ok(());
    };
    let rows = plain
        .iter()
        .zip(tallies)
        .map(|(row, lugs)| TalliedWindowRow {
            start_s: row.start_s,
            end_s: row.end_s,
            class: row.class,
            terrain: row.terrain,
            lugs_passed: lugs.passed,
            lugs_touched: lugs.touched,
            lugs_entered: lugs.entered,
        });
    write_table(location, name, &rows.collect::<Vec<_>>())?;
    Ok(())
}

fn word(text: &str) -> Result<Word> {
    Word::from_ascii(text.as_bytes()).map_err(|error| ::hdf5::Error::from(error.to_string()))
}

fn write_table<T: H5Type>(parent: &Group, name: &str, rows: &[T]) -> Result<Dataset> {
    let builder = table(parent, rows.len()).packed(true);
    builder.with_data(rows).create(name)
}

/// A dataset for this many rows, compressed where the library can.
pub(super) fn table(parent: &Group, rows: usize) -> DatasetBuilder {
    let builder = parent.new_dataset_builder().obj_track_times(false);
    if rows == 0 || !deflate_available() {
        return builder;
    }
    builder.chunk(rows.min(CHUNK)).shuffle().deflate(DEFLATE)
}

/// The group of channels and their times, of which HDF5 would index more than eight in 5 kB.
fn channel_group(run: &Group) -> Result<Group> {
    const UNINDEXED: LinkPhaseChange = LinkPhaseChange {
        max_compact: 32,
        min_dense: 24,
    };
    let builder = run.create_group_builder().obj_track_times(false);
    let builder = builder.with_gcpl(|gcpl| gcpl.link_phase_change(UNINDEXED));
    builder.create("channels")
}

pub(super) fn group(parent: &Group, name: &str) -> Result<Group> {
    let builder = parent.create_group_builder().obj_track_times(false);
    builder.create(name)
}

pub(super) fn set<T: H5Type>(location: &Location, name: &str, value: T) -> Result<()> {
    let attribute = location.new_attr::<T>().create(name)?;
    attribute.write_scalar(&value)
}

pub(super) fn set_text(location: &Location, name: &str, text: &str) -> Result<()> {
    let text = VarLenUnicode::from_str(text).map_err(|error| error.to_string())?;
    set(location, name, text)
}
