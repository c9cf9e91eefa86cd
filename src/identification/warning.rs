//! Warnings about the validity of an estimate.

use super::LocalModel;
use super::least_squares::Termination;
use super::load_missed::LoadMissed;
use super::model::{Model, peak_share};
use super::parameter::{Coordinates, Parameter};
use super::row::SteadyLoad;
use std::fmt;

/// Slip ratio [-] below which a wheel counts as braking; nearer to 0 it is the scatter of a rolling wheel.
const ROLLING: f64 = -0.02;

/// A condition that limits the validity of an estimate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A parameter ended at a bound of the search.
    AtBound {
        /// Which.
        parameter: Parameter,
        /// The bound, in its unit.
        end: f64,
    },
    /// `n_0` is not identifiable: the value is of greatest posterior density.
    ExponentAssumed {
        /// `n_0` [-].
        value: f64,
    },
    /// `θ_m` lies outside the contact at a measured slip.
    PeakOutsideContact {
        /// The slip ratio [-].
        slip: f64,
        /// `θ_m/θ_1` [-].
        share: f64,
    },
    /// The stress peak is at an end of the contact, the limit of the quadrature.
    PeakAtEnd {
        /// A slip ratio [-] at which it is.
        slip: f64,
    },
    /// The residuals exceed the uncertainties; intervals are widened by the root of this ratio.
    Misfit {
        /// Sum of squares per degree of freedom [-].
        reduced_chi_square: f64,
    },
    /// The fitted loads differ significantly from the measured ones at their sinkages.
    LoadMissed(LoadMissed),
    /// Only some rows state uncertainties, so none were used.
    UncertaintiesIgnored,
    /// There are no degrees of freedom: the residual scatter is unknown.
    NoFreedom,
    /// Loads differ although the class sets one sinkage for all, so that `k_s zᴺ` is a mean.
    LoadsDiffer {
        /// Least load \[N\].
        least: f64,
        /// Greatest load \[N\].
        most: f64,
    },
    /// Rows of a braking wheel, whose shear stress reverses within the contact.
    Braking {
        /// How many.
        rows: usize,
        /// The least slip ratio [-].
        slip: f64,
    },
    /// The fit did not end at a minimum.
    NotAMinimum(Termination),
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtBound { parameter, end } => {
                let [low, high] = parameter.range();
                let (name, unit) = (parameter.name(), parameter.unit());
                write!(f, "{name} [{unit}] ended at {end}, of [{low}, {high}]")
            }
            Self::ExponentAssumed { value } => write!(
                f,
                "the rows do not identify n0, nor k_s and n1: of the values that fit equally well, those with \
                 the n0 most probable for soils, {value:.2}, are given"
            ),
            Self::PeakOutsideContact { slip, share } => write!(
                f,
                "the maximum stress lies outside the contact at slip {slip:.3}: \
                 c1 + c2 s = {share:.3}"
            ),
            Self::PeakAtEnd { slip } => write!(
                f,
                "the angle of maximum stress reached an end of the contact arc at slip {slip:.3}"
            ),
            Self::Misfit { reduced_chi_square } => write!(
                f,
                "the residuals exceed the uncertainties, the stated ones or 1 % of each force where there \
                 are none (reduced chi square \
                 {reduced_chi_square:.3}); intervals are widened accordingly"
            ),
            Self::LoadMissed(missed) => missed.fmt(f),
            Self::UncertaintiesIgnored => f.write_str(
                "some rows state no uncertainty: none is used, the residual scatter is \
                 used instead",
            ),
            Self::NoFreedom => f.write_str(
                "no more measured forces than parameters: the model is untested; add rows",
            ),
            Self::LoadsDiffer { least, most } => write!(
                f,
                "loads from {least:.1} to {most:.1} N share one sinkage on ground that lugs do \
                 not enter: k_s z^N is their mean; identify each load alone"
            ),
            Self::Braking { rows, slip } => write!(
                f,
                "{rows} rows brake (slip down to {slip:.3}): (62)-(69) describe a driven wheel, whose \
                 shear has one direction"
            ),
            Self::NotAMinimum(termination) => {
                write!(f, "the fit did not end at a minimum: {termination}")
            }
        }
    }
}

