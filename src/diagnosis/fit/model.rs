//! A condition as a point of an explanation has it: change, departure of the runs from it, spread.

use super::super::calibration::Calibration;
use super::super::emulator::Emulated;
use super::super::form;
use super::super::observation::Observed;
use super::super::pins::{Defect, Point};
use super::super::product::{add, scaled, scores};

/// Variance of a condition's numbers, the emulator's error with it.
#[derive(Debug)]
pub(super) struct Spread {
    /// Were the runs of common loudness.
    pub common: Vec<f64>,
    /// As loud as they are.
    pub own: Vec<f64>,
    /// What effects add to both by their error of form, and by what they scatter themselves.
    pub form: Vec<f64>,
}

impl Spread {
    /// Common and own variance, with this error of form.
    pub fn with_form(&self, form: &[f64]) -> [Vec<f64>; 2] {
        [&self.common, &self.own].map(|variance| sum(variance, form))
    }
}

pub(super) fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sum = a.to_vec();
    add(&mut sum, 1.0, b);
    sum
}

/// Changes by effects and by parameters.
pub(super) struct Model<'a> {
    point: &'a Point,
    by_effects: Vec<f64>,
    by_parameters: Vec<f64>,
    defect: &'a Defect,
}

impl<'a> Model<'a> {
    pub fn new(emulated: &Emulated, point: &'a Point, defect: &'a Defect) -> Self {
        let mut by_effects = vec![0.0; emulated.cells.len()];
        let mut by_parameters = by_effects.clone();
        emulated.add_effects(&point.effects, &mut by_effects);
        emulated.add_parameters(&point.offsets, &mut by_parameters);
        Self {
            point,
            by_effects,
            by_parameters,
            defect,
        }
    }

    /// The change of the numbers.
    pub fn change(&self) -> Vec<f64> {
        let mut change = self.by_effects.clone();
        add(&mut change, 1.0, &self.by_parameters);
        add(
            &mut change,
            1.0,
            &self.defect.change_at(&self.point.offsets),
        );
        change
    }

    pub fn departure(&self, observed: &Observed) -> Vec<f64> {
        let mut departure = observed.residual.clone();
        add(&mut departure, -1.0, &self.change());
        departure
    }

    /// The loudness of the runs is what the fit leaves of them.
    pub fn spread(
        &self,
        (emulated, observed): (&Emulated, &Observed),
        departure: &[f64],
        (likeness, calibration): (f64, &Calibration),
    ) -> Spread {
        let mut of_emulator = vec![0.0; observed.variance.len()];
        for &(effect, strength) in &self.point.effects {
            emulated.shapes[effect].add_error(strength, &mut of_emulator);
        }
        for (error, offset) in emulated.jacobian_error.iter().zip(&self.point.offsets) {
            add(&mut of_emulator, offset * offset, error);
        }
        let relative = calibration.relative_error * calibration.relative_error;
        for part in [&self.by_effects, &self.by_parameters] {
            add(&mut of_emulator, relative, &scaled(part, part));
        }
        let variance = |loudness: f64| {
            let mut variance: Vec<f64> = observed.variance.iter().map(|v| loudness * v).collect();
            add(&mut variance, self.defect.left, &of_emulator);
            add(&mut variance, 1.0, &self.defect.error);
            variance
        };
        let mut form = form::scattered(emulated, &self.point.effects, likeness);
        emulated.add_scatter(&self.point.effects, observed.runs.len(), &mut form);
        let common = variance(1.0);
        let loudness = emulated
            .scatter
            .loudness_of(&scores(departure, sum(&common, &form)));
        Spread {
            own: variance(observed.loudness.possible(loudness)),
            common,
            form,
        }
    }
}
