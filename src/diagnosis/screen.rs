//! A linear look: what of each effect parameters leave, and how far effects can be told apart.
//!
//! ```text
//! P = S⁻¹ − S⁻¹ J (Jᵀ S⁻¹ J + I)⁻¹ Jᵀ S⁻¹
//! ```
//!
//! takes from a difference what recalibration within the parameters' priors could make. With the
//! signature `d` of an effect at its typical level, whose numbers count less the worse they are known,
//! `(dᵀ P r)² / (dᵀ P d)` is the χ² that the effect alone would take from a residual `r`; three over
//! `√(dᵀ P d)` typical levels show themselves with three deviations; `1 − dᵀ P d / (dᵀ S⁻¹ d)` is
//! absorbed by parameters.

use super::emulator::{Emulated, Emulator};
use super::fit::{Fit, Problem};
use super::product::{add, product, scaled};
use super::responses::Candidate;
use super::shape::Shape;
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;
use std::fmt;

/// Deviations beyond which a number of a residual counts no more [-].
const OUTLYING: f64 = 6.0;

/// What the screen says of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Screened {
    /// Name with the channel.
    pub name: String,
    /// χ² that it alone would explain [-].
    pub score: f64,
    /// Distance from the neutral magnitude that shows itself with three deviations, in the
    /// magnitude's unit, or the magnitude itself where the neutral one is infinite; none where
    /// nothing shows.
    pub detectable: Option<f64>,
    /// Share [-] that parameters absorb.
    pub absorbed: f64,
    /// Effects that these conditions cannot tell from it, and the cosine of their projected
    /// signatures [-].
    pub equivalent: Vec<(String, f64)>,
    /// Strongest alarm that its typical magnitude would raise were only parameters recalibrated.
    pub alarm: Option<Alarm>,
}

/// Products of all projected signatures with each other.
#[derive(Debug, Clone)]
pub(super) struct Screen {
    /// Typical strength of every candidate.
    typical: Vec<f64>,
    /// Signatures' products before projection, their squares on the diagonal.
    raw: DMatrix<f64>,
    /// `Jᵀ S⁻¹ d`, a column a candidate.
    along: DMatrix<f64>,
    /// `Jᵀ S⁻¹ J`.
    information: DMatrix<f64>,
    /// `dᵀ S⁻¹ r`.
    with_residual: DVector<f64>,
    /// `Jᵀ S⁻¹ r`.
    residual_along: DVector<f64>,
}

/// A screen, projected.
#[derive(Debug, Clone)]
pub(super) struct Projected {
    /// `dᵀ P d` of all pairs.
    pub products: DMatrix<f64>,
    /// `dᵀ P r`.
    pub with_residual: DVector<f64>,
    /// `dᵀ S⁻¹ d`.
    squares: DVector<f64>,
    /// Estimated parameters [prior standard deviations].
    pub offsets: DVector<f64>,
}

impl Screen {
    /// Of measured conditions.
    pub fn new(problem: Problem) -> Self {
        Self::of(problem, &problem.straightened())
    }

    /// Of what a fit leaves, as well as it foretells it.
    pub fn beside(problem: Problem, fit: &Fit) -> Self {
        let mut screen = Self::empty(problem.emulator);
        let departures = fit.departures(problem);
        let left = departures.iter().zip(fit.variances());
        for ((emulated, _), (departure, variance)) in problem.conditions().zip(left) {
            screen.include(emulated, variance, departure);
        }
        screen
    }

    /// Of these departures, a row a condition.
    fn of(problem: Problem, residuals: &[Vec<f64>]) -> Self {
        let mut screen = Self::empty(problem.emulator);
        for ((emulated, observed), residual) in problem.conditions().zip(residuals) {
            screen.include(emulated, &observed.variance, residual);
        }
        screen
    }

    fn empty(emulator: &Emulator) -> Self {
        let (candidates, parameters) = (emulator.candidates.len(), emulator.parameters.len());
        Self {
            typical: emulator.candidates.iter().map(Candidate::typical).collect(),
            raw: DMatrix::zeros(candidates, candidates),
            along: DMatrix::zeros(parameters, candidates),
            information: DMatrix::zeros(parameters, parameters),
            with_residual: DVector::zeros(candidates),
            residual_along: DVector::zeros(parameters),
        }
    }

