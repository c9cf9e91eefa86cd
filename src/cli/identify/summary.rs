//! What was identified, for machines.

use super::class::ToldBy;
use super::group::{Fit, LeftOut, Rows, StretchLeftOut, Unused, WheelOfRun};
use super::law::{LawTold, OtherStress};
use super::plates::PlateReport;
use crate::identification::{
    Combination, Cylinder, Drift, Estimate, Identified, Open, Parameter, Predicted, Prediction,
    PredictionErrors, Scope, Standing, SteadyRow, Termination, TerrainParameters, Warning,
};
use crate::soil::wheel_load::WheelLoad;
use crate::terrain::class::{TerrainLabel, Wtic};
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};

/// The parameters in the order in which they are told.
const ORDER: [Parameter; 8] = [
    Parameter::SinkageModulus,
    Parameter::SinkageExponent,
    Parameter::SinkageExponentSlip,
    Parameter::StressAngle,
    Parameter::StressAngleSlip,
    Parameter::Cohesion,
    Parameter::FrictionAngle,
    Parameter::ShearModulus,
];

/// Share of a run's windows [-] below which its rows may come from several grounds.
const CLEAR: f64 = 0.9;

/// What files gave: for machines an object, or a list of several.
#[derive(Debug)]
pub struct Summary {
    /// The files by name.
    pub files: String,
    /// One for each class and wheel.
    pub reports: Vec<Report>,
    /// One for each ground that plates were pressed into.
    pub plates: Vec<PlateReport>,
    /// What gave nothing, and why.
    pub unused: Unused,
}

impl Summary {
    /// What came of files.
    pub fn new(
        files: String,
        mut reports: Vec<Report>,
        mut plates: Vec<PlateReport>,
        unused: Unused,
    ) -> Self {
        for report in &mut reports {
            report.left_out.clone_from(&unused.runs);
            report.stretches_left_out.clone_from(&unused.stretches);
        }
        for report in &mut plates {
            report.left_out.clone_from(&unused.runs);
        }
        Self {
            files,
            reports,
            plates,
            unused,
        }
    }
}

impl Serialize for Summary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (&self.reports[..], &self.plates[..]) {
            ([one], []) => one.serialize(serializer),
            ([], [one]) => one.serialize(serializer),
            (reports, plates) => {
                let reports = reports.iter().map(Either::Wheel);
                serializer.collect_seq(reports.chain(plates.iter().map(Either::Plates)))
            }
        }
    }
}

/// What a wheel or plates gave.
#[derive(Serialize)]
#[serde(untagged)]
enum Either<'a> {
    Wheel(&'a Report),
    Plates(&'a PlateReport),
}

/// What one class and wheel gave.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The class.
    pub class: Wtic,
    /// The wheel.
    pub wheel: WheelOfRun,
    /// How the equations take it.
    pub setting: SettingTold,
    /// The runs used.
    pub runs: Vec<RunTold>,
    /// The rows used.
    pub rows: Vec<RowTold>,
    /// What to know before using a number.
    pub warnings: Vec<WarningTold>,
    /// Why the parameters are effective ones, of this wheel and load; none where they may be the soil's.
    pub effective: Option<String>,
    /// The parameters by name.
    #[serde(serialize_with = "by_name")]
    pub parameters: Vec<(Parameter, ParameterTold)>,
    /// The parameters if the stress is distributed otherwise than presumed; none by the paper's equations.
    pub other_stress: Option<OtherStress>,
    /// What is known of parameters that are not identified one by one.
    pub combinations: Vec<CombinationTold>,
    /// How estimates go together.
    pub correlation: Correlation,
    /// Errors of the forces that the parameters give at the slip and sinkage measured (Table 7).
    pub force_error_percent: Forces<Option<f64>>,
    /// Errors of what they predict from slip and load.
    pub prediction_error_percent: PredictionErrors,
    /// What the paper's three stages gave; none without torques.
    pub staged: Option<StagedTold>,
    /// Why the fit stopped.
    pub termination: &'static str,
    /// Sum of squared weighted residuals [-].
    pub chi_square: f64,
    /// Measured forces less directions that they fix.
    pub degrees_of_freedom: usize,
    /// Runs that are in no fit.
    pub left_out: Vec<LeftOut>,
    /// Stretches of runs in a fit that are not in it.
    pub stretches_left_out: Vec<StretchLeftOut>,
    /// The drawing, where one was asked for.
    pub figure: Option<String>,
}

