//! A case put to `diagnose`.

use crate::challenge::{Question, Unanswered};
use crate::cli::{interrupt, program};
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks at a diagnosis.
const PAUSE: Duration = Duration::from_millis(100);
/// Time that a diagnosis is given to stop by itself, as it does where the terminal interrupts both.
const GRACE: Duration = Duration::from_secs(5);

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
    /// Whether the run that separates effects is not searched for.
    pub without_next_run: bool,
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
        let answered = output(
            self.command(&program, question),
            interrupt::is_requested,
            GRACE,
        );
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
        if self.without_next_run {
            command.arg("--without-next-run");
        }
        if let Some(budget) = self.budget {
            command.args(["--budget", &budget.to_string()]);
        }
        command
    }
}

/// What a command wrote, and how it ended; it is killed where it runs for `grace` after `is_stopped`.
fn output(
    mut command: Command,
    is_stopped: impl Fn() -> bool,
    grace: Duration,
) -> io::Result<Output> {
    // Files, since a pipe is full after some kilobytes and has to be read meanwhile.
    let [mut stdout, mut stderr] = [tempfile::tempfile()?, tempfile::tempfile()?];
    let command = command
        .stdout(stdout.try_clone()?)
        .stderr(stderr.try_clone()?);
    let mut child = command.spawn()?;
    let mut stopped: Option<Instant> = None;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if is_stopped() && stopped.get_or_insert_with(Instant::now).elapsed() >= grace {
            child.kill()?;
            break child.wait()?;
        }
        thread::sleep(PAUSE);
    };
    let mut written = [Vec::new(), Vec::new()];
    for (file, bytes) in [&mut stdout, &mut stderr].into_iter().zip(&mut written) {
        file.rewind()?;
        file.read_to_end(bytes)?;
    }
    let [stdout, stderr] = written;
    Ok(Output {
        status,
        stdout,
        stderr,
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn an_output_larger_than_a_pipe_is_read_in_full() {
        let command = shell("yes | head -c 300000; echo why >&2; exit 3");
        let output = output(command, || false, GRACE).unwrap();
        assert_eq!(output.stdout.len(), 300_000);
        assert_eq!(output.stderr, b"why\n");
        assert_eq!(output.status.code(), Some(3));
    }

    #[test]
    fn a_command_that_does_not_stop_on_request_is_killed() {
        let begun = Instant::now();
        let output = output(shell("exec sleep 60"), || true, PAUSE).unwrap();
        assert!(!output.status.success());
        assert!(begun.elapsed() < Duration::from_secs(20));
    }
}
