//! Result of `identify` for machines.

use super::class::ClassSource;
use super::group::{Fit, Rows};
use super::law::{LawReport, OtherStress};
use super::parameter_order::{ORDER, values_by_name};
use super::plates::PlateReport;
use super::unused::{LeftOut, StretchLeftOut, Unused};
use super::wheel::WheelOfRun;
use crate::dataset::inspection;
use crate::identification::{
    Combination, Cylinder, Drift, Estimate, ForceErrors, Identified, Parameter, Prediction,
    PredictionErrors, Scope, Standing, SteadyRow, Termination, TerrainParameters, Unidentifiable,
    Warning,
};
use crate::soil::wheel_load::WheelLoad;
use crate::terrain::class::{TerrainLabel, Wtic};
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};

/// Fraction of a run's windows [-] with its class below which it may be on several grounds.
const CLEAR: f64 = 0.9;

/// Result for several files: in JSON an object, or a list of several.
#[derive(Debug)]
pub struct Summary {
    /// The files by name.
    pub files: String,
    /// One for each class and wheel.
    pub reports: Vec<Report>,
    /// One for each ground that plates were pressed into.
    pub plates: Vec<PlateReport>,
    /// What was not used, with reasons.
    pub unused: Unused,
}

impl Summary {
    /// The summary of a command.
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

/// Result of a wheel or of plates.
#[derive(Serialize)]
#[serde(untagged)]
enum Either<'a> {
    Wheel(&'a Report),
    Plates(&'a PlateReport),
}

/// Result for one class and wheel.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The class.
    pub class: Wtic,
    /// The wheel.
    pub wheel: WheelOfRun,
    /// Conventions of the equations.
    pub setting: SettingReport,
    /// The runs used.
    pub runs: Vec<RunReport>,
    /// The rows used.
    pub rows: Vec<RowReport>,
    /// Warnings, to be read before the numbers.
    pub warnings: Vec<WarningReport>,
    /// Why the parameters are effective ones, of this wheel and load; none where they may be the soil's.
    pub effective: Option<String>,
    /// The parameters by name.
    #[serde(serialize_with = "by_name")]
    pub parameters: Vec<(Parameter, ParameterReport)>,
    /// The parameters for the alternative stress distribution; none by the paper's equations.
    pub other_stress: Option<OtherStress>,
    /// Identifiable combinations of parameters that are not identifiable alone.
    pub combinations: Vec<Combination>,
    /// Correlation of the estimates.
    pub correlation: Correlation,
    /// Relative errors of the forces at the measured slip and sinkage (Table 7).
    pub force_error_percent: ForceErrors,
    /// Relative errors of predictions from slip and load.
    pub prediction_error_percent: PredictionErrors,
    /// Result of the paper's three stages; none without torques.
    pub staged: Option<StagedReport>,
    /// Why the fit stopped.
    pub termination: Termination,
    /// Sum of squared weighted residuals [-].
    pub chi_square: f64,
    /// Number of measured forces minus number of identified directions.
    pub degrees_of_freedom: usize,
    /// Runs that were not used.
    pub left_out: Vec<LeftOut>,
    /// Stretches that were not used, of runs that were.
    pub stretches_left_out: Vec<StretchLeftOut>,
    /// The figure, if one was drawn.
    pub figure: Option<String>,
}

/// Conventions of the equations.
#[derive(Debug, Serialize)]
pub struct SettingReport {
    /// The cylinder of the paper's equations.
    pub cylinder: Cylinder,
    /// `c_3` [-].
    pub exit_angle: f64,
    /// The equations.
    #[serde(flatten)]
    pub law: LawReport,
}

/// A run used.
#[derive(Debug, Serialize)]
pub struct RunReport {
    /// Its name.
    pub run: String,
    /// Its ground, if stated in the file.
    pub terrain: Option<TerrainLabel>,
    /// Source of its class.
    #[serde(flatten)]
    pub class_by: ClassSource,
}

/// One value for each force.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Forces {
    /// Drawbar pull [N].
    pub drawbar_pull: f64,
    /// Vertical load [N].
    pub load: f64,
    /// Driving torque [N·m].
    pub driving_torque: f64,
}

