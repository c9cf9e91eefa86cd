//! The terramechanics model switched by class (Table 4), in the coordinates of the fit.

use super::law::{Law, Own};
use super::parameter::{Coordinates, Parameter};
use super::point::{ALL, Point};
use super::row::{Setting, SteadyLoad};
use super::stage::Stage;
use super::standing::Standing;
use crate::soil::closed_form::{ArcCoefficients, Rim, RimContact};
use crate::soil::contact::{ContactAngles, entry_angle};
use crate::soil::departures::Departures;
use crate::soil::real::{Dual, Real};
use crate::soil::wheel_load::{self, WheelLoad};
use crate::soil::{Soil, StressConvention};
use crate::terrain::class::Wtic;
use crate::wheel::Wheel;
use std::f64::consts::PI;

/// The equations for one class and setting.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    pub class: Wtic,
    pub setting: Setting,
}

/// Panels of the quadrature on either side of the peak: for a driven wheel more panels change a load by less
/// than 1e-4 of the normal force, a hundredth of a force sensor's calibration uncertainty.
const FINE_ENOUGH: u32 = 1;

impl Model {
    /// The cylinder in the soil.
    pub fn surface(&self) -> Rim {
        self.setting.surface()
    }

    /// The fitted parameters: neither set by the class nor given.
    pub fn free(&self) -> Vec<Parameter> {
        self.free_among(&Parameter::ALL)
    }

    /// The free parameters with a nonzero derivative at `at`: without a cohesion that is effectively zero.
    pub fn sensitive_at(&self, at: &Coordinates) -> Vec<Parameter> {
        let mut free = self.free();
        free.retain(|parameter| !parameter.is_as_good_as_zero(at[*parameter as usize]));
        free
    }

    fn free_among(&self, parameters: &[Parameter]) -> Vec<Parameter> {
        let free = parameters.iter().copied();
        free.filter(|&parameter| self.standing(parameter).is_none())
            .collect()
    }

    /// Standing of a parameter that is not fitted; the class takes precedence over given values.
    pub fn standing(&self, parameter: Parameter) -> Option<Standing> {
        if !parameter.is_free(self.class) {
            return Some(Standing::SetByClass);
        }
        let known = self.setting.known.get(parameter);
        known.map(|_| Standing::Given)
    }

    /// Sets the given values and those of the class (Table 4): `c` and `K` to 0.
    pub fn switch(&self, at: &mut Coordinates) {
        self.setting.known.put(at);
        for parameter in Parameter::ALL {
            if !parameter.is_free(self.class) {
                at[parameter as usize] = f64::NEG_INFINITY;
            }
        }
    }

    /// Whether sinkage differs between rows, so that `k_s` and `n_0` have distinct effects.
    pub fn splits_pressure(&self) -> bool {
        self.class == Wtic::Leis
    }

    /// The parameters varied in a fit: `n_0` is fixed if the class sets the sinkage, where it is confounded
    /// with `k_s`.
    pub fn moved(&self) -> Vec<Parameter> {
        self.moved_among(&Parameter::ALL)
    }

    /// The parameters that ended at a bound, with that bound in their unit.
    pub fn at_bounds(&self, at: &Coordinates) -> Vec<(Parameter, f64)> {
        let held = |parameter: Parameter| {
            let coordinate = at[parameter as usize];
            let holds = !parameter.is_as_good_as_zero(coordinate);
            let end = parameter.bound_at(coordinate).filter(|_| holds)?;
            Some((parameter, end))
        };
        self.moved().into_iter().filter_map(held).collect()
    }

    /// Those of `parameters` that are varied in a fit.
    pub fn moved_among(&self, parameters: &[Parameter]) -> Vec<Parameter> {
        let mut moved = self.free_among(parameters);
        moved.retain(|p| *p != Parameter::SinkageExponent || self.splits_pressure());
        moved
    }

    /// The rows used in a stage: those with torque and a rim below the surface; on hard ground, rows held by
    /// static friction do not follow Eq. (75).
    pub fn rows_of(&self, stage: Stage, rows: &[SteadyLoad]) -> Vec<SteadyLoad> {
        let slips = |row: &SteadyLoad| !self.setting.holds_by_friction(row, self.class);
        // A rim held above the soil by its lugs has no contact arc.
        let sunk = |row: &SteadyLoad| row.has_torque() && row.sinkage > 0.0;
        let used = |row: &&SteadyLoad| sunk(row) && (stage != Stage::ShearStress || slips(row));
        rows.iter().filter(used).copied().collect()
    }

    /// The first stage with fewer rows than parameters, with the number needed and given.
    pub fn stage_without_rows(&self, rows: &[SteadyLoad]) -> Option<(Stage, [usize; 2])> {
        Stage::ALL.into_iter().find_map(|stage| {
            let given = self.rows_of(stage, rows).len();
            let needed = self.moved_among(stage.parameters()).len();
            (given < needed).then_some((stage, [needed, given]))
        })
    }

