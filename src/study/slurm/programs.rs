//! Slurm by its programs.

use super::{Job, JobState, Queue, SlurmError};
use std::io::Write;
use std::process::{Command, Output, Stdio};

/// Slurm as this machine's `sbatch`, `squeue` and `scontrol` reach it.
#[derive(Debug, Clone, Copy)]
pub struct Programs;

impl Queue for Programs {
    fn submit(&self, options: &[String], script: &str) -> Result<u32, SlurmError> {
        const PROGRAM: &str = "sbatch";
        let output = call(PROGRAM, options, script)?;
        job_number(&output).ok_or_else(|| refused(PROGRAM, format!("no number of a job: {output}")))
    }

    fn jobs(&self, name: &str) -> Result<Vec<Job>, SlurmError> {
        let name = format!("--name={name}");
        let options = [
            "--noheader",
            "--array",
            "--states=all",
            "--format=%F|%K|%T|%r",
            &name,
        ];
        let output = call("squeue", &options.map(str::to_owned), "")?;
        Ok(output.lines().filter_map(job).collect())
    }

    fn largest_task(&self) -> Result<u32, SlurmError> {
        const PROGRAM: &str = "scontrol";
        let options = ["show", "config"].map(str::to_owned);
        let output = call(PROGRAM, &options, "")?;
        largest_task(&output)
            .ok_or_else(|| refused(PROGRAM, "the configuration has no MaxArraySize".to_owned()))
    }
}

/// What a program answers to `options` and what it reads.
fn call(program: &'static str, options: &[String], input: &str) -> Result<String, SlurmError> {
    let no_program = |error: std::io::Error| SlurmError::NoProgram {
        program,
        reason: error.to_string(),
    };
    let mut command = Command::new(program);
    command
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    // Ctrl-C is for the one who follows, not for a submission under way.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().map_err(no_program)?;
    if let Some(mut stdin) = child.stdin.take() {
        // A program that rejects its options does not read; its output has the reason.
        let _ = stdin.write_all(input.as_bytes());
    }
    answer(program, &child.wait_with_output().map_err(no_program)?)
}

fn answer(program: &'static str, output: &Output) -> Result<String, SlurmError> {
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let words = String::from_utf8_lossy(&output.stderr);
    let lead = format!("{program}: ");
    let lines = words.lines().map(|line| {
        let line = line.strip_prefix(&lead).unwrap_or(line);
        line.strip_prefix("error: ").unwrap_or(line)
    });
    let reason = lines.collect::<Vec<_>>().join("; ");
    Err(refused(program, reason))
}

fn refused(program: &'static str, reason: String) -> SlurmError {
    SlurmError::Refused { program, reason }
}

/// The job number in the output of `sbatch --parsable`; the name of a cluster may follow.
fn job_number(output: &str) -> Option<u32> {
    output.trim().split(';').next()?.parse().ok()
}

/// A job in a line of `squeue`.
fn job(line: &str) -> Option<Job> {
    let mut cells = line.trim().splitn(4, '|');
    let number = cells.next()?.parse().ok()?;
    let is_task = cells.next()?.parse::<u32>().is_ok();
    let state = state(cells.next()?, cells.next().unwrap_or_default());
    Some(Job {
        number,
        is_task,
        state,
    })
}

/// What a job is at, by Slurm's long name of its state.
fn state(name: &str, reason: &str) -> JobState {
    match name {
        "CANCELLED" => JobState::Cancelled,
        "COMPLETED" | "FAILED" | "TIMEOUT" | "NODE_FAIL" | "PREEMPTED" | "OUT_OF_MEMORY"
        | "BOOT_FAIL" | "DEADLINE" | "REVOKED" => JobState::Ended(name.to_owned()),
        "RUNNING" | "COMPLETING" | "CONFIGURING" | "RESIZING" | "SIGNALING" | "STAGE_OUT" => {
            JobState::Running
        }
        _ => JobState::Waiting(reason.to_owned()),
    }
}

/// The largest task number in the output of `scontrol show config`.
fn largest_task(output: &str) -> Option<u32> {
    let values = output.lines().filter_map(|line| line.split_once('='));
    let mut sizes = values.filter(|(key, _)| key.trim() == "MaxArraySize");
    let size: u32 = sizes.next()?.1.trim().parse().ok()?;
    Some(size.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jobs_number_stands_before_the_clusters_name() {
        assert_eq!(job_number("1234\n"), Some(1234));
        assert_eq!(job_number("1234;west\n"), Some(1234));
        assert_eq!(job_number("Submitted batch job 1234\n"), None);
    }

    #[test]
    fn every_task_is_waiting_running_cancelled_or_ended() {
        let state = |line: &str| job(line).unwrap().state;
        assert_eq!(
            job("12|N/A|PENDING|Dependency"),
            Some(Job {
                number: 12,
                is_task: false,
                state: JobState::Waiting("Dependency".to_owned())
            })
        );
        assert_eq!(
            state("12|7|REQUEUED|BeginTime"),
            JobState::Waiting("BeginTime".to_owned())
        );
        assert_eq!(state("12|7|COMPLETING|None"), JobState::Running);
        assert_eq!(state("12|7|CANCELLED|None"), JobState::Cancelled);
        assert_eq!(
            state("12|7|OUT_OF_MEMORY|OutOfMemory"),
            JobState::Ended("OUT_OF_MEMORY".to_owned())
        );
        assert_eq!(job(""), None);
    }

    #[test]
    fn the_tasks_of_an_array_end_one_below_its_size() {
        let output = "Configuration data\nMaxArraySize            = 1001\nMaxDBDMsgs = 20008\n";
        assert_eq!(largest_task(output), Some(1000));
        assert_eq!(largest_task("MaxJobCount = 10000"), None);
    }
}
