//! A study of the demo, in its folder.

use crate::cli::interrupt::{self, Interrupted};
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::series::Jobs;
use crate::scenario::ready::{self, ReadyDocument};
use crate::study::{self, Options, Outcome, Study, StudyError};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The single wheel on the ground of this key, as shipped.
pub fn shipped(ground: &str) -> &'static ReadyDocument {
    let name = format!("single_wheel_{ground}");
    ready::scenario(&name).expect("the demo's scenarios are part of the program")
}

/// A study on sand.
pub struct SmallStudy {
    study: Study,
    /// Its file.
    pub file: PathBuf,
    /// Its results.
    pub folder: PathBuf,
}

impl SmallStudy {
    /// Writes the study of this text into a folder, as `name`.toml.
    ///
    /// Its results go to a folder of their own, named by all that decides them: a demo that was
    /// run before, and the same, is not computed again.
    pub fn prepare(folder: &Path, name: &str, text: &str, seed: u64) -> anyhow::Result<Self> {
        let file = folder.join(format!("{name}.toml"));
        let text = text.replace("seed = 1\n", &format!("seed = {seed}\n"));
        output::write_file(&file, &text)?;
        let study = Study::load(&file)?;
        let results = format!("{name}_{}", &study.fingerprint()[..8]);
        Ok(Self {
            folder: folder.join(results),
            study,
            file,
        })
    }

    /// Simulated time [s].
    pub fn simulated(&self) -> f64 {
        let runs = self.study.runs();
        runs.map(|run| self.study.scenario(&run).driven()).sum()
    }

    /// Runs the study.
    pub fn execute(&self, jobs: Jobs, progress: &Progress) -> anyhow::Result<Outcome> {
        let options = Options {
            out: self.folder.clone(),
            jobs: NonZeroUsize::new(jobs.count()),
            resume: true,
            shard: None,
        };
        let each = self.simulated() / self.study.run_count() as f64;
        let reported = AtomicU64::new(0);
        let outcome = self.study.execute(&options, &|now: study::Progress| {
            let before = reported.fetch_max(now.done, Ordering::Relaxed);
            progress.advance(now.done.saturating_sub(before) as f64 * each);
            if interrupt::is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match outcome {
            Err(stopped @ StudyError::Stopped { .. }) => {
                Err(Interrupted(stopped.to_string()).into())
            }
            other => Ok(other?),
        }
    }
}
