//! Data sets for machine learning: windows with features and classes, splits without leakage, and
//! documentation.
//!
//! A data set is a file of runs, or of features alone, with four text files:
//!
//! ```text
//! x.h5               the runs (see `dataset::hdf5`), or the table of windows where only features are stored
//! x.windows.csv      one row a window: class, features, its subset in every split; see [`windows`]
//! x.splits.csv       one row a run: its condition, its stream of random numbers, its parts; see [`splits`]
//! x.datasheet.md     what it is made of, how, and what for; see [`datasheet`]
//! x.croissant.json   the same for machines: JSON-LD of MLCommons Croissant 1.0; see [`croissant`]
//! ```
//!
//! They contain no time or place of creation: the same runs give the same bytes.

pub mod balance;
pub mod croissant;
pub mod datasheet;
pub mod splits;
pub mod windows;

use crate::dataset::records::{Field, Records};
use crate::quantity::{Seed, hexadecimal};
use crate::trace::Trace;
use sha2::{Digest, Sha256};
use splits::{GROUPINGS, Member, Part};
use std::io::{self, Read};
use std::path::Path;

/// Content stored per run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Every channel at its output rate.
    Traces,
    /// The features of the windows only.
    Features,
}

/// A channel of the runs.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFact {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Samples per second \[Hz\].
    pub sample_rate: f64,
}

impl ChannelFact {
    /// Those of a run.
    pub fn of(trace: &Trace) -> Vec<Self> {
        let channels = trace.channels.iter().map(|channel| Self {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            sample_rate: channel.sample_rate,
        });
        channels.collect()
    }
}

/// The file of runs as it lies on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileFact {
    /// Its name, without folders.
    pub name: String,
    /// Its size \[B\].
    pub bytes: u64,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
}

impl FileFact {
    /// Reads a file for its size and hash.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn of(path: &Path) -> io::Result<Self> {
        let mut file = std::fs::File::open(path)?;
        let (mut hash, mut bytes, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
        loop {
            let read = file.read(&mut buffer)?;
            if read == 0 {
                break;
            }
            hash.update(&buffer[..read]);
            bytes += read as u64;
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            name: name.into_owned(),
            bytes,
            sha256: hexadecimal(&hash.finalize()),
        })
    }
}

/// Metadata of a data set besides its windows.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// The command that makes it again.
    pub command: String,
    /// The program that made it, with its version.
    pub created_by: String,
    /// Where all randomness comes from, its splits included.
    pub seed: Seed,
    /// Content stored per run.
    pub kept: Kept,
    /// Their channels.
    pub channels: Vec<ChannelFact>,
    /// Runs that failed and are not in it.
    pub failed: u64,
}

/// A data set: its windows, its runs and their parts.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    facts: Facts,
    /// A row a window, with the parts of its run.
    windows: Records,
    members: Vec<Member>,
    /// The parts of every run in the order of [`GROUPINGS`]; none where there are too few groups.
    parts: [Option<Vec<Option<Part>>>; GROUPINGS.len()],
}

impl DataSet {
    /// Endings of the texts beside a data set's file.
    pub const ENDINGS: [&'static str; 4] = [
        "windows.csv",
        "splits.csv",
        "datasheet.md",
        "croissant.json",
    ];

    /// A data set of these windows, those of a run together: columns [`run_fields`], then
    /// [`windows::fields`].
    pub fn new(facts: Facts, windows: Records) -> Self {
        let members = splits::members(&windows);
        let parts = GROUPINGS.map(|grouping| splits::split(&members, grouping, facts.seed));
        let mut set = Self {
            facts,
            windows,
            members,
            parts,
        };
        set.add_parts();
        set
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.members.len()
    }

    /// One row a window.
    pub fn windows(&self) -> &Records {
        &self.windows
    }

    /// One row a run: its condition and stream, its ground and class, its part in every split.
    pub fn splits(&self) -> Records {
        let mut fields = run_fields(Vec::new());
        fields.truncate(3);
        fields.push(Field::text(
            "stratum",
            "ground and class, of which every part has its share",
        ));
        fields.extend(part_fields());
        let row = |(index, member): (usize, &Member)| {
            let mut cells = vec![
                member.id.clone(),
                member.condition.to_string(),
                member.stream.to_string(),
                member.stratum.clone(),
            ];
            cells.extend(self.part_cells(index));
            cells
        };
        Records {
            fields,
            rows: self.members.iter().enumerate().map(row).collect(),
        }
    }

    /// The texts beside the file of runs, each with the ending of its name.
    pub fn texts(&self, file: &FileFact) -> Vec<(&'static str, String)> {
        let [windows, splits, datasheet, croissant] = Self::ENDINGS;
        let mut texts = vec![
            (windows, self.windows.to_csv()),
            (splits, self.splits().to_csv()),
            (datasheet, self.datasheet(file)),
        ];
        texts.push((croissant, self.croissant(file, &texts)));
        texts
    }

    fn add_parts(&mut self) {
        self.windows.fields.extend(part_fields());
        let mut member = 0;
        let mut rows = std::mem::take(&mut self.windows.rows);
        for row in &mut rows {
            while self.members[member].id != row[0] {
                member += 1;
            }
            row.extend(self.part_cells(member));
        }
        self.windows.rows = rows;
    }

    fn part_cells(&self, member: usize) -> [String; GROUPINGS.len()] {
        std::array::from_fn(|grouping| {
            let parts = self.parts[grouping].as_ref();
            let part = parts.and_then(|parts| parts[member]);
            part.map_or_else(String::new, |part| part.as_str().to_owned())
        })
    }
}

/// The columns that identify a window's run; `swept` are those of the swept keys.
pub fn run_fields(swept: Vec<Field>) -> Vec<Field> {
    let mut fields = vec![
        Field::text("run", "id in the file of runs"),
        Field::whole("condition", "number of the scenario with its swept values"),
        Field::whole(
            "stream",
            "random numbers it draws from: its ground and its noise",
        ),
        Field::text("scenario", "name of the scenario's file"),
    ];
    fields.extend(swept);
    fields
}

/// The id of run `number` in a file.
pub fn run_id(number: u64) -> String {
    format!("run_{number:06}")
}

fn part_fields() -> impl Iterator<Item = Field> {
    GROUPINGS
        .into_iter()
        .map(|grouping| Field::text(grouping.column(), grouping.meaning()))
}
