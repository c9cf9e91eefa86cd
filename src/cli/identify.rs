//! `identify`: terrain parameters from the runs of a file.

mod class;
mod group;
mod law;
mod lines;
mod parameter_order;
mod plates;
mod summary;
mod text;
mod unused;
mod wheel;

use super::interrupt;
use super::output::Output;
use super::progress::Progress;
use super::recognize::{chosen, write_figure};
use super::target::is_same;
use crate::dataset::hdf5::RunFile;
use crate::identification::{Cylinder, Known, Parameter};
use crate::quantity::SlipRatio;
use crate::report::force_curves;
use crate::terrain::class::Wtic;
use clap::{Args, ValueEnum};
use class::Classifier;
use group::{Fit, Groups, Run};
use law::{LawName, StressName};
use std::fmt;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::str::FromStr;
use summary::{Report, Summary};
use unused::Unused;

/// Estimate terrain parameters from steady loads, slip and sinkage
///
/// Each interval of constant slip in a run gives one data point, from time series or means of drawbar_pull,
/// driving_torque, normal_force (or the commanded load), slip_ratio (or the commanded one) and, where lugs
/// enter soil, sinkage. Runs of one class and wheel are fitted together; slip has to differ among them.
/// Simulated and measured runs are treated alike. Runs of a plate in place of a wheel give k and n of p = k
/// z^n.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Identify {
    /// Run files, simulated or measured; runs of several are fitted together
    #[arg(value_name = "FILE.h5", required = true)]
    files: Vec<PathBuf>,
    /// Interaction class, which selects the model; auto recognises it run by run, or takes the run's label
    /// where that fails
    #[arg(long, value_enum, default_value_t = ClassName::Auto, ignore_case = true)]
    class: ClassName,
    /// Only this run of every file; may be given several times
    #[arg(long, value_name = "ID")]
    run: Vec<String>,
    /// Only data points with a slip ratio from LOW to HIGH, for example 0:1 to exclude a braking wheel
    #[arg(long, value_name = "LOW:HIGH", default_value_t = SlipRange::ALL, allow_hyphen_values = true)]
    slip: SlipRange,
    #[command(flatten)]
    convention: Convention,
    /// Folder for figures: forces and sinkage against slip, measured and predicted
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Range of slip ratios [-] of the rows to use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipRange {
    low: f64,
    high: f64,
}

impl SlipRange {
    /// The whole range.
    const ALL: Self = Self {
        low: -1.0,
        high: 1.0,
    };

    /// Whether rows at `slip` are used; in the default range, slips out of range are rejected later with a
    /// reason.
    fn contains(&self, slip: f64) -> bool {
        *self == Self::ALL || (self.low..=self.high).contains(&slip)
    }
}

impl fmt::Display for SlipRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.low, self.high)
    }
}

impl FromStr for SlipRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text
            .split_once(':')
            .ok_or("write LOW:HIGH, for example 0:1")?;
        let end = |text: &str| {
            let slip = text
                .trim()
                .parse()
                .map_err(|_| format!("{text:?} is no number"))?;
            let slip = SlipRatio::new(slip).map_err(|error| error.to_string())?;
            Ok::<f64, String>(slip.get())
        };
        let (low, high) = (end(ends.0)?, end(ends.1)?);
        if low <= high {
            Ok(Self { low, high })
        } else {
            Err(format!("{low} is above {high}; write LOW:HIGH"))
        }
    }
}

/// Conventions of wheel and contact.
#[derive(Debug, Clone, Args)]
pub struct Convention {
    /// Equations of soil that lugs enter; default: own for a wheel with known lugs, and for a smooth wheel
    /// under several loads; otherwise, and with --cylinder, paper
    #[arg(long, value_enum)]
    law: Option<LawName>,
    /// Stress distribution assumed by --law own
    #[arg(long, value_enum, default_value_t = StressName::WongReece)]
    stress: StressName,
    /// Bulk density of the soil that pushes lugs, for --law own [default: 1600, dry sand]
    #[arg(long, value_name = "KG_M3", value_parser = bulk_density)]
    bulk_density: Option<f64>,
    /// Thickness of a lug along the circumference, for --law own [default: the run file's, else 0.003]
    #[arg(long, value_name = "M", value_parser = lug_thickness)]
    lug_thickness: Option<f64>,
    /// Cylinder equivalent to the lugged wheel in the paper's equations
    #[arg(long, value_enum, default_value_t = CylinderName::Rim)]
    cylinder: CylinderName,
    /// Exit angle coefficient c3 [-], from -1 to 0, given and not fitted [default: -0.2 by --law own, as of
    /// dry sand; 0 by --law paper]
    #[arg(long, value_name = "C3", allow_negative_numbers = true, value_parser = exit_angle)]
    exit_angle: Option<f64>,
    /// A parameter known from another measurement, which is not fitted: k_s, n0, n1, c1, c2, c, phi or K in
    /// the unit of the result; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = known)]
    known: Vec<(Parameter, f64)>,
}

