//! Multinomial logistic regression with weights that all classes share.
//!
//! The probability of class `k` of an example is `exp(w·x_k) / Σ_j exp(w·x_j)`, with features `x_k` of the example as that
//! class sees it. The weighted log likelihood less a small quadratic penalty is concave; Newton's method finds its maximum.

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Penalty of a squared weight [examples].
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
    /// One a feature.
    pub weights: Vec<f64>,
}

impl Logistic {
    /// The weights of largest likelihood; zeros where there is no example.
    pub fn fit(examples: &[Example]) -> Self {
        let count = examples.first().map_or(0, |it| it.features[0].len());
        let mut logistic = Self {
            weights: vec![0.0; count],
        };
        let mut likelihood = logistic.likelihood(examples);
        for _ in 0..STEPS {
            let Some(step) = logistic.step(examples) else {
                break;
            };
            // Halved until it climbs.
            let mut scale = 1.0;
            let next = loop {
                let weights = logistic.weights.iter().zip(step.iter());
                let next = Self {
                    weights: weights
                        .map(|(weight, step)| weight + scale * step)
                        .collect(),
                };
                let reached = next.likelihood(examples);
                if reached >= likelihood || scale < 1.0e-6 {
                    likelihood = reached;
                    break next;
                }
                scale *= 0.5;
            };
            logistic = next;
            if scale * step.amax() < CONVERGED {
                break;
            }
        }
        logistic
    }

    /// Probabilities of the classes.
    pub fn probabilities(&self, features: &[Vec<f64>]) -> Vec<f64> {
        let dot = |x: &Vec<f64>| x.iter().zip(&self.weights).map(|(x, w)| x * w).sum::<f64>();
        softmax(features.iter().map(dot).collect())
    }

    fn likelihood(&self, examples: &[Example]) -> f64 {
        let log = |example: &Example| {
            let probability = self.probabilities(&example.features)[example.class];
            example.weight * libm::log(probability.max(f64::MIN_POSITIVE))
        };
        let squares: f64 = self.weights.iter().map(|w| w * w).sum();
        examples.iter().map(log).sum::<f64>() - 0.5 * PENALTY * squares
    }

    fn step(&self, examples: &[Example]) -> Option<DVector<f64>> {
        let count = self.weights.len();
        let mut slope = -PENALTY * DVector::from_column_slice(&self.weights);
        let mut curvature = PENALTY * DMatrix::<f64>::identity(count, count);
        for example in examples {
            let probabilities = self.probabilities(&example.features);
            let vectors: Vec<DVector<f64>> = example
                .features
                .iter()
                .map(|x| DVector::from_column_slice(x))
                .collect();
            let weighted = vectors.iter().zip(&probabilities);
            let mean: DVector<f64> = weighted.clone().map(|(x, p)| x * *p).sum();
            slope += example.weight * (&vectors[example.class] - &mean);
            for (x, p) in weighted {
                let off = x - &mean;
                curvature.ger(example.weight * p, &off, &off, 1.0);
            }
        }
        Some(Cholesky::new(curvature)?.solve(&slope))
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
            weights: vec![1.5, -0.7],
        };
        let mut rng = Seed(1).rng("logistic", 0);
        let examples: Vec<Example> = (0..4000)
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
            .collect();
        let found = Logistic::fit(&examples);
        // Some 0.04 by the curvature.
        for (found, truth) in found.weights.iter().zip(&truth.weights) {
            assert!((found - truth).abs() < 0.15, "{found} {truth}");
        }
    }
}