    /// Adds what one more condition would tell, measured once.
    pub fn with(&self, emulated: &Emulated) -> Self {
        let mut screen = self.clone();
        let replicates = emulated.replicates.len() as f64;
        let variance = emulated.scatter.variance(1.0 + 1.0 / replicates);
        let variance: Vec<f64> = variance.collect();
        screen.include(emulated, &variance, &vec![0.0; variance.len()]);
        screen
    }

    fn include(&mut self, emulated: &Emulated, variance: &[f64], residual: &[f64]) {
        let mut variance = variance.to_vec();
        for error in &emulated.jacobian_error {
            add(&mut variance, 1.0, error);
        }
        let precision = emulated.scatter.precision(&variance);
        let clipped = residual.iter().zip(&variance);
        let clipped: Vec<f64> = clipped
            .map(|(r, v)| r.clamp(-OUTLYING * libm::sqrt(*v), OUTLYING * libm::sqrt(*v)))
            .collect();
        let signatures = emulated.shapes.iter().zip(&self.typical);
        let signatures: Vec<Vec<f64>> = signatures
            .map(|(shape, typical)| told(shape, *typical, &variance))
            .collect();
        let weighted: Vec<Vec<f64>> = signatures.iter().map(|d| scaled(d, &precision)).collect();
        for (i, weighted) in weighted.iter().enumerate() {
            for (j, other) in signatures.iter().enumerate().take(i + 1) {
                let own = product(weighted, other);
                self.raw[(i, j)] += own;
                if i != j {
                    self.raw[(j, i)] += own;
                }
            }
            self.with_residual[i] += product(weighted, &clipped);
            for (j, column) in emulated.jacobian.iter().enumerate() {
                self.along[(j, i)] += product(weighted, column);
            }
        }
        for (i, column) in emulated.jacobian.iter().enumerate() {
            let weighted = scaled(column, &precision);
            self.residual_along[i] += product(&weighted, &clipped);
            for (j, other) in emulated.jacobian.iter().enumerate() {
                self.information[(i, j)] += product(&weighted, other);
            }
        }
    }

    /// What recalibration leaves.
    pub fn projected(&self) -> Projected {
        let parameters = self.information.nrows();
        let penalised = &self.information + DMatrix::identity(parameters, parameters);
        let inverse = Cholesky::new(penalised).map(|c| c.inverse());
        let inverse = inverse.unwrap_or_else(|| DMatrix::zeros(parameters, parameters));
        let offsets = &inverse * &self.residual_along;
        Projected {
            products: &self.raw - self.along.transpose() * inverse * &self.along,
            with_residual: &self.with_residual - self.along.transpose() * &offsets,
            squares: self.raw.diagonal(),
            offsets,
        }
    }
}

/// What measurements of this variance tell of a change: `d √(v / (v + e))`, as a change that is known no better
/// than `e` weighs in a fit.
fn told(shape: &Shape, strength: f64, variance: &[f64]) -> Vec<f64> {
    let mut error = vec![0.0; variance.len()];
    shape.add_error(strength, &mut error);
    let known = variance.iter().zip(&error);
    let known: Vec<f64> = known.map(|(v, e)| libm::sqrt(v / (v + e))).collect();
    scaled(&shape.at(strength), &known)
}

impl Projected {
    /// χ² that a candidate alone explains.
    pub fn score(&self, candidate: usize) -> f64 {
        let square = self.products[(candidate, candidate)];
        let along = self.with_residual[candidate];
        if square > 0.0 {
            along * along / square
        } else {
            0.0
        }
    }

    /// χ² that a candidate explains beside another.
    pub fn score_beside(&self, candidate: usize, other: usize) -> f64 {
        let of_other = self.products[(other, other)].max(f64::MIN_POSITIVE);
        let share = self.products[(candidate, other)] / of_other;
        let square =
            self.products[(candidate, candidate)] - share * self.products[(candidate, other)];
        let along = self.with_residual[candidate] - share * self.with_residual[other];
        let distinct = 1.0e-3 * self.products[(candidate, candidate)];
        if square > distinct.max(f64::MIN_POSITIVE) {
            along * along / square
        } else {
            0.0
        }
    }

