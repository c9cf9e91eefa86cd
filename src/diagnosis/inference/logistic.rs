//! Multinomial logistic regression with weights that all classes share, and deviations of each class from them.
//!
//! The probability of class `k` of an example is
//!
//! ```text
//! p_k = exp(β_k·x_k) / Σ_j exp(β_j·x_j),     β_k = w + d_k,     d_k ~ N(0, τ²)
//! ```
//!
//! with features `x_k` of the example as that class sees it: a class with few examples keeps the shared weights `w`, one with
//! many gets its own. With `τ = 0` there are shared weights only. The weighted log likelihood with the prior of `d_k` and a
//! small quadratic penalty of `w` is concave; Newton's method finds its maximum.

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Penalty of a squared shared weight [examples].
const PENALTY: f64 = 0.01;
const STEPS: usize = 50;
/// Change of the weights at which they have converged.
const CONVERGED: f64 = 1.0e-8;

/// An example.
#[derive(Debug, Clone, PartialEq)]
pub struct Example {
    /// Features, class by class.
    pub features: Vec<Vec<f64>>,
    /// Its class.
    pub class: usize,
    /// Its weight.
    pub weight: f64,
}

/// Fitted weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Logistic {
    /// Shared ones, one a feature.
    pub shared: Vec<f64>,
    /// Deviations from them, class by class; none where all classes share the weights.
    own: Vec<Vec<f64>>,
}

impl Logistic {
    /// Stated weights that all classes share.
    pub fn with_weights(shared: Vec<f64>) -> Self {
        Self {
            shared,
            own: Vec::new(),
        }
    }

    /// The shared weights of largest likelihood; zeros where there is no example.
    pub fn fit(examples: &[Example]) -> Self {
        Self::fit_with(examples, None)
    }

    /// Weights of which those of each class scatter about shared ones with this standard deviation.
    pub fn fit_by_class(examples: &[Example], scatter: f64) -> Self {
        Self::fit_with(examples, Some(scatter))
    }

    fn fit_with(examples: &[Example], scatter: Option<f64>) -> Self {
        let first = examples.first();
        let problem = Problem {
            examples,
            scatter,
            features: first.map_or(0, |it| it.features[0].len()),
            classes: first.map_or(0, |it| it.features.len()),
        };
        let mut reached = problem.start();
        let mut likelihood = problem.likelihood(&reached);
        for _ in 0..STEPS {
            let Some(step) = problem.step(&reached) else {
                break;
            };
            // Halved until it climbs.
            let mut scale = 1.0;
            loop {
                let next = &reached + scale * &step;
                let climbed = problem.likelihood(&next);
                if climbed >= likelihood || scale < 1.0e-6 {
                    (reached, likelihood) = (next, climbed);
                    break;
                }
                scale *= 0.5;
            }
            if scale * step.amax() < CONVERGED {
                break;
            }
        }
        problem.logistic(&reached)
    }

    /// Probabilities of the classes.
    pub fn probabilities(&self, features: &[Vec<f64>]) -> Vec<f64> {
        let dot = |x: &[f64], weights: &[f64]| -> f64 {
            x.iter().zip(weights).map(|(x, weight)| x * weight).sum()
        };
        let logs = features.iter().enumerate().map(|(class, x)| {
            let own = self.own.get(class).map_or(0.0, |own| dot(x, own));
            dot(x, &self.shared) + own
        });
        softmax(logs.collect())
    }
}

/// What is maximised: shared weights come first, then the deviations of one class after the other.
struct Problem<'a> {
    examples: &'a [Example],
    /// `τ`; none for shared weights only.
    scatter: Option<f64>,
    features: usize,
    classes: usize,
}

