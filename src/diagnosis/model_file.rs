//! A trained model on disk, beside the rigs that it was learned from.
//!
//! ```text
//! lugwheel model 2 <sha256 of the key of rigs and candidates> <sha256 of what follows>
//! <the model, as postcard writes it>
//! ```
//!
//! A file that is torn, altered, or of other rigs does not open, and the model is learned again.

use super::inference::Model;
use super::sealed::{self, hash};
use std::io;
use std::path::{Path, PathBuf};

const HEADING: &str = "lugwheel model 2";

/// Where the model of so many rigs and of this key is.
pub fn path(folder: &Path, rigs: usize, key: &str) -> PathBuf {
    folder.join(format!("model_{rigs}_{}.bin", &hash(key.as_bytes())[..8]))
}

/// The model in a file; none where it is not there and whole.
pub fn read(path: &Path, key: &str) -> Option<Model> {
    sealed::read(path, &title(key))
}

/// Writes a model.
///
/// # Errors
/// Where the file cannot be written.
pub fn write(path: &Path, key: &str, model: &Model) -> io::Result<()> {
    sealed::write(path, &title(key), model)
}

fn title(key: &str) -> String {
    format!("{HEADING} {}", hash(key.as_bytes()))
}