    /// Share [-] of a signature that parameters absorb.
    pub fn absorbed(&self, candidate: usize) -> f64 {
        let raw = self.squares[candidate];
        if raw > 0.0 {
            1.0 - self.products[(candidate, candidate)] / raw
        } else {
            0.0
        }
    }

    /// Cosine of two projected signatures [-].
    pub fn cosine(&self, a: usize, b: usize) -> f64 {
        let square = self.products[(a, a)] * self.products[(b, b)];
        if square > 0.0 {
            self.products[(a, b)] / libm::sqrt(square)
        } else {
            0.0
        }
    }

    /// Whether two candidates show alike, at magnitudes that each can have.
    pub fn equivalent(&self, emulator: &Emulator, a: usize, b: usize, least: f64) -> bool {
        let cosine = self.cosine(a, b);
        let turned = [a, b].iter().any(|&number| {
            let candidate = &emulator.candidates[number];
            let [_, _, reach] = candidate.levels();
            candidate.density(0.5 * reach) > 0.0 && candidate.density(-0.5 * reach) > 0.0
        });
        cosine > least || (turned && cosine < -least)
    }

    /// What the screen says of every candidate, but for alarms.
    pub fn table(&self, emulator: &Emulator, equivalent: f64) -> Vec<Screened> {
        let of = |number: usize| {
            let candidate = &emulator.candidates[number];
            let square = self.products[(number, number)];
            let typical = candidate.typical();
            let alike = (0..emulator.candidates.len())
                .filter(|&other| {
                    other != number && self.equivalent(emulator, number, other, equivalent)
                })
                .map(|other| {
                    (
                        emulator.candidates[other].name.clone(),
                        self.cosine(number, other),
                    )
                });
            Screened {
                name: candidate.name.clone(),
                score: self.score(number),
                detectable: candidate.detectable(3.0 * typical.abs() / libm::sqrt(square.max(0.0))),
                absorbed: self.absorbed(number),
                equivalent: alike.collect(),
                alarm: None,
            }
        };
        (0..emulator.candidates.len()).map(of).collect()
    }
}

/// A parameter that looks like something else.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alarm {
    /// The parameter.
    pub parameter: String,
    /// What is suspicious.
    pub what: Suspicion,
    /// How far it is from what is expected [standard deviations].
    pub deviations: f64,
}

impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            parameter, what, ..
        } = self;
        let deviations = self.deviations.abs();
        write!(
            f,
            "{parameter} {what} ({deviations:.1} standard deviations)"
        )
    }
}

/// Why a parameter may stand for an effect that is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Suspicion {
    /// It is at the end of its prior.
    AtItsEnd,
    /// It would have to change with slip.
    DriftsWithSlip,
    /// It would have to change with load.
    DriftsWithLoad,
    /// It would have to change with speed.
    DriftsWithSpeed,
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtItsEnd => "is at the end of what is known of it",
            Self::DriftsWithSlip => "would have to change with slip",
            Self::DriftsWithLoad => "would have to change with load",
            Self::DriftsWithSpeed => "would have to change with speed",
        })
    }
}

/// Deviations of a prior [-] that count as its end.
pub(super) const END: f64 = 3.0;

/// Parameters at the end of their prior, and those that conditions would have drift: a change in
/// proportion to slip, load or speed explains more than chance would.
pub(super) fn alarms(problem: Problem) -> Vec<Alarm> {
    raised(problem, &problem.straightened())
}

