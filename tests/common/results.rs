//! What the tests of studies share: what a study leaves in its folder.

use std::fs;
use std::path::{Path, PathBuf};

/// Every file below a folder of results with its bytes, without what may differ between
/// executions: computing times, and what the jobs of a cluster said.
pub fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let differs = name == "timing.csv" || name.ends_with(".times.csv") || name == "slurm";
            if differs {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else {
                let relative = path.strip_prefix(folder).unwrap().to_owned();
                found.push((relative, fs::read(path).unwrap()));
            }
        }
    }
    found.sort();
    found
}
