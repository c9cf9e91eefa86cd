//! Loads that are physically impossible on any ground.
//!
//! **Power.** The motor gives `T ω`; the wheel gives `F v` to what it pulls. The rest goes into the ground:
//!
//! ```text
//! T ω − F v ≥ 0
//! ```
//!
//! Divided by the faster of rim and forward speed this is in newtons, and slip alone gives the speeds.
//!
//! **Resistance.** Of the normal stress `σ` and shear stress `τ` on the arc from the entry angle `θ_1` back,
//!
//! ```text
//! T/ρ − F = b ρ ∫ [σ sin θ + τ (1 − cos θ)] dθ,    W = b ρ ∫ [σ cos θ + τ sin θ] dθ
//! ```
//!
//! and as both `sin θ / cos θ` and `(1 − cos θ) / sin θ` are at most `tan θ_1`, a driven wheel meets
//!
//! ```text
//! T/ρ − F ≤ W tan θ_1,    cos θ_1 = (r − z) / ρ
//! ```
//!
//! whatever the stresses, with `ρ = r + h` for lugs of height `h`, whose tips are the outermost to meet
//! ground. Without torque, `−F` alone is at most as much. Heaps before the wheel and stones let it meet
//! ground higher than it sinks: these are in the [`HEAP`] and in the roughness of ground that is not known to be sand.
//!
//! On a slope both apply to the contact forces: the part of the wheel's own weight is subtracted from the
//! readings; where its mass is unknown neither is checked.

use super::doubts::Doubts;
use super::subject::{SIGMAS, Steady, Subject, ZERO};
use super::{Severity, number};
use crate::quantity::GRAVITY;
use crate::soil::contact::entry_angle;
use crate::terrain::class::TerrainLabel;
use crate::trace::RunAttributes;

/// Error of a force's or torque's gain [-] that remains unnoticed.
const GAIN: f64 = 0.05;

/// Zero error of the sinkage [m] that remains unnoticed.
const SINKAGE_ZERO: f64 = 0.3e-3;

/// Height of the soil that a wheel pushes up before it, over the sinkage [-].
const HEAP: f64 = 0.1;

/// Height [m] above the mean surface at which a wheel meets stones or steps, where the ground may have some.
const STEP: f64 = 0.005;

/// Entry angle [°] beyond which no rover wheel drives; the axle would be level with the ground at 90°.
const STEEPEST: f64 = 60.0;

/// Slip [-] above which a wheel is driven though its torque is not measured.
const DRIVING_SLIP: f64 = 0.05;

/// Torque over radius and load [-] below which a unit that makes it so small explains nothing.
const LEAST_THRUST: f64 = 1.0e-3;

/// Torque over radius and load [-] that is as good as none: the quadrature gives 0.1 to 0.25 of lugged wheels at slip 0.
const TORQUE_FREE: f64 = 0.06;

/// Slip [-] that is as good as 0.
const NO_SLIP: f64 = 0.005;

/// Lug height over radius [-] from which lugs show at slip 0.
const LEAST_LUGS: f64 = 0.03;

/// Checks pull and torque against each other, load, slip and sinkage.
pub(super) fn check(subject: &Subject<'_>, doubts: &mut Doubts) {
    let is_doubted = doubts.has_any(&["drawbar_pull", "driving_torque"]);
    let is_still = subject.trace.attributes.is_lifted() || subject.is_rest();
    if is_doubted || is_still || subject.is_over_one_stone() {
        return;
    }
    let steepest = STEEPEST.to_radians().tan();
    let entry = if doubts.has_any(&["sinkage"]) {
        steepest
    } else {
        entry(subject)
    };
    let Some(loads) = Loads::of(subject, entry) else {
        return;
    };
    if let Some(seen) = loads.torque_free(subject) {
        let guess = "is slip counted from the lugs' tips, or from where the torque is 0? State slip_radius or slip_zero in the \
                     campaign";
        doubts.channel("driving_torque", Severity::Warning, &seen, guess);
    }
    for fault in [loads.power(), loads.resistance()].into_iter().flatten() {
        doubts.channel("drawbar_pull", Severity::Warning, &fault, &loads.remedies());
    }
}

/// The loads of a wheel in the direction of its motion.
#[derive(Debug, Clone, Copy)]
struct Loads {
    /// Drawbar pull `F` [N].
    pull: Steady,
    /// Driving torque over the lugs' tip radius, `T/ρ` [N].
    thrust: Option<Steady>,
    /// Tip radius over rim radius, `ρ/r` [-].
    tips: f64,
    /// Load `W` [N].
    load: f64,
    /// Slip [-]; NaN where unknown, so that the power is not checked.
    slip: f64,
    /// `tan θ_1` [-], the largest that the sinkage allows.
    entry: f64,
}