/// How the equations take the wheel.
#[derive(Debug, Serialize)]
pub struct SettingTold {
    /// `rim` or `lug_tips`.
    pub cylinder: &'static str,
    /// `c_3` [-].
    pub exit_angle: f64,
    /// The equations.
    #[serde(flatten)]
    pub law: LawTold,
}

/// A run used.
#[derive(Debug, Serialize)]
pub struct RunTold {
    /// Its name.
    pub run: String,
    /// Its ground, where the file says.
    pub terrain: Option<TerrainLabel>,
    /// Who told its class.
    #[serde(flatten)]
    pub class_by: ToldBy,
}

/// Three forces, or something of each.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Forces<T> {
    /// Drawbar pull [N].
    pub drawbar_pull: T,
    /// Vertical load [N].
    pub load: T,
    /// Driving torque [N·m].
    pub driving_torque: T,
}

/// A row as measured, and what the parameters give there.
#[derive(Debug, Serialize)]
pub struct RowTold {
    /// Its run.
    pub run: String,
    /// When it was measured [s]; none in a run of means.
    pub interval_s: Option<[f64; 2]>,
    /// Slip ratio [-].
    pub slip: f64,
    /// Sinkage [m] of the rim; none where it was not measured.
    pub sinkage: f64,
    /// The forces measured.
    #[serde(flatten)]
    pub measured: Forces<f64>,
    /// Their standard uncertainties, where they are known.
    pub uncertainty: Option<Forces<f64>>,
    /// What still changes in the interval, which its uncertainty holds.
    pub drifts: Vec<Drift>,
    /// Standard uncertainty of the slip ratio [-]; 0 where it counts as exact.
    pub slip_uncertainty: f64,
    /// Standard uncertainty of the sinkage [m]; 0 where it counts as exact.
    pub sinkage_uncertainty: f64,
    /// The forces by the parameters at this slip and sinkage.
    pub fitted: Forces<f64>,
    /// Sinkage, pull and torque by the parameters at this slip and load; none where the soil does
    /// not carry the load or static friction holds the wheel.
    pub predicted: Option<PredictionTold>,
}

/// What is predicted from slip and load.
#[derive(Debug, Serialize)]
pub struct PredictionTold {
    /// Sinkage [m] of the rim.
    pub sinkage: PredictedTold,
    /// Drawbar pull [N].
    pub drawbar_pull: PredictedTold,
    /// Driving torque [N·m].
    pub driving_torque: PredictedTold,
}

impl PredictionTold {
    fn of(prediction: &Prediction) -> Self {
        Self {
            sinkage: PredictedTold::of(&prediction.sinkage),
            drawbar_pull: PredictedTold::of(&prediction.drawbar_pull),
            driving_torque: PredictedTold::of(&prediction.driving_torque),
        }
    }
}

/// A predicted quantity.
#[derive(Debug, Serialize)]
pub struct PredictedTold {
    /// Its value.
    pub value: f64,
    /// Interval that holds 95 % of measurements; none where it is unbounded.
    pub interval95: Option<[f64; 2]>,
}

impl PredictedTold {
    fn of(predicted: &Predicted) -> Self {
        let interval = predicted.interval();
        Self {
            value: predicted.value,
            interval95: interval
                .iter()
                .all(|end| end.is_finite())
                .then_some(interval),
        }
    }
}

/// A warning.
#[derive(Debug, Serialize)]
pub struct WarningTold {
    /// Its name.
    pub kind: &'static str,
    /// What is the case.
    pub message: String,
    /// What not to believe.
    pub meaning: &'static str,
}

/// A parameter.
#[derive(Debug, Serialize)]
pub struct ParameterTold {
    /// Its value.
    pub value: f64,
    /// 95 % interval; `None` where it is unbounded.
    pub ci95: [Option<f64>; 2],
    /// Its unit.
    pub unit: &'static str,
    /// Whether the data fix it.
    pub identifiable: bool,
    /// How it came by its value.
    pub standing: &'static str,
    /// Why the data do not fix it; none where they do, or were not asked.
    pub reason: Option<String>,
    /// Whether it is of this wheel and load only.
    pub effective: bool,
}

/// A combination of parameters.
#[derive(Debug, Serialize)]
pub struct CombinationTold {
    /// What it is.
    pub name: &'static str,
    /// Where it was taken.
    pub at: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: &'static str,
}

