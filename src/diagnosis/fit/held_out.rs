//! A condition predicted from the others: a predictive density, Laplace's approximation over the parameters.

use super::super::pins::Defect;
use super::super::product::{log_sum, scores};
use super::super::scatter::mean_square;
use super::Problem;
use super::fold::log_determinant;
use super::model::Model;
use super::posterior::Posterior;
use nalgebra::Cholesky;

/// A condition predicted from the others.
#[derive(Debug)]
pub(in crate::diagnosis) struct HeldOut {
    /// Log predictive density of its numbers [-].
    pub log_density: f64,
    /// Its numbers less the prediction, over their deviations [-].
    pub scores: Vec<f64>,
    /// Loudness of that, and its mean square, outlying numbers cut [-]: over the deviations of runs of
    /// common loudness.
    pub loudness: f64,
    pub square: f64,
    /// Log deviations [-], weighed and summed.
    pub log_spread: f64,
    /// Numbers less those that parameters adapt to [-].
    pub freedom: f64,
    /// Whitened change predicted.
    pub shift: Vec<f64>,
}

impl Posterior {
    /// What the other conditions say of one.
    pub fn predict(
        &self,
        problem: Problem,
        number: usize,
        ([common, own], defect): (&[Vec<f64>; 2], &Defect),
    ) -> HeldOut {
        let fold = self.fold(self.holds_out(problem).then_some(number));
        let (emulated, observed) = problem.conditions().nth(number).expect("one of them");
        let terms = &self.terms[number];
        let mut best: Option<HeldOut> = None;
        let mut logs = Vec::new();
        for (scale, point, log_weight) in fold.predicting() {
            let offsets = fold.offsets(scale, point);
            let mut adapted = offsets.clone();
            let (mut penalty, mut adapts) = (0.0, 0.0);
            if let Some(precision) = &fold.precisions[scale] {
                let of_others = precision.l() * precision.l().transpose();
                let ahead = terms.projections.column(point) - &terms.information * &offsets;
                if let Some(joint) = Cholesky::new(&of_others + &terms.information) {
                    let step = joint.solve(&ahead);
                    penalty = 0.5
                        * (step.dot(&(&of_others * &step)) + log_determinant(&joint)
                            - log_determinant(precision));
                    adapts = joint.solve(&terms.information).trace();
                    adapted += step;
                }
            }
            let adapted = self.at(point, &adapted);
            let departure = Model::new(emulated, &adapted, defect).departure(observed);
            let log_density = emulated.scatter.log_density(&departure, own);
            logs.push(log_weight + log_density - penalty);
            if best.is_none() {
                let scores = |variance: &[f64]| scores(&departure, variance.iter().copied());
                let of_common = scores(common);
                let of_others = self.at(point, &offsets);
                best = Some(HeldOut {
                    log_density: 0.0,
                    scores: scores(own),
                    loudness: emulated.scatter.loudness_of(&of_common),
                    square: mean_square(of_common.into_iter()),
                    log_spread: log_spread(&emulated.scatter.weights, own),
                    freedom: (departure.len() as f64 - adapts).max(1.0),
                    shift: Model::new(emulated, &of_others, defect).change(),
                });
            }
        }
        let mut best = best.expect("a fold has a best point");
        best.log_density = log_sum(logs.into_iter());
        best
    }
}

fn log_spread(weights: &[f64], variance: &[f64]) -> f64 {
    let numbers = weights.iter().zip(variance);
    numbers
        .map(|(weight, v)| 0.5 * weight * libm::log(*v))
        .sum()
}