/// A row as measured, as fitted and as predicted.
#[derive(Debug, Serialize)]
pub struct RowReport {
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
    pub measured: Forces,
    /// Their standard uncertainties, where known.
    pub uncertainty: Option<Forces>,
    /// Drifts in the interval, included in the uncertainty.
    pub drifts: Vec<Drift>,
    /// Standard uncertainty of the slip ratio [-]; 0 where treated as exact.
    pub slip_uncertainty: f64,
    /// Standard uncertainty of the sinkage [m]; 0 where treated as exact.
    pub sinkage_uncertainty: f64,
    /// The fitted forces at this slip and sinkage.
    pub fitted: Forces,
    /// Sinkage, pull and torque predicted at this slip and load; none where the soil does not carry the load
    /// or static friction holds the wheel.
    pub predicted: Option<Prediction>,
}

/// A warning.
#[derive(Debug, Serialize)]
pub struct WarningReport {
    /// Its name.
    pub kind: &'static str,
    /// The finding.
    pub message: String,
    /// Its consequence for the results.
    pub meaning: &'static str,
}

/// A parameter.
#[derive(Debug, Serialize)]
pub struct ParameterReport {
    /// Its value.
    pub value: f64,
    /// 95 % interval; `None` where unbounded.
    pub ci95: [Option<f64>; 2],
    /// Its unit.
    pub unit: &'static str,
    /// Whether the data identify it.
    pub identifiable: bool,
    /// How it got its value.
    pub standing: Standing,
    /// Why it is not identifiable; none where it is, or was not fitted.
    pub reason: Option<String>,
    /// Whether it applies to this wheel and load only.
    pub effective: bool,
}

/// Correlation of the estimates.
#[derive(Debug, Serialize)]
pub struct Correlation {
    /// The fitted parameters.
    pub parameters: Vec<&'static str>,
    /// Their correlation; none with an unbounded parameter.
    pub matrix: Vec<Vec<Option<f64>>>,
}

impl Correlation {
    /// Pairs with an absolute correlation above `limit`, the strongest first.
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

/// Result of the paper's three stages.
#[derive(Debug, Serialize)]
pub struct StagedReport {
    /// Values by name.
    #[serde(serialize_with = "values_by_name")]
    pub parameters: TerrainParameters,
    /// Why each stage stopped.
    pub terminations: [Termination; 3],
}

impl Report {
    /// The report of a fit.
    pub fn of(fit: &Fit) -> Self {
        let estimate = &fit.estimate;
        let rows = fit.runs.iter().flat_map(|run| {
            let rows = run.rows.iter();
            rows.map(|row| row_report(&run.run, row, fit))
        });
        let scope = fit.scope();
        let runs = fit.runs.iter().map(|run| RunReport {
            run: run.run.clone(),
            terrain: run.terrain,
            class_by: run.classification.by.clone(),
        });
        let runs: Vec<RunReport> = runs.collect();
        let mut warnings = measured_wrong(fit);
        warnings.extend(estimate.warnings.iter().map(warning));
        warnings.extend(mixed(&runs));
        warnings.extend(not_steady(fit));
        warnings.extend(unused(fit));
        warnings.extend(thickness_assumed(&fit.law));
        Self {
            class: estimate.class,
            wheel: fit.wheel,
            setting: SettingReport {
                cylinder: fit.setting.cylinder,
                exit_angle: fit.setting.exit_angle,
                law: fit.law.clone(),
            },
            rows: rows.collect(),
            warnings,
            effective: scope.as_ref().map(Scope::to_string),
            parameters: ORDER
                .map(|parameter| {
                    let report = parameter_report(estimate.of(parameter), scope.is_some());
                    (parameter, report)
                })
                .into(),
            other_stress: fit.other_stress.clone(),
            combinations: estimate.combinations.clone(),
            correlation: Correlation {
                parameters: free(estimate),
                matrix: estimate.correlation.clone(),
            },
            force_error_percent: estimate.force_errors,
            prediction_error_percent: fit.predictor.errors(&fit.rows()),
            staged: estimate.staged.map(|staged| StagedReport {
                parameters: staged.parameters,
                terminations: staged.terminations,
            }),
            termination: estimate.termination,
            chi_square: estimate.chi_square,
            degrees_of_freedom: estimate.degrees_of_freedom,
            left_out: Vec::new(),
            stretches_left_out: Vec::new(),
            figure: None,
            runs,
        }
    }
}

fn row_report(run: &str, row: &SteadyRow, fit: &Fit) -> RowReport {
    let SteadyRow {
        load: row,
        interval,
        drifts,
    } = row;
    RowReport {
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
        predicted: fit.predictor.of_row(row),
    }
}

fn forces(load: WheelLoad) -> Forces {
    Forces {
        drawbar_pull: load.drawbar_pull,
        load: load.normal_force,
        driving_torque: load.driving_torque,
    }
}

fn parameter_report(identified: &Identified, effective: bool) -> ParameterReport {
    ParameterReport {
        value: identified.value,
        ci95: identified.ci95(),
        unit: identified.parameter.unit(),
        identifiable: identified.is_identifiable(),
        standing: identified.standing,
        reason: identified
            .unidentifiable
            .as_ref()
            .map(Unidentifiable::to_string),
        effective: effective && identified.is_identifiable(),
    }
}

/// Names of the fitted parameters, in the order of their correlation.
fn free(estimate: &Estimate) -> Vec<&'static str> {
    let free = estimate.parameters.iter().filter(|identified| {
        matches!(
            identified.standing,
            Standing::Identified | Standing::NotIdentifiable
        )
    });
    free.map(|identified| identified.parameter.name()).collect()
}

