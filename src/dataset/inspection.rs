//! What is in a run file, checked: channels, units, rates, gaps, clipped or constant channels, and
//! labels that the channels contradict.
//!
//! A check can only doubt. Each finding says what it saw and what would explain it; the data stay
//! as they are.

mod labels;
mod samples;

use super::hdf5::RunFile;
use crate::quantity::Seed;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::{Channel, Mean, RunAttributes, Trace};
use serde::Serialize;
use std::fmt;

/// What is in a run file, and what is odd about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Inspection {
    /// The file.
    pub file: String,
    /// The program that wrote it.
    pub created_by: String,
    /// The seed of simulated runs.
    pub seed: Option<Seed>,
    /// The runs that could be read.
    pub runs: Vec<RunSummary>,
    /// What is odd, in the order of the runs.
    pub findings: Vec<Finding>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Id in the file.
    pub run: String,
    /// Label, if known.
    pub terrain: Option<TerrainLabel>,
    /// Class, if known.
    pub class: Option<Wtic>,
    /// Commanded forward speed [m/s].
    pub speed_m_s: f64,
    /// Commanded slip ratio [-].
    pub slip_ratio: f64,
    /// Commanded load [N].
    pub load_n: f64,
    /// Whether it was simulated and has ground truth.
    pub truth: bool,
    /// Its time series.
    pub channels: Vec<ChannelSummary>,
    /// Its steady means.
    pub means: Vec<MeanSummary>,
}

/// One time series.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// Name.
    pub channel: String,
    /// Unit as the file has it.
    pub unit: String,
    /// Samples per second [Hz].
    pub sample_rate_hz: f64,
    /// Time of the first sample [s].
    pub start_s: f64,
    /// Length [s].
    pub duration_s: f64,
    /// Number of samples that are no numbers.
    pub missing: usize,
    /// Smallest number, in its unit; none in an empty channel.
    pub min: Option<f64>,
    /// Mean of the numbers in the middle half of the record, in its unit.
    pub steady_mean: Option<f64>,
    /// Largest number, in its unit.
    pub max: Option<f64>,
}

/// One steady mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeanSummary {
    /// Name of the quantity.
    pub channel: String,
    /// Unit as the file has it.
    pub unit: String,
    /// Mean.
    pub mean: f64,
    /// Standard deviation within the steady interval.
    pub sd: f64,
    /// Number of samples behind it.
    pub n: u64,
}

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Results may suffer.
    Warning,
    /// Do not use before it is mended.
    Error,
}

/// Something odd.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The run.
    pub run: String,
    /// The channel, if it is about one.
    pub channel: Option<String>,
    /// How much it matters.
    pub severity: Severity,
    /// What was seen, and what would explain it.
    pub message: String,
}

/// Reads all runs of `file`, one after another, and checks them.
///
/// A run that cannot be read is a finding; the others are still inspected.
pub fn inspect(file: &RunFile) -> Inspection {
    let provenance = file.provenance();
    let mut inspection = Inspection {
        file: file.path().display().to_string(),
        created_by: provenance.created_by.clone(),
        seed: provenance.seed,
        runs: Vec::new(),
        findings: Vec::new(),
    };
    for id in file.runs() {
        let mut doubts = Doubts::of(id);
        match file.read(id) {
            Ok(trace) => {
                inspection.runs.push(summary(id, &trace));
                check(&trace, &mut doubts);
            }
            Err(error) => doubts.run(Severity::Error, error.to_string()),
        }
        inspection.findings.append(&mut doubts.findings);
    }
    inspection
}

/// What is odd about one run.
pub fn findings(id: &str, trace: &Trace) -> Vec<Finding> {
    let mut doubts = Doubts::of(id);
    check(trace, &mut doubts);
    doubts.findings
}

fn check(trace: &Trace, doubts: &mut Doubts) {
    samples::check(trace, doubts);
    labels::check(trace, doubts);
}

/// Findings of one run, as they are made.
struct Doubts {
    run: String,
    findings: Vec<Finding>,
}

impl Doubts {
    fn of(run: &str) -> Self {
        Self {
            run: run.to_owned(),
            findings: Vec::new(),
        }
    }

    fn run(&mut self, severity: Severity, message: String) {
        self.add(None, severity, message);
    }

    fn channel(&mut self, channel: &str, severity: Severity, message: String) {
        self.add(Some(channel.to_owned()), severity, message);
    }

    fn add(&mut self, channel: Option<String>, severity: Severity, message: String) {
        self.findings.push(Finding {
            run: self.run.clone(),
            channel,
            severity,
            message,
        });
    }
}

