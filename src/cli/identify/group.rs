//! Runs of one class and wheel, fitted together.

use super::class::{Classification, Classifier};
use super::law::{Chosen, LawReport, OtherStress};
use super::plates::{self, PlateReport, PlateTests};
use super::unused::{LeftOut, StretchLeftOut, Unused};
use super::wheel::WheelOfRun;
use super::{Convention, SlipRange};
use crate::dataset::hdf5::RunFile;
use crate::dataset::inspection::{self, Finding};
use crate::identification::{
    Cylinder, Estimate, Identification, IdentifyError, Law, Predictor, Scope, Setting, SteadyLoad,
    SteadyRow, pool, steady_stretches,
};
use crate::quantity::RangeError;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::Trace;
use std::rc::Rc;

/// A run of a file.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name in results: its id, and the file's name where there are several.
    pub name: String,
    /// Its file.
    pub file: Rc<RunFile>,
    /// Its id there.
    pub id: String,
}

/// Conventions of the equations for a wheel.
fn setting(wheel: &WheelOfRun, convention: &Convention, chosen: &Chosen) -> Setting {
    let is_rim = convention.cylinder.cylinder() == Cylinder::Rim;
    Setting {
        // The rim's equations do not need the lug height.
        lug_height: match wheel.lug_height_m {
            unknown if unknown.is_nan() && is_rim => 0.0,
            height => height,
        },
        cylinder: convention.cylinder.cylinder(),
        exit_angle: chosen.exit_angle,
        known: convention.known(),
        law: chosen.law,
        ..Setting::new(crate::soil::closed_form::Rim {
            radius: wheel.radius_m,
            width: wheel.width_m,
        })
    }
}

/// A run and its rows.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Its name.
    pub run: String,
    /// Its class.
    pub classification: Classification,
    /// Its ground, if stated in the file.
    pub terrain: Option<TerrainLabel>,
    /// One for each steady interval.
    pub rows: Vec<SteadyRow>,
    /// What is wrong with it, as `inspect` finds it.
    pub errors: Vec<Finding>,
    /// Whether the rows are from time series.
    sampled: bool,
}

/// Runs of one class and wheel.
#[derive(Debug, Clone)]
struct Group {
    class: Wtic,
    wheel: WheelOfRun,
    runs: Vec<Rows>,
}

/// Result of a group.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Its wheel.
    pub wheel: WheelOfRun,
    /// Conventions of the equations.
    pub setting: Setting,
    /// The equations.
    pub law: LawReport,
    /// The parameters for the alternative stress distribution, which is assumed and not fitted.
    pub other_stress: Option<OtherStress>,
    /// The runs used.
    pub runs: Vec<Rows>,
    /// The parameters.
    pub estimate: Estimate,
    /// Predictions from the estimate.
    pub predictor: Predictor,
}

impl Fit {
    /// Why its parameters are effective ones; `None` where they may be the soil's.
    pub fn scope(&self) -> Option<Scope> {
        Scope::of(&self.setting.law, self.wheel.lugs(), &self.rows())
    }

    /// The rows of all its runs.
    pub fn rows(&self) -> Vec<SteadyLoad> {
        loads(&self.runs)
    }
}

fn loads(runs: &[Rows]) -> Vec<SteadyLoad> {
    let rows = runs.iter().flat_map(|run| &run.rows);
    rows.map(|row| row.load).collect()
}

/// All runs of a file by class and wheel.
#[derive(Debug, Default)]
pub struct Groups {
    groups: Vec<Group>,
    plates: PlateTests,
    unused: Unused,
}

impl Groups {
    /// Adds the rows of a run with a slip in `slips` [-]. A run that cannot be read, classified or cut into
    /// rows is recorded as unused with the reason, and so is a stretch that gives no row.
    pub fn add(&mut self, run: &Run, classifier: &mut Classifier, slips: SlipRange) {
        if let Err(reason) = self.take(run, classifier, slips) {
            let run = run.name.clone();
            self.unused.runs.push(LeftOut { run, reason });
        }
    }

