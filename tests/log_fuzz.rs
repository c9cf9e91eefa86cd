//! Mutilated logs, campaigns and run files: none panics or hangs, none that a careful reader would
//! refuse is taken in silence.
//!
//! `LUGWHEEL_FUZZ_CASES=100000 cargo test --test all log_fuzz` runs longer; `LUGWHEEL_FUZZ_SEED` draws
//! other cases. A failure names the seed and number of its case.

use flate2::Compression;
use flate2::write::GzEncoder;
use lugwheel::dataset::Provenance;
use lugwheel::dataset::csv::Campaign;
use lugwheel::dataset::hdf5::{RunFile, RunFileWriter};
use lugwheel::trace::Trace;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest time that a small file may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// Rows of a sound log.
const ROWS: usize = 60;

fn number(name: &str, default: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(default, |text| text.parse().expect(name))
}

/// Runs `case` as often as asked, each with its own random numbers.
fn fuzz(subject: &str, share: u64, mut case: impl FnMut(&mut ChaCha8Rng, &Path)) {
    let folder = tempfile::tempdir().unwrap();
    let (cases, seed) = (
        number("LUGWHEEL_FUZZ_CASES", 300) / share,
        number("LUGWHEEL_FUZZ_SEED", 1),
    );
    let mut slowest = Duration::ZERO;
    for number in 0..cases {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| case(&mut rng, folder.path())));
        slowest = slowest.max(start.elapsed());
        assert!(outcome.is_ok(), "{subject}: seed {seed}, case {number}");
        assert!(slowest < PATIENCE, "{subject}: seed {seed}, case {number}");
    }
    println!(
        "{subject}: {cases} cases, the slowest {} ms",
        slowest.as_millis()
    );
}

/// How a log is written.
#[derive(Debug, Clone, Copy)]
struct Style {
    delimiter: char,
    comma: bool,
    units: bool,
    behind_hash: bool,
    gzip: bool,
}

impl Style {
    fn drawn(rng: &mut ChaCha8Rng) -> Self {
        let delimiter = *[',', ';', '\t', ' '].choose(rng).unwrap();
        let behind_hash = rng.random_bool(0.2);
        Self {
            delimiter,
            comma: delimiter != ',' && rng.random_bool(0.4),
            units: !behind_hash && rng.random_bool(0.3),
            behind_hash,
            gzip: rng.random_bool(0.2),
        }
    }

    fn line(&self, cells: &[String]) -> String {
        cells.join(&self.delimiter.to_string())
    }

    fn campaign(&self, more: &str) -> String {
        let delimiter = match self.delimiter {
            '\t' => "\\t".to_owned(),
            c => c.to_string(),
        };
        format!(
            "version = 1\n[[run]]\nfile = \"a.csv\"\ndelimiter = \"{delimiter}\"\n{more}\
             columns = {{ time_s = \"t\", drawbar_pull = \"F\", sinkage = \"z\" }}\n"
        )
    }
}

/// A log as rows of cells, the names first.
fn sound(style: Style) -> Vec<Vec<String>> {
    let cell = |value: f64| {
        let text = format!("{value:.4}");
        if style.comma {
            text.replace('.', ",")
        } else {
            text
        }
    };
    let row = |i: usize| {
        let time = 0.02 * i as f64;
        [time, 10.0 + (3.0 * time).sin(), 0.01 * time, 5.5]
            .map(cell)
            .to_vec()
    };
    let names = ["t", "F", "z", "other"].map(str::to_owned).to_vec();
    std::iter::once(names).chain((0..ROWS).map(row)).collect()
}