/// Alarms of these departures, a row a condition.
fn raised(problem: Problem, residuals: &[Vec<f64>]) -> Vec<Alarm> {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    let screen = Screen::of(problem, residuals);
    let offsets = screen.projected().offsets;
    let names = &problem.emulator.parameters;
    let mut alarms: Vec<Alarm> = names
        .iter()
        .zip(offsets.iter())
        .filter(|(_, offset)| offset.abs() > END)
        .map(|(name, offset)| Alarm {
            parameter: name.clone(),
            what: Suspicion::AtItsEnd,
            deviations: *offset,
        })
        .collect();
    let kinds = [
        Suspicion::DriftsWithSlip,
        Suspicion::DriftsWithLoad,
        Suspicion::DriftsWithSpeed,
    ];
    let tests = (names.len() * kinds.len()).max(1) as f64;
    let one = ChiSquared::new(1.0).expect("one degree of freedom");
    for (place, name) in names.iter().enumerate() {
        for (covariate, what) in kinds.into_iter().enumerate() {
            let square = drift(problem, residuals, &screen, (place, covariate));
            if one.sf(square) * tests < problem.calibration.alarm {
                alarms.push(Alarm {
                    parameter: name.clone(),
                    what,
                    deviations: libm::sqrt(square),
                });
            }
        }
    }
    alarms
}

/// χ² of a parameter's change in proportion to a covariate, the parameters free as ever.
fn drift(
    problem: Problem,
    residuals: &[Vec<f64>],
    screen: &Screen,
    (place, covariate): (usize, usize),
) -> f64 {
    let values: Vec<f64> = problem
        .conditions()
        .map(|(e, _)| e.covariates[covariate])
        .collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let scatter: f64 = values
        .iter()
        .map(|value| (value - mean) * (value - mean))
        .sum();
    let deviation = libm::sqrt(scatter / values.len() as f64);
    // Not known everywhere, or the same.
    if deviation.is_nan() || deviation <= 1.0e-9 * mean.abs() {
        return 0.0;
    }
    let mut own = Screen {
        raw: DMatrix::zeros(1, 1),
        along: DMatrix::zeros(screen.information.nrows(), 1),
        with_residual: DVector::zeros(1),
        ..screen.clone()
    };
    let conditions = problem.conditions().zip(residuals);
    for (((emulated, observed), residual), value) in conditions.zip(values) {
        let factor = (value - mean) / deviation;
        let mut variance = observed.variance.clone();
        for error in &emulated.jacobian_error {
            add(&mut variance, 1.0, error);
        }
        let precision = emulated.scatter.precision(&variance);
        let weighted = scaled(&emulated.jacobian[place], &precision);
        own.raw[(0, 0)] += factor * factor * product(&weighted, &emulated.jacobian[place]);
        for (other, column) in emulated.jacobian.iter().enumerate() {
            own.along[(other, 0)] += factor * product(&weighted, column);
        }
        let clipped = residual.iter().zip(&variance);
        let clipped: Vec<f64> = clipped
            .map(|(r, v)| r.clamp(-OUTLYING * libm::sqrt(*v), OUTLYING * libm::sqrt(*v)))
            .collect();
        own.with_residual[0] += factor * product(&weighted, &clipped);
    }
    own.projected().score(0)
}

/// Cosines of all projected signatures with each other, row by row; 0 for one that does not show.
pub fn isolability(problem: Problem) -> Vec<Vec<f64>> {
    let projected = Screen::new(problem).projected();
    let all = 0..problem.emulator.candidates.len();
    let row = |a: usize| all.clone().map(|b| projected.cosine(a, b)).collect();
    all.clone().map(row).collect()
}

/// What a linear look at these conditions says of every candidate.
pub fn screen(problem: Problem) -> Vec<Screened> {
    let projected = Screen::new(problem).projected();
    let mut table = projected.table(problem.emulator, problem.calibration.equivalent);
    for (number, screened) in table.iter_mut().enumerate() {
        let raised = raised(problem, &signature(problem.emulator, number));
        let size = |alarm: &Alarm| alarm.deviations.abs();
        screened.alarm = raised
            .into_iter()
            .max_by(|a, b| size(a).total_cmp(&size(b)));
    }
    table
}

/// What a candidate changes at its typical level, a row a condition.
fn signature(emulator: &Emulator, number: usize) -> Vec<Vec<f64>> {
    let typical = emulator.candidates[number].typical();
    let conditions = emulator.conditions.iter();
    conditions
        .map(|emulated| emulated.shapes[number].at(typical))
        .collect()
}
