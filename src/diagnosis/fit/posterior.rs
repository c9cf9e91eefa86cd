//! What all conditions say of strengths, on their grid, and of parameters, in closed form.

use super::super::grid::Axis;
use super::super::hypothesis::{Hypothesis, Scale};
use super::super::pins::Point;
use super::super::product::{add, log_sum};
use super::Problem;
use super::fold::{Fold, Terms, log_determinant};
use super::local::Local;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Finer looks at strengths.
const LOOKS: usize = 7;
/// Variance of a parameter that does not move.
const FIXED: f64 = 1.0e-10;

/// Median of a strength and its 95 % interval, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Estimate {
    pub value: f64,
    pub ci95: [f64; 2],
}

impl Estimate {
    /// Standard deviation, about: a quarter of the interval.
    pub fn deviation(&self) -> f64 {
        let [low, high] = self.ci95;
        0.25 * (high - low)
    }
}

/// What all conditions say of strengths and parameters.
pub(super) struct Posterior {
    pub effects: Vec<usize>,
    pub axes: Vec<(usize, Axis)>,
    pub log_prior: Vec<f64>,
    pub scales: Vec<Scale>,
    pub terms: Vec<Terms>,
}

impl Posterior {
    /// Strengths start over their priors, or about where they were `before`.
    pub fn new(
        problem: Problem,
        hypothesis: &Hypothesis,
        (about, precisions): (&[Local], &[Vec<f64>]),
        before: Option<Vec<(usize, Axis)>>,
    ) -> Self {
        let candidates = &problem.emulator.candidates;
        let effects = hypothesis.effects().to_vec();
        let first = before.is_none();
        let mut axes: Vec<(usize, Axis)> = match before {
            Some(axes) => axes
                .into_iter()
                .map(|(effect, axis)| (effect, axis.widened()))
                .collect(),
            None => effects
                .iter()
                .map(|&effect| (effect, Axis::over(&candidates[effect])))
                .collect(),
        };
        let scales = hypothesis.scales(problem.emulator.parameters.len());
        for look in 0.. {
            let terms = problem.conditions().zip(about).zip(precisions);
            let terms = terms
                .map(|(((emulated, _), about), precision)| {
                    Terms::new(emulated, about, precision, &axes)
                })
                .collect();
            let posterior = Self {
                effects: effects.clone(),
                log_prior: log_prior(problem, &axes),
                axes,
                scales: scales.clone(),
                terms,
            };
            let mut finer = posterior.axes.clone();
            // While precisions are those of no fit, it need not be where each fold has it.
            for ((_, axis), weights) in finer.iter_mut().zip(posterior.largest(!first)) {
                axis.refine(&weights, first && look == 0);
            }
            if look == LOOKS || finer.iter().all(|(_, axis)| axis.resolved) {
                return posterior;
            }
            axes = finer;
        }
        unreachable!("the last look returns")
    }

    /// Given all conditions but one.
    pub fn fold(&self, left_out: Option<usize>) -> Fold {
        let used = || {
            let terms = self.terms.iter().enumerate();
            terms.filter(move |(number, _)| Some(*number) != left_out)
        };
        let parameters = self.terms[0].information.nrows();
        let mut information = DMatrix::zeros(parameters, parameters);
        let mut squares = vec![0.0; self.log_prior.len()];
        let mut projections = DMatrix::zeros(parameters, self.log_prior.len());
        for (_, terms) in used() {
            information += &terms.information;
            add(&mut squares, 1.0, &terms.squares);
            projections += &terms.projections;
        }
        let precision = |spreads: &[f64]| {
            let moves = spreads.iter().any(|spread| *spread > 0.0);
            let prior = spreads
                .iter()
                .map(|spread| 1.0 / (spread * spread).max(FIXED));
            let prior = DMatrix::from_diagonal(&DVector::from_iterator(parameters, prior));
            moves.then(|| Cholesky::new(&information + prior)).flatten()
        };
        let precisions: Vec<_> = self
            .scales
            .iter()
            .map(|scale| precision(&scale.spreads))
            .collect();
        let log_weights = self.scales.iter().zip(&precisions);
        let log_weights = log_weights
            .map(|(scale, precision)| {
                let priors = scale
                    .spreads
                    .iter()
                    .map(|spread| libm::log((spread * spread).max(FIXED)));
                let volume = precision.as_ref().map_or(0.0, |precision| {
                    log_determinant(precision) + priors.sum::<f64>()
                });
                let gained = precision
                    .as_ref()
                    .and_then(|precision| precision.l_dirty().solve_lower_triangular(&projections));
                let point = |point: usize| {
                    let gained = gained
                        .as_ref()
                        .map_or(0.0, |g| g.column(point).norm_squared());
                    self.log_prior[point] + libm::log(scale.probability)
                        - 0.5 * (squares[point] - gained + volume)
                };
                (0..self.log_prior.len()).map(point).collect()
            })
            .collect();
        Fold {
            log_weights,
            projections,
            precisions,
        }
    }

    /// Largest log weight of each strength under the best, given all conditions, or over all
    /// folds.
    fn largest(&self, folds: bool) -> Vec<Vec<f64>> {
        let lengths: Vec<usize> = self.axes.iter().map(|(_, a)| a.strengths.len()).collect();
        let mut largest: Vec<Vec<f64>> = lengths
            .iter()
            .map(|length| vec![f64::NEG_INFINITY; *length])
            .collect();
        let folds = match self.terms.len() {
            conditions if folds && conditions > 1 => {
                (0..conditions).map(Some).chain([None]).collect()
            }
            _ => vec![None],
        };
        for left_out in folds {
            let fold = self.fold(left_out);
            let (scale, point) = fold.best();
            let best = fold.log_weights[scale][point];
            for (point, place) in (0..self.log_prior.len()).map(|p| (p, self.places(p))) {
                let weights = fold.log_weights.iter().map(|weights| weights[point] - best);
                let weight = weights.fold(f64::NEG_INFINITY, f64::max);
                for (axis, place) in place.into_iter().enumerate() {
                    largest[axis][place] = largest[axis][place].max(weight);
                }
            }
        }
        largest
    }