    fn take(
        &mut self,
        run: &Run,
        classifier: &mut Classifier,
        slips: SlipRange,
    ) -> Result<(), String> {
        let trace = run.file.read(&run.id);
        let trace = trace.map_err(|error| error.to_string())?;
        if trace.attributes.plate.is_some() {
            return self.plates.add(&run.name, &trace);
        }
        let rows = self.rows(&run.name, &trace, slips)?;
        let classification = classifier.classify(&trace)?;
        let wheel = WheelOfRun::of(&trace.attributes);
        let class = classification.class;
        let run = Rows {
            run: run.name.clone(),
            classification,
            terrain: trace.attributes.terrain,
            rows,
            errors: inspection::errors(&run.name, &trace),
            sampled: trace.channel("drawbar_pull").is_some(),
        };
        let mut groups = self.groups.iter_mut();
        match groups.find(|group| group.class == class && group.wheel.is(&wheel)) {
            Some(group) => {
                let known = &mut group.wheel.lug_thickness_m;
                *known = known.or(wheel.lug_thickness_m);
                group.runs.push(run);
            }
            None => self.groups.push(Group {
                class,
                wheel,
                runs: vec![run],
            }),
        }
        Ok(())
    }

    /// The rows of a run.
    ///
    /// # Errors
    /// The reason why there are none.
    fn rows(
        &mut self,
        run: &str,
        trace: &Trace,
        slips: SlipRange,
    ) -> Result<Vec<SteadyRow>, String> {
        let stretches = steady_stretches(trace).map_err(|error| error.to_string())?;
        let mut rows = Vec::new();
        let mut refused = Vec::new();
        for stretch in stretches {
            let interval = stretch.interval;
            match stretch.row {
                Ok(row) => rows.push(row),
                Err(reason) => refused.push(StretchLeftOut {
                    run: run.to_owned(),
                    interval_s: interval,
                    reason: reason.to_string(),
                }),
            }
        }
        if rows.is_empty() {
            let first = refused.into_iter().next();
            let reason = first.map_or_else(String::new, |stretch| stretch.reason);
            return Err(reason + plates::way_out(trace));
        }
        self.unused.stretches.extend(refused);
        // NaN is rejected later with a reason, not by the range.
        rows.retain(|row| row.load.slip.is_nan() || slips.contains(row.load.slip));
        if rows.is_empty() {
            Err(format!("no row has a slip in --slip {slips}"))
        } else {
            Ok(rows)
        }
    }

    /// Fits every group; the fits, the plate tests and what was not used.
    pub fn fit(mut self, convention: &Convention) -> (Vec<Fit>, Vec<PlateReport>, Unused) {
        let unused = &mut self.unused;
        let widths: Vec<f64> = self
            .groups
            .iter()
            .map(|group| group.wheel.width_m)
            .collect();
        let fits = self.groups.into_iter();
        let fits = fits
            .filter_map(|mut group| {
                group.pool();
                group.fit(convention, unused)
            })
            .collect();
        let plates = self.plates.fit(&widths, &mut unused.runs);
        (fits, plates, self.unused)
    }
}

impl Group {
    /// Pools the uncertainties of rows from time series, except for the drifts.
    fn pool(&mut self) {
        let sampled = self.runs.iter_mut().filter(|run| run.sampled);
        let rows = sampled.flat_map(|run| &mut run.rows);
        pool(&mut rows.map(|row| &mut row.load).collect::<Vec<_>>());
        let rows = self.runs.iter_mut().flat_map(|run| &mut run.rows);
        rows.for_each(SteadyRow::widen);
    }

    /// Fits the rows that are within their ranges; the others are recorded as unused.
    fn fit(mut self, convention: &Convention, unused: &mut Unused) -> Option<Fit> {
        if let Some(reason) = self.upward_sinkage() {
            self.leave_out(&reason, unused);
        }
        while !self.runs.is_empty() {
            let rows = loads(&self.runs);
            let chosen = Chosen::of(convention, &self.wheel, self.class, &rows);
            let chosen = chosen
                .map_err(|reason| self.leave_out(&reason, unused))
                .ok()?;
            let setting = setting(&self.wheel, convention, &chosen);
            match identified(&rows, self.class, &setting) {
                Ok((estimate, predictor)) => {
                    return Some(Fit {
                        wheel: self.wheel,
                        setting,
                        law: chosen.report(),
                        other_stress: OtherStress::of(&rows, self.class, &setting),
                        runs: self.runs,
                        estimate,
                        predictor,
                    });
                }
                Err(IdentifyError::Row { row, reason }) => {
                    self.without(row, &faulty(&reason, &setting), unused);
                }
                Err(error) => {
                    let reason = self.refusal(&error);
                    self.leave_out(&reason, unused);
                }
            }
        }
        None
    }

