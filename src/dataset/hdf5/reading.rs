//! Runs from a file, whoever wrote it.

use super::encoding::{self, missing_filter, odd_float};
use super::scale::is_scale;
use super::{
    ClassWindowRow, ContactRow, FORMAT, FORMAT_VERSION, ProfileRow, RunFileError, TalliedWindowRow,
};
use super::{Outcome, reason};
use crate::dataset::Provenance;
use crate::quantity::Seed;
use crate::terrain::class::TerrainLabel;
use crate::trace::wheel::{Lugs, Plate};
use crate::trace::{
    AtLimit, Channel, ClassWindow, Contact, LugTally, Mean, RunAttributes, Trace, Truth,
};
use ::hdf5::types::{FixedAscii, FixedUnicode, TypeDescriptor, VarLenAscii, VarLenUnicode};
use ::hdf5::{Attribute, Container, Dataset, File, Group, H5Type, Location, MinorErrorCode};
use ::hdf5::{IndexType, IterationOrder};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::Error as NameError;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A run file opened for reading.
#[derive(Debug)]
pub struct RunFile {
    path: PathBuf,
    file: File,
    provenance: Provenance,
    runs: Vec<String>,
}

impl RunFile {
    /// Opens a run file and checks that it is one.
    ///
    /// # Errors
    /// `Read` where the file system refuses, `NotHdf5` for another kind of file, `Table` for a table, `Damaged` for a
    /// truncated one, `StillOpen` and `Locked` for one that another program has open, `Content` for HDF5 of another format or
    /// version.
    pub fn open(path: impl AsRef<Path>) -> Outcome<Self> {
        let path = path.as_ref().to_owned();
        readable(&path)?;
        let file = open_unlocked(&path).map_err(|error| not_opened(&path, &error))?;
        let root = Place {
            path: &path,
            location: &file,
        };
        let format = root.text("format")?;
        if format == super::table::FORMAT {
            return Err(RunFileError::Table { path });
        }
        if format != FORMAT {
            return Err(root.content(format!("format = {FORMAT:?}"), format!("{format:?}")));
        }
        let version: u32 = root.whole("format_version")?;
        if version != FORMAT_VERSION {
            let expected = format!("format_version = {FORMAT_VERSION}");
            return Err(root.content(expected, version.to_string()));
        }
        let provenance = Provenance {
            scenario: root
                .has("scenario")
                .then(|| root.text("scenario"))
                .transpose()?,
            seed: root.has("seed").then(|| root.seed()).transpose()?,
            created_by: root.text_or_empty("created_by")?,
        };
        let runs = group(&root, &file, "runs")?;
        let runs = sorted_names(&runs).map_err(|error| root.damaged(&error))?;
        Ok(Self {
            provenance,
            runs,
            path,
            file,
        })
    }

    /// Where the file lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where its runs come from.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// The ids of its runs, in the order of their letters.
    pub fn runs(&self) -> &[String] {
        &self.runs
    }

    /// Wheel, condition and label of a run, without its samples.
    ///
    /// # Errors
    /// `NoSuchRun`; `Content` for an attribute that is missing or of another type. Label, class,
    /// repeat, day and notes may be missing.
    pub fn attributes(&self, id: &str) -> Outcome<RunAttributes> {
        let run = self.run(id)?;
        attributes(&self.place(&run))
    }

    /// A run with all it has, channels and means in the order of their letters.
    ///
    /// # Errors
    /// As [`attributes`](Self::attributes); `Content` for a channel or mean without its unit, rate
    /// or start, and `Damaged` for samples that cannot be read.
    pub fn read(&self, id: &str) -> Outcome<Trace> {
        let run = self.run(id)?;
        let place = self.place(&run);
        let attributes = attributes(&place)?;
        let mut trace = Trace::default();
        for (name, dataset) in self.members(&run, "channels")? {
            trace
                .channels
                .push(channel(name, &dataset, &self.place(&dataset))?);
        }
        for (name, dataset) in self.members(&run, "means")? {
            trace
                .means
                .push(mean(name, &dataset, &self.place(&dataset))?);
        }
        if run.link_exists("truth") {
            let truth = group(&place, &run, "truth")?;
            trace.truth = Some(self.truth(&truth, attributes.terrain)?);
        }
        Ok(Trace {
            attributes,
            ..trace
        })
    }

    fn run(&self, id: &str) -> Outcome<Group> {
        if !self.runs.iter().any(|run| run == id) {
            return Err(RunFileError::NoSuchRun {
                path: self.path.clone(),
                id: id.to_owned(),
                has: listed(&self.runs),
            });
        }
        let root = self.place(&self.file);
        group(&root, &self.file, &format!("runs/{id}"))
    }