fn written(style: Style, rows: &[Vec<String>]) -> Vec<u8> {
    let mut lines: Vec<String> = rows.iter().map(|row| style.line(row)).collect();
    if style.behind_hash {
        lines[0].insert_str(0, "# ");
    }
    if style.units {
        lines.insert(1, style.line(&["s", "N", "m", "V"].map(str::to_owned)));
    }
    let text = lines.join("\n") + "\n";
    match style.gzip {
        true => packed(text.as_bytes()),
        false => text.into_bytes(),
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// What an import gave: runs, or a message; and the number of columns with gaps.
struct Outcome {
    read: Result<Vec<Trace>, String>,
    gaps: usize,
}

fn import(folder: &Path, bytes: &[u8], campaign: &str) -> Outcome {
    fs::write(folder.join("a.csv"), bytes).unwrap();
    let path = folder.join("a.toml");
    fs::write(&path, campaign).unwrap();
    let campaign = match Campaign::load(&path) {
        Ok(campaign) => campaign,
        Err(error) => {
            return Outcome {
                read: Err(error.to_string()),
                gaps: 0,
            };
        }
    };
    let runs = campaign.runs().map(|run| {
        run.map(|(_, trace)| trace)
            .map_err(|error| error.to_string())
    });
    let read: Result<Vec<Trace>, String> = runs.collect();
    if let Err(message) = &read {
        // The excerpt of the campaign is the user's own text.
        let first = message.lines().next().unwrap();
        assert!(
            !first.chars().any(|c| c.is_control() && c != '\t'),
            "{first:?}"
        );
        assert!(first.chars().count() < 2_000, "{first}");
    }
    for trace in read.iter().flatten() {
        for channel in &trace.channels {
            assert!(channel.sample_rate > 0.0 && channel.sample_rate.is_finite());
            assert!(channel.start.is_finite() && channel.samples.len() <= 100 * bytes.len() + 100);
        }
    }
    Outcome {
        read,
        gaps: campaign.gaps().len(),
    }
}

/// A change after which a log must be refused.
type Spoil = fn(&mut Vec<Vec<String>>, &mut ChaCha8Rng);

fn inner(rng: &mut ChaCha8Rng) -> usize {
    rng.random_range(3..ROWS - 2)
}

const REFUSED: [(&str, Spoil); 10] = [
    ("a separator dropped", |rows, rng| {
        let row = inner(rng);
        let cell = rows[row].remove(1);
        rows[row][0] += &cell;
    }),
    ("two rows swapped", |rows, rng| {
        let row = inner(rng);
        rows.swap(row, row + 1);
    }),
    ("texts in half of a column", |rows, rng| {
        for row in rows.iter_mut().skip(1) {
            if rng.random_bool(0.5) {
                row[1] = "high".to_owned();
            }
        }
        rows[ROWS / 2][1] = "high".to_owned();
    }),
    ("a name twice", |rows, _| rows[0][3] = "F".to_owned()),
    ("a row lost", |rows, rng| drop(rows.remove(inner(rng)))),
    ("a time repeated", |rows, rng| {
        let row = inner(rng);
        rows[row + 1][0] = rows[row][0].clone();
    }),
    ("a time a thousand times too large", |rows, rng| {
        let row = inner(rng);
        let (_, digits) = rows[row][0].split_at(1);
        rows[row][0] = format!("999{digits}");
    }),
    ("the last row cut off behind a cell", |rows, _| {
        rows[ROWS].truncate(2)
    }),
    ("a quote that does not close", |rows, rng| {
        let row = inner(rng);
        rows[row][3].insert(0, '"');
    }),
    ("a time missing", |rows, rng| {
        let row = inner(rng);
        rows[row][0] = "nan".to_owned();
    }),
];

#[test]
fn a_log_that_a_careful_reader_refuses_is_refused() {
    fuzz("spoilt logs", 3, |rng, folder| {
        let style = Style::drawn(rng);
        let campaign = style.campaign("");
        let mut rows = sound(style);
        let whole = import(folder, &written(style, &rows), &campaign);
        let read = whole
            .read
            .unwrap_or_else(|error| panic!("{style:?}: {error}"));
        assert_eq!(
            (read.len(), read[0].channels[0].samples.len(), whole.gaps),
            (1, ROWS, 0)
        );
        let (name, spoil) = *REFUSED.choose(rng).unwrap();
        spoil(&mut rows, rng);
        let bytes = written(style, &rows);
        let outcome = import(folder, &bytes, &campaign);
        assert!(outcome.read.is_err(), "{name}, {style:?}");
    });
}

#[test]
fn a_log_with_an_empty_cell_or_uneven_times_is_taken_with_a_note_only() {
    fuzz("doubtful logs", 6, |rng, folder| {
        let style = Style::drawn(rng);
        let mut rows = sound(style);
        let row = inner(rng);
        if rng.random_bool(0.5) {
            rows[row][1] = (*["nan", "-", "inf"].choose(rng).unwrap()).to_owned();
            let outcome = import(folder, &written(style, &rows), &style.campaign(""));
            assert!(outcome.read.is_ok() && outcome.gaps == 1, "{style:?}");
        } else {
            rows.drain(row..(row + 3).min(ROWS));
            let campaign = style.campaign("resample_hz = 50\n");
            let outcome = import(folder, &written(style, &rows), &campaign);
            let notes = &outcome.read.unwrap()[0].attributes.import_notes;
            assert!(
                notes.iter().any(|note| note.contains("left empty in gaps")),
                "{notes:?}"
            );
        }
        let whole = packed(&written(
            Style {
                gzip: false,
                ..style
            },
            &sound(style),
        ));
        let cut = rng.random_range(3..whole.len());
        let outcome = import(folder, &whole[..cut], &style.campaign(""));
        assert!(
            outcome.read.is_err(),
            "gzip cut at {cut} of {}",
            whole.len()
        );
    });
}

fn mutilated(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>) {
    const ODD: &[u8] = b"\0\n\r\t ,;#\"'.-+eENa0193{}[]=:\xff\xfe\x1f\x8b\xef\xbb\xbf";
    for _ in 0..rng.random_range(1..8) {
        if bytes.is_empty() {
            return;
        }
        let place = rng.random_range(0..bytes.len());
        let end = (place + rng.random_range(1..40)).min(bytes.len());
        match rng.random_range(0..6) {
            0 => bytes[place] = rng.random(),
            1 => bytes[place] = *ODD.choose(rng).unwrap(),
            2 => bytes.insert(place, *ODD.choose(rng).unwrap()),
            3 => drop(bytes.drain(place..end)),
            4 => {
                let copy = bytes[place..end].to_vec();
                let other = rng.random_range(0..bytes.len());
                drop(bytes.splice(other..other, copy));
            }
            _ => bytes.truncate(place.max(1)),
        }
    }
}

#[test]
fn any_bytes_of_logs_and_campaigns_are_runs_or_a_reason() {
    const KEYS: [&str; 8] = [
        "",
        "resample_hz = 30\n",
        "skip_lines = 2\n",
        "header_rows = 2\n",
        "decimal = \",\"\n",
        "names = [\"t\", \"F\", \"z\", \"other\"]\n",
        "rows = { F = { min = 9.5 } }\n",
        "encoding = \"utf-16le\"\n",
    ];
    fuzz("mutilated logs and campaigns", 3, |rng, folder| {
        let style = Style::drawn(rng);
        let mut bytes = written(style, &sound(style));
        let mut campaign = style.campaign(KEYS.choose(rng).unwrap()).into_bytes();
        if rng.random_bool(0.7) {
            mutilated(rng, &mut bytes);
        }
        if rng.random_bool(0.4) {
            mutilated(rng, &mut campaign);
        }
        let campaign = String::from_utf8_lossy(&campaign).into_owned();
        import(folder, &bytes, &campaign);
    });
}

/// Places in a run file beside its heaps of texts: HDF5 1.10 never ends reading one whose free space
/// is said to have no size.
fn outside_heaps(bytes: &[u8]) -> Vec<usize> {
    const SIZE: usize = 4096;
    let is_heap = |place: &usize| bytes[*place..].starts_with(b"GCOL");
    let heaps: Vec<usize> = (0..bytes.len()).filter(is_heap).collect();
    assert!(!heaps.is_empty(), "texts lie in heaps");
    let in_heap = |place: usize| {
        heaps
            .iter()
            .any(|heap| (*heap..heap + SIZE).contains(&place))
    };
    (0..bytes.len()).filter(|&place| !in_heap(place)).collect()
}

#[test]
fn any_bytes_of_a_run_file_are_runs_or_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let style = Style {
        delimiter: ',',
        comma: false,
        units: false,
        behind_hash: false,
        gzip: false,
    };
    let sound = import(
        folder.path(),
        &written(style, &sound(style)),
        &style.campaign(""),
    );
    let path = folder.path().join("sound.h5");
    let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
    writer.add("run", &sound.read.unwrap()[0]).unwrap();
    writer.finish().unwrap();
    let whole = fs::read(&path).unwrap();
    let sound = outside_heaps(&whole);
    fuzz("damaged run files", 6, |rng, folder| {
        let mut bytes = whole.clone();
        match rng.random_bool(0.3) {
            true => bytes.truncate(rng.random_range(0..whole.len())),
            false => {
                for _ in 0..rng.random_range(1..6) {
                    bytes[*sound.choose(rng).unwrap()] = rng.random();
                }
            }
        }
        let path = folder.join("a.h5");
        fs::write(&path, &bytes).unwrap();
        if let Ok(file) = RunFile::open(&path) {
            for id in file.runs() {
                let _ = file.read(id);
            }
        }
    });
}