    /// Place on each axis of a point of the grid.
    fn places(&self, point: usize) -> Vec<usize> {
        let mut places = Vec::with_capacity(self.axes.len());
        let mut rest = point;
        for (_, axis) in self.axes.iter().rev() {
            places.push(rest % axis.strengths.len());
            rest /= axis.strengths.len();
        }
        places.reverse();
        places
    }

    /// A point of the grid with these parameters.
    pub fn at(&self, point: usize, offsets: &DVector<f64>) -> Point {
        let places = self.axes.iter().zip(self.places(point));
        Point {
            offsets: offsets.iter().copied().collect(),
            effects: places
                .map(|((effect, axis), place)| (*effect, axis.strengths[place]))
                .collect(),
        }
    }

    /// Whether conditions are predicted from the others. One condition cannot be predicted from none:
    /// its own fit stands for that.
    pub fn holds_out(&self, problem: Problem) -> bool {
        problem.calibration.held_out && self.terms.len() > 1
    }

    /// Largest log likelihood [-] over strengths.
    pub fn likelihood(&self) -> f64 {
        let fold = self.fold(None);
        let of_spread = |weights: &Vec<f64>| {
            let weights = weights.iter().zip(&self.log_prior);
            let possible = weights.filter(|(_, prior)| prior.is_finite());
            let likelihoods = possible.map(|(weight, prior)| weight - prior);
            likelihoods.fold(f64::NEG_INFINITY, f64::max)
        };
        let all = fold.log_weights.iter().map(of_spread);
        all.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The best fit.
    pub fn best(&self) -> Point {
        let fold = self.fold(None);
        let (scale, point) = fold.best();
        self.at(point, &fold.offsets(scale, point))
    }

    pub fn occam(&self) -> f64 {
        let fold = self.fold(None);
        let evidence = log_sum(fold.log_weights.iter().flatten().copied());
        let (scale, point) = fold.best();
        let offsets = fold.offsets(scale, point);
        let square: f64 = self
            .terms
            .iter()
            .map(|terms| {
                terms.squares[point] - 2.0 * terms.projections.column(point).dot(&offsets)
                    + offsets.dot(&(&terms.information * &offsets))
            })
            .sum();
        evidence + 0.5 * square
    }

    pub fn determined(&self) -> f64 {
        let fold = self.fold(None);
        let (scale, _) = fold.best();
        let information: DMatrix<f64> = self.terms.iter().map(|terms| &terms.information).sum();
        let parameters = fold.precisions[scale]
            .as_ref()
            .map_or(0.0, |precision| precision.solve(&information).trace());
        parameters + self.effects.len() as f64
    }

    pub fn offsets(&self) -> Vec<[f64; 2]> {
        let fold = self.fold(None);
        let (scale, point) = fold.best();
        let offsets = fold.offsets(scale, point);
        let inverse = fold.precisions[scale].as_ref().map(Cholesky::inverse);
        let deviation = |place: usize| {
            let variance = inverse
                .as_ref()
                .map_or(0.0, |inverse| inverse[(place, place)]);
            libm::sqrt(variance)
        };
        offsets
            .iter()
            .enumerate()
            .map(|(place, offset)| [*offset, deviation(place)])
            .collect()
    }

    pub fn estimates(&self) -> Vec<Estimate> {
        let fold = self.fold(None);
        let largest = fold
            .log_weights
            .iter()
            .flatten()
            .fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let mut masses: Vec<Vec<f64>> = self
            .axes
            .iter()
            .map(|(_, axis)| vec![0.0; axis.strengths.len()])
            .collect();
        for point in 0..self.log_prior.len() {
            let weights = fold
                .log_weights
                .iter()
                .map(|w| libm::exp(w[point] - largest));
            let weight: f64 = weights.sum();
            for (masses, place) in masses.iter_mut().zip(self.places(point)) {
                masses[place] += weight;
            }
        }
        let of = |((_, axis), masses): (&(usize, Axis), Vec<f64>)| {
            let below = |share| quantile(&axis.strengths, &masses, share);
            Estimate {
                value: below(0.5),
                ci95: [below(0.025), below(0.975)],
            }
        };
        self.axes.iter().zip(masses).map(of).collect()
    }
}

fn log_prior(problem: Problem, axes: &[(usize, Axis)]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for (effect, axis) in axes {
        let own = axis.log_prior(&problem.emulator.candidates[*effect]);
        sums = sums
            .iter()
            .flat_map(|sum| own.iter().map(move |log| sum + log))
            .collect();
    }
    sums
}

/// Where `share` of the masses lies below, straight between the places.
fn quantile(places: &[f64], masses: &[f64], share: f64) -> f64 {
    let total: f64 = masses.iter().sum();
    let mut below = -0.5 * masses[0] / total;
    let mut last = (places[0], 0.0);
    for (place, mass) in places.iter().zip(masses) {
        // Half of a place's mass lies on each side of it.
        let here = below + 0.5 * mass / total;
        let here = here.max(last.1);
        if here >= share && here > last.1 {
            return last.0 + (place - last.0) * (share - last.1) / (here - last.1);
        }
        below += mass / total;
        last = (*place, here);
    }
    last.0
}
