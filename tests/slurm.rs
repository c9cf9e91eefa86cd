//! A cluster changes where a study is computed, and no byte of its results: first on a queue in
//! this process, then on a real Slurm that the tests start and damage.

use crate::common::results::contents;
use lugwheel::study::slurm::{Job, JobState, News, Queue, SlurmError, Submission, TRIES};
use lugwheel::study::{Options, Study, StudyError};
use std::cell::{Cell, RefCell};
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_lugwheel");

/// A study of twelve runs of this length [s] on flat stone and sand, each a shard.
fn study_file(folder: &Path, duration: f64) -> PathBuf {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let file = folder.join("study.toml");
    let text = format!(
        "version = 1\nseed = 7\nrepeats = 2\nrandom_numbers = \"independent\"\n\
         scenarios = [\"{scenarios}/single_wheel_ref.toml\", \"{scenarios}/single_wheel_st.toml\"]\n\
         [set]\nduration = {duration:?}\nphysics_rate = 4000\nrig.single_wheel.start_up = 0.02\n\
         [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.0, 0.1, 0.3]\n\
         [recognition]\n"
    );
    fs::write(&file, text).unwrap();
    file
}

fn short() -> (TempDir, Study) {
    let folder = tempfile::tempdir().unwrap();
    let study = Study::load(study_file(folder.path(), 0.15)).unwrap();
    (folder, study)
}

fn share(out: &Path, share: Option<(u32, u32)>) -> Options {
    Options {
        out: out.to_owned(),
        jobs: NonZeroUsize::new(1),
        resume: true,
        shard: share,
    }
}

/// What a local execution of the short study leaves.
static LOCAL: LazyLock<Vec<(PathBuf, Vec<u8>)>> = LazyLock::new(|| {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let outcome = study.execute(&share(&out, None), &|_| ControlFlow::Continue(()));
    assert_eq!(outcome.unwrap().runs, 12);
    contents(&out)
});

/// A queue that does a task between two looks at it.
struct InProcess<'s> {
    study: &'s Study,
    out: PathBuf,
    /// Numbers and states of the tasks of every job, and the tasks of its array.
    jobs: RefCell<Vec<(u32, u32, JobState)>>,
    /// Into how many the study is divided, by the text of the jobs.
    tasks: Cell<u32>,
    arrays: RefCell<Vec<String>>,
    /// How a task ends on a try, from 0, without having done its share.
    fate: fn(u32, usize) -> Option<JobState>,
    /// How many looks are answered before one is not.
    silent_after: Cell<u32>,
}

impl<'s> InProcess<'s> {
    fn new(study: &'s Study, out: &Path) -> Self {
        Self {
            study,
            out: out.to_owned(),
            jobs: RefCell::default(),
            tasks: Cell::new(0),
            arrays: RefCell::default(),
            fate: |_, _| None,
            silent_after: Cell::new(u32::MAX),
        }
    }

    fn work(&self, task: u32) -> JobState {
        if let Some(end) = (self.fate)(task, self.arrays.borrow().len() - 1) {
            return end;
        }
        let options = share(&self.out, Some((task, self.tasks.get())));
        let done = self
            .study
            .execute_share(&options, &|_| ControlFlow::Continue(()));
        done.unwrap();
        JobState::Ended("COMPLETED".to_owned())
    }
}

/// The value of an option.
fn value<'o>(options: &'o [String], name: &str) -> Option<&'o str> {
    let lead = format!("--{name}=");
    options
        .iter()
        .rev()
        .find_map(|option| option.strip_prefix(&lead))
}

fn numbers(ranges: &str) -> Vec<u32> {
    let ranges = ranges.split(',').map(|range| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        first.parse().unwrap()..=last.parse().unwrap()
    });
    ranges.flatten().collect()
}

