//! Rows of rigs on disk: one file a rig, so that a stopped simulation goes on.
//!
//! ```text
//! lugwheel rig 1 <key> <sha256 of what follows>
//! {"rows": [...], "columns": 4032}
//! <values, row by row, as little-endian f32>
//! ```
//!
//! The key is the hash of everything that determines a rig but its number. A file that is torn, altered or another's does
//! not open, and the rig is simulated again. Where a rig could not be simulated, `failed` has the reason and there are no
//! rows.

use super::table::Row;
use crate::diagnosis::sealed;
use crate::whole_file;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

const HEADING: &str = "lugwheel rig 1";

/// Rows of a rig, or why there are none.
pub(super) type Drawn = Result<Vec<Row>, String>;

#[derive(Serialize, Deserialize)]
struct Header {
    rows: Vec<Row>,
    columns: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    failed: Option<String>,
}

/// A folder of rigs of one key.
#[derive(Debug)]
pub(super) struct Store {
    folder: PathBuf,
    key: String,
}

impl Store {
    /// # Errors
    /// Where the folder cannot be made or written into.
    pub fn open(folder: &Path, key: String) -> io::Result<Self> {
        let folder = folder.join("rigs").join(&key[..16]);
        std::fs::create_dir_all(&folder)?;
        whole_file::check_room(&folder)?;
        Ok(Self { folder, key })
    }

    /// Where what belongs to these rigs is kept.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn path(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{number:05}.rig"))
    }

    /// The rig of that number, where it is there and whole.
    pub fn read(&self, number: u64) -> Option<Drawn> {
        let bytes = std::fs::read(self.path(number)).ok()?;
        opened(&self.key, &bytes)
    }

    /// Keeps a rig.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, number: u64, drawn: &Drawn) -> io::Result<()> {
        whole_file::write_unsynced(&self.path(number), &sealed(&self.key, drawn))
    }
}

fn sealed(key: &str, drawn: &Drawn) -> Vec<u8> {
    let header = match drawn {
        Ok(rows) => Header {
            rows: rows.clone(),
            columns: rows.first().map_or(0, |row| row.values.len()),
            failed: None,
        },
        Err(reason) => Header {
            rows: Vec::new(),
            columns: 0,
            failed: Some(reason.clone()),
        },
    };
    let mut body = serde_json::to_vec(&header).expect("labels are numbers and text");
    body.push(b'\n');
    for value in drawn.iter().flatten().flat_map(|row| &row.values) {
        body.extend(value.to_le_bytes());
    }
    sealed::seal(&title(key), &body)
}

fn opened(key: &str, bytes: &[u8]) -> Option<Drawn> {
    let body = sealed::open(&title(key), bytes)?;
    let (header, values) = sealed::line(body)?;
    let Header {
        mut rows,
        columns,
        failed,
    } = serde_json::from_slice(header).ok()?;
    if let Some(reason) = failed {
        return Some(Err(reason));
    }
    let (numbers, rest) = values.as_chunks::<4>();
    if numbers.len() != rows.len() * columns || !rest.is_empty() {
        return None;
    }
    let mut numbers = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes));
    for row in &mut rows {
        row.values = numbers.by_ref().take(columns).collect();
    }
    Some(Ok(rows))
}

fn title(key: &str) -> String {
    format!("{HEADING} {key}")
}

#[cfg(test)]
mod tests {
    use super::super::design::Part;
    use super::*;

    fn rows() -> Vec<Row> {
        let row = |size: f64| Row {
            rig: 7,
            parameters: vec![0.1, -0.7],
            effects: vec![Part { candidate: 3, size }],
            randomised: size > 0.5,
            values: vec![1.5, size as f32, -2.0e-30],
        };
        vec![row(0.3), row(0.9)]
    }

    #[test]
    fn rows_and_reasons_come_back() {
        for drawn in [Ok(rows()), Err("sank".to_owned()), Ok(Vec::new())] {
            assert_eq!(opened("key", &sealed("key", &drawn)), Some(drawn));
        }
    }

    #[test]
    fn a_file_with_any_byte_changed_or_cut_off_or_of_another_key_does_not_open() {
        let bytes = sealed("key", &Ok(rows()));
        for at in 0..bytes.len() {
            let mut altered = bytes.clone();
            altered[at] ^= 1;
            assert_eq!(opened("key", &altered), None, "byte {at}");
            assert_eq!(opened("key", &bytes[..at]), None, "cut at {at}");
        }
        assert_eq!(opened("another", &bytes), None);
    }
}