/// How estimates go together.
#[derive(Debug, Serialize)]
pub struct Correlation {
    /// The free parameters.
    pub parameters: Vec<&'static str>,
    /// Their correlation; none with a parameter that the data do not fix at all.
    pub matrix: Vec<Vec<Option<f64>>>,
}

impl Correlation {
    /// Pairs that correlate by more than `limit`, the strongest first.
    pub fn above(&self, limit: f64) -> Vec<(&'static str, &'static str, f64)> {
        let names = &self.parameters;
        let rows = self.matrix.iter().enumerate();
        let pairs = rows.flat_map(|(i, row)| {
            let before = row.iter().take(i).enumerate();
            before.filter_map(move |(j, entry)| Some((names[j], names[i], (*entry)?)))
        });
        let mut pairs: Vec<_> = pairs.filter(|(.., value)| value.abs() > limit).collect();
        pairs.sort_by(|one, other| other.2.abs().total_cmp(&one.2.abs()));
        pairs
    }
}

/// What the paper's three stages gave.
#[derive(Debug, Serialize)]
pub struct StagedTold {
    /// Values by name.
    #[serde(serialize_with = "values_by_name")]
    pub parameters: TerrainParameters,
    /// Why each stage stopped.
    pub terminations: [&'static str; 3],
}

impl Report {
    /// What a fit gave.
    pub fn of(fit: &Fit) -> Self {
        let estimate = &fit.estimate;
        let rows = fit.runs.iter().flat_map(|run| {
            let rows = run.rows.iter();
            rows.map(|row| row_told(&run.run, row, fit))
        });
        let scope = fit.scope();
        let runs = fit.runs.iter().map(|run| RunTold {
            run: run.run.clone(),
            terrain: run.terrain,
            class_by: run.told.by.clone(),
        });
        let runs: Vec<RunTold> = runs.collect();
        let mut warnings: Vec<WarningTold> = estimate.warnings.iter().map(warning).collect();
        warnings.extend(mixed(&runs));
        warnings.extend(not_steady(fit));
        warnings.extend(unused(fit));
        warnings.extend(thickness_assumed(&fit.law));
        Self {
            class: estimate.class,
            wheel: fit.wheel,
            setting: SettingTold {
                cylinder: match fit.setting.cylinder {
                    Cylinder::Rim => "rim",
                    Cylinder::LugTips => "lug_tips",
                },
                exit_angle: fit.setting.exit_angle,
                law: fit.law.clone(),
            },
            rows: rows.collect(),
            warnings,
            effective: scope.as_ref().map(Scope::to_string),
            parameters: ORDER
                .map(|parameter| {
                    let told = parameter_told(estimate.of(parameter), scope.is_some());
                    (parameter, told)
                })
                .into(),
            other_stress: fit.other_stress.clone(),
            combinations: estimate.combinations.iter().map(combination).collect(),
            correlation: Correlation {
                parameters: free(estimate),
                matrix: estimate.correlation.clone(),
            },
            force_error_percent: Forces {
                drawbar_pull: estimate.force_errors.drawbar_pull,
                load: estimate.force_errors.load,
                driving_torque: estimate.force_errors.driving_torque,
            },
            prediction_error_percent: fit.predictor.errors(&fit.rows()),
            staged: estimate.staged.map(|staged| StagedTold {
                parameters: staged.parameters,
                terminations: staged.terminations.map(termination),
            }),
            termination: termination(estimate.termination),
            chi_square: estimate.chi_square,
            degrees_of_freedom: estimate.degrees_of_freedom,
            left_out: Vec::new(),
            stretches_left_out: Vec::new(),
            figure: None,
            runs,
        }
    }
}

fn row_told(run: &str, row: &SteadyRow, fit: &Fit) -> RowTold {
    let SteadyRow {
        load: row,
        interval,
        drifts,
    } = row;
    RowTold {
        run: run.to_owned(),
        interval_s: (interval[1] > interval[0]).then_some(*interval),
        slip: row.slip,
        sinkage: row.sinkage,
        measured: Forces {
            drawbar_pull: row.drawbar_pull,
            load: row.load,
            driving_torque: row.driving_torque,
        },
        uncertainty: row.uncertainty.map(|uncertainty| Forces {
            drawbar_pull: uncertainty.drawbar_pull,
            load: uncertainty.load,
            driving_torque: uncertainty.driving_torque,
        }),
        drifts: drifts.clone(),
        slip_uncertainty: row.uncertainty.map_or(0.0, |uncertainty| uncertainty.slip),
        sinkage_uncertainty: row
            .uncertainty
            .map_or(0.0, |uncertainty| uncertainty.sinkage),
        fitted: forces(fit.estimate.loads_at(&fit.setting, row.slip, row.sinkage)),
        predicted: fit.predictor.of_row(row).as_ref().map(PredictionTold::of),
    }
}

fn forces(load: WheelLoad) -> Forces<f64> {
    Forces {
        drawbar_pull: load.drawbar_pull,
        load: load.normal_force,
        driving_torque: load.driving_torque,
    }
}

fn parameter_told(identified: &Identified, effective: bool) -> ParameterTold {
    ParameterTold {
        value: identified.value,
        ci95: identified.ci95(),
        unit: identified.parameter.unit(),
        identifiable: identified.is_identifiable(),
        standing: match identified.standing {
            Standing::Identified => "identified",
            Standing::NotIdentifiable => "not_identifiable",
            Standing::SetByClass => "set_by_class",
            Standing::Given => "given",
        },
        reason: identified.open.as_ref().map(Open::to_string),
        effective: effective && identified.is_identifiable(),
    }
}

fn combination(combination: &Combination) -> CombinationTold {
    CombinationTold {
        name: combination.name,
        at: combination.place.clone(),
        value: combination.value,
        ci95: combination.interval,
        unit: combination.unit,
    }
}

/// Names of the parameters that the fit leaves free, in the order of their correlation.
fn free(estimate: &Estimate) -> Vec<&'static str> {
    let free = estimate.parameters.iter().filter(|identified| {
        matches!(
            identified.standing,
            Standing::Identified | Standing::NotIdentifiable
        )
    });
    free.map(|identified| identified.parameter.name()).collect()
}

fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Converged => "converged",
        Termination::PrecisionReached => "precision_reached",
        Termination::OutOfPatience => "out_of_patience",
        Termination::NotFinite => "not_finite",
    }
}

fn warning(warning: &Warning) -> WarningTold {
    let (kind, meaning) = match warning {
        Warning::AtBound { .. } => (
            "at_bound",
            "this value is where the search ends, not what the ground is: do not use it or its \
             interval, and take the others as given with it",
        ),
        Warning::ExponentAssumed { .. } => (
            "exponent_assumed",
            "use k_s, n0 and n1 together and near the loads measured; runs at other loads, or n0 \
             from plates (--known n0), part them",
        ),
        Warning::PeakOutsideContact { .. } => (
            "peak_outside_contact",
            "c1 and c2 only serve to give these forces back: they say nothing of where the stress \
             peaks, here or at other slips",
        ),
        Warning::PeakAtEnd { .. } => (
            "peak_at_end",
            "c1, c2 and K are held by the contact and not by the loads, and the intervals of the others presume this \
             peak: is slip counted from another radius, or is the convention or c3 another?",
        ),
        Warning::Misfit { .. } => (
            "misfit",
            "the model does not describe these loads: no parameter is known as well as its \
             interval says, however narrow it is; trust the force errors instead",
        ),
        Warning::LoadMissed(_) => (
            "load_missed",
            "what carries this wheel is not what these parameters say: use them for no other wheel or load",
        ),
        Warning::UncertaintiesIgnored => (
            "uncertainties_ignored",
            "rows of great and of small uncertainty count alike",
        ),
        Warning::NoFreedom => (
            "no_freedom",
            "the values go through the rows exactly, whatever is wrong with these: they are \
             untested",
        ),
        Warning::LoadsDiffer { .. } => (
            "loads_differ",
            "k_s and what is told of k_s z^n0 belong to none of the loads; choose the runs of one load with \
             --run",
        ),
        Warning::Braking { .. } => (
            "braking",
            "these rows pull the parameters to where a driven wheel's forces would have to be theirs; \
             --slip 0:1 leaves them out",
        ),
        Warning::NotAMinimum(_) => (
            "not_a_minimum",
            "no value and no interval below is an estimate: do not use them",
        ),
    };
    WarningTold {
        kind,
        message: warning.to_string(),
        meaning,
    }
}

