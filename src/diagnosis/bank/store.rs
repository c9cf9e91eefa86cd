//! Answers on disk: one file each, named by the hash of what makes it.
//!
//! ```text
//! # lugwheel bank 1 <hash>
//! # slip_sinkage=0.8, case 0, stream 3
//! sinkage/load/mean,0.0123,0.0123
//! loads,0.1,0.0123,12.5,100.2,3.1,0.001,0.0001,1.2,1.1,0.05
//! # sha256 <of all the lines above>
//! ```
//!
//! A line is a cell with its value and size, or a row of steady loads with its uncertainties where
//! they are known; `failed,` begins the reason where there is no run. A file that is torn, altered or
//! another's does not open, and is made again.

use super::{BankError, Failure, Outcome};
use crate::gap::{Cell, Reading, Readings, Run};
use crate::identification::{SteadyLoad, Uncertainty};
use crate::quantity::hexadecimal;
use crate::trace::RunAttributes;
use crate::whole_file;
use sha2::{Digest, Sha256};
use std::fmt;
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How a file begins.
const HEADING: &str = "# lugwheel bank 1 ";

/// What stands before the checksum.
const CHECKSUM: &str = "# sha256 ";

/// How a row of steady loads begins.
const LOADS: &str = "loads,";

/// How the reason of a failure begins.
const FAILED: &str = "failed,";

/// A SHA-256 hash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key([u8; 32]);

impl Key {
    pub fn of(text: &str) -> Self {
        Self(Sha256::digest(text.as_bytes()).into())
    }
}

impl Key {
    /// Its first 31 bits.
    pub fn number(&self) -> u64 {
        let first = [self.0[0], self.0[1], self.0[2], self.0[3]];
        u64::from(u32::from_le_bytes(first) >> 1)
    }
}

/// In hexadecimal digits.
impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&hexadecimal(&self.0))
    }
}

/// A folder of answers; processes may share it.
#[derive(Debug)]
pub(super) struct Store {
    folder: PathBuf,
}

impl Store {
    pub fn open(folder: &Path) -> Result<Self, BankError> {
        let folder = folder.to_owned();
        make(&folder)?;
        whole_file::check_room(&folder)
            .map_err(|error| refused("write in the folder", &folder, error))?;
        Ok(Self { folder })
    }

    /// The answer of this key, where it is there and whole.
    pub fn read(&self, key: &Key, attributes: &RunAttributes) -> Option<Outcome> {
        let text = std::fs::read_to_string(self.path(key)).ok()?;
        parsed(opened(key, &text)?, attributes)
    }

    /// Keeps an answer: written beside its name, and given it when whole.
    pub fn write(&self, key: &Key, title: &str, outcome: &Outcome) -> Result<(), BankError> {
        let text = sealed(key, title, outcome);
        let path = self.path(key);
        let folder = path.parent().unwrap_or(&self.folder);
        make(folder)?;
        // What a crash tears, the checksum finds.
        whole_file::write_unsynced(&path, text.as_bytes())
            .map_err(|error| refused("write", &path, error))
    }

    /// Files lie in 256 folders, by the first two digits.
    fn path(&self, key: &Key) -> PathBuf {
        let name = key.to_string();
        self.folder.join(&name[..2]).join(format!("{name}.csv"))
    }
}

fn make(folder: &Path) -> Result<(), BankError> {
    std::fs::create_dir_all(folder).map_err(|error| refused("make the folder", folder, error))
}

fn refused(action: &'static str, path: &Path, source: io::Error) -> BankError {
    BankError::File {
        action,
        path: path.to_owned(),
        source,
    }
}

fn sealed(key: &Key, title: &str, outcome: &Outcome) -> String {
    let mut text = format!("{HEADING}{key}\n# {}\n", one_line(title));
    match outcome {
        Ok(run) => {
            run.readings
                .iter()
                .for_each(|(cell, it)| line(&mut text, &[&cell.to_string()], &[it.value, it.size]));
            run.loads
                .iter()
                .for_each(|row| line(&mut text, &["loads"], &numbers(row)));
        }
        Err(Failure(reason)) => line(&mut text, &["failed", &one_line(reason)], &[]),
    }
    let checksum = Key::of(&text);
    format!("{text}{CHECKSUM}{checksum}\n")
}

fn one_line(text: &str) -> String {
    text.lines().collect::<Vec<_>>().join("; ")
}

/// Numbers have as many digits as bring the same number back.
fn line(text: &mut String, words: &[&str], numbers: &[f64]) {
    text.push_str(&words.join(","));
    for number in numbers {
        write!(text, ",{number:?}").expect("a string takes all");
    }
    text.push('\n');
}

/// The lines between heading and checksum; `None` where the file is not whole.
fn opened<'t>(key: &Key, text: &'t str) -> Option<&'t str> {
    let (body, tail) = text.split_at_checked(text.rfind(CHECKSUM)?)?;
    let stated = tail.strip_prefix(CHECKSUM)?.strip_suffix('\n')?;
    if stated != Key::of(body).to_string() {
        return None;
    }
    let body = body.strip_prefix(&format!("{HEADING}{key}\n"))?;
    body.split_once('\n').map(|(_, lines)| lines)
}