impl Queue for InProcess<'_> {
    fn submit(&self, options: &[String], script: &str) -> Result<u32, SlurmError> {
        let mut jobs = self.jobs.borrow_mut();
        let number = jobs
            .iter()
            .map(|(number, ..)| number + 1)
            .max()
            .unwrap_or(1);
        let waiting = |task| (number, task, JobState::Waiting("Resources".to_owned()));
        match value(options, "array") {
            Some(array) => {
                let of = script.split("$SLURM_ARRAY_TASK_ID/").nth(1).unwrap();
                self.tasks
                    .set(of.split('"').next().unwrap().parse().unwrap());
                self.arrays.borrow_mut().push(array.to_owned());
                jobs.extend(numbers(array).into_iter().map(waiting));
            }
            None => {
                assert!(script.ends_with("--collect only\n"), "{script}");
                let after: u32 = value(options, "dependency").unwrap()["afterany:".len()..]
                    .parse()
                    .unwrap();
                assert_eq!(after, number - 1);
                jobs.push(waiting(0));
            }
        }
        Ok(number)
    }

    fn jobs(&self, _: &str) -> Result<Vec<Job>, SlurmError> {
        let left = self.silent_after.get();
        self.silent_after.set(left.wrapping_sub(1));
        if left == 0 {
            return Err(SlurmError::Refused {
                program: "squeue",
                reason: "Unable to contact slurm controller".to_owned(),
            });
        }
        let mut jobs = self.jobs.borrow_mut();
        let answer = jobs.iter().map(|(number, task, state)| Job {
            number: *number,
            is_task: *task > 0,
            state: state.clone(),
        });
        let answer = answer.collect();
        let waits = |state: &JobState| matches!(state, JobState::Waiting(_));
        if let Some((_, task, state)) = jobs.iter_mut().find(|(.., state)| waits(state)) {
            *state = match task {
                0 => JobState::Ended("COMPLETED".to_owned()),
                task => self.work(*task),
            };
        }
        Ok(answer)
    }

    fn largest_task(&self) -> Result<u32, SlurmError> {
        Ok(5)
    }
}

fn submission(out: &Path) -> Submission {
    Submission {
        out: out.to_owned(),
        resume: false,
        program: PROGRAM.into(),
        study: "study.toml".into(),
        threads: 1.try_into().unwrap(),
        tasks: None,
        options: Vec::new(),
    }
}

/// Follows to the end; what was heard, and how it ended.
fn follow(queue: &InProcess, submission: &Submission) -> (Vec<News>, Result<(), StudyError>) {
    let mut heard = Vec::new();
    let end = queue.study.execute_on(queue, submission, &mut |news| {
        heard.push(news);
        ControlFlow::Continue(())
    });
    (heard, end)
}

fn collected(study: &Study, out: &Path) {
    let options = Options {
        out: out.to_owned(),
        jobs: None,
        resume: false,
        shard: None,
    };
    study
        .collect(&options, &|_| ControlFlow::Continue(()))
        .unwrap();
    assert!(contents(out) == *LOCAL, "other bytes than a local run");
}

#[test]
fn a_study_on_a_cluster_leaves_the_bytes_of_a_local_run_in_an_array_the_cluster_allows() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let queue = InProcess::new(&study, &out);
    let (heard, end) = follow(&queue, &submission(&out));
    end.unwrap();
    assert_eq!(*queue.arrays.borrow(), ["1-5"]);
    let standings = heard.iter().filter_map(|news| match news {
        News::Standing(standing) => Some(standing.done),
        _ => None,
    });
    // Twelve shards in five tasks: three, three, two, two, two.
    assert_eq!(standings.collect::<Vec<_>>(), [3, 6, 8, 10, 12, 12]);
    collected(&study, &out);
}

#[test]
fn only_tasks_that_left_shards_undone_are_submitted_again_and_said_how_they_ended() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let mut queue = InProcess::new(&study, &out);
    queue.fate = |task, tried| match (task, tried) {
        (2 | 4, 0) => Some(JobState::Ended("TIMEOUT".to_owned())),
        (4, 1) => Some(JobState::Ended("NODE_FAIL".to_owned())),
        _ => None,
    };
    let (heard, end) = follow(&queue, &submission(&out));
    end.unwrap();
    assert_eq!(*queue.arrays.borrow(), ["1-5", "2,4", "4"]);
    let again = heard.iter().filter_map(|news| match news {
        News::Again { missing, ended } => Some((*missing, ended.clone())),
        _ => None,
    });
    let again: Vec<_> = again.collect();
    assert_eq!((again[0].0, again[1].0), (5, 2));
    assert_eq!(again[0].1["TIMEOUT"], 2);
    assert_eq!(again[1].1["NODE_FAIL"], 1);
    collected(&study, &out);
}