    /// `row` with the torque that follows from its pull and load for the peak at `at` (Eq. 73).
    pub fn with_torque(&self, at: &Coordinates, row: &SteadyLoad) -> SteadyLoad {
        let arc = ArcCoefficients::from(self.contact(&Point::of(at, row)).angles);
        SteadyLoad {
            driving_torque: self.surface().radius * arc.rim_force(row.load, row.drawbar_pull),
            ..*row
        }
    }

    /// The soil at `at`.
    ///
    /// `k_s` is taken as frictional: one wheel width cannot separate `k_c` from `k_φ`.
    pub fn soil<T: Real>(&self, at: &[T; 8]) -> Soil<T> {
        let of = |parameter: Parameter| at[parameter as usize];
        let own = self.own();
        Soil {
            convention: own.map_or(StressConvention::Triangular, |own| own.convention),
            cohesive_modulus: T::constant(0.0),
            frictional_modulus: of(Parameter::SinkageModulus).exp(),
            sinkage_exponent: of(Parameter::SinkageExponent),
            sinkage_exponent_slip: of(Parameter::SinkageExponentSlip),
            cohesion: of(Parameter::Cohesion).exp(),
            friction_angle_deg: of(Parameter::FrictionAngle) * (180.0 / PI),
            shear_modulus: of(Parameter::ShearModulus).exp(),
            stress_angle: of(Parameter::StressAngle),
            stress_angle_slip: of(Parameter::StressAngleSlip),
            exit_angle: self.setting.exit_angle,
            bulk_density: own.map_or(1.0, |own| own.bulk_density),
            departures: Departures::NONE,
            // Steady loads do not depend on it: any admissible value serves.
            unloading_stiffness: 1.0,
            damping: 0.0,
            repose_angle_deg: 30.0,
        }
    }

    /// Inputs of the quadrature, where it gives the loads: in soil that lugs enter.
    pub fn own(&self) -> Option<&Own> {
        match &self.setting.law {
            Law::Own(own) if self.class == Wtic::Leis => Some(own),
            _ => None,
        }
    }

    /// Depth of the lug tips below the sinkage used in the equations [m].
    fn lug_depth(&self) -> f64 {
        self.own().map_or(0.0, Own::lug_height)
    }

    /// Depth [m] of the lowest point of wheel and lugs at a `sinkage` [m], which is above 0.
    pub fn depth(&self, sinkage: f64) -> f64 {
        sinkage + self.lug_depth()
    }

    /// The sinkage [m] for a [`depth`](Self::depth) [m].
    pub fn sinkage(&self, depth: f64) -> f64 {
        depth - self.lug_depth()
    }

    /// The slip [-] of a row whose stress peak is at an end of the contact in the quadrature.
    pub fn peak_at_end(&self, at: &Coordinates, rows: &[SteadyLoad]) -> Option<f64> {
        const NEAR: f64 = 1e-3;
        self.own()?;
        let inside = self.setting.exit_angle + NEAR..1.0 - NEAR;
        rows.iter()
            .map(|row| row.slip)
            .find(|slip| !inside.contains(&peak_share(at, *slip)))
    }

    /// The loads at a point.
    pub fn loads<T: Real>(&self, point: &Point<T>) -> WheelLoad<T> {
        let soil = self.soil(&point.at);
        let Some(own) = self.own() else {
            return self.contact(point).loads(&soil);
        };
        let Rim { radius, width } = self.setting.rim;
        let wheel = Wheel {
            radius,
            width,
            lugs: own.lugs,
            ..Wheel::rover()
        };
        wheel_load::loads_to(FINE_ENOUGH, &wheel, &soil, [point.sinkage, point.slip])
    }

    /// The loads at a point with their derivatives by every parameter, the logarithm of the
    /// [`depth`](Self::depth) and slip.
    pub fn derivatives(&self, point: Point<f64>) -> WheelLoad<Dual<ALL>> {
        self.loads(&point.by_all(self.depth(point.sinkage)))
    }

    /// The contact of a row by the paper's equations, with the peak at `c_1 + c_2 s`.
    ///
    /// Unlike in [`ContactAngles::new`] the peak may lie outside the contact, where Eq. (65) continues
    /// smoothly: a fit stopped at the border would bias every other parameter.
    pub fn contact<T: Real>(&self, point: &Point<T>) -> RimContact<T> {
        let rim = self.surface();
        let entry = entry_angle(T::constant(rim.radius), point.sinkage);
        let share = point.at[Parameter::StressAngle as usize]
            + point.at[Parameter::StressAngleSlip as usize] * point.slip;
        RimContact {
            rim,
            angles: ContactAngles {
                entry,
                peak: share * entry,
                exit: entry * self.setting.exit_angle,
            },
            sinkage: point.sinkage,
            slip: point.slip,
        }
    }
}

/// `θ_m/θ_1 = c_1 + c_2 s` [-].
pub(super) fn peak_share(at: &Coordinates, slip: f64) -> f64 {
    at[Parameter::StressAngle as usize] + at[Parameter::StressAngleSlip as usize] * slip
}
