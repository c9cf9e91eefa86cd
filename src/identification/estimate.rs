//! Result of an identification: values, intervals and identifiability.

use super::combination::Combination;
use super::force_error::ForceErrors;
use super::least_squares::{Minimum, Termination};
use super::parameter::{Parameter, TerrainParameters};
use super::stages::Staged;
use super::standing::Standing;
use super::warning::Warning;
use crate::terrain::class::Wtic;
use std::fmt;

/// Why a parameter is not identifiable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unidentifiable {
    /// No bound other than that of the search is found at equal goodness of fit.
    Unbounded,
    /// Its 95 % interval is bounded but too wide to be [informative](Parameter::uninformative).
    Wide,
    /// The search ended at this end of its range, in the parameter's unit.
    AtEnd(f64),
    /// It is confounded with a parameter that ended at a bound.
    With(Parameter),
    /// `k_s`, `n_0` and `n_1` are confounded: the value is that of greatest posterior density.
    Ridge,
    /// The stress peak is at an end of the contact, which bounds it.
    PeakAtEnd,
    /// All rows have one load, under which it acts only in combination with others.
    OneLoad,
}

impl fmt::Display for Unidentifiable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unbounded => f.write_str("the rows do not bound it"),
            Self::Wide => f.write_str("its interval is too wide to be informative"),
            Self::AtEnd(end) => write!(f, "the search ended at {end}, a bound of its range"),
            Self::With(other) => write!(
                f,
                "confounded with {}, which ended at a bound",
                other.name()
            ),
            Self::Ridge => f.write_str("k_s, n0 and n1 are confounded"),
            Self::PeakAtEnd => {
                f.write_str("the maximum stress is at an end of the contact, which bounds it")
            }
            Self::OneLoad => f.write_str("under one load it is confounded with others"),
        }
    }
}

/// One parameter of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    /// Which.
    pub parameter: Parameter,
    /// Its value, in its [`unit`](Parameter::unit).
    pub value: f64,
    /// How it got its value.
    pub standing: Standing,
    /// Why it is not identifiable; `None` where it is identified or not fitted.
    pub unidentifiable: Option<Unidentifiable>,
    /// Standard error in the coordinate of the fit (`ln k_s`, `ln c`, `ln K`, `φ` \[rad\]); infinite where the
    /// parameter is unbounded, 0 where it is not fitted.
    pub standard_error: f64,
    /// 95 % interval from the covariance, in its unit; `None` where unbounded.
    pub interval: [Option<f64>; 2],
    /// 95 % interval from the profile likelihood, in its unit; an end is `None` where the profile stays below
    /// its limit up to the bound of the search. `None` where no profile was computed or the parameter is not
    /// free.
    pub profile: Option<[Option<f64>; 2]>,
}

impl Identified {
    /// Whether the data identify it.
    pub fn is_identifiable(&self) -> bool {
        self.standing == Standing::Identified
    }

    /// The 95 % interval to report, in its unit: from the profile where there is one, since that remains
    /// valid for a nonlinear model. For a parameter that is not identifiable: its ends where it is merely
    /// wide, the upper limit of a cohesion estimated as zero, otherwise unbounded.
    pub fn ci95(&self) -> [Option<f64>; 2] {
        let ends = self.profile.unwrap_or(self.interval);
        match self.unidentifiable {
            None => ends,
            Some(Unidentifiable::Wide) if ends.iter().all(Option::is_some) => ends,
            Some(Unidentifiable::AtEnd(_)) if ends[0] == Some(0.0) => ends,
            Some(_) => [None; 2],
        }
    }

    /// Marks the parameter as not identifiable.
    pub(super) fn mark_unidentifiable(&mut self, reason: Unidentifiable) {
        self.standing = Standing::NotIdentifiable;
        self.unidentifiable = Some(reason);
    }
}

/// Least-squares estimate of the terrain parameters with their uncertainties.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The class whose model was fitted.
    pub class: Wtic,
    /// The parameters' values, all together.
    pub terrain: TerrainParameters,
    /// The parameters one by one, in the order of [`Parameter::ALL`].
    pub parameters: [Identified; 8],
    /// Correlation of the estimates of the free parameters, in their order; `None` with an unbounded
    /// parameter.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Identifiable combinations of parameters that are not identifiable alone.
    pub combinations: Vec<Combination>,
    /// The paper's three-stage result, which starts the joint fit; `None` without torques.
    pub staged: Option<Staged>,
    /// Relative errors of the fitted loads.
    pub force_errors: ForceErrors,
    /// Sum of squared weighted residuals [-].
    pub chi_square: f64,
    /// Number of measured forces minus number of identified directions.
    pub degrees_of_freedom: usize,
    /// Why the fit stopped.
    pub termination: Termination,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// The least-squares minimum; the values are taken from it unless `n_0` is not identifiable.
    pub(super) minimum: Minimum,
}

impl Estimate {
    /// Marks the parameters at a bound as not identifiable.
    pub(super) fn mark_at_bounds(&mut self, held: &[(Parameter, f64)]) {
        for (parameter, end) in held {
            self.parameters[*parameter as usize].mark_unidentifiable(Unidentifiable::AtEnd(*end));
        }
    }

    /// Marks those of `parameters` that are identified as not identifiable.
    pub(super) fn mark_unidentifiable(&mut self, parameters: &[Parameter], reason: Unidentifiable) {
        for &parameter in parameters {
            let identified = &mut self.parameters[parameter as usize];
            if identified.is_identifiable() {
                identified.mark_unidentifiable(reason);
                identified.interval = [None; 2];
            }
        }
    }

    /// Sum of squares per degree of freedom [-].
    pub fn reduced_chi_square(&self) -> f64 {
        self.chi_square / self.degrees_of_freedom as f64
    }

    /// The estimate of one parameter.
    pub fn of(&self, parameter: Parameter) -> &Identified {
        &self.parameters[parameter as usize]
    }
}
