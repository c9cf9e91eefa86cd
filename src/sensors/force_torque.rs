//! Force and torque sensor between wheel and axle.

use super::transducer::{Transducer, finite};
use crate::quantity::RangeError;
use crate::simulation::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Force and torque sensor between wheel and axle.
///
/// The default is ideal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ForceTorque {
    /// Sensitivity of each bridge to the loads: rows `F_N`, `F_DP` and `M_R`, columns `F_N` \[N\], `F_DP` \[N\]
    /// and `M_R` [N·m].
    pub crosstalk: [[f64; 3]; 3],
    /// Channel of the normal force, in N.
    pub normal_force: Transducer,
    /// Channel of the drawbar pull, in N.
    pub drawbar_pull: Transducer,
    /// Channel of the driving torque, in N·m.
    pub driving_torque: Transducer,
}

impl Default for ForceTorque {
    fn default() -> Self {
        Self {
            crosstalk: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            normal_force: Transducer::default(),
            drawbar_pull: Transducer::default(),
            driving_torque: Transducer::default(),
        }
    }
}

impl ForceTorque {
    /// A calibrated six-axis strain-gauge sensor of 330 N and 30 N·m, into a 16-bit converter.
    ///
    /// Figures typical of the kind, not of one product:
    /// - noise 2e-3 N/√Hz and 1.2e-4 N·m/√Hz: 0.06 N and 0.004 N·m rms over 1 kHz, the resolution
    ///   that data sheets of this size state;
    /// - bandwidth 2 kHz, that of the amplifier's filter;
    /// - ranges ±330 N and ±30 N·m, in 2¹⁶ steps of 0.010 N and 9.2e-4 N·m;
    /// - crosstalk below the 1-2 % of full scale that data sheets allow;
    /// - gain 1 and bias 0, as calibrated and tared; drift none.
    pub fn realistic() -> Self {
        let force = Transducer {
            bandwidth: 2_000.0,
            noise_density: 2e-3,
            range: 330.0,
            resolution: 0.010,
            ..Transducer::default()
        };
        Self {
            crosstalk: [[1.0, 0.005, 0.02], [0.005, 1.0, 0.02], [5e-4, 5e-4, 1.0]],
            normal_force: force,
            drawbar_pull: force,
            driving_torque: Transducer {
                noise_density: 1.2e-4,
                range: 30.0,
                resolution: 9.2e-4,
                ..force
            },
        }
    }

    pub(super) fn check(&self, rate: f64) -> Result<(), RangeError> {
        for value in self.crosstalk.as_flattened() {
            finite("crosstalk", "-", *value)?;
        }
        self.normal_force.check("N", rate)?;
        self.drawbar_pull.check("N", rate)?;
        self.driving_torque.check("N m", rate)
    }

    /// Loads at the bridges: normal force [N], drawbar pull [N], driving torque [N·m].
    pub(super) fn bridges(&self, loads: &Loads) -> [f64; 3] {
        self.crosstalk.map(|[normal, pull, torque]| {
            normal * loads.normal_force + pull * loads.drawbar_pull + torque * loads.driving_torque
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crosstalk_is_a_matrix_on_the_loads() {
        let loads = Loads {
            normal_force: 100.0,
            drawbar_pull: 20.0,
            driving_torque: 3.0,
        };
        assert_eq!(ForceTorque::default().bridges(&loads), [100.0, 20.0, 3.0]);
        let mut crossed = ForceTorque::default();
        crossed.crosstalk[1][0] = 0.01;
        crossed.crosstalk[2][1] = 0.5;
        assert_eq!(crossed.bridges(&loads), [100.0, 21.0, 13.0]);
    }
}