/// Rows of values that still change.
fn not_steady(fit: &Fit) -> Option<WarningTold> {
    const SHOWN: usize = 3;
    let of_run = |run: &'_ Rows| {
        let drifting = run.rows.iter().filter(|row| !row.is_steady());
        drifting
            .map(|row| drifting_row(&run.run, row))
            .collect::<Vec<String>>()
    };
    let drifting: Vec<String> = fit.runs.iter().flat_map(of_run).collect();
    let all: usize = fit.runs.iter().map(|run| run.rows.len()).sum();
    let more = if drifting.len() > SHOWN { "; ..." } else { "" };
    let shown = drifting[..drifting.len().min(SHOWN)].join("; ");
    (!drifting.is_empty()).then(|| WarningTold {
        kind: "not_steady",
        message: format!(
            "{} of {all} rows are not steady ({shown}{more})",
            drifting.len()
        ),
        meaning: "their means depend on how long the wheel had been rolling; the change over each interval is in \
                  its uncertainty: record longer, or leave these runs out with --run",
    })
}

/// A row that is not steady, with its rates of change.
fn drifting_row(run: &str, row: &SteadyRow) -> String {
    let rates: Vec<String> = row.drifts.iter().map(Drift::to_string).collect();
    let [from, to] = row.interval;
    format!("{run} from {from:.1} to {to:.1} s: {}", rates.join(", "))
}

/// Runs that may not be of one ground.
fn mixed(runs: &[RunTold]) -> Vec<WarningTold> {
    let mut warnings = Vec::new();
    for run in runs {
        if let ToldBy::Recognized {
            windows,
            of_windows,
        } = run.class_by
            && (windows as f64) < CLEAR * of_windows as f64
        {
            warnings.push(WarningTold {
                kind: "mixed_windows",
                message: format!(
                    "run {} has this class in {windows} of its {of_windows} windows only",
                    run.run
                ),
                meaning: "rows from other ground may be among its rows",
            });
        }
    }
    let terrains: BTreeSet<TerrainLabel> = runs.iter().filter_map(|run| run.terrain).collect();
    if terrains.len() > 1 {
        let names: Vec<&str> = terrains.iter().map(|terrain| terrain.as_str()).collect();
        warnings.push(WarningTold {
            kind: "mixed_terrains",
            message: format!("the runs are labelled {}", names.join(" and ")),
            meaning: "one set of parameters stands for several grounds; choose runs with --run",
        });
    }
    warnings
}

/// A guess that carries some of the load.
fn thickness_assumed(law: &LawTold) -> Option<WarningTold> {
    let thickness = law.lug_thickness_m.filter(|_| law.lug_thickness_assumed)?;
    Some(WarningTold {
        kind: "lug_thickness_assumed",
        message: format!(
            "the lugs' thickness is not stated: {} mm are assumed",
            1.0e3 * thickness
        ),
        meaning: "k_s and n0 depend on what the lugs' edges carry: state lug_thickness_m in the campaign, or \
                  --lug-thickness",
    })
}

/// Known parameters that the class sets otherwise.
fn unused(fit: &Fit) -> Vec<WarningTold> {
    let is_unused = |parameter: &Parameter| {
        let set = fit.estimate.of(*parameter).standing == Standing::SetByClass;
        set && fit.setting.known.get(*parameter).is_some()
    };
    let unused = ORDER.into_iter().filter(is_unused);
    let told = unused.map(|parameter| WarningTold {
        kind: "known_not_used",
        message: format!(
            "{} is not as given with --known: class {} sets it to 0",
            parameter.name(),
            fit.estimate.class
        ),
        meaning: "the forces are explained without it",
    });
    told.collect()
}

fn by_name<S: Serializer>(
    parameters: &[(Parameter, ParameterTold)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(parameters.iter().map(|(of, told)| (of.name(), told)))
}

pub fn values_by_name<S: Serializer>(
    parameters: &TerrainParameters,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(ORDER.map(|of| (of.name(), parameters.get(of))))
}

/// Runs of each origin of the class, in the order of the origins.
pub fn by_origin(runs: &[RunTold]) -> BTreeMap<Origin<'_>, Vec<&RunTold>> {
    let mut origins: BTreeMap<Origin, Vec<&RunTold>> = BTreeMap::new();
    for run in runs {
        origins.entry(Origin::of(run)).or_default().push(run);
    }
    origins
}

/// Who told the classes of several runs.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin<'r> {
    /// Their vibration.
    Recognized,
    /// Others, for one reason.
    Other(&'r ToldBy),
}

impl<'r> Origin<'r> {
    fn of(run: &'r RunTold) -> Self {
        match &run.class_by {
            ToldBy::Recognized { .. } => Self::Recognized,
            other => Self::Other(other),
        }
    }
}