impl Convention {
    /// Whether an option applies only to the paper's equations.
    fn is_of_paper(&self) -> bool {
        self.cylinder != CylinderName::Rim
    }

    /// The given parameters, which are not fitted.
    fn known(&self) -> Known {
        let none = Known::default();
        let known = self.known.iter();
        known.fold(none, |known, (parameter, value)| {
            known.with(*parameter, *value)
        })
    }
}

const EXAMPLES: &str = "\
Examples:
  lugwheel identify measured.h5
  lugwheel identify slip_01.h5 slip_02.h5 slip_04.h5
  lugwheel identify runs.h5 --class LEIS --run run_000003 --run run_000004
  lugwheel identify plates.h5
  lugwheel identify measured.h5 --known n0=1.10
  lugwheel identify measured.h5 --slip 0:1
  lugwheel identify runs.h5 --law paper --cylinder lug-tips --out output/parameters --json
  lugwheel identify runs.h5 --law own --bulk-density 1500 --lug-thickness 0.002

Classes: ALCT (all lugs touch: c = K = 0), SLCT (some do: c = 0), LEIS (lugs enter soil: all
parameters). Laws of soil that lugs enter: own integrates the stress over rim and lugs, as the simulation
does; paper is (62)-(66), whose parameters absorb the effect of the lugs. Rows of one load identify
c + sigma tan(phi) and k_s z^N, and neither phi nor c nor n0. All intervals are conditional on the model: read
the warnings first. Forces are weighted by their stated uncertainties and 1 % for calibration; means without
a stated sd by that 1 % alone.";

/// Which class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ClassName {
    /// As recognised
    Auto,
    /// All lugs contact the surface
    #[value(name = "ALCT")]
    Alct,
    /// Some do
    #[value(name = "SLCT")]
    Slct,
    /// Lugs enter the soil
    #[value(name = "LEIS")]
    Leis,
}

impl ClassName {
    fn given(self) -> Option<Wtic> {
        match self {
            Self::Auto => None,
            Self::Alct => Some(Wtic::Alct),
            Self::Slct => Some(Wtic::Slct),
            Self::Leis => Some(Wtic::Leis),
        }
    }
}

/// Which cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CylinderName {
    /// The rim, as in the paper
    Rim,
    /// The circle through the lugs' edges
    LugTips,
}

impl CylinderName {
    fn cylinder(self) -> Cylinder {
        match self {
            Self::Rim => Cylinder::Rim,
            Self::LugTips => Cylinder::LugTips,
        }
    }
}

fn exit_angle(text: &str) -> Result<f64, String> {
    within(text, [-1.0, 0.0])
}

fn bulk_density(text: &str) -> Result<f64, String> {
    within(text, [100.0, 5.0e3])
}

fn lug_thickness(text: &str) -> Result<f64, String> {
    within(text, [0.0, 0.1])
}

/// A number in a range.
fn within(text: &str, [low, high]: [f64; 2]) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "give a number".to_owned())?;
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(format!("it has to be in [{low}, {high}]"))
    }
}

fn known(text: &str) -> Result<(Parameter, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    let parameter = Parameter::ALL.into_iter().find(|of| of.name() == name);
    let parameter = parameter.ok_or_else(|| {
        let names = Parameter::ALL.map(Parameter::name).join(", ");
        format!("there is no parameter {name:?}; there are {names}")
    })?;
    let value: f64 = value.parse().map_err(|_| {
        format!(
            "{value:?} is no number; give {name} in {}",
            parameter.unit()
        )
    })?;
    let checked = parameter.checked(value);
    checked
        .map(|value| (parameter, value))
        .map_err(|error| error.to_string())
}