impl Loads {
    fn of(subject: &Subject<'_>, entry: f64) -> Option<Self> {
        let RunAttributes {
            wheel_radius,
            lug_height,
            ..
        } = subject.trace.attributes;
        let load = subject.carried();
        let direction = subject.direction();
        let forward = |steady: Steady| Steady {
            mean: direction * steady.mean,
            ..steady
        };
        let tip_radius = wheel_radius + lug_height.max(0.0);
        let over_tips = |torque: Steady| Steady {
            mean: torque.mean / tip_radius,
            sd: torque.sd / tip_radius,
        };
        let measured = subject.contact("normal_force");
        let measured = measured.map_or(f64::NAN, |steady| steady.mean);
        let loads = Self {
            pull: forward(subject.contact("drawbar_pull")?),
            thrust: subject
                .contact("driving_torque")
                .map(forward)
                .map(over_tips),
            tips: tip_radius / wheel_radius,
            load: if load > 0.0 {
                load.max(measured)
            } else {
                measured
            },
            slip: subject.slip(),
            entry,
        };
        let known = loads.load > 0.0 && loads.tips.is_finite() && loads.entry.is_finite();
        let is_slip = loads.slip.is_nan() || (-1.0..=1.0).contains(&loads.slip);
        (known && is_slip).then_some(loads)
    }

    /// Rim and forward speed over the faster of them [-].
    fn speeds(&self) -> [f64; 2] {
        [1.0_f64.min(1.0 + self.slip), 1.0_f64.min(1.0 - self.slip)]
    }

    /// What is wrong with the power, if the wheel gives more than it gets.
    fn power(&self) -> Option<String> {
        let thrust = self.thrust.filter(|_| self.slip.is_finite())?;
        let [rim, forward] = self.speeds();
        let (into, out) = (self.tips * thrust.mean * rim, self.pull.mean * forward);
        let noise = (self.tips * thrust.sd * rim).hypot(self.pull.sd * forward);
        let slack = SIGMAS * noise + GAIN * into.abs().max(out.abs()) + ZERO * self.load;
        if out - into <= slack {
            return None;
        }
        let pull = format!(
            "a pull of {} N at slip {}",
            number(self.pull.mean),
            number(self.slip)
        );
        Some(match into {
            into if into > 0.0 => {
                let ratio = number(out / into);
                format!("{pull}: the output power is {ratio} times the input power of the torque")
            }
            0.0 => format!("{pull}: output power without input power of the torque"),
            _ => format!("{pull}: output power although the torque brakes"),
        })
    }

    /// What is wrong with the resistance, if it is more than ground before the wheel can give.
    fn resistance(&self) -> Option<String> {
        let most = self.load * self.entry;
        let (resistance, noise, gain, of) = match self.thrust {
            Some(thrust) if thrust.mean > 0.0 => (
                thrust.mean - self.pull.mean,
                thrust.sd.hypot(self.pull.sd),
                thrust.mean.max(self.pull.mean.abs()),
                "torque over radius less pull",
            ),
            None if self.slip > DRIVING_SLIP => {
                let pull = self.pull;
                (
                    -pull.mean,
                    pull.sd,
                    pull.mean.abs(),
                    "the pull of a driven wheel",
                )
            }
            _ => return None,
        };
        let slack = SIGMAS * noise + GAIN * gain + ZERO * self.load;
        (resistance - most > slack).then(|| {
            format!(
                "{of} leaves a resistance of {} N, more than the {} N that the ground can exert at this \
                 sinkage (load x tan(entry angle))",
                number(resistance),
                number(most)
            )
        })
    }

    /// What is odd of the torque at slip 0, if a lugged wheel in soil has next to none there: by the rim
    /// its lugs' tips slip.
    fn torque_free(&self, subject: &Subject<'_>) -> Option<String> {
        let thrust = self.thrust?;
        let depth = subject.steady("sinkage")?.mean;
        let most = thrust.mean.abs() + SIGMAS * thrust.sd;
        let lugged = self.tips > 1.0 + LEAST_LUGS && depth > 0.0;
        (lugged && self.slip.abs() <= NO_SLIP && most < TORQUE_FREE * self.load).then(|| {
            format!(
                "a lugged wheel in soil has a torque of {} N over its tips' radius at slip {}, where the tips slip by {} \
                 and shear the soil",
                number(thrust.mean),
                number(self.slip),
                number(1.0 - 1.0 / self.tips)
            )
        })
    }

    fn is_possible(&self) -> bool {
        self.power().is_none() && self.resistance().is_none()
    }

    /// Whether the torque is more than nothing.
    fn is_felt(&self) -> bool {
        let least = LEAST_THRUST * self.load;
        self.thrust.is_none_or(|thrust| thrust.mean.abs() > least)
    }

    fn scaled(&self, [pull, torque]: [f64; 2]) -> Self {
        let times = |steady: Steady, by: f64| Steady {
            mean: by * steady.mean,
            sd: by.abs() * steady.sd,
        };
        Self {
            pull: times(self.pull, pull),
            thrust: self.thrust.map(|thrust| times(thrust, torque)),
            ..*self
        }
    }

