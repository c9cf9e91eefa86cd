//! A block of consecutive runs on disk: its rows between a heading and a checksum.
//!
//! ```text
//! # lugwheel shard 3, study <fingerprint>
//! run,condition,...
//! 12,3,...
//! # sha256 <of all the lines above>
//! ```

use super::Study;
use crate::quantity::hexadecimal;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// Most runs in a shard: what an interruption may cost each thread.
const MOST_RUNS: u64 = 16;

/// Shards into which a small study is divided, so that many threads or machines share it.
const SMALL_STUDY: u64 = 64;

/// Prefix of the checksum.
const CHECKSUM: &str = "# sha256 ";

/// A block of consecutive runs.
#[derive(Debug, Clone)]
pub(super) struct Shard {
    pub(super) number: usize,
    pub(super) runs: Range<u64>,
}

/// All shards of a study; they depend on nothing but its number of runs.
pub(super) fn all(study: &Study) -> Vec<Shard> {
    let runs = study.run_count();
    let size = (runs / SMALL_STUDY).clamp(1, MOST_RUNS);
    let starts = (0..runs).step_by(size as usize).enumerate();
    starts
        .map(|(number, start)| Shard {
            number,
            runs: start..(start + size).min(runs),
        })
        .collect()
}

impl Shard {
    /// The text of the shard's file with its `rows`.
    pub(super) fn seal(&self, fingerprint: &str, rows: &str) -> String {
        sealed(&self.heading(fingerprint), rows)
    }

    /// The rows in the text of the shard's file; `None` where it is torn, altered or another's.
    pub(super) fn open<'t>(&self, fingerprint: &str, text: &'t str) -> Option<&'t str> {
        opened(&self.heading(fingerprint), text)
    }

    fn heading(&self, fingerprint: &str) -> String {
        format!("# lugwheel shard {}, study {fingerprint}\n", self.number)
    }
}

/// A text between a heading and the checksum of both.
pub(super) fn sealed(heading: &str, text: &str) -> String {
    let body = format!("{heading}{text}");
    let checksum = checksum(&body);
    format!("{body}{CHECKSUM}{checksum}\n")
}

/// The text below this heading; `None` where it is torn, altered or another's.
pub(super) fn opened<'t>(heading: &str, sealed: &'t str) -> Option<&'t str> {
    let (body, tail) = sealed.split_at_checked(sealed.rfind(CHECKSUM)?)?;
    let stated = tail.strip_prefix(CHECKSUM)?.strip_suffix('\n')?;
    if stated != checksum(body) {
        return None;
    }
    body.strip_prefix(heading)
}

fn checksum(body: &str) -> String {
    hexadecimal(&Sha256::digest(body))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARD: Shard = Shard {
        number: 3,
        runs: 12..16,
    };

    #[test]
    fn a_sealed_shard_opens_to_its_rows() {
        let sealed = SHARD.seal("abc", "run\n12\n");
        assert_eq!(SHARD.open("abc", &sealed), Some("run\n12\n"));
    }

    #[test]
    fn a_shard_with_any_byte_changed_or_cut_off_does_not_open() {
        let sealed = SHARD.seal("abc", "run\n12\n");
        for at in 0..sealed.len() {
            let mut altered = sealed.clone().into_bytes();
            altered[at] ^= 1;
            let altered = String::from_utf8(altered).unwrap();
            assert_eq!(SHARD.open("abc", &altered), None, "byte {at}");
            assert_eq!(SHARD.open("abc", &sealed[..at]), None, "cut at {at}");
        }
    }

    #[test]
    fn a_shard_of_another_number_or_study_does_not_open() {
        let sealed = SHARD.seal("abc", "run\n12\n");
        assert_eq!(SHARD.open("abd", &sealed), None);
        let other = Shard { number: 4, ..SHARD };
        assert_eq!(other.open("abc", &sealed), None);
    }
}
