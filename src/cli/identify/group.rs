//! Runs of one class and wheel, fitted together.

use super::Convention;
use super::class::{Teller, Told};
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::identification::{
    Cylinder, Estimate, Identification, IdentifyError, Predictor, Setting, SteadyLoad, pool,
    steady_loads,
};
use lugwheel::quantity::RangeError;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::RunAttributes;
use lugwheel::trace::wheel::Lugs;
use serde::Serialize;
use std::fmt;
use std::rc::Rc;

/// A run of a file.
#[derive(Debug, Clone)]
pub struct Run {
    /// What it is called in results: its id, and the file's name where there are several.
    pub name: String,
    /// Its file.
    pub file: Rc<RunFile>,
    /// Its id there.
    pub id: String,
}

/// A run that gives nothing, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Its name.
    pub run: String,
    /// Why.
    pub reason: String,
}

/// The wheel of a run.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct WheelOfRun {
    /// Rim radius [m].
    pub radius_m: f64,
    /// Width [m].
    pub width_m: f64,
    /// Number of lugs; none where it is unknown.
    pub lug_count: Option<u32>,
    /// Lug height [m]; none where it is unknown.
    pub lug_height_m: f64,
}

impl WheelOfRun {
    fn of(run: &RunAttributes) -> Self {
        Self {
            radius_m: run.wheel_radius,
            width_m: run.wheel_width,
            // A smooth wheel's file need not say how high its lugs are.
            lug_height_m: if run.lugs().are_none() {
                0.0
            } else {
                run.lug_height
            },
            lug_count: run.lug_count,
        }
    }

    /// Its lugs.
    fn lugs(&self) -> Lugs {
        Lugs {
            count: self.lug_count,
            height: self.lug_height_m,
        }
    }

    /// Whether it is the same wheel; unknown lengths are the same as unknown ones.
    fn is(&self, other: &Self) -> bool {
        let lengths = |wheel: &Self| {
            let Self {
                radius_m,
                width_m,
                lug_height_m,
                ..
            } = wheel;
            [radius_m, width_m, lug_height_m].map(|length| length.to_bits())
        };
        self.lug_count == other.lug_count && lengths(self) == lengths(other)
    }

    fn setting(&self, convention: &Convention) -> Setting {
        let is_rim = convention.cylinder.cylinder() == Cylinder::Rim;
        Setting {
            // The rim's equations do not need a height that nobody knows.
            lug_height: match self.lug_height_m {
                unknown if unknown.is_nan() && is_rim => 0.0,
                height => height,
            },
            cylinder: convention.cylinder.cylinder(),
            exit_angle: convention.exit_angle,
            known: convention.known(),
            ..Setting::new(lugwheel::soil::closed_form::Rim {
                radius: self.radius_m,
                width: self.width_m,
            })
        }
    }
}

impl fmt::Display for WheelOfRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // To a hundredth of a millimetre.
        let shown = |length: f64| (length * 1.0e5).round() / 1.0e2;
        let [radius, width] = [self.radius_m, self.width_m].map(shown);
        write!(
            f,
            "rim radius {radius} mm, width {width} mm, {}",
            self.lugs()
        )
    }
}

/// A run and its rows.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Its name.
    pub run: String,
    /// Who told its class.
    pub told: Told,
    /// Its ground, where the file says.
    pub terrain: Option<TerrainLabel>,
    /// One for each steady interval.
    pub rows: Vec<SteadyLoad>,
    /// Whether they were cut from time series.
    sampled: bool,
}

/// Runs of one class and wheel.
#[derive(Debug, Clone)]
struct Group {
    class: Wtic,
    wheel: WheelOfRun,
    runs: Vec<Rows>,
}

/// What a group came to.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Its wheel.
    pub wheel: WheelOfRun,
    /// How the equations take the wheel.
    pub setting: Setting,
    /// The runs used.
    pub runs: Vec<Rows>,
    /// The parameters.
    pub estimate: Estimate,
    /// What they predict.
    pub predictor: Predictor,
}

impl Fit {
    /// The rows of all its runs.
    pub fn rows(&self) -> Vec<SteadyLoad> {
        let rows = self.runs.iter().flat_map(|run| &run.rows);
        rows.copied().collect()
    }
}

/// All runs of a file by class and wheel.
#[derive(Debug, Default)]
pub struct Groups {
    groups: Vec<Group>,
    left_out: Vec<LeftOut>,
}

impl Groups {
    /// Takes a run. One that cannot be read, classed or cut into rows is left out with its reason.
    pub fn add(&mut self, run: &Run, teller: &mut Teller) {
        if let Err(reason) = self.take(run, teller) {
            let run = run.name.clone();
            self.left_out.push(LeftOut { run, reason });
        }
    }

