//! What an identification says: values, how sure they are, and what the data leave open.

use super::combination::Combination;
use super::force_error::ForceErrors;
use super::least_squares::{Minimum, Termination};
use super::parameter::{Parameter, TerrainParameters};
use super::stages::Staged;
use super::warning::Warning;
use crate::terrain::class::Wtic;
use std::fmt;

/// How a parameter came by its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// The data fix it.
    Identified,
    /// The data do not: its value only serves to predict loads together with the others.
    NotIdentifiable,
    /// The class sets it (Table 4).
    SetByClass,
    /// It was [known](super::Known) before.
    Given,
}

/// Why the data do not fix a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Open {
    /// What explains the rows as well has no end, or one of the search only.
    Unbounded,
    /// Its 95 % interval has ends, but is [wider](Parameter::uninformative) than is of use.
    Wide,
    /// The search ended at this end of its range, in the parameter's unit.
    AtEnd(f64),
    /// It goes with a parameter that ended at an end of its range.
    With(Parameter),
    /// The rows leave `k_s`, `n_0` and `n_1` open together: the value is that of the most usual `n_0`.
    Ridge,
    /// The fit has the maximum stress at an end of the contact, which holds it there.
    PeakAtEnd,
    /// The rows are of one load, under which it only counts together with others.
    OneLoad,
}

impl fmt::Display for Open {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unbounded => f.write_str("the rows set it no limits"),
            Self::Wide => f.write_str("its interval is too wide to be of use"),
            Self::AtEnd(end) => write!(f, "the search ended at {end}, an end of its range"),
            Self::With(other) => write!(f, "goes with {}, which ended at its end", other.name()),
            Self::Ridge => f.write_str("k_s, n0 and n1 make up for each other"),
            Self::PeakAtEnd => {
                f.write_str("the maximum stress stands at an end of the contact, which holds it")
            }
            Self::OneLoad => f.write_str("one load tells it only together with others"),
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
    /// How it came by it.
    pub standing: Standing,
    /// Why the data do not fix it, where they do not.
    pub open: Option<Open>,
    /// Standard error in the coordinate of the fit (`ln k_s`, `ln c`, `ln K`, `φ` [rad]);
    /// infinite where the data do not fix the parameter at all, 0 where the class does.
    pub standard_error: f64,
    /// 95 % interval from the covariance, in its unit; `None` where it is unbounded.
    pub interval: [Option<f64>; 2],
    /// 95 % interval from the profile of the likelihood, in its unit, an end `None` where the
    /// profile stays below its limit as far as the parameter's range goes; `None` where it was
    /// not asked for or the parameter is not free.
    pub profile: Option<[Option<f64>; 2]>,
}

impl Identified {
    /// Whether the data fix it.
    pub fn is_identifiable(&self) -> bool {
        self.standing == Standing::Identified
    }

    /// The 95 % interval to report, in its unit: the profile's where there is one, which holds where
    /// the model bends too. Of a parameter that the data do not fix, its ends where it is merely too wide,
    /// and how much cohesion there may be where the fit found none; else without ends.
    pub fn ci95(&self) -> [Option<f64>; 2] {
        let ends = self.profile.unwrap_or(self.interval);
        match self.open {
            None => ends,
            Some(Open::Wide) if ends.iter().all(Option::is_some) => ends,
            Some(Open::AtEnd(_)) if ends[0] == Some(0.0) => ends,
            Some(_) => [None; 2],
        }
    }

    /// Takes the parameter for one that the data do not fix.
    pub(super) fn open_by(&mut self, reason: Open) {
        self.standing = Standing::NotIdentifiable;
        self.open = Some(reason);
    }
}

/// Terrain parameters that best explain the rows, and how well the rows fix them.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The class whose model was fitted.
    pub class: Wtic,
    /// The parameters' values, all together.
    pub terrain: TerrainParameters,
    /// The parameters one by one, in the order of [`Parameter::ALL`].
    pub parameters: [Identified; 8],
    /// Correlation of the estimates of the free parameters, in their order; `None` with a
    /// parameter that the data do not fix at all.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// What the rows fix of the parameters that they do not fix one by one.
    pub combinations: Vec<Combination>,
    /// The paper's result from three stages, from which this one began; `None` without torques,
    /// which all three need.
    pub staged: Option<Staged>,
    /// Errors of the loads predicted.
    pub force_errors: ForceErrors,
    /// Sum of squared weighted residuals [-].
    pub chi_square: f64,
    /// Measured forces less directions that they fix.
    pub degrees_of_freedom: usize,
    /// Why the fit stopped.
    pub termination: Termination,
    /// What else to know.
    pub warnings: Vec<Warning>,
    /// The least sum of squares: where the values stand unless the rows leave `n_0` open.
    pub(super) minimum: Minimum,
}

impl Estimate {
    /// Identifies none of the parameters that an end of their range holds.
    pub(super) fn open_at_ends(&mut self, held: &[(Parameter, f64)]) {
        for (parameter, end) in held {
            self.parameters[*parameter as usize].open_by(Open::AtEnd(*end));
        }
    }

    /// Takes those of `parameters` that are identified for ones that the data do not fix.
    pub(super) fn open_identified(&mut self, parameters: &[Parameter], reason: Open) {
        for &parameter in parameters {
            let identified = &mut self.parameters[parameter as usize];
            if identified.is_identifiable() {
                identified.open_by(reason);
                identified.interval = [None; 2];
            }
        }
    }

    /// Sum of squares per degree of freedom [-].
    pub fn reduced_chi_square(&self) -> f64 {
        self.chi_square / self.degrees_of_freedom as f64
    }

    /// What is known of one parameter.
    pub fn of(&self, parameter: Parameter) -> &Identified {
        &self.parameters[parameter as usize]
    }
}
