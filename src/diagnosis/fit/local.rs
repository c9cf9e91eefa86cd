//! A condition about some parameters, where its change is a straight line.

use super::super::emulator::{BENT, Emulated};
use super::super::observation::Observed;
use super::super::pins::Defect;
use super::super::product::add;
use super::Problem;

/// A condition about some parameters: `r − J θ − Q θ²`, less the defect, as a straight line in `θ`.
pub(super) struct Local {
    pub jacobian: Vec<Vec<f64>>,
    pub residual: Vec<f64>,
}

impl Local {
    pub fn all(problem: Problem, offsets: &[f64], defects: &[Defect]) -> Vec<Self> {
        let conditions = problem.conditions().zip(defects);
        conditions
            .map(|((emulated, observed), defect)| Self::about(emulated, observed, offsets, defect))
            .collect()
    }

    fn about(emulated: &Emulated, observed: &Observed, offsets: &[f64], defect: &Defect) -> Self {
        let mut residual = observed.residual.clone();
        let nowhere = vec![0.0; offsets.len()];
        add(&mut residual, -1.0, &defect.change_at(&nowhere));
        let slopes = emulated.jacobian.iter().zip(&emulated.bend).zip(offsets);
        let jacobian = slopes.map(|((slope, bend), offset)| {
            let bent = offset.clamp(-BENT, BENT);
            let mut slope = slope.clone();
            if bent == *offset {
                add(&mut slope, 2.0 * bent, bend);
                add(&mut residual, bent * bent, bend);
            } else {
                add(&mut residual, -bent * bent, bend);
            }
            slope
        });
        let mut jacobian: Vec<Vec<f64>> = jacobian.collect();
        for (slope, lacking) in jacobian.iter_mut().zip(&defect.slopes) {
            add(slope, 1.0, lacking);
        }
        Self { jacobian, residual }
    }
}