/// A file is named twice.
#[derive(Debug, thiserror::Error)]
#[error("{} is given twice; name each file once, as its rows count as independent", path.display())]
pub struct GivenTwice {
    path: PathBuf,
}

/// No run of the files gives parameters.
#[derive(Debug, thiserror::Error)]
#[error("no terrain parameters from {files}; {}", text::reasons(unused))]
pub struct NothingIdentified {
    files: String,
    unused: Unused,
}

impl Identify {
    /// Identifies the parameters and prints them.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let runs = self.runs()?;
        self.claim(output, runs.len())?;
        let mut classifier = Classifier::new(self.class.given())?;
        let mut groups = Groups::default();
        let progress = Progress::of_runs(output, "identify", runs.len());
        for run in &runs {
            interrupt::check()?;
            groups.add(run, &mut classifier, self.slip);
            progress.advance(1.0);
        }
        let (fits, plates, unused) = groups.fit(&self.convention);
        drop(progress);
        if fits.is_empty() && plates.is_empty() {
            let files = self.file_names();
            return Err(NothingIdentified { files, unused }.into());
        }
        let figures = self.out.as_deref().map(|folder| draw(folder, &fits));
        let mut figures = figures.transpose()?.unwrap_or_default().into_iter();
        let report = |fit| Report {
            figure: figures.next(),
            ..Report::of(fit)
        };
        let reports = fits.iter().map(report).collect();
        output.print(&Summary::new(self.file_names(), reports, plates, unused))
    }

    /// Claims the folder of figures, and every figure that this number of runs may give.
    fn claim(&self, output: &Output, runs: usize) -> anyhow::Result<()> {
        let Some(folder) = &self.out else {
            return Ok(());
        };
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        let claim = output.claim(&inputs);
        claim.folder(folder)?;
        let classes = [Wtic::Alct, Wtic::Slct, Wtic::Leis];
        let names = |number| classes.map(|class| figure_name(class, number));
        claim.files_in(folder, (1..=runs).flat_map(names))
    }

    /// The selected runs, file after file.
    fn runs(&self) -> anyhow::Result<Vec<Run>> {
        let mut runs = Vec::new();
        for (place, path) in self.files.iter().enumerate() {
            // Repeated rows would count as independent.
            if self.files[..place].iter().any(|it| is_same(it, path)) {
                let path = path.clone();
                return Err(GivenTwice { path }.into());
            }
            let file = Rc::new(RunFile::open(path)?);
            let chosen = chosen(&file, &self.run)?.into_iter();
            runs.extend(chosen.map(|id| Run {
                name: match self.files.len() {
                    1 => id.clone(),
                    _ => format!("{}:{id}", path.display()),
                },
                file: Rc::clone(&file),
                id,
            }));
        }
        Ok(runs)
    }

    /// The files by name; the first and last of many.
    fn file_names(&self) -> String {
        let names: Vec<String> = self.files.iter().map(|f| f.display().to_string()).collect();
        match &names[..] {
            [first, .., last] if names.len() > 3 => {
                format!("{} files from {first} to {last}", names.len())
            }
            few => few.join(", "),
        }
    }
}

/// The figure of the fit of this number, from 1, among those of its class.
fn figure_name(class: Wtic, number: usize) -> String {
    match number {
        1 => format!("forces_{class}.svg"),
        number => format!("forces_{class}_{number}.svg"),
    }
}

/// Draws every fit into a folder that the command has claimed; the names of the figures.
fn draw(folder: &Path, fits: &[Fit]) -> anyhow::Result<Vec<String>> {
    let figures = fits.iter().enumerate().map(|(number, fit)| {
        let class = fit.estimate.class;
        let before = fits[..number].iter();
        let before = before.filter(|fit| fit.estimate.class == class).count();
        let name = figure_name(class, before + 1);
        let title = format!("{class}: {}", fit.wheel);
        let svg = force_curves(&title, &fit.estimate, &fit.predictor, &fit.rows());
        write_figure(folder, &name, &svg)
    });
    figures.collect()
}