/// All warnings about a fit of `rows`.
pub(super) fn all(model: &Model, rows: &[SteadyLoad], local: &LocalModel) -> Vec<Warning> {
    let LocalModel {
        best, precision, ..
    } = local;
    let mut warnings = at_bounds(model, &best.at);
    match model.own() {
        Some(_) => {
            let slip = model.peak_at_end(&best.at, rows);
            warnings.extend(slip.map(|slip| Warning::PeakAtEnd { slip }));
        }
        None => {
            warnings.extend(peak_outside(model, rows, local));
        }
    }
    let misfit = precision.misfit;
    warnings.extend(misfit.map(|reduced_chi_square| Warning::Misfit { reduced_chi_square }));
    warnings.extend(LoadMissed::of(model, rows, &best.at).map(Warning::LoadMissed));
    let stated = rows.iter().filter(|row| row.uncertainty.is_some()).count();
    if stated > 0 && stated < rows.len() {
        warnings.push(Warning::UncertaintiesIgnored);
    }
    if precision.freedom == 0 {
        warnings.push(Warning::NoFreedom);
    }
    warnings.extend(loads_differ(model, rows));
    if model.own().is_none() {
        warnings.extend(braking(rows));
    }
    if !best.termination.is_minimum() {
        warnings.push(Warning::NotAMinimum(best.termination));
    }
    warnings
}

fn at_bounds(model: &Model, at: &Coordinates) -> Vec<Warning> {
    let bounds = model.at_bounds(at).into_iter();
    bounds
        .map(|(parameter, end)| Warning::AtBound { parameter, end })
        .collect()
}

/// The row whose peak lies farthest outside the contact, by more than its standard error.
fn peak_outside(model: &Model, rows: &[SteadyLoad], local: &LocalModel) -> Option<Warning> {
    let LocalModel {
        best,
        directions,
        precision,
        ..
    } = local;
    let at = &best.at;
    let [rear, front] = [model.setting.exit_angle, 1.0];
    let beyond = |slip: f64| {
        let share = peak_share(at, slip);
        let function = directions.function(|parameter| match parameter {
            Parameter::StressAngle => 1.0,
            Parameter::StressAngleSlip => slip,
            _ => 0.0,
        });
        let variance = directions.covariance(&function, &function)?;
        let half = precision.half_width() * libm::sqrt(variance);
        Some((rear - share).max(share - front) - half)
    };
    let slips = rows.iter().map(|row| row.slip);
    slips
        .filter_map(|slip| Some((slip, beyond(slip).filter(|beyond| *beyond > 0.0)?)))
        .max_by(|one, other| one.1.total_cmp(&other.1))
        .map(|(slip, _)| Warning::PeakOutsideContact {
            slip,
            share: peak_share(at, slip),
        })
}

fn braking(rows: &[SteadyLoad]) -> Option<Warning> {
    let braking = rows
        .iter()
        .map(|row| row.slip)
        .filter(|slip| *slip < ROLLING);
    let slip = braking.clone().reduce(f64::min)?;
    let rows = braking.count();
    Some(Warning::Braking { rows, slip })
}

fn loads_differ(model: &Model, rows: &[SteadyLoad]) -> Option<Warning> {
    let loads = || rows.iter().map(|row| row.load);
    let (least, most) = (
        loads().fold(f64::INFINITY, f64::min),
        loads().fold(0.0, f64::max),
    );
    // n_1 alone makes loads of gravel differ by half from slip 0 to 0.6 (Table 6).
    let differ = !model.splits_pressure() && most > 2.0 * least;
    differ.then_some(Warning::LoadsDiffer { least, most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::Setting;
    use crate::soil::closed_form::Rim;
    use crate::terrain::class::Wtic;

    #[test]
    fn a_braking_wheel_gives_a_warning_and_a_rolling_one_does_not() {
        let row = |slip| SteadyLoad {
            slip,
            sinkage: 0.01,
            drawbar_pull: 10.0,
            load: 60.0,
            driving_torque: 1.0,
            uncertainty: None,
        };
        assert_eq!(braking(&[row(-0.01), row(0.2)]), None);
        let warning = braking(&[row(-0.4), row(-0.1), row(0.2)]).unwrap();
        assert!(
            warning
                .to_string()
                .starts_with("2 rows brake (slip down to -0.400)")
        );
    }

    #[test]
    fn loads_that_one_sinkage_cannot_carry_give_a_warning_where_the_class_sets_it() {
        let rim = Rim {
            radius: 0.155,
            width: 0.15,
        };
        let loads_differ_in = |class| {
            let model = Model {
                class,
                setting: Setting::new(rim),
            };
            let row = |load| SteadyLoad {
                slip: 0.1,
                sinkage: 0.01,
                drawbar_pull: 10.0,
                load,
                driving_torque: 1.0,
                uncertainty: None,
            };
            loads_differ(&model, &[row(60.0), row(200.0)])
        };
        let warning = loads_differ_in(Wtic::Alct).unwrap().to_string();
        assert!(
            warning.starts_with("loads from 60.0 to 200.0 N share"),
            "{warning}"
        );
        assert_eq!(loads_differ_in(Wtic::Leis), None);
    }
}
