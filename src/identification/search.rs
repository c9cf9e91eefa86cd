//! Starts of the fits and choice among their minima.

use super::joint::Joint;
use super::least_squares::{Minimum, Residuals, Termination, minimise_from};
use super::model::Model;
use super::parameter::{Coordinates, Parameter, TerrainParameters};
use super::point::Point;
use super::precision::Precision;
use super::row::SteadyLoad;
use super::stage::Stage;
use super::stages::{self, ANGLES, STRENGTHS, Staged};
use super::weight::Scale;

/// Default start: typical of sands, and the paper's exponents `n_0` for hard ground.
const START: TerrainParameters = TerrainParameters {
    stress_angle: 0.4,
    stress_angle_slip: 0.0,
    sinkage_modulus: 1.0e6,
    sinkage_exponent: 0.5,
    sinkage_exponent_slip: 0.5,
    cohesion: 300.0,
    friction_angle_deg: 30.0,
    shear_modulus: 0.01,
};

/// Multistart search for the least-squares minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search<'a> {
    pub model: &'a Model,
    pub rows: &'a [SteadyLoad],
}

impl Search<'_> {
    /// The paper's three stages in sequence; `None` with too few torques.
    pub fn staged(&self) -> Option<Staged> {
        let can = self.model.stage_without_rows(self.rows).is_none();
        can.then(|| {
            let mut at = self.start();
            let terminations = Stage::ALL.map(|stage| self.advance(stage, self.rows, &mut at));
            Staged {
                parameters: TerrainParameters::at(&at),
                terminations,
            }
        })
    }

    /// The start before any row is used, adapted to the class.
    fn start(&self) -> Coordinates {
        let mut start = START.coordinates();
        self.model.switch(&mut start);
        start
    }

    fn advance(&self, stage: Stage, rows: &[SteadyLoad], at: &mut Coordinates) -> Termination {
        match stages::run(stage, self.model, rows, *at) {
            Some(minimum) => {
                *at = minimum.at;
                minimum.termination
            }
            None => Termination::NotFinite,
        }
    }

    /// The least minimum over the starts; many more starts are tried where the first minimum is at a bound or
    /// misfits the rows, as along the ridge of `k_s` and `n_0` under one load.
    pub fn best(&self, joint: &Joint, staged: Option<&Staged>) -> Option<Minimum> {
        let moved = self.model.moved();
        let first = minimise_from(joint, self.starts(staged), &moved)?;
        let freedom = joint.forces().saturating_sub(moved.len());
        let missed = Precision::new(Scale::of(self.rows).known, first.chi_square, freedom);
        let held = |p: &Parameter| p.is_at_bound(first.at[*p as usize]);
        if missed.misfit.is_none() && !moved.iter().any(held) {
            return Some(first);
        }
        let nearest = nearest(joint, self.more_starts(first.at));
        let more = minimise_from(joint, nearest, &moved);
        let better = more.filter(|more| more.chi_square < first.chi_square);
        better.or(Some(first))
    }

    /// Starts with the angles of `at`, exponents from plate tests on loose to layered soils, and strengths
    /// from loose to crusted sands.
    fn more_starts(&self, at: Coordinates) -> Vec<Coordinates> {
        const EXPONENTS: [f64; 4] = [0.3, 0.8, 1.3, 2.0];
        let exponent = Parameter::SinkageExponent;
        let exponents = if self.model.moved().contains(&exponent) {
            EXPONENTS.to_vec()
        } else {
            vec![at[exponent as usize]]
        };
        let angles = ANGLES.map(|[c_1, c_2]| {
            [
                (Parameter::StressAngle, c_1),
                (Parameter::StressAngleSlip, c_2),
            ]
        });
        let mut starts = Vec::new();
        for exponent in exponents {
            for angles in angles {
                for strength in STRENGTHS {
                    let mut start = at;
                    let shear = Stage::ShearStress.parameters().iter().copied();
                    let set = angles.into_iter().chain(shear.zip(strength));
                    for (parameter, value) in set.chain([(Parameter::SinkageExponent, exponent)]) {
                        start[parameter as usize] = parameter.coordinate(value);
                    }
                    self.model.switch(&mut start);
                    starts.push(self.with_pressure(start));
                }
            }
        }
        starts
    }

    /// `at` with the sinkage modulus that carries the mean load.
    fn with_pressure(&self, mut at: Coordinates) -> Coordinates {
        let modulus = Parameter::SinkageModulus;
        if !self.model.moved().contains(&modulus) {
            return at;
        }
        let ratio =
            |row: &SteadyLoad| row.load / self.model.loads(&Point::of(&at, row)).normal_force;
        let carrying = self.rows.iter().map(ratio).filter(|ratio| *ratio > 0.0);
        let logarithms: Vec<f64> = carrying.map(libm::log).collect();
        let count = logarithms.len().max(1) as f64;
        at[modulus as usize] += logarithms.iter().sum::<f64>() / count;
        at
    }

    /// Starts of the joint fit: the stages' result, and that of the later stages with default angles, since
    /// noise may mislead the first stage. Without torques, the results of the later stages for torques
    /// derived from several angles.
    fn starts(&self, staged: Option<&Staged>) -> Vec<Coordinates> {
        let default = self.start();
        if let Some(staged) = staged {
            let begun = staged.parameters.coordinates();
            return vec![begun, self.later_stages(self.rows, default)];
        }
        let angles = ANGLES.map(|[c_1, c_2]| {
            let mut at = default;
            at[Parameter::StressAngle as usize] = c_1;
            at[Parameter::StressAngleSlip as usize] = c_2;
            self.model.switch(&mut at);
            at
        });
        let begun = angles.into_iter().chain([default]).map(|at| {
            let torque = |row: &SteadyLoad| {
                if row.has_torque() {
                    *row
                } else {
                    self.model.with_torque(&at, row)
                }
            };
            let rows: Vec<SteadyLoad> = self.rows.iter().map(torque).collect();
            self.later_stages(&rows, at)
        });
        begun.collect()
    }

    fn later_stages(&self, rows: &[SteadyLoad], mut at: Coordinates) -> Coordinates {
        for stage in [Stage::NormalStress, Stage::ShearStress] {
            self.advance(stage, rows, &mut at);
        }
        at
    }
}

/// The few starts with the least sum of squares.
fn nearest(joint: &Joint, starts: Vec<Coordinates>) -> impl Iterator<Item = Coordinates> {
    const DESCENTS: usize = 12;
    let square = |at: &Coordinates| joint.residuals(at).iter().map(|r| r * r).sum::<f64>();
    let mut ranked: Vec<(f64, Coordinates)> =
        starts.into_iter().map(|at| (square(&at), at)).collect();
    ranked.sort_by(|one, other| one.0.total_cmp(&other.0));
    ranked.into_iter().take(DESCENTS).map(|(_, at)| at)
}
