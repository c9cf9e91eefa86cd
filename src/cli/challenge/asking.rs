//! A case put to `diagnose`.

use crate::challenge::{Question, Unanswered};
use crate::cli::{interrupt, program};
use std::path::{Path, PathBuf};
use std::process::Command;

/// How cases are put to the diagnosis: in a process of its own each, with only the information that a
/// user has.
#[derive(Debug)]
pub struct Asking<'a> {
    /// Folder of the trial.
    pub folder: &'a Path,
    /// Folder of simulated statistics, which all cases share.
    pub bank: PathBuf,
    /// Driving that a diagnosis may simulate [s]; its own default where not given.
    pub budget: Option<f64>,
    /// Cores for each.
    pub cores: usize,
}

impl Asking<'_> {
    /// The JSON of the diagnosis.
    ///
    /// # Errors
    /// `Failed` with the last message of the diagnosis, `Stopped` on request.
    pub fn ask(&self, question: &Question) -> Result<String, Unanswered> {
        let failed = |error: &dyn std::fmt::Display| Unanswered::Failed(error.to_string());
        let program = program::file().map_err(|error| failed(&error))?;
        let answered = self.command(&program, question).output();
        let answered = answered.map_err(|error| failed(&error))?;
        if answered.status.success() {
            return String::from_utf8(answered.stdout).map_err(|error| failed(&error));
        }
        if interrupt::is_requested() {
            return Err(Unanswered::Stopped);
        }
        let stderr = String::from_utf8_lossy(&answered.stderr);
        let reason = format!(
            "diagnose: {}, {}",
            stderr.trim().replace('\n', "; "),
            answered.status
        );
        Err(Unanswered::Failed(reason))
    }

    fn command(&self, program: &Path, question: &Question) -> Command {
        let diagnoses = self.folder.join("diagnoses");
        let mut command = Command::new(program);
        command
            .args(["diagnose", "--json", "--quiet", "--force", "--measured"])
            .arg(&question.measured)
            .arg("--scenario")
            .arg(&question.scenario)
            .arg("--out")
            .arg(diagnoses.join(question.case))
            .arg("--bank")
            .arg(&self.bank)
            .args(["--jobs", &self.cores.to_string()])
            // The campaigns are simulated.
            .args(["--discrepancy", "0"]);
        for effect in question.without {
            command.args(["--without", effect]);
        }
        if let Some(budget) = self.budget {
            command.args(["--budget", &budget.to_string()]);
        }
        command
    }
}