    /// What would make the loads possible: a sign, a unit, or else a zero.
    fn remedies(&self) -> String {
        const GUESSES: [([f64; 2], &str); 7] = [
            ([-1.0, 1.0], "a pull of the other sign"),
            ([1.0 / GRAVITY, 1.0], "a pull 9.81 times too large"),
            ([GRAVITY, 1.0], "a pull in kgf"),
            ([1.0, 1.0 / GRAVITY], "a torque 9.81 times too large"),
            ([1.0, GRAVITY], "a torque in kgf m"),
            ([1.0, 1.0e3], "a torque in kN m"),
            ([1.0, 1.0e-3], "a torque in N mm"),
        ];
        let possible = GUESSES
            .iter()
            .map(|(factors, guess)| (self.scaled(*factors), guess))
            .filter(|(loads, _)| loads.is_possible() && loads.is_felt());
        let mut guesses: Vec<&str> = possible.map(|(_, guess)| *guess).take(2).collect();
        guesses.push("a zero of pull, torque or sinkage that was not taken off");
        format!("{}?", guesses.join(", "))
    }
}

/// Tangent of the largest entry angle [-] that the sinkage allows; that of the steepest where it is not measured.
fn entry(subject: &Subject<'_>) -> f64 {
    let RunAttributes {
        wheel_radius,
        lug_height,
        terrain,
        ..
    } = subject.trace.attributes;
    let Some(Steady { mean, sd }) = subject.steady("sinkage") else {
        return STEEPEST.to_radians().tan();
    };
    let tip_radius = wheel_radius + lug_height.max(0.0);
    let step = if terrain == Some(TerrainLabel::Sand) {
        0.0
    } else {
        STEP
    };
    let depth = mean + lug_height.max(0.0);
    let deepest = (1.0 + HEAP) * depth.max(0.0) + SIGMAS * sd + SINKAGE_ZERO + step;
    let most = STEEPEST.to_radians();
    entry_angle(tip_radius, deepest).min(most).tan()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RADIUS: f64 = 0.14;
    const SINKAGE: f64 = 0.02;

    fn exactly(mean: f64) -> Steady {
        Steady { mean, sd: 0.0 }
    }

    /// Loads of a smooth wheel 20 mm deep, by what one element of its arc after the other carries.
    fn loads(slip: f64, stresses: &[[f64; 2]]) -> Loads {
        let entry = entry_angle(RADIUS, SINKAGE);
        let [mut pull, mut thrust, mut load] = [0.0; 3];
        for (i, [normal, shear]) in stresses.iter().enumerate() {
            let angle = entry * (i as f64 + 0.5) / stresses.len() as f64;
            let (sine, cosine) = angle.sin_cos();
            pull += shear * cosine - normal * sine;
            load += normal * cosine + shear * sine;
            thrust += shear;
        }
        Loads {
            pull: exactly(pull),
            thrust: Some(exactly(thrust)),
            tips: 1.0,
            load,
            slip,
            entry: entry.tan(),
        }
    }

    proptest! {
        #[test]
        fn no_stress_on_the_arc_of_a_driven_wheel_is_doubted(
            slip in 0.0..1.0_f64,
            stresses in prop::collection::vec([0.0..100.0_f64, 0.0..100.0_f64], 1..20),
        ) {
            let loads = loads(slip, &stresses);
            prop_assert!(loads.is_possible(), "{loads:?}");
        }
    }

    #[test]
    fn more_power_out_than_in_is_doubted_by_means_and_their_scatter() {
        let sound = loads(0.2, &[[5.0, 3.0], [5.0, 3.0]]);
        assert_eq!((sound.power(), sound.resistance()), (None, None));
        let untared = Loads {
            pull: exactly(sound.pull.mean + 0.5 * sound.load),
            ..sound
        };
        assert!(
            untared
                .power()
                .unwrap()
                .contains("times the input power of the torque")
        );
        let uncertain = Loads {
            pull: Steady {
                sd: sound.load,
                ..untared.pull
            },
            ..untared
        };
        assert_eq!(uncertain.power(), None);
    }

    #[test]
    fn a_resistance_beyond_load_and_entry_angle_names_what_would_explain_it() {
        let sound = loads(0.2, &[[5.0, 3.0], [5.0, 3.0]]);
        let kilograms = sound.scaled([1.0, GRAVITY]);
        assert!(kilograms.resistance().is_some());
        assert!(
            kilograms
                .remedies()
                .contains("a torque 9.81 times too large")
        );
        let without_torque = Loads {
            pull: exactly(-0.9 * sound.load),
            thrust: None,
            ..sound
        };
        let seen = without_torque.resistance().unwrap();
        assert!(
            seen.starts_with("the pull of a driven wheel leaves"),
            "{seen}"
        );
        let braking = Loads {
            slip: -0.3,
            ..without_torque
        };
        assert_eq!(braking.resistance(), None);
    }
}