    fn take(&mut self, run: &Run, teller: &mut Teller) -> Result<(), String> {
        let trace = run.file.read(&run.id);
        let trace = trace.map_err(|error| error.to_string())?;
        let rows = steady_loads(&trace).map_err(|error| error.to_string())?;
        let told = teller.tell(&trace)?;
        let wheel = WheelOfRun::of(&trace.attributes);
        let class = told.class;
        let run = Rows {
            run: run.name.clone(),
            told,
            terrain: trace.attributes.terrain,
            rows,
            sampled: trace.channel("drawbar_pull").is_some(),
        };
        let mut groups = self.groups.iter_mut();
        match groups.find(|group| group.class == class && group.wheel.is(&wheel)) {
            Some(group) => group.runs.push(run),
            None => self.groups.push(Group {
                class,
                wheel,
                runs: vec![run],
            }),
        }
        Ok(())
    }

    /// Fits every group; what came of them, and the runs that are in none.
    pub fn fit(mut self, convention: &Convention) -> (Vec<Fit>, Vec<LeftOut>) {
        let left_out = &mut self.left_out;
        let fits = self.groups.into_iter();
        let fits = fits
            .filter_map(|mut group| {
                group.pool();
                group.fit(convention, left_out)
            })
            .collect();
        (fits, self.left_out)
    }
}

impl Group {
    /// Rows from time series have their uncertainties in common.
    fn pool(&mut self) {
        let sampled = self.runs.iter_mut().filter(|run| run.sampled);
        let mut rows: Vec<&mut SteadyLoad> = sampled.flat_map(|run| &mut run.rows).collect();
        pool(&mut rows);
    }

    /// The parameters of the runs whose rows are all in their ranges; the others are left out.
    fn fit(mut self, convention: &Convention, left_out: &mut Vec<LeftOut>) -> Option<Fit> {
        let setting = self.wheel.setting(convention);
        while !self.runs.is_empty() {
            let rows: Vec<SteadyLoad> = self
                .runs
                .iter()
                .flat_map(|run| &run.rows)
                .copied()
                .collect();
            match identified(&rows, self.class, &setting) {
                Ok((estimate, predictor)) => {
                    return Some(Fit {
                        wheel: self.wheel,
                        setting,
                        runs: self.runs,
                        estimate,
                        predictor,
                    });
                }
                Err(IdentifyError::Row { row, reason }) => {
                    left_out.push(self.without(row, &reason, &setting));
                }
                Err(error) => {
                    let reason = self.refusal(&error);
                    left_out.extend(self.runs.drain(..).map(|Rows { run, .. }| LeftOut {
                        run,
                        reason: reason.clone(),
                    }));
                }
            }
        }
        None
    }

    /// Takes out the run with the faulty `row`, counted from 1 over all runs.
    fn without(&mut self, row: usize, fault: &RangeError, setting: &Setting) -> LeftOut {
        let mut row = row;
        let mut at = 0;
        while row > self.runs[at].rows.len() {
            row -= self.runs[at].rows.len();
            at += 1;
        }
        LeftOut {
            reason: format!("row {row}: {fault}; {}", way_out(fault, setting)),
            run: self.runs.remove(at).run,
        }
    }

    fn refusal(&self, error: &IdentifyError) -> String {
        let way_out = match error {
            IdentifyError::Setting(_) => "; state the wheel in the campaign and import it again",
            IdentifyError::TooFewRows { .. } | IdentifyError::TooFewPulls { .. } => {
                "; a row is a stretch of steady slip: add runs at other slips or loads"
            }
            _ => "",
        };
        format!("{error}{way_out} (class {}, {})", self.class, self.wheel)
    }
}

/// The parameters of rows, and what they predict.
fn identified(
    rows: &[SteadyLoad],
    class: Wtic,
    setting: &Setting,
) -> Result<(Estimate, Predictor), IdentifyError> {
    let identification = Identification::new(rows, class, setting)?;
    let mut estimate = identification.estimate()?;
    identification.profile(&mut estimate);
    let predictor = Predictor::new(&identification, &estimate);
    Ok((estimate, predictor))
}

/// What to do about a number out of its range.
fn way_out(fault: &RangeError, setting: &Setting) -> String {
    match fault.quantity {
        "sinkage" if fault.value.is_nan() => {
            "record the channel or mean sinkage, or give the class with --class if lugs do not \
             enter the soil"
                .to_owned()
        }
        "sinkage" if fault.value > setting.rim.radius => {
            "check that it is in m and counted from the undisturbed surface".to_owned()
        }
        "sinkage" if setting.cylinder == Cylinder::Rim && setting.lug_height > 0.0 => {
            "the rim does not reach the soil: --cylinder lug-tips takes the circle that does"
                .to_owned()
        }
        "load" => "check the sign of normal_force: the ground pushes the wheel up".to_owned(),
        _ => "correct it, or choose other runs with --run".to_owned(),
    }
}
