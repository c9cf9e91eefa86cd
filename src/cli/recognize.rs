//! `recognize`: the class of every window of a run file.

mod figures;
mod reference;
mod summary;

use super::interrupt::{self, Interrupted};
use super::output::{self, Output};
use super::progress::Progress;
use crate::dataset::hdf5::RunFile;
use crate::features::{Settings, Window};
use crate::recognition::{Method, Recognizer};
use clap::{Args, ValueEnum};
use figures::Figures;
use std::path::{Path, PathBuf};
use summary::Summary;

/// Recognise how the lugs contact the ground, window by window
///
/// ALCT: all lugs contact the surface. SLCT: some do. LEIS: lugs enter the soil. UWTIC: cannot be
/// recognised, with the reason. Needs the channel acceleration_y, and wheel_angle or forward_speed;
/// simulated and measured runs, labelled or not. Where the true class is known, the result is
/// scored against it.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Recognize {
    /// Run file, simulated or measured
    #[arg(value_name = "FILE.h5")]
    file: PathBuf,
    /// Method of recognition
    #[arg(long, value_enum, default_value_t = MethodName::Improved)]
    method: MethodName,
    /// Length of the windows [s] [default: 15]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = super::positive)]
    window: Option<f64>,
    /// Define windows by number of lug passes (wheel angle) instead of time
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = super::positive, conflicts_with = "window")]
    window_passes: Option<f64>,
    /// Runs on flat hard ground (REF), measured on the same rig, that normalise the features
    #[arg(long, value_name = "REF.h5")]
    reference: Option<PathBuf>,
    /// Corner frequency of the low-pass before feature extraction [Hz] [default: 100]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = super::positive)]
    bandwidth: Option<f64>,
    /// Only this run; may be given several times
    #[arg(long, value_name = "ID")]
    run: Vec<String>,
    /// Folder for figures: features, planes, every run, confusion matrix
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  lugwheel recognize output/single_wheel_ht/runs.h5
  lugwheel recognize runs.h5 --method paper --reference ref.h5 --out output/classes
  lugwheel recognize runs.h5 --window-passes 4 --run run_000003 --json

Features are normalised by those of the same wheel on flat hard ground: measured with --reference, otherwise
computed, with the sensors of the scenario if the file contains one.
--out draws a figure of every run; --run selects runs.";

/// Method of recognition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// The paper's regions of the features; needs no wheel_angle, but answers UWTIC more often
    Paper,
    /// Tests each lug pass for an impact synchronous with the lug rotation; needs no zero of the wheel angle
    Improved,
}

impl MethodName {
    fn method(self) -> Method {
        match self {
            Self::Paper => Method::Paper,
            Self::Improved => Method::Improved,
        }
    }
}

