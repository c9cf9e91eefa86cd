//! Least squares between bounds (Levenberg-Marquardt, Moré 1978, as in MINPACK).

use super::parameter::{Coordinates, Parameter};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra_lm::storage::Owned;
use nalgebra_lm::{DMatrix, DVector, Dyn};
use serde::Serialize;
use std::fmt;

/// Why a fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// The sum of squares or the parameters no longer change, or the gradient is 0.
    Converged,
    /// No change representable in double precision lowers the sum of squares.
    PrecisionReached,
    /// The limit of evaluations was reached.
    OutOfPatience,
    /// The equations gave a number that is not finite.
    NotFinite,
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::PrecisionReached => "double precision allows no further step",
            Self::OutOfPatience => "maximum number of evaluations reached",
            Self::NotFinite => "the equations gave a number that is not finite",
        })
    }
}

impl Termination {
    /// Whether the fit ended at a minimum within precision.
    pub fn is_minimum(self) -> bool {
        matches!(self, Self::Converged | Self::PrecisionReached)
    }

    fn of(reason: &TerminationReason) -> Self {
        match reason {
            TerminationReason::NoImprovementPossible(_) => Self::PrecisionReached,
            TerminationReason::LostPatience => Self::OutOfPatience,
            reason if reason.was_successful() => Self::Converged,
            _ => Self::NotFinite,
        }
    }
}

/// Differences between measured and predicted, normalised by their standard uncertainties.
pub(super) trait Residuals {
    /// The differences.
    fn residuals(&self, at: &Coordinates) -> Vec<f64>;
    /// Their derivatives by every coordinate.
    fn gradient(&self, at: &Coordinates) -> Vec<Coordinates>;
}

/// End point of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Minimum {
    pub at: Coordinates,
    /// Sum of the squared residuals.
    pub chi_square: f64,
    pub termination: Termination,
}

/// Least squares over the `free` coordinates from `start`, the others fixed.
pub(super) fn minimise<R: Residuals>(
    residuals: &R,
    start: Coordinates,
    free: &[Parameter],
) -> Minimum {
    // A relative change of the sum of squares by 1e-12 moves no parameter by 1e-5 of its
    // standard error.
    minimise_to(1e-12, residuals, start, free)
}

/// As [`minimise`], to a relative `tolerance` of the sum of squares.
pub(super) fn minimise_to<R: Residuals>(
    tolerance: f64,
    residuals: &R,
    start: Coordinates,
    free: &[Parameter],
) -> Minimum {
    if free.is_empty() {
        return Minimum {
            at: start,
            chi_square: sum_of_squares(&residuals.residuals(&start)),
            termination: Termination::Converged,
        };
    }
    let minimum = descend(tolerance, residuals, start, free);
    if minimum.termination.is_minimum() {
        return minimum;
    }
    // A coordinate moving along its bound slows the others down: it is fixed there.
    let inside: Vec<Parameter> = free
        .iter()
        .copied()
        .filter(|parameter| !parameter.is_at_bound(minimum.at[*parameter as usize]))
        .collect();
    if inside.len() == free.len() {
        minimum
    } else {
        minimise_to(tolerance, residuals, minimum.at, &inside)
    }
}

/// One run of Levenberg-Marquardt.
fn descend<R: Residuals>(
    tolerance: f64,
    residuals: &R,
    start: Coordinates,
    free: &[Parameter],
) -> Minimum {
    let (problem, report) = LevenbergMarquardt::new()
        .with_ftol(tolerance)
        .with_xtol(tolerance)
        .with_gtol(1e-12)
        .with_patience(50)
        // A third of the start's distance from the middles of the ranges: with longer first steps, 6 of 100
        // far starts diverge.
        .with_stepbound(0.3)
        .minimize(Problem::new(residuals, start, free));
    Minimum {
        at: problem.at,
        chi_square: 2.0 * report.objective_function,
        termination: Termination::of(&report.termination),
    }
}

