//! Scenarios and studies by path or by name.
//!
//! What is asked for is looked for as a file of that path, as `NAME.toml` in the working folder, as `NAME.toml` in the
//! folder `scenarios` (`scenarios/studies`) in it, and then among the documents that are part of the program. Files
//! come first, so that whoever edits a ready scenario uses what was edited.

use crate::scenario::Scenario;
use crate::scenario::ready::{self, ReadyDocument};
use crate::study::Study;
use std::fs;
use std::path::{Path, PathBuf};

/// How alike [0 to 1] two names are that one may have meant for the other.
const ALIKE: f64 = 0.8;

/// Most names in a suggestion.
const SUGGESTED: usize = 3;

/// A kind of document that is found by its name.
#[derive(Debug, Clone, Copy)]
struct Kind {
    noun: &'static str,
    /// Folder in which one is looked for.
    folder: &'static str,
    /// Those that are part of the program.
    ready: fn() -> &'static [ReadyDocument],
}

const SCENARIOS: Kind = Kind {
    noun: "scenario",
    folder: "scenarios",
    ready: ready::scenarios,
};

const STUDIES: Kind = Kind {
    noun: "study",
    folder: "scenarios/studies",
    ready: ready::studies,
};

/// Where a document comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// A file.
    File(PathBuf),
    /// The program.
    Ready(&'static ReadyDocument),
}

/// There is no such scenario or study.
#[derive(Debug, thiserror::Error)]
pub enum NoDocument {
    /// Nothing has the name.
    #[error("there is no {noun} {}, as a file or in the program; {hint}", asked.display())]
    Missing {
        /// What it would be.
        noun: &'static str,
        asked: PathBuf,
        hint: String,
    },
    /// It describes many runs.
    #[error("{} is a study, no scenario; `lugwheel study {}` runs it", .0.display(), .0.display())]
    Study(PathBuf),
    /// It describes one run.
    #[error("{} is a scenario, no study; `lugwheel simulate {}` runs it", .0.display(), .0.display())]
    Scenario(PathBuf),
}

impl Source {
    /// The file, where it is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Ready(_) => None,
        }
    }
}

/// The scenario of this path or name.
///
/// # Errors
/// `NoDocument` with the names like it, or for a study; `ScenarioError` for a text that is none.
pub fn read_scenario(asked: &Path) -> anyhow::Result<Scenario> {
    match scenario(asked)? {
        Source::Ready(document) => Ok(Scenario::ready(document)?),
        Source::File(path) => Scenario::load(&path).map_err(|error| match Study::load(&path) {
            Ok(_) => NoDocument::Study(path).into(),
            Err(_) => error.into(),
        }),
    }
}

/// The study of this path or name.
///
/// # Errors
/// `NoDocument` with the names like it, or for a scenario; `StudyError` for a text that is none.
pub fn read_study(source: &Source) -> anyhow::Result<Study> {
    match source {
        Source::Ready(document) => Ok(Study::ready(document)?),
        Source::File(path) => Study::load(path).map_err(|error| match Scenario::load(path) {
            Ok(_) => NoDocument::Scenario(path.clone()).into(),
            Err(_) => error.into(),
        }),
    }
}

/// Where the scenario of this path or name comes from.
///
/// # Errors
/// `NoDocument` with the names like it, or for the name of a study.
pub fn scenario(asked: &Path) -> Result<Source, NoDocument> {
    SCENARIOS.source_unless(STUDIES, NoDocument::Study, asked)
}

/// Where the study of this path or name comes from.
///
/// # Errors
/// `NoDocument` with the names like it, or for the name of a scenario.
pub fn study(asked: &Path) -> Result<Source, NoDocument> {
    STUDIES.source_unless(SCENARIOS, NoDocument::Scenario, asked)
}

/// The scenario of the program with this name, or the study: `studies/NAME` where a scenario has its name.
///
/// # Errors
/// `NoDocument` with the names like it.
pub fn ready(name: &str) -> Result<&'static ReadyDocument, NoDocument> {
    let file = with_ending(Path::new(name));
    let found = SCENARIOS.ready(&file).or_else(|| STUDIES.ready(&file));
    found.ok_or_else(|| {
        let documents = ready::scenarios().iter().chain(ready::studies());
        let names: Vec<&str> = documents.map(|document| document.name).collect();
        NoDocument::Missing {
            noun: "scenario or study",
            hint: hint(Path::new(name), &names, &[]),
            asked: name.into(),
        }
    })
}

/// Whether a document of the program is a study.
pub fn is_study(document: &ReadyDocument) -> bool {
    ready::studies().contains(document)
}