fn warning(warning: &Warning) -> WarningReport {
    let (kind, meaning) = match warning {
        Warning::AtBound { .. } => (
            "at_bound",
            "this value is a bound of the search, not an estimate: do not use it or its interval; the \
             other estimates are conditional on it",
        ),
        Warning::ExponentAssumed { .. } => (
            "exponent_assumed",
            "use k_s, n0 and n1 together and near the measured loads; runs at other loads, or n0 \
             from plates (--known n0), separate them",
        ),
        Warning::PeakOutsideContact { .. } => (
            "peak_outside_contact",
            "c1 and c2 only reproduce these forces: they do not locate the stress peak, here or at \
             other slips",
        ),
        Warning::PeakAtEnd { .. } => (
            "peak_at_end",
            "c1, c2 and K are determined by the bound and not by the loads, and the other intervals are conditional on \
             it: check the slip radius, the stress distribution and c3",
        ),
        Warning::Misfit { .. } => (
            "misfit",
            "the model does not describe these loads: the intervals understate the uncertainty; \
             judge by the force errors instead",
        ),
        Warning::LoadMissed(_) => (
            "load_missed",
            "these parameters do not describe what carries this wheel: use them for no other wheel or load",
        ),
        Warning::UncertaintiesIgnored => (
            "uncertainties_ignored",
            "rows of large and small uncertainty have equal weight",
        ),
        Warning::NoFreedom => (
            "no_freedom",
            "the fit is exact whatever the errors of the rows: the values are untested",
        ),
        Warning::LoadsDiffer { .. } => (
            "loads_differ",
            "k_s and the identifiable combination k_s z^n0 apply to none of the loads; choose the runs of one load \
             with --run",
        ),
        Warning::Braking { .. } => (
            "braking",
            "these rows bias the parameters of the driven-wheel model; --slip 0:1 excludes them",
        ),
        Warning::NotAMinimum(_) => (
            "not_a_minimum",
            "no value or interval below is an estimate: do not use them",
        ),
    };
    WarningReport {
        kind,
        message: warning.to_string(),
        meaning,
    }
}

/// Warning about rows with drifts.
fn not_steady(fit: &Fit) -> Option<WarningReport> {
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
    (!drifting.is_empty()).then(|| WarningReport {
        kind: "not_steady",
        message: format!(
            "{} of {all} rows are not steady ({shown}{more})",
            drifting.len()
        ),
        meaning: "their means depend on how long the wheel had been rolling; the change over each interval is included \
                  in its uncertainty: record longer, or exclude these runs with --run",
    })
}