    /// The datasets of a group that may be missing; scales of their dimensions are none of them.
    fn members(&self, run: &Group, name: &str) -> Outcome<Vec<(String, Dataset)>> {
        if !run.link_exists(name) {
            return Ok(Vec::new());
        }
        let group = group(&self.place(run), run, name)?;
        let place = self.place(&group);
        let names = sorted_names(&group).map_err(|error| place.damaged(&error))?;
        let open = |name: String| Ok((name.clone(), dataset(&place, &group, &name)?));
        let opened = names.into_iter().map(open);
        let is_member = |member: &Outcome<(String, Dataset)>| {
            !member.as_ref().is_ok_and(|(_, dataset)| is_scale(dataset))
        };
        opened.filter(is_member).collect()
    }

    fn truth(&self, truth: &Group, label: Option<TerrainLabel>) -> Outcome<Truth> {
        let place = self.place(truth);
        let contacts = rows(
            &place,
            truth,
            "contacts",
            &["lug", "start_s", "end_s", "entered"],
        )?;
        let profile = rows(&place, truth, "profile", &["x", "height"])?;
        let mut parameters = BTreeMap::new();
        if truth.link_exists("parameters") {
            let group = group(&place, truth, "parameters")?;
            let place = self.place(&group);
            let names = group.attr_names().map_err(|error| place.damaged(&error))?;
            for name in names {
                let value = place.number(&name)?;
                parameters.insert(name, value);
            }
        }
        Ok(Truth {
            contacts: contacts.into_iter().map(contact).collect(),
            class_windows: class_windows(&place, truth, label)?,
            parameters,
            profile: profile
                .into_iter()
                .map(|row: ProfileRow| [row.x, row.height])
                .collect(),
            at_limit: AtLimit {
                carriage: place.optional("carriage_at_limit")?.unwrap_or(0.0),
                motor: place.optional("motor_at_limit")?.unwrap_or(0.0),
            },
        })
    }

    fn place<'a>(&'a self, location: &'a Location) -> Place<'a> {
        Place {
            path: &self.path,
            location,
        }
    }
}

/// The members of a group in alphabetical order; HDF5's own is that of storage.
fn sorted_names(group: &Group) -> ::hdf5::Result<Vec<String>> {
    group.member_names_by(IndexType::Name, IterationOrder::Increasing)
}

