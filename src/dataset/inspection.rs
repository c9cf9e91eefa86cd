//! Consistency checks of a run file: channels, units, rates, gaps, offsets, clipped or constant channels,
//! labels that contradict the channels, and physically impossible loads.
//!
//! Checks do not change the data. Each finding has an observation and a possible cause; for simulated runs
//! only the observation.

mod acceleration;
mod campaign;
mod doubts;
mod labels;
mod lifted;
mod mechanics;
mod offsets;
mod samples;
mod subject;
mod turning;

pub use campaign::Sinkages;

pub use lifted::LiftedRuns;

use self::doubts::Doubts;
use self::subject::Subject;
use super::hdf5::{RunFile, RunFileError};
use crate::quantity::Seed;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::{Channel, Mean, RunAttributes, Trace};
use serde::Serialize;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
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
    /// Commanded load \[N\].
    pub load_n: f64,
    /// Whether it was simulated and has ground truth.
    pub truth: bool,
    /// What its import took for granted or did to its data.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub import_notes: Vec<String>,
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
    /// Samples per second \[Hz\].
    pub sample_rate_hz: f64,
    /// Time of the first sample \[s\].
    pub start_s: f64,
    /// Length \[s\].
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// For information.
    Info,
    /// Results may suffer.
    Warning,
    /// Do not use before it is corrected.
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
    /// The observation, with a possible cause.
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
    let mut sinkages = Sinkages::default();
    let mut lifted = LiftedRuns::default();
    for id in file.runs() {
        match file.read(id) {
            Ok(trace) => {
                inspection.runs.push(summary(id, &trace));
                inspection.findings.extend(findings(id, &trace));
                sinkages.add(id, &trace);
                lifted.add(id, &trace);
            }
            Err(error) => inspection.findings.push(unreadable(id, &error)),
        }
    }
    inspection.findings.extend(sinkages.findings());
    inspection.findings.extend(lifted.findings());
    inspection
}

fn unreadable(run: &str, error: &RunFileError) -> Finding {
    Finding {
        run: run.to_owned(),
        channel: None,
        severity: Severity::Error,
        message: error.to_string(),
    }
}

impl Inspection {
    /// How many findings are at least so severe.
    pub fn count(&self, severity: Severity) -> usize {
        let findings = self.findings.iter();
        findings
            .filter(|finding| finding.severity >= severity)
            .count()
    }
}

/// Findings on a single run; [`Sinkages`] and [`LiftedRuns`] check several runs together.
pub fn findings(id: &str, trace: &Trace) -> Vec<Finding> {
    let mut doubts = Doubts::of_trace(id, trace);
    let subject = Subject::of(trace);
    samples::check(&subject, &mut doubts);
    turning::check(&subject, &mut doubts);
    labels::check(&subject, &mut doubts);
    acceleration::check(&subject, &mut doubts);
    offsets::check(&subject, &mut doubts);
    mechanics::check(&subject, &mut doubts);
    labels::check_grip(&subject, &mut doubts);
    doubts.into_findings()
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
        import_notes: trace.attributes.import_notes.clone(),
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
        write!(f, "{file}: {}", counted(runs.len(), "run"))?;
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
            return writeln!(f, "\nno findings");
        }
        writeln!(f, "\n{}", counted(findings.len(), "finding"))?;
        for (finding, runs) in alike(findings) {
            writeln!(f, "{finding}{}", in_others(runs))?;
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
            known(1.0e3 * self.speed_m_s),
            known(self.slip_ratio),
            known(self.load_n),
        )?;
        for note in &self.import_notes {
            writeln!(f, "  imported: {note}")?;
        }
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
            known(self.sd),
            if self.n > 0 {
                self.n.to_string()
            } else {
                "-".to_owned()
            }
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
        write!(f, "  {severity:<8} {}: {}", self.place(), self.message)
    }
}

/// Findings on a single run by which it should not be used.
pub fn errors(id: &str, trace: &Trace) -> Vec<Finding> {
    let mut findings = findings(id, trace);
    findings.retain(|finding| finding.severity == Severity::Error);
    findings
}

