//! Provenance of a page.

use crate::dataset;
use std::path::Path;
use std::thread::available_parallelism;

/// Program, source and machine.
pub fn facts() -> Vec<(String, String)> {
    let program = dataset::Provenance::measured().created_by;
    let threads = available_parallelism().map_or(1, usize::from);
    let (os, processor) = (std::env::consts::OS, std::env::consts::ARCH);
    let mut facts = vec![("program".to_owned(), program)];
    let commit = option_env!("LUGWHEEL_COMMIT");
    facts.extend(commit.map(|commit| ("commit".to_owned(), commit.to_owned())));
    let machine = format!("{os} on {processor}, {threads} threads");
    facts.push(("machine".to_owned(), machine));
    facts
}

/// A path as a shell takes it.
pub fn quoted(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+,@%:=".contains(c);
    if path.chars().all(is_plain) {
        return path;
    }
    format!("'{}'", path.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_a_space_or_a_quote_stays_one_word() {
        assert_eq!(quoted(Path::new("output/demo")), "output/demo");
        assert_eq!(quoted(Path::new("my demo")), "'my demo'");
        assert_eq!(quoted(Path::new("it's")), r"'it'\''s'");
    }
}