/// Whether the file system lets this file be read at all, in its own words.
fn readable(path: &Path) -> Outcome<()> {
    let opened = std::fs::File::open(path).and_then(|file| file.metadata());
    let is_file = opened.and_then(|about| {
        let folder = std::io::ErrorKind::IsADirectory.into();
        if about.is_dir() { Err(folder) } else { Ok(()) }
    });
    is_file.map_err(|source| RunFileError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Opens a file once it is unlocked, or fails after ten seconds.
///
/// HDF5 locks files it opens, and a child process just forked by another thread inherits the lock until it
/// executes its program.
fn open_unlocked(path: &Path) -> hdf5::Result<File> {
    const TRIES: u32 = 200;
    for _ in 1..TRIES {
        match File::open(path) {
            Err(error) if error.to_string().contains(LOCKED) => std::thread::sleep(PAUSE),
            opened => return opened,
        }
    }
    File::open(path)
}

/// Message of the system for a locked file (EAGAIN).
const LOCKED: &str = "temporarily unavailable";

/// Message of HDF5 for a file not closed by its writer.
const OPEN: &str = "already open for";

/// Time between two tries to open a locked file.
const PAUSE: Duration = Duration::from_millis(50);

fn not_opened(path: &Path, error: &::hdf5::Error) -> RunFileError {
    let path = path.to_owned();
    if error.contains_minor(MinorErrorCode::NotHdf5) {
        return RunFileError::NotHdf5 { path };
    }
    let reason = reason(error);
    if error.to_string().contains(LOCKED) {
        RunFileError::Locked { path }
    } else if reason.contains(OPEN) {
        RunFileError::StillOpen { path }
    } else {
        RunFileError::Damaged { path, reason }
    }
}

/// The first of many names.
fn listed(names: &[String]) -> String {
    match names {
        [] => "no runs".to_owned(),
        [first, _, _, _, _, .., last] => format!("{} runs, {first} to {last}", names.len()),
        few => few.join(", "),
    }
}

fn attributes(run: &Place<'_>) -> Outcome<RunAttributes> {
    let lugs = lugs(run)?;
    Ok(RunAttributes {
        wheel_radius: run.number("wheel_radius_m")?,
        wheel_width: run.number("wheel_width_m")?,
        lug_count: lugs.count,
        lug_height: lugs.height,
        lug_thickness: run.optional("lug_thickness_m")?,
        wheel_mass: run.optional("wheel_mass_kg")?,
        plate: plate(run)?,
        slope_deg: run.optional("slope_deg")?.unwrap_or(0.0),
        load: run.number("load_n")?,
        speed: run.number("speed_m_s")?,
        slip_ratio: run.number("slip_ratio")?,
        terrain: run.name("terrain", &run.text_or_empty("terrain")?)?,
        class: run.name("class", &run.text_or_empty("class")?)?,
        repeat: if run.has("repeat") {
            run.whole("repeat")?
        } else {
            0
        },
        day: run.text_or_empty("day")?,
        notes: run.text_or_empty("notes")?,
        physics_rate: run.optional("physics_rate_hz")?,
        angle_zero_unknown: run.text_or_empty("wheel_angle_zero")? == "unknown",
        import_notes: run
            .text_or_empty("import_notes")?
            .lines()
            .map(str::to_owned)
            .collect(),
    })
}

/// Lugs of a run. Files of versions that always had a count have 0 lugs of nonzero height where it is
/// unknown.
fn lugs(run: &Place<'_>) -> Outcome<Lugs> {
    let height = run.number("lug_height_m")?;
    let count = if run.has("lug_count") {
        Some(run.whole("lug_count")?)
    } else {
        None
    };
    let unknown = count == Some(0) && height > 0.0;
    Ok(Lugs::stated(count.filter(|_| !unknown), height))
}

/// The plate of a run: its diameter, or both sides.
fn plate(run: &Place<'_>) -> Outcome<Option<Plate>> {
    let diameter = run.optional("plate_diameter_m")?;
    let sides = [
        run.optional("plate_length_m")?,
        run.optional("plate_width_m")?,
    ];
    match (diameter, sides) {
        (None, [None, None]) => Ok(None),
        (Some(diameter), [None, None]) => Ok(Some(Plate::Disc { diameter })),
        (None, [Some(length), Some(width)]) => Ok(Some(Plate::rectangle([length, width]))),
        (diameter, _) => {
            let expected = "plate_diameter_m, or plate_length_m and plate_width_m";
            let found = if diameter.is_some() {
                "a diameter and sides"
            } else {
                "one side"
            };
            Err(run.content(expected, found.to_owned()))
        }
    }
}

fn channel(name: String, dataset: &Dataset, place: &Place<'_>) -> Outcome<Channel> {
    let shape = dataset.shape();
    // MATLAB writes vectors as matrices of one row or column.
    if shape.is_empty() || shape.iter().filter(|&&n| n != 1).count() > 1 {
        return Err(place.content("samples in one dimension", format!("shape {shape:?}")));
    }
    if let Some(unreadable) = missing_filter(dataset) {
        return Err(place.encoded(unreadable));
    }
    let sample_rate = place.number("sample_rate_hz")?;
    if !(sample_rate > 0.0 && sample_rate.is_finite()) {
        let expected = "sample_rate_hz above 0 and finite";
        return Err(place.content(expected, sample_rate.to_string()));
    }
    Ok(Channel {
        unit: place.text("unit")?,
        sample_rate,
        start: place.number("start_s")?,
        samples: numbers(dataset).map_err(|found| place.wrong("numbers", found))?,
        name,
    })
}

fn mean(name: String, dataset: &Dataset, place: &Place<'_>) -> Outcome<Mean> {
    let values = numbers(dataset).map_err(|found| place.wrong("a number", found))?;
    let [value] = values[..] else {
        return Err(place.content("one number", format!("{}", values.len())));
    };
    Ok(Mean {
        unit: place.text("unit")?,
        value,
        sd: place.number("sd")?,
        n: place.whole("n")?,
        name,
    })
}

fn contact(row: ContactRow) -> Contact {
    Contact {
        lug: row.lug,
        start: row.start_s,
        end: row.end_s,
        entered: row.entered != 0,
    }
}

/// Columns of every table of class windows.
const WINDOW_COLUMNS: [&str; 4] = ["start_s", "end_s", "class", "terrain"];
/// Columns that it has where lugs were counted.
const LUG_COLUMNS: [&str; 3] = ["lugs_passed", "lugs_touched", "lugs_entered"];

fn class_windows(
    place: &Place<'_>,
    truth: &Group,
    label: Option<TerrainLabel>,
) -> Outcome<Vec<ClassWindow>> {
    let name = "class_windows";
    if !truth.link_exists(name) {
        return Ok(Vec::new());
    }
    let (plain, lugs): (Vec<ClassWindowRow>, Vec<Option<LugTally>>) =
        if columns(place, truth, name)?
            .iter()
            .any(|column| column == LUG_COLUMNS[0])
        {
            let expected = [&WINDOW_COLUMNS[..], &LUG_COLUMNS].concat();
            let rows: Vec<TalliedWindowRow> = rows(place, truth, name, &expected)?;
            rows.into_iter().map(untallied).unzip()
        } else {
            let rows: Vec<ClassWindowRow> = rows(place, truth, name, &WINDOW_COLUMNS)?;
            rows.into_iter().map(|row| (row, None)).unzip()
        };
    let window = |(row, lugs): (ClassWindowRow, Option<LugTally>)| {
        let terrain = place.name("class_windows, terrain", row.terrain.as_str())?;
        let class = place.name("class_windows, class", row.class.as_str())?;
        let blank = |column| place.content(format!("class_windows with a {column}"), "\"\"");
        Ok(ClassWindow {
            start: row.start_s,
            end: row.end_s,
            class: class.ok_or_else(|| blank("class"))?,
            terrain: terrain.or(label).ok_or_else(|| blank("terrain"))?,
            lugs,
        })
    };
    plain.into_iter().zip(lugs).map(window).collect()
}

fn untallied(row: TalliedWindowRow) -> (ClassWindowRow, Option<LugTally>) {
    let plain = ClassWindowRow {
        start_s: row.start_s,
        end_s: row.end_s,
        class: row.class,
        terrain: row.terrain,
    };
    let lugs = LugTally {
        passed: row.lugs_passed,
        touched: row.lugs_touched,
        entered: row.lugs_entered,
    };
    (plain, Some(lugs))
}

/// The rows of a table that may be missing, but not in part.
fn rows<T: H5Type>(
    place: &Place<'_>,
    parent: &Group,
    name: &str,
    expected: &[&str],
) -> Outcome<Vec<T>> {
    if !parent.link_exists(name) {
        return Ok(Vec::new());
    }
    let has = columns(place, parent, name)?;
    if expected
        .iter()
        .any(|column| !has.iter().any(|name| name == column))
    {
        let expected = format!("{name} with columns {}", expected.join(", "));
        return Err(place.content(expected, has.join(", ")));
    }
    let table = dataset(place, parent, name)?;
    if let Some(unreadable) = missing_filter(&table) {
        return Err(place.encoded(unreadable));
    }
    table.read_raw().map_err(|error| place.damaged(&error))
}

/// Names of a table's columns.
fn columns(place: &Place<'_>, parent: &Group, name: &str) -> Outcome<Vec<String>> {
    let kind = dataset(place, parent, name)?.dtype();
    let kind = kind.and_then(|kind| kind.to_descriptor());
    Ok(match kind.map_err(|error| place.damaged(&error))? {
        TypeDescriptor::Compound(kind) => kind.fields.into_iter().map(|field| field.name).collect(),
        _ => Vec::new(),
    })
}

fn group(place: &Place<'_>, parent: &Group, name: &str) -> Outcome<Group> {
    let found = parent.group(name);
    found.map_err(|_| place.content(format!("a group {name}"), "none"))
}

fn dataset(place: &Place<'_>, parent: &Group, name: &str) -> Outcome<Dataset> {
    let found = parent.dataset(name);
    found.map_err(|_| place.content(format!("a dataset {name}"), "something else"))
}

/// All numbers of a dataset or attribute, or its actual content.
fn numbers(container: &Container) -> Result<Vec<f64>, Wrong> {
    if let Some(unreadable) = odd_float(container) {
        return Err(Wrong::Encoding(unreadable));
    }
    match container.dtype()?.to_descriptor() {
        Ok(TypeDescriptor::Float(_) | TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) => {
            Ok(container.read_raw::<f64>()?)
        }
        Ok(kind) => Err(Wrong::Kind(kind.to_string())),
        Err(error) => Err(error.into()),
    }
}

/// Content of an unexpected type.
enum Wrong {
    Kind(String),
    Encoding(encoding::Unreadable),
    Unreadable(::hdf5::Error),
}

impl From<::hdf5::Error> for Wrong {
    fn from(error: ::hdf5::Error) -> Self {
        Self::Unreadable(error)
    }
}

/// A group or dataset with attributes, with its path for errors.
#[derive(Clone, Copy)]
struct Place<'a> {
    path: &'a Path,
    location: &'a Location,
}

impl Place<'_> {
    fn has(&self, name: &str) -> bool {
        self.location.attr(name).is_ok()
    }

    fn number(&self, name: &str) -> Outcome<f64> {
        let attribute = self.attribute(name, "a number")?;
        let expected = format!("{name}, a number");
        match numbers(&attribute).map_err(|found| self.wrong(&expected, found))?[..] {
            [value] => Ok(value),
            ref values => Err(self.content(expected, format!("{} of them", values.len()))),
        }
    }

    /// A number that may be missing.
    fn optional(&self, name: &str) -> Outcome<Option<f64>> {
        self.has(name).then(|| self.number(name)).transpose()
    }

    fn whole<T: TryFrom<i64>>(&self, name: &str) -> Outcome<T> {
        let value = self.number(name)?;
        let expected = || self.content(format!("{name}, a count"), value.to_string());
        if value.fract() != 0.0 {
            return Err(expected());
        }
        T::try_from(value as i64).map_err(|_| expected())
    }

    /// The seed, all 64 bits of it.
    fn seed(&self) -> Outcome<Seed> {
        let attribute = self.attribute("seed", "a whole number")?;
        let seeds = attribute.read_raw::<u64>();
        match seeds.map_err(|error| self.damaged(&error))?[..] {
            [seed] => Ok(Seed(seed)),
            ref seeds => Err(self.content("one seed", seeds.len().to_string())),
        }
    }

    fn text(&self, name: &str) -> Outcome<String> {
        let attribute = self.attribute(name, "a text")?;
        let read = texts(&attribute).map_err(|found| self.wrong(&format!("{name}, a text"), found));
        Ok(read?.into_iter().next().unwrap_or_default())
    }

    fn text_or_empty(&self, name: &str) -> Outcome<String> {
        if self.has(name) {
            self.text(name)
        } else {
            Ok(String::new())
        }
    }

    /// A label or class by its name in files; `None` where it is empty.
    fn name<T: for<'de> Deserialize<'de>>(&self, what: &str, name: &str) -> Outcome<Option<T>> {
        if name.is_empty() {
            return Ok(None);
        }
        let named = T::deserialize(name.into_deserializer());
        named.map(Some).map_err(|error: NameError| {
            let choice = error.to_string();
            let expected = choice.split("expected ").nth(1).unwrap_or(&choice);
            self.content(format!("{what} to be {expected}"), format!("{name:?}"))
        })
    }

    fn attribute(&self, name: &str, kind: &str) -> Outcome<Attribute> {
        let found = self.location.attr(name);
        found.map_err(|_| self.content(format!("an attribute {name}, {kind}"), "none"))
    }

    fn content(&self, expected: impl Into<String>, found: impl Into<String>) -> RunFileError {
        RunFileError::Content {
            path: self.path.to_owned(),
            group: self.location.name(),
            expected: expected.into(),
            found: found.into(),
        }
    }

    fn encoded(&self, unreadable: encoding::Unreadable) -> RunFileError {
        RunFileError::Encoding {
            path: self.path.to_owned(),
            group: self.location.name(),
            found: unreadable.found,
            way_out: unreadable.way_out,
        }
    }

    fn wrong(&self, expected: &str, found: Wrong) -> RunFileError {
        match found {
            Wrong::Kind(kind) => self.content(expected, kind),
            Wrong::Encoding(unreadable) => self.encoded(unreadable),
            Wrong::Unreadable(error) => self.damaged(&error),
        }
    }

    fn damaged(&self, error: &::hdf5::Error) -> RunFileError {
        RunFileError::Damaged {
            path: self.path.to_owned(),
            reason: format!("{}: {}", self.location.name(), reason(error)),
        }
    }
}

/// The texts in an attribute, of any of HDF5's four kinds.
fn texts(attribute: &Attribute) -> Result<Vec<String>, Wrong> {
    /// Attributes do not grow longer.
    const LONGEST: usize = 65_536;
    fn all<T: H5Type>(attribute: &Attribute, bytes: fn(&T) -> &[u8]) -> Result<Vec<String>, Wrong> {
        let read = attribute.read_raw::<T>()?;
        let text = |text| String::from_utf8_lossy(bytes(text)).into_owned();
        Ok(read.iter().map(text).collect())
    }
    match attribute.dtype()?.to_descriptor()? {
        TypeDescriptor::VarLenUnicode => all(attribute, VarLenUnicode::as_bytes),
        TypeDescriptor::VarLenAscii => all(attribute, VarLenAscii::as_bytes),
        TypeDescriptor::FixedUnicode(_) => all(attribute, FixedUnicode::<LONGEST>::as_bytes),
        TypeDescriptor::FixedAscii(_) => all(attribute, FixedAscii::<LONGEST>::as_bytes),
        kind => Err(Wrong::Kind(kind.to_string())),
    }
}