fn parsed(lines: &str, attributes: &RunAttributes) -> Option<Outcome> {
    if let Some(reason) = lines.strip_prefix(FAILED) {
        return Some(Err(Failure(reason.trim_end_matches('\n').to_owned())));
    }
    let mut readings: Vec<(Cell, Reading)> = Vec::new();
    let mut loads = Vec::new();
    for line in lines.lines() {
        if let Some(row) = line.strip_prefix(LOADS) {
            loads.push(steady_load(row)?);
            continue;
        }
        let mut parts = line.rsplitn(3, ',');
        let size = parts.next()?.parse().ok()?;
        let value = parts.next()?.parse().ok()?;
        let mut cell: Cell = parts.next()?.parse().ok()?;
        // Cells of a channel stand together: they share its name.
        if let Some((before, _)) = readings.last().filter(|(it, _)| it.channel == cell.channel) {
            cell.channel = Arc::clone(&before.channel);
        }
        readings.push((cell, Reading { value, size }));
    }
    Some(Ok(Run {
        attributes: attributes.clone(),
        readings: readings.into_iter().collect::<Readings>(),
        loads,
    }))
}

fn numbers(row: &SteadyLoad) -> Vec<f64> {
    let SteadyLoad {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
        uncertainty,
    } = *row;
    let mut numbers = vec![slip, sinkage, drawbar_pull, load, driving_torque];
    numbers.extend(uncertainty.into_iter().flat_map(|known| {
        [
            known.slip,
            known.sinkage,
            known.drawbar_pull,
            known.load,
            known.driving_torque,
        ]
    }));
    numbers
}

fn steady_load(row: &str) -> Option<SteadyLoad> {
    let numbers: Option<Vec<f64>> = row.split(',').map(|number| number.parse().ok()).collect();
    let numbers = numbers?;
    let (&[slip, sinkage, drawbar_pull, load, driving_torque], known) =
        numbers.split_first_chunk()?;
    let uncertainty = match *known {
        [] => None,
        [slip, sinkage, drawbar_pull, load, driving_torque] => Some(Uncertainty {
            slip,
            sinkage,
            drawbar_pull,
            load,
            driving_torque,
        }),
        _ => return None,
    };
    Some(SteadyLoad {
        slip,
        sinkage,
        drawbar_pull,
        load,
        driving_torque,
        uncertainty,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::Statistic;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn any_load() -> impl Strategy<Value = SteadyLoad> {
        let known = proptest::option::of(vec(-1.0e3..1.0e3_f64, 5));
        (vec(any::<f64>(), 5), known).prop_map(|(numbers, known)| {
            let text: Vec<String> = numbers
                .iter()
                .chain(known.iter().flatten())
                .map(|number| format!("{number:?}"))
                .collect();
            steady_load(&text.join(",")).unwrap()
        })
    }

    fn any_run() -> impl Strategy<Value = Run> {
        let cells = vec((0_u32..90, any::<f64>(), 0.0..1.0e9_f64), 0..20);
        (cells, vec(any_load(), 0..3)).prop_map(|(cells, loads)| Run {
            attributes: RunAttributes::default(),
            readings: cells
                .into_iter()
                .map(|(order, value, size)| {
                    let cell = Cell::new("acceleration_y", Statistic::OrderCosine(order));
                    (cell, Reading { value, size })
                })
                .collect(),
            loads,
        })
    }

    fn key() -> Key {
        Key::of("something")
    }

    proptest! {
        #[test]
        fn every_run_comes_back_from_its_file_bit_by_bit(run in any_run()) {
            let text = sealed(&key(), "as_shipped", &Ok(run.clone()));
            let back = parsed(opened(&key(), &text).unwrap(), &run.attributes).unwrap().unwrap();
            prop_assert_eq!(&back.readings, &run.readings);
            // Not a number is not equal to itself, but has the same text.
            prop_assert_eq!(format!("{:?}", back.loads), format!("{:?}", run.loads));
        }
    }

    #[test]
    fn a_failure_comes_back_with_its_reason_in_one_line() {
        let text = sealed(
            &key(),
            "as_shipped",
            &Err(Failure("sank,\n deep".to_owned())),
        );
        let back = parsed(opened(&key(), &text).unwrap(), &RunAttributes::default());
        assert_eq!(back, Some(Err(Failure("sank,;  deep".to_owned()))));
    }

    #[test]
    fn a_file_with_any_byte_changed_or_cut_off_or_of_another_key_does_not_open() {
        let text = sealed(&key(), "as_shipped", &Err(Failure("sank".to_owned())));
        for at in 0..text.len() {
            let mut altered = text.clone().into_bytes();
            altered[at] ^= 1;
            let altered = String::from_utf8(altered).unwrap();
            assert_eq!(opened(&key(), &altered), None, "byte {at}");
            assert_eq!(opened(&key(), &text[..at]), None, "cut at {at}");
        }
        assert_eq!(opened(&Key::of("another"), &text), None);
    }
}