impl Problem<'_> {
    fn start(&self) -> DVector<f64> {
        DVector::zeros(match self.scatter {
            Some(_) => self.features * (1 + self.classes),
            None => self.features,
        })
    }

    fn logistic(&self, weights: &DVector<f64>) -> Logistic {
        let (shared, own) = weights.as_slice().split_at(self.features);
        Logistic {
            shared: shared.to_vec(),
            own: own
                .chunks(self.features.max(1))
                .map(<[f64]>::to_vec)
                .collect(),
        }
    }

    fn penalty(&self, place: usize) -> f64 {
        match self.scatter {
            Some(scatter) if place >= self.features => 1.0 / (scatter * scatter),
            _ => PENALTY,
        }
    }

    fn likelihood(&self, weights: &DVector<f64>) -> f64 {
        let logistic = self.logistic(weights);
        let log = |example: &Example| {
            let probability = logistic.probabilities(&example.features)[example.class];
            example.weight * libm::log(probability.max(f64::MIN_POSITIVE))
        };
        let penalties = weights.iter().enumerate();
        let penalties = penalties.map(|(place, weight)| self.penalty(place) * weight * weight);
        self.examples.iter().map(log).sum::<f64>() - 0.5 * penalties.sum::<f64>()
    }

    /// Newton's step.
    fn step(&self, weights: &DVector<f64>) -> Option<DVector<f64>> {
        let logistic = self.logistic(weights);
        let count = self.features * self.classes;
        let mut slope = DVector::zeros(count);
        let mut curvature = DMatrix::zeros(count, count);
        let mut expected = DMatrix::zeros(count, self.examples.len());
        for (place, example) in self.examples.iter().enumerate() {
            let root = libm::sqrt(example.weight);
            let probabilities = logistic.probabilities(&example.features);
            for (class, (x, probability)) in example.features.iter().zip(&probabilities).enumerate()
            {
                let x = DVector::from_column_slice(x);
                let first = self.features * class;
                let is_own = if class == example.class { 1.0 } else { 0.0 };
                let weight = example.weight * (is_own - probability);
                slope.rows_mut(first, self.features).axpy(weight, &x, 1.0);
                let mut own = expected.view_mut((first, place), (self.features, 1));
                own.copy_from(&(&x * (root * probability)));
                let mut block = curvature.view_mut((first, first), (self.features, self.features));
                block.ger(example.weight * probability, &x, &x, 1.0);
            }
        }
        curvature -= &expected * expected.transpose();
        let of_weights = self.of_weights(weights.len());
        let mut slope = &of_weights * slope;
        let mut curvature = &of_weights * curvature * of_weights.transpose();
        for place in 0..slope.len() {
            slope[place] -= self.penalty(place) * weights[place];
            curvature[(place, place)] += self.penalty(place);
        }
        Some(Cholesky::new(curvature)?.solve(&slope))
    }

    /// Derivatives of all classes' `β` with respect to the weights, one of these a row.
    fn of_weights(&self, weights: usize) -> DMatrix<f64> {
        DMatrix::from_fn(weights, self.features * self.classes, |weight, place| {
            let is_there = match weight.checked_sub(self.features) {
                Some(own) => own == place,
                None => weight == place % self.features,
            };
            if is_there { 1.0 } else { 0.0 }
        })
    }
}

/// Exponentials over their sum.
pub fn softmax(mut logs: Vec<f64>) -> Vec<f64> {
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    logs.iter_mut()
        .for_each(|log| *log = libm::exp(*log - largest));
    let sum: f64 = logs.iter().sum();
    logs.iter_mut().for_each(|p| *p /= sum);
    logs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand::RngExt;

    #[test]
    fn weights_of_a_world_of_that_kind_are_found_again() {
        let truth = Logistic {
            shared: vec![1.5, -0.7],
            own: Vec::new(),
        };
        let found = Logistic::fit(&examples(&truth));
        // Some 0.04 by the curvature.
        for (found, truth) in found.shared.iter().zip(&truth.shared) {
            assert!((found - truth).abs() < 0.15, "{found} {truth}");
        }
    }

    #[test]
    fn a_class_with_weights_of_its_own_is_found_beside_those_that_share_them() {
        let truth = Logistic {
            shared: vec![1.0, -0.7],
            own: vec![vec![0.0; 2], vec![0.0; 2], vec![1.5, 0.0]],
        };
        let examples = examples(&truth);
        let found = Logistic::fit_by_class(&examples, 1.0);
        let weight =
            |class: usize, feature: usize| found.shared[feature] + found.own[class][feature];
        assert!(weight(2, 0) - weight(1, 0) > 1.0);
        assert!((weight(2, 1) - weight(1, 1)).abs() < 0.4);
        let tight = Logistic::fit_by_class(&examples, 1.0e-3);
        let shared = Logistic::fit(&examples);
        let [first, second] = [tight, shared].map(|it| it.probabilities(&examples[0].features));
        assert!((first[0] - second[0]).abs() < 1.0e-3);
    }

    fn examples(truth: &Logistic) -> Vec<Example> {
        let mut rng = Seed(1).rng("logistic", 0);
        (0..4000)
            .map(|_| {
                let features: Vec<Vec<f64>> = (0..3)
                    .map(|_| vec![rng.random_range(-2.0..2.0), rng.random_range(-2.0..2.0)])
                    .collect();
                let mut left = rng.random::<f64>();
                let probabilities = truth.probabilities(&features);
                let class = probabilities.iter().position(|p| {
                    left -= p;
                    left < 0.0
                });
                Example {
                    features,
                    class: class.unwrap_or(2),
                    weight: 1.0,
                }
            })
            .collect()
    }
}
