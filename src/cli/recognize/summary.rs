//! What the windows are, for machines and for people.

use super::Unfit;
use super::figures::Figures;
use crate::dataset::hdf5::RunFile;
use crate::recognition::alignment::{Alignment, LugOffset};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::recognition::known::{Source, known_class};
use crate::recognition::{Method, Recognized, Recognizer};
use crate::table::{Cell, Column, Table};
use crate::terrain::class::Wtic;
use crate::trace::Trace;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// What the windows of a file are.
#[derive(Debug, Serialize)]
pub struct Summary {
    file: String,
    method: Method,
    reference: String,
    windows: Vec<Window>,
    /// Zero of the wheel angle of every run whose pulses keep step with the lugs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    wheel_angle: Vec<RunAlignment>,
    /// Runs without windows, and why.
    skipped: Vec<Skipped>,
    #[serde(flatten)]
    score: Score,
    /// Files drawn.
    pub figures: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Window {
    run: String,
    start_s: f64,
    end_s: f64,
    class: Wtic,
    confidence: f64,
    reason: String,
    p: Option<[f64; 4]>,
    /// The class it is known to have.
    truth: Option<Wtic>,
    /// Where lugs were found to strike.
    #[serde(skip_serializing_if = "Option::is_none")]
    lug_offset: Option<LugOffset>,
}

impl Window {
    /// Its row of the table.
    fn row(&self) -> Vec<Cell> {
        let number = |value: f64| Cell::Written(format!("{value:.2}"), value);
        // 0 has no sign.
        let feature = |p: f64| number((p * 100.0).round() / 100.0 + 0.0);
        let features = self.p.map(|p| p.map(feature));
        let mut cells = vec![
            Cell::text(&self.run),
            number(self.start_s),
            number(self.end_s),
            Cell::text(self.class.as_str()),
            number(self.confidence),
            Cell::text(self.truth.map_or("-", Wtic::as_str)),
        ];
        cells.extend(features.unwrap_or([const { Cell::Missing }; 4]));
        cells.push(Cell::text(&self.reason));
        cells
    }
}

#[derive(Debug, Serialize)]
struct RunAlignment {
    run: String,
    #[serde(flatten)]
    alignment: Alignment,
}

#[derive(Debug, Serialize)]
struct Skipped {
    run: String,
    reason: String,
}

/// Answers counted against known classes, and where those come from.
#[derive(Debug, Default)]
struct Score {
    confusion: Confusion,
    sources: BTreeMap<Source, u64>,
}

impl Summary {
    /// Nothing yet.
    pub fn new(file: &Path, method: Method, reference: String) -> Self {
        Self {
            file: file.display().to_string(),
            method,
            reference,
            windows: Vec::new(),
            wheel_angle: Vec::new(),
            skipped: Vec::new(),
            score: Score::default(),
            figures: Vec::new(),
        }
    }

    /// Recognises a run of `file`. One that cannot be read or recognised is noted with its reason.
    ///
    /// # Errors
    /// Where a figure cannot be written.
    pub fn add(
        &mut self,
        file: &RunFile,
        id: &str,
        recognizer: &mut Recognizer,
        figures: Option<&mut Figures>,
    ) -> anyhow::Result<()> {
        let trace = match file.read(id) {
            Ok(trace) => trace,
            Err(error) => {
                self.skip(id, error);
                return Ok(());
            }
        };
        let windows = match recognizer.recognize(&trace) {
            Ok(windows) => windows,
            Err(error) => {
                self.skip(id, error);
                return Ok(());
            }
        };
        for window in &windows {
            self.count(id, &trace, window);
        }
        self.align(id, &windows);
        figures.map_or(Ok(()), |figures| figures.add(id, &trace, &windows))
    }

    /// Notes the zero of the wheel angle, where pulses keep step with the lugs.
    fn align(&mut self, id: &str, windows: &[Recognized]) {
        let answers = windows.iter().flat_map(|window| &window.answers);
        let offsets: Vec<LugOffset> = answers.filter_map(|answer| answer.offset).collect();
        let run = id.to_owned();
        let alignment = Alignment::of(&offsets);
        self.wheel_angle
            .extend(alignment.map(|alignment| RunAlignment { run, alignment }));
    }

    /// Answers against known classes.
    pub fn confusion(&self) -> &Confusion {
        &self.score.confusion
    }

    /// The error that no run could be recognised, if so.
    pub fn nothing_recognized(&self, path: &Path) -> Option<Unfit> {
        let first = self.skipped.first()?;
        self.windows.is_empty().then(|| Unfit::NoneRecognizable {
            path: path.to_owned(),
            run: first.run.clone(),
            reason: first.reason.clone(),
        })
    }

    fn skip(&mut self, id: &str, reason: impl ToString) {
        self.skipped.push(Skipped {
            run: id.to_owned(),
            reason: reason.to_string(),
        });
    }

    fn count(&mut self, id: &str, trace: &Trace, window: &Recognized) {
        let known = known_class(trace, [window.start, window.end]);
        for answer in &window.answers {
            if let Some(known) = known {
                self.score.confusion.add(known.class, answer.class);
                *self.score.sources.entry(known.source).or_default() += 1;
            }
            self.windows.push(Window {
                run: id.to_owned(),
                start_s: window.start,
                end_s: window.end,
                class: answer.class,
                confidence: answer.confidence,
                reason: answer.reason.clone(),
                p: window.p.as_ref().ok().copied(),
                truth: known.map(|known| known.class),
                lug_offset: answer.offset,
            });
        }
    }