impl Kind {
    /// Where a document comes from; `is_other` is the error for the name of another kind.
    fn source_unless(
        self,
        other: Self,
        is_other: fn(PathBuf) -> NoDocument,
        asked: &Path,
    ) -> Result<Source, NoDocument> {
        self.source(asked).ok_or_else(|| match other.source(asked) {
            Some(_) => is_other(asked.to_owned()),
            None => self.missing(asked),
        })
    }

    fn source(self, asked: &Path) -> Option<Source> {
        let named = with_ending(asked);
        let in_folder = Path::new(self.folder).join(&named);
        let files = [asked, &named, &in_folder].into_iter();
        let mut files = files.filter(|path| path.exists() && !path.is_dir());
        if let Some(path) = files.next() {
            return Some(Source::File(path.to_owned()));
        }
        let ready = self.ready(&named).map(Source::Ready);
        // What is there and no file is for the reader to refuse.
        ready.or_else(|| asked.exists().then(|| Source::File(asked.to_owned())))
    }

    /// The document of the program that `NAME.toml` stands for, alone or in the folder of the repository.
    fn ready(self, file: &Path) -> Option<&'static ReadyDocument> {
        let folder = Path::new(self.folder);
        let innermost = folder.file_name().unwrap_or_default();
        let within = file.strip_prefix(folder).or(file.strip_prefix(innermost));
        let file = within.unwrap_or(file);
        let name = file.to_str()?.strip_suffix(".toml")?;
        let mut documents = (self.ready)().iter();
        documents.find(|document| document.name == name)
    }

    fn missing(self, asked: &Path) -> NoDocument {
        let ready = (self.ready)().iter().map(|document| document.name);
        NoDocument::Missing {
            noun: self.noun,
            asked: asked.to_owned(),
            hint: hint(asked, &ready.collect::<Vec<_>>(), &files_beside(asked)),
        }
    }
}

/// The path with the ending `.toml`.
pub fn with_ending(asked: &Path) -> PathBuf {
    if asked.extension().is_some_and(|ending| ending == "toml") {
        return asked.to_owned();
    }
    let mut named = asked.as_os_str().to_owned();
    named.push(".toml");
    named.into()
}

/// TOML files in the folder of a file that is not there.
fn files_beside(asked: &Path) -> Vec<PathBuf> {
    let parent = asked.parent().unwrap_or(Path::new(""));
    let folder = if parent == Path::new("") {
        Path::new(".")
    } else {
        parent
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| parent.join(entry.file_name()));
    let is_toml = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    paths.filter(is_toml).collect()
}

/// The documents and files like the one asked for; all documents where none is.
fn hint(asked: &Path, documents: &[&str], files: &[PathBuf]) -> String {
    let stem = |path: &Path| {
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let asked = stem(asked);
    let documents_like = documents
        .iter()
        .map(|name| (strsim::jaro_winkler(&asked, name), (*name).to_owned()));
    let files_like = files.iter().map(|path| {
        (
            strsim::jaro_winkler(&asked, &stem(path)),
            path.display().to_string(),
        )
    });
    let mut near: Vec<(f64, String)> = documents_like
        .chain(files_like)
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .collect();
    near.sort_by(|(a, name), (b, other)| b.total_cmp(a).then_with(|| name.cmp(other)));
    near.truncate(SUGGESTED);
    if near.is_empty() {
        return format!("there are {}", documents.join(", "));
    }
    let names: Vec<String> = near.into_iter().map(|(_, name)| name).collect();
    format!("did you mean {}?", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typo_is_answered_with_the_names_like_it_and_nonsense_with_all() {
        let names = ["quick", "rover_ht", "single_wheel_gt", "single_wheel_ht"];
        let typo = hint(Path::new("singel_wheel_ht.toml"), &names, &[]);
        assert_eq!(typo, "did you mean single_wheel_ht, single_wheel_gt?");
        let file = hint(
            Path::new("rigs/my_rg"),
            &names,
            &["rigs/my_rig.toml".into()],
        );
        assert_eq!(file, "did you mean rigs/my_rig.toml?");
        let nonsense = hint(Path::new("zzz"), &names, &["zap/Cargo.toml".into()]);
        assert_eq!(
            nonsense,
            "there are quick, rover_ht, single_wheel_gt, single_wheel_ht"
        );
    }

    #[test]
    fn a_name_with_and_without_ending_and_folder_is_the_same_ready_document() {
        for name in [
            "table3",
            "table3.toml",
            "scenarios/studies/table3.toml",
            "scenarios/studies/table3",
            "studies/table3",
        ] {
            let found = STUDIES.ready(&with_ending(Path::new(name)));
            assert_eq!(
                found.map(|document| document.name),
                Some("table3"),
                "{name}"
            );
        }
        assert_eq!(STUDIES.ready(Path::new("elsewhere/table3.toml")), None);
        assert_eq!(SCENARIOS.ready(Path::new("table3.toml")), None);
    }
}