/// A row that is not steady, with its rates of change.
fn drifting_row(run: &str, row: &SteadyRow) -> String {
    let rates: Vec<String> = row.drifts.iter().map(Drift::to_string).collect();
    let [from, to] = row.interval;
    format!("{run} from {from:.1} to {to:.1} s: {}", rates.join(", "))
}

/// Warnings about runs that `inspect` calls wrong.
fn measured_wrong(fit: &Fit) -> Vec<WarningReport> {
    let errors = fit.runs.iter().flat_map(|run| &run.errors);
    let warnings = inspection::in_words(errors).into_iter();
    let warnings = warnings.map(|message| WarningReport {
        kind: "measurement_error",
        message,
        meaning: "correct the measured data first: the parameters are not those of the ground",
    });
    warnings.collect()
}

/// Warnings about runs that may be on several grounds.
fn mixed(runs: &[RunReport]) -> Vec<WarningReport> {
    let mut warnings = Vec::new();
    for run in runs {
        if let ClassSource::Recognized {
            windows,
            of_windows,
        } = run.class_by
            && (windows as f64) < CLEAR * of_windows as f64
        {
            warnings.push(WarningReport {
                kind: "mixed_windows",
                message: format!(
                    "run {} has this class in {windows} of its {of_windows} windows only",
                    run.run
                ),
                meaning: "some of its rows may be from other ground",
            });
        }
    }
    let terrains: BTreeSet<TerrainLabel> = runs.iter().filter_map(|run| run.terrain).collect();
    if terrains.len() > 1 {
        let names: Vec<&str> = terrains.iter().map(|terrain| terrain.as_str()).collect();
        warnings.push(WarningReport {
            kind: "mixed_terrains",
            message: format!("the runs are labelled {}", names.join(" and ")),
            meaning: "one set of parameters is fitted to several grounds; choose runs with --run",
        });
    }
    warnings
}

/// Warning about a default lug thickness that affects the result.
fn thickness_assumed(law: &LawReport) -> Option<WarningReport> {
    let thickness = law.lug_thickness_m.filter(|_| law.lug_thickness_assumed)?;
    Some(WarningReport {
        kind: "lug_thickness_assumed",
        message: format!(
            "the lug thickness is not stated: {} mm is assumed",
            1.0e3 * thickness
        ),
        meaning: "k_s and n0 depend on the load carried by the lugs' edges: state lug_thickness_m in the campaign, or \
                  --lug-thickness",
    })
}

/// Warnings about given parameters that the class sets otherwise.
fn unused(fit: &Fit) -> Vec<WarningReport> {
    let is_unused = |parameter: &Parameter| {
        let set = fit.estimate.of(*parameter).standing == Standing::SetByClass;
        set && fit.setting.known.get(*parameter).is_some()
    };
    let unused = ORDER.into_iter().filter(is_unused);
    let warnings = unused.map(|parameter| WarningReport {
        kind: "known_not_used",
        message: format!(
            "{} given with --known is ignored: class {} sets it to 0",
            parameter.name(),
            fit.estimate.class
        ),
        meaning: "the forces are fitted without it",
    });
    warnings.collect()
}

fn by_name<S: Serializer>(
    parameters: &[(Parameter, ParameterReport)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(parameters.iter().map(|(of, report)| (of.name(), report)))
}

/// Runs grouped by the source of their class, in the order of the sources.
pub fn by_origin(runs: &[RunReport]) -> BTreeMap<Origin<'_>, Vec<&RunReport>> {
    let mut origins: BTreeMap<Origin, Vec<&RunReport>> = BTreeMap::new();
    for run in runs {
        origins.entry(Origin::of(run)).or_default().push(run);
    }
    origins
}

/// Common source of the classes of several runs.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin<'r> {
    /// Recognition.
    Recognized,
    /// Another source, for one reason.
    Other(&'r ClassSource),
}

impl<'r> Origin<'r> {
    fn of(run: &'r RunReport) -> Self {
        match &run.class_by {
            ClassSource::Recognized { .. } => Self::Recognized,
            other => Self::Other(other),
        }
    }
}