#[test]
fn a_task_that_fails_at_every_try_ends_the_study_with_its_last_words() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let mut queue = InProcess::new(&study, &out);
    queue.fate = |task, _| (task == 3).then(|| JobState::Ended("FAILED".to_owned()));
    let (_, end) = follow(&queue, &submission(&out));
    assert_eq!(queue.arrays.borrow().len(), TRIES as usize);
    let message = end.unwrap_err().to_string();
    let start =
        "2 shards of runs are not whole after 3 tries of their tasks; no task wrote a log in";
    assert!(message.starts_with(start), "{message}");
    // Another three arrays, the last of them as job 11.
    fs::write(out.join("slurm/11_3.log"), "one\ntwo\n\nthree\nfour\n").unwrap();
    let resumed = Submission {
        resume: true,
        ..submission(&out)
    };
    let message = follow(&queue, &resumed).1.unwrap_err().to_string();
    let end = "slurm/11_3.log reads:\n  two\n  three\n  four";
    assert!(message.ends_with(end), "{message}");
}

#[test]
fn one_who_left_and_comes_back_submits_nothing_twice() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let queue = InProcess::new(&study, &out);
    let mut looks = 0;
    let left = study.execute_on(&queue, &submission(&out), &mut |news| {
        looks += u32::from(matches!(news, News::Standing(_)));
        if looks == 2 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    let message = left.unwrap_err().to_string();
    assert!(
        message.contains("the same command with --resume follows"),
        "{message}"
    );
    let (_, again) = follow(&queue, &submission(&out));
    assert!(matches!(again, Err(StudyError::NotEmpty { .. })));
    let resumed = Submission {
        resume: true,
        ..submission(&out)
    };
    follow(&queue, &resumed).1.unwrap();
    assert_eq!(*queue.arrays.borrow(), ["1-5"]);
    collected(&study, &out);
}

#[test]
fn what_somebody_cancelled_is_submitted_again_only_when_asked_for() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let mut queue = InProcess::new(&study, &out);
    queue.fate = |task, tried| (task > 3 && tried == 0).then_some(JobState::Cancelled);
    let message = follow(&queue, &submission(&out)).1.unwrap_err().to_string();
    let told = "jobs were cancelled before 4 shards of runs were whole; --resume submits the rest";
    assert_eq!(message, told);
    let resumed = Submission {
        resume: true,
        ..submission(&out)
    };
    follow(&queue, &resumed).1.unwrap();
    assert_eq!(*queue.arrays.borrow(), ["1-5", "4-5"]);
    collected(&study, &out);
}

#[test]
fn a_controller_that_is_silent_for_a_while_is_asked_again() {
    let (folder, study) = short();
    let out = folder.path().join("out");
    let queue = InProcess::new(&study, &out);
    queue.silent_after.set(3);
    let (heard, end) = follow(&queue, &submission(&out));
    end.unwrap();
    let silences = heard.iter().filter(|news| matches!(news, News::Silence(_)));
    assert_eq!(silences.count(), 1);
    assert_eq!(queue.arrays.borrow().len(), 1);
    collected(&study, &out);
}

#[test]
fn without_slurm_the_study_says_so_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    study_file(folder.path(), 0.15);
    let mut command = Command::new(PROGRAM);
    command.args(["study", "study.toml", "--out", "out", "--slurm"]);
    let output = command
        .env("PATH", "")
        .current_dir(folder.path())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    let told = "cannot start scontrol: No such file or directory (os error 2); submit from a \
                machine of the cluster, or omit --slurm";
    assert!(errors.contains(told), "{errors}");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 0);
}

/// A real cluster of one node, for one test at a time, with a study to run on it.
struct Cluster {
    folder: TempDir,
    _alone: MutexGuard<'static, ()>,
}

