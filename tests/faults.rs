//! What may befall a study - killed, no room, damaged files, a wrong clock - costs time, and no
//! byte of its results.

use crate::common::results::contents;
use lugwheel::quantity::Seed;
use rand::RngExt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant, SystemTime};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_lugwheel");

/// Thirty-two runs of 0.1 s, each a shard, at a rate that is good enough for bookkeeping.
fn study_file(folder: &Path) -> PathBuf {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let file = folder.join("study.toml");
    let text = format!(
        "version = 1\nseed = 7\nrepeats = 4\nrandom_numbers = \"independent\"\n\
         scenarios = [\"{scenarios}/single_wheel_ref.toml\", \"{scenarios}/single_wheel_st.toml\"]\n\
         [set]\nduration = 0.1\nphysics_rate = 4000\nrig.single_wheel.start_up = 0.02\n\
         [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.0, 0.1, 0.2, 0.3]\n"
    );
    fs::write(&file, text).unwrap();
    file
}

/// `study study.toml --out out` in `folder`, with more words.
fn study(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(["study", "study.toml"]);
    command.args(["--out", "out", "--jobs", "2"]);
    command.args(words.split_whitespace());
    command
}

fn done(output: &Output) {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*errors), (Some(0), ""));
}

/// The words of a study that stopped with this exit code.
fn stopped(output: &Output, code: i32) -> String {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{errors}");
    errors
}

fn new_folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    study_file(folder.path());
    folder
}

/// The folder of a study that nothing befell.
static UNTOUCHED: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = new_folder();
    done(&study(folder.path(), "").output().unwrap());
    folder
});

/// Asserts that `out` holds what the study leaves that nothing befell.
fn is_as_untouched(out: &Path) {
    let expected = contents(&UNTOUCHED.path().join("out"));
    let found = contents(out);
    let names = |files: &[(PathBuf, Vec<u8>)]| -> Vec<PathBuf> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(&found), names(&expected));
    for (found, expected) in found.iter().zip(&expected) {
        assert!(found == expected, "{} differs", found.0.display());
    }
}

/// A copy of the folder of the untouched study.
fn copy() -> TempDir {
    let folder = new_folder();
    let source = UNTOUCHED.path().join("out");
    let mut command = Command::new("cp");
    let copied = command.arg("-r").arg(source).arg(folder.path()).status();
    assert!(copied.unwrap().success());
    folder
}

/// Shards whose table of runs is there.
fn shards(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out.join("shards")).into_iter().flatten();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_rows = |path: &PathBuf| path.to_string_lossy().ends_with(".runs.csv");
    let mut found: Vec<PathBuf> = paths.filter(is_rows).collect();
    found.sort();
    found
}

#[test]
fn a_study_killed_at_ten_moments_and_resumed_leaves_the_bytes_of_one_that_was_not() {
    let folder = new_folder();
    let out = folder.path().join("out");
    let mut rng = Seed(10).rng("kill", 0);
    // Ten numbers of shards at which the process dies, a little later.
    let mut moments: Vec<usize> = (0..10).map(|_| rng.random_range(0..28)).collect();
    moments.sort_unstable();
    for moment in moments {
        let mut child = study(folder.path(), "--resume")
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while shards(&out).len() < moment {
            assert!(begun.elapsed() < Duration::from_secs(60), "no progress");
        }
        thread::sleep(Duration::from_micros(rng.random_range(0..20_000)));
        child.kill().unwrap();
        let status = child.wait().unwrap();
        assert_eq!(status.code(), None, "killed, not finished");
    }
    assert!(!out.join("runs.csv").exists());
    done(&study(folder.path(), "--resume").output().unwrap());
    is_as_untouched(&out);
}

#[test]
fn parts_of_killed_processes_are_removed_when_the_study_is_whole() {
    let folder = copy();
    let out = folder.path().join("out");
    for place in ["", "shards/", "scenarios/"] {
        let part = format!("out/{place}.lugwheel-a.part");
        fs::write(folder.path().join(part), "half a li").unwrap();
    }
    done(&study(folder.path(), "--resume").output().unwrap());
    is_as_untouched(&out);
}

#[test]
fn shards_with_any_damage_are_found_and_done_again() {
    let folder = copy();
    let out = folder.path().join("out");
    let files = shards(&out);
    let mut rng = Seed(11).rng("damage", 0);
    for file in &files[..12] {
        let mut bytes = fs::read(file).unwrap();
        let at = rng.random_range(0..bytes.len());
        bytes[at] ^= 1 << rng.random_range(0..8);
        fs::write(file, bytes).unwrap();
    }
    for file in &files[12..18] {
        let bytes = fs::read(file).unwrap();
        let length = rng.random_range(0..bytes.len());
        fs::write(file, &bytes[..length]).unwrap();
    }
    fs::copy(&files[20], &files[21]).unwrap();
    fs::write(&files[22], [0xff; 700]).unwrap();
    let errors = stopped(&study(folder.path(), "--collect only").output().unwrap(), 1);
    assert!(
        errors.ends_with("20 shards of runs in out are missing or damaged; --resume does them\n"),
        "{errors}"
    );
    done(&study(folder.path(), "--resume").output().unwrap());
    is_as_untouched(&out);
}

#[test]
fn shares_that_leave_the_collecting_to_another_write_no_table() {
    let folder = new_folder();
    let out = folder.path().join("out");
    for share in ["1/2", "2/2"] {
        let words = format!("--shard {share} --collect never");
        done(&study(folder.path(), &words).output().unwrap());
        assert!(!out.join("runs.csv").exists());
    }
    done(&study(folder.path(), "--collect only").output().unwrap());
    is_as_untouched(&out);
}

