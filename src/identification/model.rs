//! The terramechanics model switched by class (Table 4), in the coordinates of the fit.

use super::estimate::Standing;
use super::parameter::{Coordinates, Parameter, TerrainParameters};
use super::row::{Setting, SteadyLoad};
use super::stages::Stage;
use crate::soil::closed_form::{ArcCoefficients, Rim, RimContact};
use crate::soil::contact::{ContactAngles, entry_angle};
use crate::soil::departures::Departures;
use crate::soil::{Soil, StressConvention};
use crate::terrain::class::Wtic;

/// Eq. (62)-(66) for one class and setting.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    pub class: Wtic,
    pub setting: Setting,
}

/// What the closed forms do not use of a soil: any physical number does.
const UNUSED: Soil = Soil {
    convention: StressConvention::Triangular,
    cohesive_modulus: 0.0,
    frictional_modulus: 1.0,
    sinkage_exponent: 1.0,
    sinkage_exponent_slip: 0.0,
    cohesion: 0.0,
    friction_angle_deg: 30.0,
    shear_modulus: 0.0,
    stress_angle: 0.0,
    stress_angle_slip: 0.0,
    exit_angle: 0.0,
    unloading_stiffness: 1.0,
    damping: 0.0,
    bulk_density: 1.0,
    repose_angle_deg: 30.0,
    departures: Departures::NONE,
};

impl Model {
    /// The cylinder in the soil.
    pub fn surface(&self) -> Rim {
        self.setting.surface()
    }

    /// The parameters that are fitted: neither set by the class nor known.
    pub fn free(&self) -> Vec<Parameter> {
        self.free_among(&Parameter::ALL)
    }

    /// The parameters whose neighbourhood the forces show at `at`: not that of a cohesion which
    /// is as good as zero.
    pub fn seen_in(&self, at: &Coordinates) -> Vec<Parameter> {
        let mut free = self.free();
        free.retain(|parameter| !parameter.is_as_good_as_zero(at[*parameter as usize]));
        free
    }

    fn free_among(&self, parameters: &[Parameter]) -> Vec<Parameter> {
        let free = parameters.iter().copied();
        free.filter(|&parameter| self.standing(parameter).is_none())
            .collect()
    }

    /// How a parameter that is not fitted came by its value; what the class sets comes before what
    /// is known otherwise.
    pub fn standing(&self, parameter: Parameter) -> Option<Standing> {
        if !parameter.is_free(self.class) {
            return Some(Standing::SetByClass);
        }
        let known = self.setting.known.get(parameter);
        known.map(|_| Standing::Given)
    }

    /// Sets what is known otherwise, and what the class sets (Table 4): `c` and `K` to 0.
    pub fn switch(&self, at: &mut Coordinates) {
        self.setting.known.put(at);
        for parameter in Parameter::ALL {
            if !parameter.is_free(self.class) {
                at[parameter as usize] = f64::NEG_INFINITY;
            }
        }
    }

    /// Whether rows differ in sinkage, so that `k_s` and `n_0` differ in what they do.
    pub fn splits_pressure(&self) -> bool {
        self.class == Wtic::Leis
    }

    /// The parameters that a fit moves: `n_0` stays where it is if the class sets the sinkage,
    /// for then it does what `k_s` does.
    pub fn moved(&self) -> Vec<Parameter> {
        self.moved_among(&Parameter::ALL)
    }

    /// The parameters that a fit moved to an end of their range which holds them there, with that
    /// end in their unit.
    pub fn held_at(&self, at: &Coordinates) -> Vec<(Parameter, f64)> {
        let held = |parameter: Parameter| {
            let coordinate = at[parameter as usize];
            let holds = !parameter.is_as_good_as_zero(coordinate);
            let end = parameter.bound_at(coordinate).filter(|_| holds)?;
            Some((parameter, end))
        };
        self.moved().into_iter().filter_map(held).collect()
    }

    /// Those of `parameters` that a fit moves.
    pub fn moved_among(&self, parameters: &[Parameter]) -> Vec<Parameter> {
        let mut moved = self.free_among(parameters);
        moved.retain(|p| *p != Parameter::SinkageExponent || self.splits_pressure());
        moved
    }

    /// The rows that say something to a stage: those with a torque, which all three need; on hard
    /// ground, one held by static friction is not that of Eq. (75).
    pub fn rows_of(&self, stage: Stage, rows: &[SteadyLoad]) -> Vec<SteadyLoad> {
        let slips = |row: &SteadyLoad| !self.setting.holds(row, self.class);
        let used =
            |row: &&SteadyLoad| row.has_torque() && (stage != Stage::ShearStress || slips(row));
        rows.iter().filter(used).copied().collect()
    }

    /// The first stage with fewer rows than it has parameters to find, how many it needs and has.
    pub fn stage_without_rows(&self, rows: &[SteadyLoad]) -> Option<(Stage, [usize; 2])> {
        Stage::ALL.into_iter().find_map(|stage| {
            let given = self.rows_of(stage, rows).len();
            let needed = self.moved_among(stage.parameters()).len();
            (given < needed).then_some((stage, [needed, given]))
        })
    }

    /// `row` with the torque that its pull and load leave, the peak being at `at` (Eq. 73).
    pub fn with_torque(&self, at: &Coordinates, row: &SteadyLoad) -> SteadyLoad {
        let arc = ArcCoefficients::from(self.contact(at, row).angles);
        SteadyLoad {
            driving_torque: self.surface().radius * arc.rim_force(row.load, row.drawbar_pull),
            ..*row
        }
    }

    /// The soil at `at`.
    pub fn soil(&self, at: &Coordinates) -> Soil {
        TerrainParameters::at(at).on(&Soil {
            exit_angle: self.setting.exit_angle,
            ..UNUSED
        })
    }

    /// The contact of a row, its peak where `c_1` and `c_2` put it.
    ///
    /// Unlike [`ContactAngles::new`] it may leave the contact, where Eq. (65) goes on smoothly: a
    /// fit that stops at the border would push every other parameter off.
    pub fn contact(&self, at: &Coordinates, row: &SteadyLoad) -> RimContact {
        let rim = self.surface();
        let entry = entry_angle(rim.radius, row.sinkage);
        RimContact {
            rim,
            angles: ContactAngles {
                entry,
                peak: peak_share(at, row.slip) * entry,
                exit: self.setting.exit_angle * entry,
            },
            sinkage: row.sinkage,
            slip: row.slip,
        }
    }
}

/// `θ_m/θ_1 = c_1 + c_2 s` [-].
pub(super) fn peak_share(at: &Coordinates, slip: f64) -> f64 {
    at[Parameter::StressAngle as usize] + at[Parameter::StressAngleSlip as usize] * slip
}
