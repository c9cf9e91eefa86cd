//! `import`: measured CSV files to a run file.

use super::interrupt;
use super::output::Output;
use crate::dataset::Provenance;
use crate::dataset::csv::{Campaign, Gap};
use crate::dataset::hdf5::RunFileWriter;
use crate::dataset::inspection::{Finding, Severity, Sinkages, findings};
use crate::trace::Trace;
use clap::Args;
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

/// Convert measured CSV files to a run file
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Import {
    /// Campaign file: which CSV files, which columns, in which units, measured how
    #[arg(value_name = "CAMPAIGN.toml")]
    campaign: PathBuf,
    /// Run file to write
    #[arg(long, value_name = "FILE.h5")]
    out: PathBuf,
}

const EXAMPLES: &str = "\
Example campaign:
  version = 1
  [[run]]                       # a time series; [table] has a row of steady means a run
  file = \"run_01.csv\"
  columns = { time_s = \"t\", normal_force = \"Fz\", acceleration_y = { column = \"az\", unit = \"g\", subtract = 1.0 } }
  wheel = { radius_m = 0.14, width_m = 0.15, lug_count = 28, lug_height_m = 0.015 }
  load_n = 100.0
  speed_m_s = 0.014
  slip_ratio = 0.1              # commanded
  terrain = \"ST\"

Unknown attributes may be omitted. The file has all runs, or it is not written.";

/// What was gathered.
#[derive(Debug, Serialize)]
struct Summary {
    campaign: String,
    file: String,
    runs: usize,
    channels: BTreeSet<String>,
    means: BTreeSet<String>,
    /// Columns with cells that hold no number.
    gaps: Vec<String>,
    /// What was taken for granted or done to the data.
    notes: Vec<Note>,
    /// Findings of `inspect` that are warnings or errors.
    doubts: usize,
}

/// A note on the import of runs.
#[derive(Debug, Serialize)]
struct Note {
    note: String,
    /// Runs it is about.
    runs: Vec<String>,
}

impl Import {
    /// Imports the campaign and prints a summary.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let campaign = Campaign::load(&self.campaign)?;
        let sources = campaign.files();
        let mut inputs: Vec<&Path> = sources.iter().map(PathBuf::as_path).collect();
        inputs.push(&self.campaign);
        output.claim(&inputs).file(&self.out)?;
        let mut writer = RunFileWriter::create(&self.out, &Provenance::measured())?;
        let mut summary = Summary {
            campaign: self.campaign.display().to_string(),
            file: self.out.display().to_string(),
            runs: 0,
            channels: BTreeSet::new(),
            means: BTreeSet::new(),
            gaps: Vec::new(),
            notes: Vec::new(),
            doubts: 0,
        };
        let mut sinkages = Sinkages::default();
        for run in campaign.runs() {
            interrupt::check()?;
            let (id, trace) = run?;
            writer.add(&id, &trace)?;
            summary.add(&id, &trace);
            sinkages.add(&id, &trace);
        }
        writer.finish()?;
        summary.doubts += doubts(&sinkages.findings());
        summary.gaps = campaign.gaps().iter().map(Gap::to_string).collect();
        output.print(&summary)
    }
}

fn doubts(findings: &[Finding]) -> usize {
    let doubts = findings.iter().filter(|f| f.severity > Severity::Info);
    doubts.count()
}

impl Summary {
    fn add(&mut self, id: &str, trace: &Trace) {
        self.runs += 1;
        let channels = trace.channels.iter().map(|channel| channel.name.clone());
        self.channels.extend(channels);
        let means = trace.means.iter().map(|mean| mean.name.clone());
        self.means.extend(means);
        for note in &trace.attributes.import_notes {
            self.note(id, note);
        }
        self.doubts += doubts(&findings(id, trace));
    }

    fn note(&mut self, id: &str, note: &str) {
        let id = id.to_owned();
        match self.notes.iter_mut().find(|known| known.note == note) {
            Some(known) => known.runs.push(id),
            None => self.notes.push(Note {
                note: note.to_owned(),
                runs: vec![id],
            }),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            campaign,
            file,
            runs,
            gaps,
            notes,
            doubts,
            ..
        } = self;
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        writeln!(f, "{campaign}: {runs} run{}", plural(*runs))?;
        for (kind, names) in [("channels", &self.channels), ("means", &self.means)] {
            if !names.is_empty() {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                writeln!(f, "{kind:<10}{}", names.join(", "))?;
            }
        }
        for gap in gaps {
            writeln!(f, "no number  {gap}")?;
        }
        for Note { note, runs } in notes {
            write!(f, "note      {note}")?;
            match &runs[..] {
                [_] => writeln!(f)?,
                [first, ..] => writeln!(f, " ({first} and {} more)", runs.len() - 1)?,
                [] => writeln!(f)?,
            }
        }
        if *doubts > 0 {
            let plural = plural(*doubts);
            writeln!(f, "{doubts} finding{plural}; see lugwheel inspect {file}")?;
        }
        writeln!(f, "\nwritten to {file}")
    }
}