fn summary(id: &str, trace: &Trace) -> RunSummary {
    let RunAttributes {
        terrain,
        class,
        speed,
        slip_ratio,
        load,
        ..
    } = trace.attributes;
    let channels = trace.channels.iter();
    RunSummary {
        run: id.to_owned(),
        terrain,
        class,
        speed_m_s: speed,
        slip_ratio,
        load_n: load,
        truth: trace.truth.is_some(),
        channels: channels.map(channel_summary).collect(),
        means: trace.means.iter().map(mean_summary).collect(),
    }
}

fn channel_summary(channel: &Channel) -> ChannelSummary {
    let finite = || channel.samples.iter().copied().filter(|x| x.is_finite());
    ChannelSummary {
        channel: channel.name.clone(),
        unit: channel.unit.clone(),
        sample_rate_hz: channel.sample_rate,
        start_s: channel.start,
        duration_s: channel.duration(),
        missing: channel.samples.len() - finite().count(),
        min: finite().reduce(f64::min),
        steady_mean: channel.steady_mean(),
        max: finite().reduce(f64::max),
    }
}

fn mean_summary(mean: &Mean) -> MeanSummary {
    MeanSummary {
        channel: mean.name.clone(),
        unit: mean.unit.clone(),
        mean: mean.value,
        sd: mean.sd,
        n: mean.n,
    }
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            created_by,
            seed,
            runs,
            findings,
        } = self;
        write!(f, "{file}: {} runs", runs.len())?;
        if !created_by.is_empty() {
            write!(f, ", written by {created_by}")?;
        }
        if let Some(Seed(seed)) = seed {
            write!(f, ", seed {seed}")?;
        }
        writeln!(f)?;
        for run in runs {
            run.fmt(f)?;
        }
        if findings.is_empty() {
            return writeln!(f, "\nnothing odd");
        }
        writeln!(f, "\n{} findings", findings.len())?;
        for finding in findings {
            finding.fmt(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for RunSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let label = self.terrain.map_or("-", TerrainLabel::as_str);
        let class = self.class.map_or("-", Wtic::as_str);
        let truth = if self.truth {
            ", with ground truth"
        } else {
            ""
        };
        writeln!(
            f,
            "\n{}: terrain {label}, class {class}, {} mm/s, slip {}, {} N{truth}",
            self.run,
            number(1.0e3 * self.speed_m_s),
            number(self.slip_ratio),
            number(self.load_n),
        )?;
        if !self.channels.is_empty() {
            writeln!(
                f,
                "  {:<16} {:<6} {:>9} {:>9} {:>9} {:>8} {:>11} {:>11} {:>11}",
                "channel",
                "unit",
                "rate/Hz",
                "start/s",
                "length/s",
                "missing",
                "min",
                "mean",
                "max"
            )?;
        }
        for channel in &self.channels {
            channel.fmt(f)?;
        }
        if !self.means.is_empty() {
            writeln!(
                f,
                "  {:<16} {:<6} {:>11} {:>11} {:>9}",
                "steady mean", "unit", "mean", "sd", "n"
            )?;
        }
        for mean in &self.means {
            mean.fmt(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for ChannelSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |x: Option<f64>| x.map_or("-".to_owned(), number);
        writeln!(
            f,
            "  {:<16} {:<6} {:>9} {:>9} {:>9} {:>8} {:>11} {:>11} {:>11}",
            self.channel,
            self.unit,
            number(self.sample_rate_hz),
            number(self.start_s),
            number(self.duration_s),
            self.missing,
            value(self.min),
            value(self.steady_mean),
            value(self.max),
        )
    }
}

impl fmt::Display for MeanSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "  {:<16} {:<6} {:>11} {:>11} {:>9}",
            self.channel,
            self.unit,
            number(self.mean),
            number(self.sd),
            self.n
        )
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Info => "info",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        let place = match &self.channel {
            Some(channel) => format!("{} {channel}", self.run),
            None => self.run.clone(),
        };
        writeln!(f, "  {severity:<8} {place}: {}", self.message)
    }
}

/// A number with four digits that count.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !(1.0e-4..1.0e6).contains(&size) {
        format!("{value:.3e}")
    } else {
        let before = size.log10().floor() as i32;
        let decimals = (3 - before).max(0) as usize;
        let text = format!("{value:.decimals$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits_that_count() {
        let printed = [100.0, 0.014, -0.23105, 128_000.0, 98.0665, 1.0e-7, 0.0].map(number);
        assert_eq!(
            printed,
            [
                "100", "0.014", "-0.2311", "128000", "98.07", "1.000e-7", "0"
            ]
        );
        assert_eq!(number(f64::NAN), "NaN");
    }
}
