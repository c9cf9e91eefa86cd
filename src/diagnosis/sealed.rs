//! Content of a file under a title that holds its hash.
//!
//! ```text
//! <title> <sha256 of what follows>
//! <content>
//! ```
//!
//! A file that is torn, altered or of another title does not open.

use crate::quantity::hexadecimal;
use crate::whole_file;
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::io;
use std::path::Path;

/// What postcard wrote to a file of this title; none where it is not there and whole.
pub fn read<T: DeserializeOwned>(path: &Path, title: &str) -> Option<T> {
    let bytes = std::fs::read(path).ok()?;
    postcard::from_bytes(open(title, &bytes)?).ok()
}

/// Writes `value` as postcard does, whole or not at all.
///
/// # Errors
/// Where the file cannot be written.
pub fn write(path: &Path, title: &str, value: &impl Serialize) -> io::Result<()> {
    let body = postcard::to_stdvec(value).map_err(io::Error::other)?;
    whole_file::write_unsynced(path, &seal(title, &body))
}

/// The bytes of a file.
pub fn seal(title: &str, content: &[u8]) -> Vec<u8> {
    let mut bytes = first_line(title, content).into_bytes();
    bytes.push(b'\n');
    bytes.extend(content);
    bytes
}

/// The content of a file of this title; none where it is not whole.
pub fn open<'b>(title: &str, bytes: &'b [u8]) -> Option<&'b [u8]> {
    let (first, content) = line(bytes)?;
    (first == first_line(title, content).as_bytes()).then_some(content)
}

/// The first line, and what follows it.
pub fn line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// SHA-256 in hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn first_line(title: &str, content: &[u8]) -> String {
    format!("{title} {}", hash(content))
}