/// A file that cannot be used for recognition.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// There is nothing in it.
    #[error("{} has no runs", path.display())]
    NoRuns {
        /// The file.
        path: PathBuf,
    },
    /// None of its runs can be recognised.
    #[error("no run of {} can be recognised; run {run}: {reason}", path.display())]
    NoneRecognizable {
        /// The file.
        path: PathBuf,
        /// The first of the runs.
        run: String,
        /// What it lacks.
        reason: String,
    },
    /// No run is as long as the windows asked for.
    #[error("--window {asked} s is longer than the longest run of {} ({longest} s)", path.display())]
    Window {
        /// The file.
        path: PathBuf,
        /// Length of the windows [s].
        asked: f64,
        /// Length of the longest run [s].
        longest: f64,
    },
    /// No acceleration is sampled fast enough.
    #[error(
        "--bandwidth {asked} Hz is above half the sample rate of acceleration_y in {} ({nyquist} Hz)",
        path.display()
    )]
    Bandwidth {
        /// The file.
        path: PathBuf,
        /// Corner asked for [Hz].
        asked: f64,
        /// Half of the highest sample rate [Hz].
        nyquist: f64,
    },
    /// Its runs make no reference.
    #[error("{} cannot be the reference: {reason}", path.display())]
    NoReference {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl Recognize {
    /// Recognises the runs and prints their classes.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let settings = self.settings();
        let file = RunFile::open(&self.file)?;
        let runs = chosen(&file, &self.run)?;
        self.claim(output, &runs)?;
        self.check(&file, &runs)?;
        let mut figures = self.out.as_deref().map(Figures::new);
        let reference = match &self.reference {
            Some(path) => reference::measured(path, settings)?,
            None => reference::computed(&file, &runs, settings),
        };
        let mut summary = Summary::new(file.path(), self.method.method(), reference.origin);
        let methods = [self.method.method()];
        let mut recognizer = Recognizer::new(settings, reference.reference, &methods)?;
        let progress = Progress::of_runs(output, "recognize", runs.len());
        for id in &runs {
            self.go_on()?;
            summary.add(&file, id, &mut recognizer, figures.as_mut())?;
            progress.advance(1.0);
        }
        drop(progress);
        if let Some(unfit) = summary.nothing_recognized(file.path()) {
            return Err(unfit.into());
        }
        if let Some(figures) = figures {
            summary.figures = figures.finish(summary.confusion())?;
        }
        output.print(&summary)
    }

    /// Claims the folder of figures, and all figures that may be drawn.
    fn claim(&self, output: &Output, runs: &[String]) -> anyhow::Result<()> {
        let Some(folder) = &self.out else {
            return Ok(());
        };
        let inputs = std::iter::once(&self.file).chain(&self.reference);
        let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
        let claim = output.claim(&inputs);
        claim.folder(folder)?;
        claim.files_in(folder, figures::names(runs))
    }

    /// # Errors
    /// `Unfit` for windows longer, or a bandwidth higher, than every run of the `file` allows.
    fn check(&self, file: &RunFile, runs: &[String]) -> Result<(), Unfit> {
        let window = self.window.unwrap_or(0.0);
        let bandwidth = self.bandwidth.unwrap_or(0.0);
        if window == 0.0 && bandwidth == 0.0 {
            return Ok(());
        }
        let (mut longest, mut nyquist) = (0.0_f64, 0.0_f64);
        // What cannot be read is reported where it is recognised.
        for trace in runs.iter().flat_map(|id| file.read(id)) {
            let Some(acceleration) = trace.channel("acceleration_y") else {
                continue;
            };
            longest = longest.max(acceleration.duration());
            nyquist = nyquist.max(0.5 * acceleration.sample_rate);
            if longest >= window && nyquist >= bandwidth {
                return Ok(());
            }
        }
        let path = file.path().to_owned();
        if longest == 0.0 {
            return Ok(());
        }
        Err(if longest < window {
            Unfit::Window {
                path,
                asked: window,
                longest,
            }
        } else {
            Unfit::Bandwidth {
                path,
                asked: bandwidth,
                nyquist,
            }
        })
    }

    fn settings(&self) -> Settings {
        let ours = Settings::default();
        let passes = self.window_passes.map(Window::LugPasses);
        let seconds = self.window.map(Window::Seconds);
        Settings {
            window: passes.or(seconds).unwrap_or(ours.window),
            bandwidth: self.bandwidth.unwrap_or(ours.bandwidth),
            ..ours
        }
    }

    /// # Errors
    /// `Interrupted` when a stop is requested, with what that leaves behind.
    fn go_on(&self) -> Result<(), Interrupted> {
        if !interrupt::is_requested() {
            return Ok(());
        }
        let left = |folder: &Path| format!("the figures in {} are whole", folder.display());
        let nothing = || "nothing was written".to_owned();
        Err(Interrupted(self.out.as_deref().map_or_else(nothing, left)))
    }
}

/// The runs asked for, all of which there are, each once; every run where none is asked for.
///
/// # Errors
/// `Unfit` for a file without runs; those of reading a run's attributes.
pub fn chosen(file: &RunFile, asked: &[String]) -> anyhow::Result<Vec<String>> {
    if file.runs().is_empty() {
        let path = file.path().to_owned();
        return Err(Unfit::NoRuns { path }.into());
    }
    if asked.is_empty() {
        return Ok(file.runs().to_vec());
    }
    let mut chosen: Vec<String> = Vec::new();
    for id in asked {
        file.attributes(id)?;
        if !chosen.contains(id) {
            chosen.push(id.clone());
        }
    }
    Ok(chosen)
}

/// Writes a figure and notes its name.
pub fn write_figure(folder: &Path, name: &str, svg: &str) -> anyhow::Result<String> {
    let path = folder.join(name);
    output::write_file(&path, svg)?;
    Ok(path.display().to_string())
}