#[test]
fn no_result_depends_on_the_times_of_files() {
    let folder = copy();
    let out = folder.path().join("out");
    let mut kept = Vec::new();
    for (index, path) in shards(&out).into_iter().enumerate() {
        let century = Duration::from_secs(3_155_760_000);
        let now = SystemTime::now();
        let odd = [SystemTime::UNIX_EPOCH, now + century, now][index % 3];
        let file = File::options().append(true).open(&path).unwrap();
        file.set_modified(odd).unwrap();
        kept.push((path, odd));
    }
    let (lost, _) = kept.swap_remove(5);
    fs::remove_file(lost).unwrap();
    done(&study(folder.path(), "--resume").output().unwrap());
    is_as_untouched(&out);
    for (path, time) in kept {
        let now = fs::metadata(&path).unwrap().modified().unwrap();
        assert_eq!(now, time, "{} was done again", path.display());
    }
}

#[test]
fn a_limit_that_a_table_exceeds_stops_the_study_and_nothing_is_lost() {
    let folder = new_folder();
    let out = folder.path().join("out");
    // 4 KiB, in blocks of 512 bytes: room for a shard, not for the table.
    let line = "ulimit -f 8; trap '' XFSZ; exec \"$@\"";
    let mut shell = Command::new("sh");
    shell.args([
        "-c",
        line,
        "sh",
        PROGRAM,
        "study",
        "study.toml",
        "--out",
        "out",
    ]);
    let errors = stopped(&shell.current_dir(folder.path()).output().unwrap(), 1);
    assert!(
        errors.contains("cannot write out/runs.csv: File too large; raise the limit (ulimit -f)"),
        "{errors}"
    );
    assert!(
        errors.contains("what is whole stays, and --resume goes on"),
        "{errors}"
    );
    assert_eq!(shards(&out).len(), 32);
    done(&study(folder.path(), "--resume").output().unwrap());
    is_as_untouched(&out);
}

#[test]
fn a_folder_that_cannot_be_made_is_told_before_any_run() {
    let folder = new_folder();
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder.path());
    command.args(["study", "study.toml", "--out", "/proc/none/out"]);
    let errors = stopped(&command.output().unwrap(), 1);
    let told = "error: cannot make the folder /proc/none/out: No such file or directory; ";
    assert!(errors.starts_with(told), "{errors}");
}

/// Runs `line` where it may mount: `$1` is the program, the working folder has study.toml.
fn with_mounts(folder: &Path, line: &str) -> Output {
    let mut command = Command::new("unshare");
    command.args(["--map-root-user", "--mount", "sh", "-euc", line, "sh"]);
    command.arg(PROGRAM).current_dir(folder).output().unwrap()
}

#[test]
#[ignore = "mounts a small disk: cargo test --test all faults:: -- --ignored"]
fn a_full_disk_stops_the_study_and_more_room_lets_it_finish() {
    let folder = new_folder();
    // A page a file: 32 shards take a quarter of a mebibyte.
    let line = "mkdir disk && mount -t tmpfs -o size=150k tmpfs disk
                ! \"$1\" study study.toml --out disk/out
                ls disk/out/shards/*.runs.csv | wc -l >kept
                ls -A disk/out disk/out/shards | grep -c part >&2 || true
                mount -o remount,size=8m disk
                \"$1\" study study.toml --out disk/out --resume
                cp -r disk/out out";
    let output = with_mounts(folder.path(), line);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert!(errors.contains("cannot write disk/out/shards/"), "{errors}");
    assert!(errors.contains("No space left on device"), "{errors}");
    assert!(errors.ends_with("\n0\n"), "parts are left: {errors}");
    let kept = fs::read_to_string(folder.path().join("kept")).unwrap();
    let kept: usize = kept.trim().parse().unwrap();
    assert!((5..30).contains(&kept), "{kept} shards");
    is_as_untouched(&folder.path().join("out"));
}

#[test]
#[ignore = "mounts a read-only disk: cargo test --test all faults:: -- --ignored"]
fn a_folder_that_turned_read_only_stops_the_study_and_keeps_its_shards() {
    let folder = copy();
    let line = "mkdir disk && mount -t tmpfs tmpfs disk && cp -r out disk
                rm disk/out/shards/00007.runs.csv disk/out/runs.csv
                mount -o remount,ro disk
                ! \"$1\" study study.toml --out disk/out --resume
                mount -o remount,rw disk
                \"$1\" study study.toml --out disk/out --resume
                rm -r out && cp -r disk/out out";
    let output = with_mounts(folder.path(), line);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert!(
        errors.contains("cannot write in the folder disk/out: Read-only file system"),
        "{errors}"
    );
    is_as_untouched(&folder.path().join("out"));
}

#[test]
#[ignore = "needs Debian's faketime: cargo test --test all faults:: -- --ignored"]
fn a_clock_that_is_wrong_and_runs_at_another_speed_changes_no_byte() {
    for clock in ["@1970-01-02 00:00:00 x50", "+70y x0.1", "-3d i2.0"] {
        let folder = new_folder();
        let mut command = Command::new("faketime");
        command.args(["-f", clock, PROGRAM, "study", "study.toml", "--out", "out"]);
        let output = command.current_dir(folder.path()).output();
        done(&output.expect("faketime runs: apt-get install faketime"));
        is_as_untouched(&folder.path().join("out"));
    }
}