    /// Windows of each class in every run.
    fn per_run(&self) -> Vec<(&str, [usize; 4])> {
        let of_run = |windows: &[Window]| {
            CLASSES.map(|class| windows.iter().filter(|w| w.class == class).count())
        };
        let runs = self.windows.chunk_by(|a, b| a.run == b.run);
        runs.map(|windows| (windows[0].run.as_str(), of_run(windows)))
            .collect()
    }
}

impl Serialize for Score {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ScoreFields::of(self).serialize(serializer)
    }
}

/// The keys of a score; none where no class is known.
#[derive(Serialize)]
struct ScoreFields {
    #[serde(skip_serializing_if = "Option::is_none")]
    confusion: Option<Confusion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy_ci95: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    known_from: BTreeMap<Source, u64>,
}

impl ScoreFields {
    fn of(score: &Score) -> Self {
        let accuracy = score.confusion.accuracy();
        Self {
            confusion: accuracy.map(|_| score.confusion),
            accuracy: accuracy.map(|share| share.value),
            accuracy_ci95: accuracy.map(|share| share.ci95),
            known_from: score.sources.clone(),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, method {}", self.file, self.method.as_str())?;
        writeln!(f, "reference: {}\n", self.reference)?;
        f.write_str(&self.windows().to_text(0))?;
        for Skipped { run, reason } in &self.skipped {
            writeln!(f, "{run}: not recognised: {reason}")?;
        }
        write!(f, "\n{}", self.runs().to_text(0))?;
        self.write_alignments(f)?;
        self.score.fmt(f)?;
        for figure in &self.figures {
            writeln!(f, "drawn: {figure}")?;
        }
        Ok(())
    }
}

impl Summary {
    fn windows(&self) -> Table {
        let columns = ["run", "start/s", "end/s", "class", "confidence", "true"];
        let features = ["p1", "p2", "p3", "p4", "reason"];
        Table {
            columns: Column::named(columns.into_iter().chain(features)),
            rows: self.windows.iter().map(Window::row).collect(),
            ..Table::default()
        }
    }

    /// Windows of each class by run, and of all runs.
    fn runs(&self) -> Table {
        let row = |name: &str, counts: [usize; 4]| {
            let counts = counts.map(|count| Cell::Count(count as u64));
            [Cell::text(name)].into_iter().chain(counts).collect()
        };
        let runs = self.per_run();
        let all = std::array::from_fn(|i| runs.iter().map(|(_, counts)| counts[i]).sum());
        let all = (runs.len() > 1).then(|| row("all runs", all));
        let rows = runs.iter().map(|(run, counts)| row(run, *counts));
        let classes = CLASSES.map(|class| class.as_str());
        Table {
            columns: Column::named(["windows of"].into_iter().chain(classes)),
            rows: rows.chain(all).collect(),
            ..Table::default()
        }
    }

    /// Where a lug points straight down, by run.
    fn write_alignments(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.wheel_angle.is_empty() {
            writeln!(
                f,
                "\nwheel angle at which a lug points straight down, found from the pulses (95 % interval)"
            )?;
        }
        for RunAlignment { run, alignment } in &self.wheel_angle {
            let [low, high] = alignment.zero_ci95;
            write!(
                f,
                "{run}: {:.4} rad ({low:.4} to {high:.4})",
                alignment.zero_rad
            )?;
            match (alignment.lag_s, alignment.lag_ci95) {
                (Some(lag), Some([low, high])) => writeln!(
                    f,
                    "; acceleration logged {lag:.3} s late ({low:.3} to {high:.3})"
                )?,
                _ => writeln!(f, "; at one speed, a lag between the loggers is part of it")?,
            }
        }
        Ok(())
    }
}

fn windows(count: u64) -> String {
    match count {
        1 => "1 window".to_owned(),
        count => format!("{count} windows"),
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(accuracy) = self.confusion.accuracy() else {
            return writeln!(f, "\nno class is known to count answers against");
        };
        let rows = CLASSES.iter().zip(&self.confusion.counts);
        let rows = rows.filter_map(|(class, counts)| {
            let recall = self.confusion.recall(*class)?;
            let [low, high] = recall.ci95;
            let recall = format!("{:.3} ({low:.3} to {high:.3})", recall.value);
            let counts = counts.map(Cell::Count);
            let cells = [Cell::text(class.as_str())].into_iter().chain(counts);
            Some(cells.chain([Cell::Text(recall)]).collect())
        });
        let classes = CLASSES.map(|class| class.as_str());
        let columns = ["true class"].into_iter().chain(classes);
        let table = Table {
            columns: Column::named(columns.chain(["recall (95 % interval)"])),
            rows: rows.collect(),
            ..Table::default()
        };
        write!(f, "\n{}", table.to_text(0))?;
        let [low, high] = accuracy.ci95;
        writeln!(
            f,
            "accuracy {:.3} ({low:.3} to {high:.3}), {}",
            accuracy.value,
            windows(accuracy.n)
        )?;
        let source = |source: &Source| match source {
            Source::GroundTruth => "simulated lug contacts",
            Source::RunClass => "the class in the run file",
            Source::Terrain => "the class of the terrain in the paper",
        };
        for (from, count) in &self.sources {
            writeln!(f, "{} scored against {}", windows(*count), source(from))?;
        }
        Ok(())
    }
}
