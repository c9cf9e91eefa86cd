//! What is handed to `sbatch`: options, and the text of a job.

use super::Submission;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::Path;

/// The jobs of a submission in words.
pub(super) struct Script<'s> {
    pub(super) submission: &'s Submission,
    pub(super) name: &'s str,
    /// Folder of the jobs' logs.
    pub(super) words: &'s Path,
}

impl Script<'_> {
    /// Options of the array of these tasks.
    pub(super) fn array_options(&self, tasks: &BTreeSet<u32>) -> Vec<String> {
        let first = [
            self.cores(),
            // A task whose node is lost goes back into the queue.
            "--requeue".to_owned(),
            self.output("%A_%a"),
        ];
        self.options(first, [format!("--array={}", ranges(tasks))])
    }

    /// Options of the job that collects once all tasks of the array have ended. It works like a task: what a
    /// study computes of all runs together, a diagnosis above all, may take longer than they did.
    pub(super) fn collecting_options(&self, array: u32) -> Vec<String> {
        let first = [
            self.cores(),
            "--requeue".to_owned(),
            self.output("%j_collect"),
        ];
        self.options(first, [format!("--dependency=afterany:{array}")])
    }

    /// The text of a task of `of`.
    pub(super) fn task(&self, of: u32) -> String {
        let threads = self.submission.threads;
        let rest = format!(
            "--jobs {threads} --resume --shard \"$SLURM_ARRAY_TASK_ID/{of}\" --collect never"
        );
        self.text(&rest)
    }

    /// The text of the collecting job.
    pub(super) fn collecting(&self) -> String {
        let threads = self.submission.threads;
        self.text(&format!("--jobs {threads} --collect only"))
    }

    fn cores(&self) -> String {
        format!("--cpus-per-task={}", self.submission.threads)
    }

    /// The user's options, after those they may override and before fixed ones.
    fn options<const N: usize>(&self, first: [String; N], last: [String; 1]) -> Vec<String> {
        let name = format!("--job-name={}", self.name);
        let users = self.submission.options.iter().cloned();
        let first = first.into_iter().chain(["--open-mode=append".to_owned()]);
        let fixed = ["--parsable".to_owned(), "--ntasks=1".to_owned(), name];
        first.chain(users).chain(fixed).chain(last).collect()
    }

    /// Where a job's words go; a `%` of the path itself is doubled.
    fn output(&self, name: &str) -> String {
        let folder = self.words.to_string_lossy().replace('%', "%%");
        format!("--output={folder}/{name}.log")
    }

    fn text(&self, rest: &str) -> String {
        let Submission {
            program,
            study,
            out,
            ..
        } = self.submission;
        let [program, study, out] = [program, study, out].map(|path| quoted(path.as_os_str()));
        format!("#!/bin/sh\nexec {program} study {study} --out {out} --quiet {rest}\n")
    }
}

/// `text` quoted as a word of the shell.
fn quoted(text: &OsStr) -> String {
    format!("'{}'", text.to_string_lossy().replace('\'', r"'\''"))
}

/// Numbers as `sbatch` takes them: `1-4,7`.
fn ranges(numbers: &BTreeSet<u32>) -> String {
    let mut ranges: Vec<[u32; 2]> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => ranges.push([number, number]),
        }
    }
    let words = ranges.iter().map(|[first, last]| match last - first {
        0 => first.to_string(),
        _ => format!("{first}-{last}"),
    });
    words.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroU32;

    fn submission(folder: &str) -> Submission {
        Submission {
            out: folder.into(),
            resume: false,
            program: "/opt/lug wheel".into(),
            study: "/home/o'neil/study.toml".into(),
            threads: NonZeroU32::new(2).unwrap(),
            tasks: None,
            options: vec!["--partition=short".to_owned(), "--job-name=mine".to_owned()],
        }
    }

    fn script(submission: &Submission) -> Script<'_> {
        Script {
            submission,
            name: "lugwheel-1",
            words: Path::new("/data/50%/slurm"),
        }
    }

    #[test]
    fn neighbours_in_an_array_are_a_range() {
        let ranges_of = |numbers: &[u32]| ranges(&numbers.iter().copied().collect());
        assert_eq!(ranges_of(&[1, 2, 3, 5, 7, 8]), "1-3,5,7-8");
        assert_eq!(ranges_of(&[4]), "4");
    }

    #[test]
    fn a_task_does_its_share_whatever_the_paths_are_called() {
        let submission = submission("/data/50%");
        assert_eq!(
            script(&submission).task(64),
            "#!/bin/sh\nexec '/opt/lug wheel' study '/home/o'\\''neil/study.toml' --out '/data/50%' \
             --quiet --jobs 2 --resume --shard \"$SLURM_ARRAY_TASK_ID/64\" --collect never\n"
        );
    }

    #[test]
    fn the_job_that_collects_has_the_cores_of_a_task() {
        let submission = submission("/data");
        let script = script(&submission);
        let options = script.collecting_options(17);
        assert!(options.contains(&"--cpus-per-task=2".to_owned()));
        assert!(script.collecting().ends_with("--jobs 2 --collect only\n"));
    }

    #[test]
    fn the_users_options_go_before_those_by_which_jobs_are_found_again() {
        let submission = submission("/data/50%");
        let options = script(&submission).collecting_options(17);
        let place = |option: &str| options.iter().position(|o| o == option).unwrap();
        assert!(place("--job-name=mine") < place("--job-name=lugwheel-1"));
        assert!(place("--output=/data/50%%/slurm/%j_collect.log") < place("--partition=short"));
        assert_eq!(options.last().unwrap(), "--dependency=afterany:17");
    }
}
