//! Run files: HDF5 that h5py, h5dump and MATLAB read without this program.
//!
//! ```text
//! /                            format = "lugwheel-runs", format_version = 1, created_by,
//!                              scenario and seed where simulated
//! /runs/<id>/                  wheel_radius_m, wheel_width_m, lug_count, lug_height_m, load_n,
//!                              speed_m_s, slip_ratio, terrain, class, repeat, day, notes,
//!                              lug_thickness_m, wheel_mass_kg, slope_deg, physics_rate_hz where simulated,
//!                              plate_diameter_m or plate_length_m and plate_width_m; where
//!                              imported, import_notes (one a line) and wheel_angle_zero = "unknown"
//!                              where the angle is the integral of the wheel's speed
//! /runs/<id>/channels/<name>   samples; unit (and units, its name in netCDF), sample_rate_hz, start_s; steadiness of the mean over the
//!                              middle half (steady, drifting, too_short), drift_per_s where it drifts
//! /runs/<id>/channels/time     dimension scale of the channels of one rate, start and length: numbers of the samples,
//!                              in netCDF's terms scale_factor, add_offset and units of the time; of
//!                              other channels time_<name of the first>
//! /runs/<id>/means/<name>      one number; unit, sd, n
//! /runs/<id>/truth/            where simulated: contacts (lug, start_s, end_s, entered),
//!                              class_windows (start_s, end_s, class, terrain),
//!                              parameters (attributes), profile (x, height); where a drive of the rig was at its
//!                              limit, carriage_at_limit and motor_at_limit: shares of the run
//! ```
//!
//! Known channels are stored in single precision: 6e-8 of the value, 0.01 mN on 100 N and 1 nm on
//! 20 mm. The wheel angle grows without end and keeps double precision, as do channels this
//! program does not define. Unknown numbers (the load of a hand-pushed cart, the spread of a
//! published mean) are NaN. `lug_count` is left out where the count is unknown; 0 is a smooth wheel, but with a
//! `lug_height_m` above 0 it is read as unknown, as files of earlier versions have it. `wheel_mass_kg` may be left
//! out, as may `lug_thickness_m` and `slope_deg` (0, level); a run with the size of a plate has no wheel.
//!
//! The structures are HDF5 1.8's, which have checksums, as compressed samples do: damage is an error
//! or a gap, not a wrong number. Only texts have none.
//!
//! The same runs give the same bytes with the same HDF5 and zlib: a file has no time or place of creation.

mod encoding;
mod reading;
mod scale;
mod table;
mod writing;

pub use reading::RunFile;
pub use table::write_table;
pub use writing::RunFileWriter;

use crate::whole_file;
use ::hdf5::H5Type;
use ::hdf5::types::FixedAscii;
use std::io;
use std::path::{Path, PathBuf};

/// Value of `format` in a run file.
const FORMAT: &str = "lugwheel-runs";

/// The version of the layout above.
const FORMAT_VERSION: u32 = 1;