/// Findings in words, without their severity; those alike in several runs once.
pub fn in_words<'f>(findings: impl IntoIterator<Item = &'f Finding>) -> Vec<String> {
    let words = alike(findings).into_iter().map(|(finding, runs)| {
        let (place, message) = (finding.place(), &finding.message);
        format!("{place}: {message}{}", in_others(runs))
    });
    words.collect()
}

/// In how many other runs the same was found.
fn in_others(runs: usize) -> String {
    match runs {
        1 => String::new(),
        runs => format!(" (and in {})", counted(runs - 1, "other run")),
    }
}

impl Finding {
    fn place(&self) -> String {
        match &self.channel {
            Some(channel) => format!("{} {channel}", self.run),
            None => self.run.clone(),
        }
    }
}

/// The first of the findings that differ in nothing but their run, and how many there are.
fn alike<'f>(findings: impl IntoIterator<Item = &'f Finding>) -> Vec<(&'f Finding, usize)> {
    let mut groups: Vec<(&Finding, usize)> = Vec::new();
    let mut known: HashMap<_, usize> = HashMap::new();
    for finding in findings {
        let what = (&finding.channel, finding.severity, &finding.message);
        match known.entry(what) {
            Entry::Occupied(group) => groups[*group.get()].1 += 1,
            Entry::Vacant(new) => {
                new.insert(groups.len());
                groups.push((finding, 1));
            }
        }
    }
    groups
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A number, or `unknown`.
fn known(value: f64) -> String {
    if value.is_nan() {
        "-".to_owned()
    } else {
        number(value)
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
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{ClassWindow, Truth, unit_of};
    use std::f64::consts::TAU;

    const RATE: f64 = 500.0;

    /// A varying, plausible channel about `mean`.
    fn channel(name: &str, mean: f64) -> Channel {
        let ripple = |i: u32| (f64::from(i) * 0.7).sin() + (f64::from(i) * 1.9).sin();
        let size = 0.01 * mean.abs().max(0.01);
        Channel {
            name: name.to_owned(),
            unit: unit_of(name).unwrap_or("?").to_owned(),
            sample_rate: RATE,
            start: 0.0,
            samples: (0..5_000).map(|i| mean + size * ripple(i)).collect(),
        }
    }

    fn wheel_angle(wheel_speed: f64) -> Channel {
        let samples = (0..5_000).map(|i| wheel_speed * f64::from(i) / RATE);
        Channel {
            samples: samples.collect(),
            ..channel("wheel_angle", 0.0)
        }
    }

    /// A sound run at slip 0.1.
    fn sound() -> Trace {
        let attributes = RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load: 100.0,
            speed: 0.014,
            slip_ratio: 0.1,
            ..RunAttributes::default()
        };
        let channels = vec![
            channel("acceleration_y", 0.0),
            channel("normal_force", 100.3),
            channel("drawbar_pull", 20.0),
            channel("driving_torque", 5.0),
            channel("sinkage", -0.003),
            channel("slip_ratio", 0.1),
            wheel_angle(0.1 / 0.9),
            channel("forward_speed", 0.014),
        ];
        Trace {
            attributes,
            channels,
            ..Trace::default()
        }
    }

    /// The sound run with `name` replaced by a channel that `change` has changed.
    fn with(name: &str, change: impl Fn(&mut Channel)) -> Trace {
        let mut trace = sound();
        let channel = trace.channels.iter_mut().find(|c| c.name == name);
        change(channel.unwrap());
        trace
    }

    /// The sound run with samples of `name` by their number.
    fn with_samples(name: &str, sample: impl Fn(f64) -> f64) -> Trace {
        with(name, |channel| {
            let samples = channel.samples.iter_mut().enumerate();
            samples.for_each(|(i, x)| *x = sample(i as f64));
        })
    }

    fn scaled(by: f64) -> impl Fn(&mut Channel) {
        move |channel| channel.samples.iter_mut().for_each(|x| *x *= by)
    }

    /// Expects exactly one finding, of this channel and severity, with `part` in its message.
    fn expect(trace: &Trace, channel: Option<&str>, severity: Severity, part: &str) {
        let found = findings("run", trace);
        let [finding] = &found[..] else {
            panic!("{part}: {found:?}")
        };
        assert_eq!(finding.channel.as_deref(), channel, "{finding}");
        assert_eq!(finding.severity, severity, "{finding}");
        assert!(finding.message.contains(part), "{finding}");
    }

    #[test]
    fn a_sound_run_raises_no_doubt_whatever_channels_it_has() {
        assert_eq!(findings("run", &sound()), []);
        let without_acceleration = Trace {
            channels: sound().channels.split_off(1),
            ..sound()
        };
        assert_eq!(findings("run", &without_acceleration), []);
    }

    #[test]
    fn errors_are_those_by_which_a_run_should_not_be_used_and_stand_once_for_all_runs_alike() {
        assert_eq!(errors("run", &sound()), []);
        let in_kilonewton = with("normal_force", scaled(1.0e-3));
        let wrong = ["one", "two"].map(|id| errors(id, &in_kilonewton)).concat();
        let words = in_words(&wrong);
        assert_eq!(words.len(), 1, "{words:?}");
        assert!(words[0].starts_with("one normal_force: "), "{words:?}");
        assert!(words[0].ends_with(" (and in 1 other run)"), "{words:?}");
    }

    #[test]
    fn a_run_commanded_12_mm_s_that_ran_at_13_is_named() {
        let mut trace = with("forward_speed", scaled(13.0 / 14.0));
        trace.attributes.speed = 0.012;
        let part = "commanded 12 mm/s, measured 13 mm/s";
        expect(&trace, Some("forward_speed"), Severity::Warning, part);
    }

    #[test]
    fn a_rim_commanded_12_mm_s_that_ran_at_13_is_named_from_means_alone() {
        // Forward at 10 mm/s with slip 0.2311, where the command makes it 1/6.
        let mut trace = sound();
        trace.channels.clear();
        trace.means = vec![
            mean("slip_ratio", 0.2311, 0.0),
            mean("forward_speed", 0.01, 0.0),
        ];
        trace.attributes.speed = 0.01;
        trace.attributes.slip_ratio = 1.0 / 6.0;
        let part = "slip 0.1667 (rim at 12 mm/s), measured slip 0.2311 (rim at 13.01 mm/s)";
        expect(&trace, Some("slip_ratio"), Severity::Warning, part);
    }

    #[test]
    fn without_a_slip_channel_the_slip_follows_from_the_wheel_angle() {
        let mut trace = sound();
        trace.channels.retain(|c| c.name != "slip_ratio");
        assert_eq!(findings("run", &trace), []);
        trace.attributes.slip_ratio = 0.2;
        let part = "commanded slip 0.2 (rim at 17.5 mm/s), measured slip 0.1 (rim at 15.56 mm/s)";
        expect(&trace, Some("wheel_angle"), Severity::Warning, part);
    }

    #[test]
    fn a_force_off_its_load_is_diagnosed_by_factor_and_sign() {
        let off = Severity::Warning;
        let unit = Severity::Error;
        let cases = [
            (9.80665, unit, "newton against kilogram"),
            (1.0 / 9.80665, unit, "kilogram against newton"),
            (10.0, unit, "a gain or a decimal place"),
            (1.0e-3, unit, "a wrong prefix"),
            (
                -1.0,
                unit,
                "mean is -100.3 N: the normal force points upward",
            ),
            (
                1.25,
                off,
                "mean is 125.4 N, commanded load 100 N: the load was not held",
            ),
        ];
        for (factor, severity, part) in cases {
            let trace = with("normal_force", scaled(factor));
            expect(&trace, Some("normal_force"), severity, part);
        }
        assert_eq!(findings("run", &with("normal_force", scaled(1.08))), []);
    }

    #[test]
    fn signs_units_and_gravity_are_doubted_by_their_mean() {
        let (error, warning) = (Severity::Error, Severity::Warning);
        let shifted = |c: &mut Channel| c.samples.iter_mut().for_each(|x| *x += 9.8);
        let gravity = with("acceleration_y", shifted);
        expect(
            &gravity,
            Some("acceleration_y"),
            error,
            "gravity is still in it",
        );
        let per_cent = with("slip_ratio", scaled(100.0));
        expect(
            &per_cent,
            Some("slip_ratio"),
            error,
            "outside [-1, 1]: per cent?",
        );
        let millimetres = with("sinkage", scaled(-1000.0));
        expect(&millimetres, Some("sinkage"), error, "millimetres?");
        let mut raised = with("sinkage", scaled(12.0));
        raised.attributes.terrain = Some(TerrainLabel::Sand);
        expect(&raised, Some("sinkage"), warning, "change its sign");
        let torque = with("driving_torque", scaled(-1.0));
        expect(&torque, Some("driving_torque"), warning, "change its sign");
        let unit = with("normal_force", |c| c.unit = "kN".to_owned());
        expect(
            &unit,
            Some("normal_force"),
            error,
            "unit is \"kN\", expected \"N\"",
        );
        let mut wheel = sound();
        wheel.attributes.wheel_width = 150.0;
        expect(&wheel, None, error, "wheel_width_m is 150: millimetres?");
        let backward = with("wheel_angle", scaled(-1.0));
        expect(&backward, Some("wheel_angle"), error, "change its sign");
    }

    #[test]
    fn an_acceleration_sampled_once_in_two_seconds_is_slow_or_has_its_time_in_milliseconds() {
        let mut slow = sound();
        slow.channels.truncate(1);
        slow.channels[0].sample_rate /= 1000.0;
        expect(
            &slow,
            Some("acceleration_y"),
            Severity::Warning,
            "time in milliseconds?",
        );
    }

    fn shifted(by: f64) -> impl Fn(&mut Channel) {
        move |channel| channel.samples.iter_mut().for_each(|x| *x += by)
    }

    #[test]
    fn gravity_included_or_subtracted_twice_is_distinguished_from_an_offset_in_every_unit() {
        let error = Severity::Error;
        for (mean, part) in [
            (9.81, "gravity is still in it"),
            (
                -9.81,
                "gravity taken off twice, or left in by a sensor that points downward",
            ),
            (-19.6, "gravity taken off with the wrong sign"),
            (1.0, "in units of g, with gravity in it?"),
            (-1.0, "in units of g, with gravity taken off twice"),
            (96.2, "converted from g twice, with gravity in it?"),
            (981.0, "in cm/s^2, with gravity in it?"),
            (
                -9810.0,
                "in mm/s^2 or milli-g, with gravity taken off twice",
            ),
        ] {
            let trace = with("acceleration_y", shifted(mean));
            expect(&trace, Some("acceleration_y"), error, part);
        }
        // The middle half of 10 s: 0.03 m/s^2 makes 0.15 m/s, 0.06 m/s^2 makes 0.3 m/s.
        assert_eq!(findings("run", &with("acceleration_y", shifted(0.03))), []);
        let offset = with("acceleration_y", shifted(0.06));
        let part = "which makes 0.3 m/s of vertical speed in 5 s: an offset";
        expect(&offset, Some("acceleration_y"), Severity::Warning, part);
        let large = with("acceleration_y", shifted(5.0));
        expect(
            &large,
            Some("acceleration_y"),
            Severity::Warning,
            "an offset",
        );
    }

    #[test]
    fn an_acceleration_too_large_for_a_wheel_that_falls_has_another_unit() {
        // 10 m/s² at 3 Hz swing the wheel's speed by 1 m/s, less than a fall by its radius makes.
        let pulsating = |size: f64| {
            with_samples("acceleration_y", move |i| {
                size * (i * TAU * 3.0 / RATE).sin()
            })
        };
        assert_eq!(findings("run", &pulsating(10.0)), []);
        let part = "integrates to 106.1 m/s of vertical speed within 1 s";
        let millimetres = pulsating(1000.0);
        expect(&millimetres, Some("acceleration_y"), Severity::Error, part);
    }

    #[test]
    fn units_of_torque_pull_and_angle_are_doubted_by_their_size() {
        let error = Severity::Error;
        let torque = with("driving_torque", scaled(1000.0));
        expect(
            &torque,
            Some("driving_torque"),
            error,
            "newton millimetres?",
        );
        let pull = with("drawbar_pull", scaled(1000.0));
        expect(&pull, Some("drawbar_pull"), error, "a wrong prefix");
        for (factor, part) in [
            (360.0 / TAU, "in degrees?"),
            (1.0 / TAU, "in turns?"),
            (60.0 / TAU, "revolutions per minute?"),
            (1.0e-3, "time in milliseconds?"),
        ] {
            let trace = with("wheel_angle", scaled(factor));
            expect(&trace, Some("wheel_angle"), error, part);
        }
        let degrees = with("wheel_angle", scaled(360.0 / TAU));
        let mut degrees_alone = degrees;
        degrees_alone.channels.retain(|c| c.name != "slip_ratio");
        expect(&degrees_alone, Some("wheel_angle"), error, "in degrees?");
    }

    #[test]
    fn a_pull_beyond_the_load_is_doubted_and_one_below_it_is_not() {
        let pull = |by: f64| {
            let mut trace = with("drawbar_pull", scaled(by));
            let torque = trace
                .channels
                .iter_mut()
                .find(|c| c.name == "driving_torque");
            scaled(3.0)(torque.unwrap());
            trace
        };
        let name = Some("drawbar_pull");
        let caught = "more than the load of 100 N";
        expect(&pull(6.0), name, Severity::Warning, caught);
        let caught = "leaves a resistance of 216.8 N";
        expect(&pull(-6.0), name, Severity::Warning, caught);
        assert_eq!(findings("run", &pull(4.0)), []);
    }

    #[test]
    fn a_braking_wheel_that_pulls_forward_has_a_wrong_sign() {
        let mut trace = sound();
        trace.attributes.slip_ratio = -0.5;
        trace
            .channels
            .retain(|c| !["slip_ratio", "wheel_angle"].contains(&c.name.as_str()));
        let part = "mean is 20 N while braking with slip -0.5";
        expect(&trace, Some("drawbar_pull"), Severity::Warning, part);
        trace.attributes.speed = -0.014;
        trace.channels.retain(|c| c.name != "forward_speed");
        assert_eq!(findings("run", &trace), [], "in reverse it is right");
    }

    #[test]
    fn a_run_without_attributes_raises_no_other_doubt() {
        let unknown = RunAttributes {
            wheel_radius: f64::NAN,
            wheel_width: f64::NAN,
            load: f64::NAN,
            speed: f64::NAN,
            slip_ratio: f64::NAN,
            ..RunAttributes::default()
        };
        let trace = Trace {
            attributes: unknown,
            ..sound()
        };
        let found = findings("run", &trace);
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(found.iter().all(|f| f.severity == Severity::Info));
        assert!(found[0].message.starts_with("wheel_radius_m is not known"));
        assert!(found[2].message.starts_with("lugs not given"));
    }

    #[test]
    fn a_unit_is_doubted_by_other_channels_where_no_command_is_known() {
        let mut unknown = with("forward_speed", scaled(1000.0));
        unknown.attributes.speed = f64::NAN;
        unknown.attributes.slip_ratio = f64::NAN;
        let part = "by wheel angle and slip 14 mm/s: 1000 times: a wrong prefix";
        expect(&unknown, Some("forward_speed"), Severity::Error, part);
        let mut degrees = with("wheel_angle", scaled(360.0 / TAU));
        degrees.attributes = unknown.attributes.clone();
        let found = findings("run", &degrees);
        assert!(found[0].message.ends_with("in degrees?"), "{found:?}");
    }

    #[test]
    fn a_command_in_per_cent_or_millimetres_is_doubted() {
        let mut trace = sound();
        trace.channels.retain(|c| c.name == "normal_force");
        trace.attributes.slip_ratio = 10.0;
        expect(
            &trace,
            None,
            Severity::Error,
            "slip_ratio is 10, outside [-1, 1]: per cent?",
        );
        trace.attributes.slip_ratio = 0.1;
        trace.attributes.speed = 14.0;
        expect(&trace, None, Severity::Error, "speed_m_s is 14: in mm/s?");
    }

    #[test]
    fn an_encoder_or_counter_that_starts_again_is_one_angle_that_goes_on() {
        let fast = |i: f64| 2.0 * i / RATE;
        let starts_again = |range: f64, direction: f64| {
            let mut trace =
                with_samples("wheel_angle", |i| (direction * fast(i)).rem_euclid(range));
            trace.attributes.speed = direction * 2.0 * 0.9 * 0.14;
            let speed = trace.attributes.speed;
            trace
                .channels
                .retain(|c| !["slip_ratio", "forward_speed"].contains(&c.name.as_str()));
            trace.channels.push(channel("forward_speed", speed));
            if direction < 0.0 {
                trace
                    .channels
                    .retain(|c| !["drawbar_pull", "driving_torque"].contains(&c.name.as_str()));
            }
            trace
        };
        for direction in [1.0, -1.0] {
            assert_eq!(findings("run", &starts_again(TAU, direction)), []);
            let part = "after 5 rad (0.7958 turns); unwrapped";
            let counter = starts_again(5.0, direction);
            expect(&counter, Some("wheel_angle"), Severity::Info, part);
            expect(
                &starts_again(3.0 * TAU, direction),
                Some("wheel_angle"),
                Severity::Info,
                "(3 turns)",
            );
        }
    }

    #[test]
    fn a_slow_log_is_at_most_doubted_and_a_long_one_may_have_its_time_in_milliseconds() {
        let mut slow = sound();
        slow.channels.retain(|c| c.name != "wheel_angle");
        for channel in &mut slow.channels {
            channel.sample_rate = 10.0;
        }
        let name = Some("acceleration_y");
        expect(
            &slow,
            name,
            Severity::Warning,
            "sampled at 10 Hz: too slow to show a vibration",
        );
        slow.channels.remove(0);
        assert_eq!(findings("run", &slow), []);
        for channel in &mut slow.channels {
            channel.sample_rate = 0.5;
        }
        let part = "lasts 10000 s and 140 m, sampled at 0.5 Hz: time in milliseconds?";
        expect(&slow, None, Severity::Warning, part);
    }

    #[test]
    fn rest_has_no_slip_and_counts_for_nothing() {
        let still = |i: f64| i > 2000.0;
        let mut trace = with_samples("wheel_angle", |i| 0.1 / 0.9 * i.min(2000.0) / RATE);
        for (name, moving) in [("forward_speed", 0.014), ("slip_ratio", 0.1)] {
            let channel = trace.channels.iter_mut().find(|c| c.name == name);
            let samples = channel.unwrap().samples.iter_mut().enumerate();
            samples.for_each(|(i, x)| {
                *x = match (still(i as f64), name) {
                    (false, _) => moving + 1e-5 * (i as f64 * 0.7).sin(),
                    (true, "slip_ratio") => (i as f64 * 1.9).sin(),
                    (true, _) => 1e-6 * (i as f64 * 0.7).sin(),
                };
            });
        }
        assert_eq!(findings("run", &trace), []);
        let slip = trace.channels.iter_mut().find(|c| c.name == "slip_ratio");
        slip.unwrap().samples[2000..].fill(f64::NAN);
        assert_eq!(findings("run", &trace), []);
        let slip = trace.channels.iter_mut().find(|c| c.name == "slip_ratio");
        slip.unwrap().samples[1000..1010].fill(f64::NAN);
        let part = "10 of 5000 samples are no numbers";
        expect(&trace, Some("slip_ratio"), Severity::Warning, part);
    }

    #[test]
    fn a_simulated_run_gets_no_advice_and_has_no_errors() {
        let mut trace = with("drawbar_pull", scaled(-6.0));
        trace.attributes.physics_rate = Some(16_000.0);
        let [finding] = &findings("run", &trace)[..] else {
            panic!("one finding")
        };
        assert!(
            finding.message.ends_with("(load x tan(entry angle))"),
            "{finding}"
        );
        let mut gravity = with("acceleration_y", shifted(9.81));
        gravity.attributes.physics_rate = Some(16_000.0);
        let part = "mean is 9.81 m/s^2";
        expect(&gravity, Some("acceleration_y"), Severity::Warning, part);
    }

    fn mean(name: &str, value: f64, sd: f64) -> Mean {
        Mean {
            name: name.to_owned(),
            unit: unit_of(name).unwrap_or("N").to_owned(),
            value,
            sd,
            n: 1000,
        }
    }

    #[test]
    fn a_sensor_without_load_that_reads_more_than_its_noise_has_an_offset() {
        let mut trace = sound();
        trace.channels.clear();
        trace.attributes.load = 0.0;
        trace.attributes.speed = 0.0;
        trace.attributes.slip_ratio = 0.0;
        trace.means = vec![
            mean("normal_force", -0.2, 0.1),
            mean("drawbar_pull", 5.8, 0.1),
            mean("sinkage", 0.01, 0.0),
        ];
        let part = "reads 5.8 N (noise 0.1) without load: subtract it";
        expect(&trace, Some("drawbar_pull"), Severity::Warning, part);
        trace.attributes.load = 100.0;
        trace.means.remove(0);
        assert_eq!(findings("run", &trace), []);
    }

    #[test]
    fn a_lifted_wheel_may_need_torque_to_turn_but_feels_no_ground() {
        let mut trace = sound();
        trace.attributes.load = 0.0;
        trace
            .channels
            .retain(|c| c.name == "driving_torque" || c.name == "drawbar_pull");
        let part = "without load";
        expect(&trace, Some("drawbar_pull"), Severity::Warning, part);
    }

    #[test]
    fn a_torque_before_the_wheel_turns_is_an_offset_and_a_start_from_rest_is_sound() {
        let waits = |i: f64| 0.111 * (i / RATE - 1.0).max(0.0);
        let mut trace = with_samples("wheel_angle", waits);
        let stands = |samples: &mut [f64], mean: f64| {
            let at_rest = samples[..500].iter_mut().enumerate();
            at_rest.for_each(|(i, x)| *x = mean + 0.01 * (i as f64 * 0.7).sin());
        };
        for (name, at_rest) in [("driving_torque", 0.0), ("drawbar_pull", 1.0)] {
            let channel = trace.channels.iter_mut().find(|c| c.name == name);
            stands(&mut channel.unwrap().samples, at_rest);
        }
        assert_eq!(findings("run", &trace), [], "1 N is 1 % of the load");
        let torque = trace
            .channels
            .iter_mut()
            .find(|c| c.name == "driving_torque");
        stands(&mut torque.unwrap().samples, 0.7);
        // Half of the time until it has turned by 0.2 degrees.
        let part = "for 0.516 s before the wheel turns: an offset";
        expect(&trace, Some("driving_torque"), Severity::Warning, part);
    }

    #[test]
    fn gaps_constants_and_channels_of_another_length_are_counted() {
        let warning = Severity::Warning;
        let gaps = with("drawbar_pull", |c| {
            c.samples[100..350].fill(f64::NAN);
            c.samples[4_000] = f64::NAN;
        });
        let part = "251 of 5000 samples are no numbers, longest gap 0.5 s";
        expect(&gaps, Some("drawbar_pull"), warning, part);
        let dead = with_samples("drawbar_pull", |_| 0.3);
        expect(&dead, Some("drawbar_pull"), warning, "constant at 0.3");
        let held = with_samples("slip_ratio", |_| 0.1);
        expect(
            &held,
            Some("slip_ratio"),
            Severity::Info,
            "a command in place",
        );
        let short = with("drawbar_pull", |c| c.samples.truncate(4_000));
        let part = "runs from 0 s to 8 s, acceleration_y from 0 s to 10 s";
        expect(&short, Some("drawbar_pull"), warning, part);
        let empty = with("drawbar_pull", |c| c.samples.clear());
        expect(&empty, Some("drawbar_pull"), warning, "no samples");
        let bare = Trace {
            channels: Vec::new(),
            ..sound()
        };
        expect(&bare, None, warning, "no channels and no means");
    }

    #[test]
    fn a_clipped_signal_is_found_and_a_quantised_or_resting_one_is_not() {
        let wave = |i: f64| 100.0 + 20.0 * (i * 0.011).sin();
        let clipped = with_samples("normal_force", |i| wave(i).min(115.0));
        expect(
            &clipped,
            Some("normal_force"),
            Severity::Warning,
            "stuck at 115",
        );
        for step in [0.5, 2.0, 5.0] {
            let quantised = with_samples("normal_force", |i| (wave(i) / step).round() * step);
            assert_eq!(findings("run", &quantised), [], "step {step}");
        }
        // Off the ground half of the time: half a sine of peak 314 N has a mean of 100 N.
        let lifting = with_samples("normal_force", |i| 15.7 * (wave(i) - 100.0).max(0.0));
        assert_eq!(findings("run", &lifting), []);
        let starting = with_samples("forward_speed", |i| (0.014 * i / 500.0).min(0.014));
        assert_eq!(findings("run", &starting), []);
    }

    #[test]
    fn a_class_that_the_truth_contradicts_is_named() {
        let window = ClassWindow {
            start: 0.0,
            end: 15.0,
            class: Wtic::Slct,
            terrain: TerrainLabel::Gravel,
            lugs: None,
        };
        let mut trace = sound();
        trace.attributes.class = Some(Wtic::Alct);
        trace.truth = Some(Truth {
            class_windows: vec![window],
            ..Truth::default()
        });
        let part = "labelled ALCT, but every window of its ground truth is SLCT";
        expect(&trace, None, Severity::Warning, part);
    }

    #[test]
    fn the_table_shows_each_channel_and_each_finding_on_a_line() {
        let trace = with("normal_force", scaled(1.25));
        let inspection = Inspection {
            file: "runs.h5".to_owned(),
            created_by: "lugwheel".to_owned(),
            seed: Some(Seed(7)),
            runs: vec![summary("r1", &trace)],
            findings: findings("r1", &trace),
        };
        let table = inspection.to_string();
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[0], "runs.h5: 1 run, written by lugwheel, seed 7");
        assert_eq!(lines[2], "r1: terrain -, class -, 14 mm/s, slip 0.1, 100 N");
        let force = lines.iter().find(|line| line.starts_with("  normal_force"));
        let words: Vec<&str> = force.unwrap().split_whitespace().collect();
        assert_eq!(words[..5], ["normal_force", "N", "500", "0", "10"]);
        let last = lines.last().unwrap();
        assert!(
            last.starts_with("  warning  r1 normal_force: mean is 125.4 N"),
            "{last}"
        );
        let json = serde_json::to_value(&inspection).unwrap();
        assert_eq!(json["findings"][0]["severity"], "warning");
        assert_eq!(json["runs"][0]["channels"][1]["channel"], "normal_force");
    }

    #[test]
    fn findings_that_differ_only_in_their_run_stand_on_one_line() {
        let gap = |run: &str| Finding {
            run: run.to_owned(),
            channel: None,
            severity: Severity::Info,
            message: "wheel_radius_m is not known".to_owned(),
        };
        let inspection = Inspection {
            file: "runs.h5".to_owned(),
            created_by: String::new(),
            seed: None,
            runs: Vec::new(),
            findings: vec![gap("r1"), gap("r2"), gap("r3")],
        };
        let table = inspection.to_string();
        let last = "  info     r1: wheel_radius_m is not known (and in 2 other runs)";
        assert_eq!(table.lines().last(), Some(last), "{table}");
        assert!(table.contains("\n3 findings\n"));
    }

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