/// The least of the minima reached from several starts; `None` without a start.
pub(super) fn minimise_from<R: Residuals>(
    residuals: &R,
    starts: impl IntoIterator<Item = Coordinates>,
    free: &[Parameter],
) -> Option<Minimum> {
    let minima = starts
        .into_iter()
        .map(|start| minimise(residuals, start, free));
    minima
        .filter(|minimum| minimum.chi_square.is_finite())
        .min_by(|one, other| one.chi_square.total_cmp(&other.chi_square))
}

fn sum_of_squares(residuals: &[f64]) -> f64 {
    residuals.iter().map(|residual| residual * residual).sum()
}

/// The problem in unbounded variables `u`: a coordinate is `low + (high - low)(1 + sin u)/2`.
struct Problem<'a, R> {
    residuals: &'a R,
    free: &'a [Parameter],
    at: Coordinates,
    unbounded: DVector<f64>,
}

impl<'a, R: Residuals> Problem<'a, R> {
    fn new(residuals: &'a R, start: Coordinates, free: &'a [Parameter]) -> Self {
        let unbounded = free.iter().map(|&parameter| {
            let [low, high] = parameter.bounds();
            let part = 2.0 * (start[parameter as usize] - low) / (high - low) - 1.0;
            // At a bound the derivative is 0, so a start there would never move.
            libm::asin(part.clamp(-0.999, 0.999))
        });
        let unbounded = DVector::from_iterator(free.len(), unbounded);
        let mut problem = Self {
            residuals,
            free,
            at: start,
            unbounded: unbounded.clone(),
        };
        problem.set_params(&unbounded);
        problem
    }
}

impl<R: Residuals> LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, R> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, unbounded: &DVector<f64>) {
        self.unbounded.copy_from(unbounded);
        for (&parameter, &u) in self.free.iter().zip(unbounded.iter()) {
            let [low, high] = parameter.bounds();
            self.at[parameter as usize] = low + 0.5 * (high - low) * (1.0 + libm::sin(u));
        }
    }

    fn params(&self) -> DVector<f64> {
        self.unbounded.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(DVector::from_vec(self.residuals.residuals(&self.at)))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let gradient = self.residuals.gradient(&self.at);
        let scale: Vec<f64> = self
            .free
            .iter()
            .zip(self.unbounded.iter())
            .map(|(parameter, &u)| {
                let [low, high] = parameter.bounds();
                0.5 * (high - low) * libm::cos(u)
            })
            .collect();
        Some(DMatrix::from_fn(
            gradient.len(),
            self.free.len(),
            |row, column| gradient[row][self.free[column] as usize] * scale[column],
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Parameter::{SinkageExponent, StressAngle};

    /// Distance from a point in `c_1` and `n_0`.
    struct Distance([f64; 2]);

    impl Residuals for Distance {
        fn residuals(&self, at: &Coordinates) -> Vec<f64> {
            let [c_1, n_0] = [at[StressAngle as usize], at[SinkageExponent as usize]];
            vec![10.0 * (c_1 - self.0[0]), n_0 - self.0[1]]
        }
        fn gradient(&self, _: &Coordinates) -> Vec<Coordinates> {
            let mut gradient = vec![[0.0; 8]; 2];
            gradient[0][StressAngle as usize] = 10.0;
            gradient[1][SinkageExponent as usize] = 1.0;
            gradient
        }
    }

    #[test]
    fn a_minimum_within_the_bounds_is_found_and_one_beyond_ends_at_the_bound() {
        let free = [StressAngle, SinkageExponent];
        let inside = minimise(&Distance([0.3, 1.2]), [0.5; 8], &free);
        assert!((inside.at[0] - 0.3).abs() < 1e-9 && (inside.at[3] - 1.2).abs() < 1e-9);
        assert!(inside.termination.is_minimum());
        let beyond = minimise(&Distance([0.3, 9.0]), [0.5; 8], &free);
        assert!((beyond.at[3] - SinkageExponent.range()[1]).abs() < 1e-6);
        assert!((beyond.at[0] - 0.3).abs() < 1e-6);
    }

    #[test]
    fn coordinates_that_are_not_free_keep_their_value() {
        let minimum = minimise(&Distance([0.3, 1.2]), [0.5; 8], &[StressAngle]);
        assert_eq!(minimum.at[3], 0.5);
        assert!((minimum.chi_square - 0.49).abs() < 1e-12);
    }
}