/// A run file that cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunFileError {
    /// The file system or HDF5 refused.
    #[error("cannot write {}: {reason}; {way_out}", path.display())]
    Write {
        /// The file that was to be.
        path: PathBuf,
        /// What went wrong.
        reason: String,
        /// What to do.
        way_out: String,
    },
    /// A run that cannot be stored as it is.
    #[error("cannot add run {id:?} to {}: {reason}", path.display())]
    Unfit {
        /// The file that was to be.
        path: PathBuf,
        /// The run.
        id: String,
        /// What does not fit.
        reason: String,
    },
    /// The file system refused.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Some other kind of file.
    #[error("{} is not an HDF5 file; make one from CSV with `lugwheel import`", path.display())]
    NotHdf5 {
        /// The file.
        path: PathBuf,
    },
    /// A table of features or of a study, in a file of its own.
    #[error("{} is a table of `lugwheel dataset --features` or of a study, not a run file: h5py and xarray read it, and \
             `lugwheel plot FOLDER` shows a study", path.display())]
    Table {
        /// The file.
        path: PathBuf,
    },
    /// A program writes the file, or was killed while it did.
    #[error(
        "{0} is still open for writing, or its writer was killed: close it there, or run `h5clear -s {0}` on a copy",
        path.display()
    )]
    StillOpen {
        /// The file.
        path: PathBuf,
    },
    /// Another program has it open and locks it.
    #[error("{} is locked: another program has it open; close it there", path.display())]
    Locked {
        /// The file.
        path: PathBuf,
    },
    /// HDF5 cannot make sense of the file.
    #[error("{} is damaged ({reason}); copy or make it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Message of HDF5.
        reason: String,
    },
    /// Samples in a form that this program's HDF5 cannot read; the file is whole.
    #[error("{} at {group}: {found}; {way_out}", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// Where in it.
        group: String,
        /// How the samples are stored.
        found: String,
        /// What to do.
        way_out: &'static str,
    },
    /// Something in the file is missing or not as it should be.
    #[error("{} at {group}: expected {expected}, found {found}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where in it.
        group: String,
        /// What should be there.
        expected: String,
        /// What is.
        found: String,
    },
    /// No run of this id.
    #[error("{} has no run {id:?}; it has {has}", path.display())]
    NoSuchRun {
        /// The file.
        path: PathBuf,
        /// The id requested.
        id: String,
        /// The ids there are.
        has: String,
    },
}

type Outcome<T> = Result<T, RunFileError>;

impl RunFileError {
    /// The file that cannot be read or written.
    pub fn path(&self) -> &Path {
        match self {
            Self::Write { path, .. }
            | Self::Unfit { path, .. }
            | Self::Read { path, .. }
            | Self::NotHdf5 { path }
            | Self::StillOpen { path }
            | Self::Locked { path }
            | Self::Damaged { path, .. }
            | Self::Encoding { path, .. }
            | Self::Content { path, .. }
            | Self::Table { path }
            | Self::NoSuchRun { path, .. } => path,
        }
    }

    fn write(path: &Path, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Write {
            path: path.to_owned(),
            way_out: way_out(&reason),
            reason,
        }
    }
}

/// What to do about a file that could not be written for `reason`.
fn way_out(reason: &str) -> String {
    const OWN: [(&str, &str); 3] = [
        ("it is a folder", "name a file in it"),
        (
            "it is no HDF5 file",
            "name another file, or remove that one",
        ),
        ("earlier run failed", "see the message of that run"),
    ];
    let known = OWN.iter().find(|(part, _)| reason.contains(part));
    known.map_or_else(
        || whole_file::way_out(reason, "name another folder (--out)"),
        |(_, way)| (*way).to_owned(),
    )
}

/// The error message of HDF5 without its call stack: the system's own message where there is one.
fn reason(error: &::hdf5::Error) -> String {
    let Some(stack) = error.stack() else {
        return error.to_string();
    };
    let deepest = stack
        .last()
        .map_or_else(String::new, |frame| frame.desc().to_owned());
    let quoted = deepest.split("error message = '").nth(1);
    let system = quoted.and_then(|rest| rest.split('\'').next());
    system.unwrap_or(&deepest).to_owned()
}

/// A text of at most 8 letters in a table.
type Word = FixedAscii<8>;

/// A row of `truth/contacts`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct ContactRow {
    lug: u32,
    start_s: f64,
    end_s: f64,
    entered: u8,
}

/// A row of `truth/class_windows`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct ClassWindowRow {
    start_s: f64,
    end_s: f64,
    class: Word,
    terrain: Word,
}

/// A row of `truth/class_windows` where the lugs of every window were counted.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct TalliedWindowRow {
    start_s: f64,
    end_s: f64,
    class: Word,
    terrain: Word,
    lugs_passed: u32,
    lugs_touched: u32,
    lugs_entered: u32,
}

/// A row of `truth/profile`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct ProfileRow {
    x: f64,
    height: f64,
}