    /// Records all runs as unused.
    fn leave_out(&mut self, reason: &str, unused: &mut Unused) {
        let left_out = self.runs.drain(..).map(|Rows { run, .. }| LeftOut {
            run,
            reason: reason.to_owned(),
        });
        unused.runs.extend(left_out);
    }

    /// Removes the faulty `row`, counted from 1 over all runs, and its run where it has no other.
    fn without(&mut self, row: usize, fault: &str, unused: &mut Unused) {
        let mut row = row;
        let mut at = 0;
        while row > self.runs[at].rows.len() {
            row -= self.runs[at].rows.len();
            at += 1;
        }
        if self.runs[at].rows.len() > 1 {
            let run = &mut self.runs[at];
            unused.stretches.push(StretchLeftOut {
                run: run.run.clone(),
                interval_s: run.rows.remove(row - 1).interval,
                reason: fault.to_owned(),
            });
            return;
        }
        unused.runs.push(LeftOut {
            reason: format!("row {row}: {fault}"),
            run: self.runs.remove(at).run,
        });
    }

    /// Detects sinkages with reversed sign: all are negative and decrease with slip, while a slipping wheel
    /// sinks deeper.
    fn upward_sinkage(&self) -> Option<String> {
        let mut points: Vec<[f64; 2]> = loads(&self.runs)
            .iter()
            .map(|row| [row.slip, row.sinkage])
            .filter(|point| point.iter().all(|x| x.is_finite()))
            .collect();
        points.sort_by(|one, other| one[0].total_cmp(&other[0]));
        let [first, .., last] = points[..] else {
            return None;
        };
        let is_upward = points.iter().all(|[_, sinkage]| *sinkage < 0.0)
            && points.windows(2).all(|pair| pair[1][1] <= pair[0][1])
            && last[1] < first[1];
        let in_mm = |sinkage: f64| 1.0e3 * sinkage;
        (self.class == Wtic::Leis && is_upward).then(|| {
            format!(
                "sinkage is below 0 and falls as slip grows, from {:.1} mm at slip {:.2} to {:.1} mm at {:.2}, but a wheel \
                 that slips more sinks deeper: it seems to be counted upward; import it with scale = -1.0",
                in_mm(first[1]),
                first[0],
                in_mm(last[1]),
                last[0]
            )
        })
    }

    fn refusal(&self, error: &IdentifyError) -> String {
        let way_out = match error {
            IdentifyError::Setting(_) => "; state the wheel in the campaign and import it again",
            IdentifyError::TooFewRows { .. } | IdentifyError::TooFewPulls { .. } => {
                "; a row is a stretch of steady slip: add runs at other slips or loads, or give parameters known \
                 otherwise with --known"
            }
            _ => "",
        };
        format!("{error}{way_out} (class {}, {})", self.class, self.wheel)
    }
}

/// The estimate and its predictor.
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

/// The fault of a row with its remedy.
fn faulty(fault: &RangeError, setting: &Setting) -> String {
    format!("{fault}; {}", way_out(fault, setting))
}

/// The remedy for a number out of its range.
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
        "sinkage" if setting.law != Law::Paper => {
            "neither rim nor lugs reach the soil: check its zero and sign".to_owned()
        }
        "sinkage" if setting.cylinder == Cylinder::Rim && setting.lug_height > 0.0 => {
            "the rim does not reach the soil: --cylinder lug-tips takes the circle that does"
                .to_owned()
        }
        "load" => "check the sign of normal_force: the ground pushes the wheel up".to_owned(),
        _ => "correct it, or choose other runs with --run".to_owned(),
    }
}