static ALONE: Mutex<()> = Mutex::new(());

impl Cluster {
    /// With runs of this length [s].
    fn start(duration: f64) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("cluster")).unwrap();
        study_file(folder.path(), duration);
        let cluster = Self {
            folder,
            _alone: alone,
        };
        cluster.is("start");
        cluster
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn script(&self, command: &str) -> Output {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/slurm/cluster.sh");
        let mut shell = Command::new(script);
        shell.arg(command).arg(self.at("cluster"));
        // Daemons would keep pipes open for ever.
        let words = fs::File::create(self.at("words")).unwrap();
        shell.stdout(Stdio::null()).stderr(words);
        shell.output().unwrap()
    }

    /// Has `cluster.sh` do something to the cluster.
    fn is(&self, command: &str) {
        let output = self.script(command);
        let words = fs::read_to_string(self.at("words")).unwrap();
        assert!(output.status.success(), "cluster.sh {command}: {words}");
    }

    /// `study study.toml --slurm` with these words, started.
    fn study(&self, words: &str) -> Child {
        let mut command = self.slurm(PROGRAM);
        command.args(["study", "study.toml", "--out", "out", "--slurm"]);
        command.args(words.split_whitespace());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// A program that finds this cluster.
    fn slurm(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.at("cluster/slurm.conf"));
        command.current_dir(self.folder.path());
        command
    }

    /// Arrays of jobs that Slurm remembers.
    fn arrays(&self) -> Vec<String> {
        let mut squeue = self.slurm("squeue");
        squeue.args(["--noheader", "--states=all", "--format=%F %K"]);
        let said = String::from_utf8(squeue.output().unwrap().stdout).unwrap();
        let arrays = said.lines().filter(|line| !line.contains("N/A"));
        let mut arrays: Vec<String> = arrays
            .filter_map(|line| Some(line.split_once(' ')?.0.to_owned()))
            .collect();
        arrays.sort();
        arrays.dedup();
        arrays
    }

    fn shards(&self) -> usize {
        let entries = fs::read_dir(self.at("out/shards")).into_iter().flatten();
        let names = entries.map(|entry| entry.unwrap().file_name());
        names
            .filter(|name| name.to_string_lossy().ends_with(".windows.csv"))
            .count()
    }

    /// Waits until some shards are there and others are not.
    fn until_under_way(&self) {
        let begun = Instant::now();
        while self.shards() < 2 {
            assert!(begun.elapsed() < PATIENCE, "no shard is done");
            thread::sleep(Duration::from_millis(20));
        }
        assert!(self.shards() < 12, "the study is too short for this test");
    }

    /// Asserts that the folder holds what a local execution leaves.
    fn is_as_local(&self) {
        let mut command = Command::new(PROGRAM);
        command.args(["study", "study.toml", "--out", "local"]);
        let output = command.current_dir(self.folder.path()).output().unwrap();
        assert!(output.status.success());
        assert!(
            contents(&self.at("out")) == contents(&self.at("local")),
            "other bytes than a local run"
        );
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        self.script("stop");
    }
}

/// Longest wait for anything a cluster does.
const PATIENCE: Duration = Duration::from_secs(600);

/// The end of a program: exit code, result, words.
fn end(mut child: Child) -> (Option<i32>, String, String) {
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > PATIENCE {
            child.kill().unwrap();
            let output = child.wait_with_output().unwrap();
            panic!("no end: {}", String::from_utf8_lossy(&output.stderr));
        }
        thread::sleep(Duration::from_millis(50));
    }
    let output = child.wait_with_output().unwrap();
    let [result, words] = [output.stdout, output.stderr].map(|b| String::from_utf8(b).unwrap());
    (output.status.code(), result, words)
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn slurm_runs_a_whole_study_to_the_bytes_of_a_local_run_figures_included() {
    let cluster = Cluster::start(0.15);
    let options = "--slurm-tasks 5 --slurm-option=--time=10 --slurm-option=--comment=a_test";
    let (code, result, words) = end(cluster.study(options));
    assert_eq!(code, Some(0), "{words}");
    assert!(
        words.starts_with("submitted: 5 tasks as job 1 and a collecting job"),
        "{words}"
    );
    assert_eq!(words.lines().count(), 1, "{words}");
    assert!(result.contains("12 runs, 0 failed"), "{result}");
    assert_eq!(cluster.arrays(), ["1"]);
    cluster.is_as_local();
    // The collecting job did it first.
    let word = fs::read_to_string(cluster.at("out/slurm/2_collect.log")).unwrap();
    assert!(word.contains("12 runs, 0 failed"), "{word}");
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn node_and_controller_may_be_lost_midway_and_nothing_else_is() {
    let cluster = Cluster::start(3.0);
    let child = cluster.study("--slurm-tasks 4");
    cluster.until_under_way();
    cluster.is("crash-node");
    let kept = cluster.shards();
    cluster.is("crash-controller");
    thread::sleep(Duration::from_secs(3));
    cluster.is("controller");
    cluster.is("node");
    assert!((2..12).contains(&kept), "{kept} shards");
    // Slurm holds back what it puts into the queue again for two minutes.
    cluster.is("hasten");
    let (code, _, words) = end(child);
    assert_eq!(code, Some(0), "{words}");
    assert_eq!(cluster.arrays(), ["1"], "Slurm itself tried again");
    cluster.is_as_local();
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn a_task_that_dies_is_tried_again() {
    let cluster = Cluster::start(3.0);
    let child = cluster.study("--slurm-tasks 3");
    cluster.until_under_way();
    cluster.is("crash-task");
    let (code, _, words) = end(child);
    assert_eq!(code, Some(0), "{words}");
    assert!(
        words.contains("1 tasks FAILED; their tasks are tried again, 3 times at most"),
        "{words}"
    );
    assert_eq!(cluster.arrays().len(), 2);
    cluster.is_as_local();
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn a_shard_that_can_never_be_written_ends_the_study_after_three_tries() {
    let cluster = Cluster::start(0.15);
    fs::create_dir_all(cluster.at("out/shards/00003.runs.csv/x")).unwrap();
    let mut local = Command::new(PROGRAM);
    local.current_dir(cluster.folder.path());
    local.args(["study", "study.toml", "--out", "other", "--shard", "1/12"]);
    assert!(local.output().unwrap().status.success());
    fs::copy(cluster.at("other/origin.txt"), cluster.at("out/origin.txt")).unwrap();
    let (code, _, words) = end(cluster.study("--resume --slurm-tasks 4"));
    assert_eq!(code, Some(1), "{words}");
    assert!(
        words.contains("3 shards of runs are not whole after 3 tries"),
        "{words}"
    );
    assert!(
        words.contains("00003.runs.csv") && words.contains("it is a folder"),
        "{words}"
    );
    assert_eq!(cluster.arrays().len(), TRIES as usize);
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn ctrl_c_leaves_the_jobs_running_and_resume_follows_them() {
    let cluster = Cluster::start(3.0);
    let child = cluster.study("--slurm-tasks 4");
    cluster.until_under_way();
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let (code, _, words) = end(child);
    assert_eq!(code, Some(130), "{words}");
    assert!(words.contains("interrupted; the jobs go on"), "{words}");
    let (code, result, words) = end(cluster.study("--slurm-tasks 4 --resume"));
    assert_eq!((code, words.as_str()), (Some(0), ""));
    assert!(result.contains("12 runs, 0 failed"), "{result}");
    assert_eq!(cluster.arrays(), ["1"]);
    cluster.is_as_local();
}

#[test]
#[ignore = "starts Slurm (apt-get install slurm-wlm munge): cargo test --test all slurm:: -- --ignored"]
fn an_option_that_slurm_refuses_is_told_in_its_words() {
    let cluster = Cluster::start(0.15);
    let (code, _, words) = end(cluster.study("--slurm-option=--partition=none"));
    assert_eq!(code, Some(1));
    assert!(
        words.contains("sbatch: ") && words.contains("invalid partition"),
        "{words}"
    );
}
