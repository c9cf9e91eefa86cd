//! Effects of the wheel and of what turns it.

use super::{
    Bound, Effect, EffectError, OtherForm, Prior, Seat, Seated, Setup, Signature, Source, Stage,
};
use crate::simulation::rig::flaws::DriveFlaws;
use crate::wheel::Lugs;

/// The effects of the wheel and of what turns it.
pub(super) const EFFECTS: &[Effect] = &[
    WHEEL_ECCENTRICITY,
    WHEEL_OVALITY,
    SHORT_LUG,
    LUG_WEAR,
    MOTOR_COGGING,
    SERVO_RIPPLE,
    ENCODER_SCALE,
    CARRIAGE_SCALE,
    CARRIAGE_COMPLIANCE,
    MOTOR_COMPLIANCE,
    DRIVE_VIBRATION,
];

/// Fewest lugs of a wheel on which one may be short.
const FEWEST_LUGS: u32 = 4;

/// Wheel speed [rad/s] at which both forms of cogging, and of a wrong scale, are equal: 56 mm/s on a rim of
/// 140 mm, between the 20 and 100 mm/s of a campaign that is to separate them.
const TYPICAL_SPEED: f64 = 0.4;

const WHEEL_ECCENTRICITY: Effect = Effect {
    name: "wheel_eccentricity",
    title: "eccentricity of the axle",
    edits: "wheel.flaws.eccentricity",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m",
        [0.0, 0.01],
        [1.0e-4, 4.0e-4, 1.5e-3],
        Prior::log_normal(3.0e-4, 2.0),
    )],
    signature: Signature {
        channels: &["sinkage", "driving_torque", "drawbar_pull"],
        bound: Bound::WheelAngle,
        dependence: "order 1 of the wheel, sidebands of the lug line; torque (W - m g) e with the wheel's mass m, \
                     so it grows with load, and m g e on a lifted wheel; the same at every speed, and too slow \
                     for the accelerometer; on rigid ground in the torque alone, for the rim's depth stays what \
                     it is",
    },
    confusers: &["wheel_ovality", "short_lug", "slope"],
    source: Source::Cited(
        "ISO 2768-2, general tolerance of circular run-out, classes H, K, L: 0.1, 0.2, 0.5 mm, twice \
         the eccentricity; a wheel built up from sheet metal has more",
    ),
    law: |setup, eccentricity, _| {
        setup.wheel.flaws.eccentricity += eccentricity;
        Ok(())
    },
    other_form: None,
};

const WHEEL_OVALITY: Effect = Effect {
    name: "wheel_ovality",
    title: "ovality of the rim",
    edits: "wheel.flaws.ovality",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m",
        [0.0, 0.01],
        [1.0e-4, 4.0e-4, 1.5e-3],
        Prior::log_normal(3.0e-4, 2.0),
    )],
    signature: Signature {
        channels: &["sinkage", "driving_torque", "drawbar_pull"],
        bound: Bound::WheelAngle,
        dependence: "order 2 of the wheel by this amplitude; the same at every speed, and too slow for the \
                     accelerometer",
    },
    confusers: &["wheel_eccentricity", "short_lug"],
    source: Source::Cited(
        "ISO 2768-2, general tolerance of circular run-out, as of wheel_eccentricity: an oval rim runs out \
         by twice the amplitude too",
    ),
    law: |setup, ovality, _| {
        setup.wheel.flaws.ovality += ovality;
        Ok(())
    },
    other_form: None,
};

const SHORT_LUG: Effect = Effect {
    name: "short_lug",
    title: "one short or missing lug",
    edits: "wheel.flaws.short_lug",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 1.0],
        [0.1, 0.4, 1.0],
        Prior::half_normal(0.5),
    )],
    signature: Signature {
        channels: &["acceleration_y", "sinkage", "driving_torque"],
        bound: Bound::WheelAngle,
        dependence: "once a turn at one lug; on hard ground the wheel drops deeper there, in soil it \
                     cuts less",
    },
    confusers: &["wheel_eccentricity", "lug_wear"],
    source: Source::Cited(
        "grousers of Curiosity broke off whole (Science News, 21 March 2017); machining leaves 1 to 2 %",
    ),
    law: |setup, missing, seated| shorten(setup, missing, 1, seated),
    other_form: Some(OtherForm {
        description: "two neighbouring lugs lack half of it each",
        not_on: &[],
        law: |setup, missing, seated| shorten(setup, missing, 2, seated),
    }),
};

const LUG_WEAR: Effect = Effect {
    name: "lug_wear",
    title: "wear of all lugs",
    edits: "wheel.lugs.height",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 0.5],
        [0.03, 0.12, 0.35],
        Prior::log_normal(0.12, 2.2),
    )],
    signature: Signature {
        channels: &["acceleration_y", "drawbar_pull", "sinkage"],
        bound: Bound::WheelAngle,
        dependence: "lug line lower in proportion; on hard ground less way a turn, as (r + l) shrinks; \
                     in soil less pull",
    },
    confusers: &["encoder_scale", "lug_action", "gain_error"],
    source: Source::Guess("wear is known of rover wheels, not its size"),
    law: |setup, worn, seated| {
        lugs(setup, seated)?.height *= 1.0 - worn;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "worn on one side: none at lug 0, twice the mean opposite",
        not_on: &[],
        law: |setup, worn, seated| {
            lugs(setup, seated)?;
            setup.wheel.flaws.uneven_wear += worn;
            Ok(())
        },
    }),
};

const MOTOR_COGGING: Effect = Effect {
    name: "motor_cogging",
    title: "speed ripple by motor cogging or gear",
    edits: "rig.*.drive_flaws.cogging",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 0.5],
        [0.005, 0.02, 0.06],
        Prior::log_normal(0.015, 2.0),
    )],
    signature: Signature {
        channels: &["driving_torque", "drawbar_pull", "acceleration_y"],
        bound: Bound::WheelAngle,
        dependence: "order 200 of the wheel (two a turn of a 100:1 harmonic drive), in the lifted wheel \
                     too",
    },
    confusers: &["servo_ripple", "mains_hum", "aliasing"],
    source: Source::Cited(
        "kinematic error of harmonic drives at twice the wave generator's speed: Ghorbel, Gandhi and \
         Alpeter (2001), J. Mech. Design 123:90-97; catalogues state 0.5 to 1.5 arcmin, at order 200 \
         3 to 9 % of the speed",
    ),
    law: |setup, part, _| {
        drive_flaws(setup).cogging += part;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "a cogging torque against a servo of finite stiffness: the ripple in rad/s does \
                      not grow with speed, and is the same at 0.4 rad/s",
        not_on: &[],
        law: |setup, part, _| {
            drive_flaws(setup).cogging_speed += part * TYPICAL_SPEED;
            Ok(())
        },
    }),
};

const SERVO_RIPPLE: Effect = Effect {
    name: "servo_ripple",
    title: "speed-loop oscillation",
    edits: "rig.*.drive_flaws.hunting",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 0.3],
        [0.005, 0.02, 0.05],
        Prior::log_normal(0.015, 2.0),
    )],
    signature: Signature {
        channels: &["driving_torque", "drawbar_pull", "slip_ratio"],
        bound: Bound::Frequency,
        dependence: "2.3 Hz at every speed; pull follows by the slope of its curve over slip, less at \
                     high slip",
    },
    confusers: &["motor_cogging", "rail_friction", "added_noise"],
    source: Source::Cited(
        "bounded by the rim speed of the cmu-single-wheel runs (tests/data): 3.4 % rms at 10 mm/s, \
         0.6 % at 100 mm/s, estimation noise included",
    ),
    law: |setup, part, _| {
        drive_flaws(setup).hunting += part;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "a saw-tooth of the same root mean square: it sticks and slips",
        not_on: &[],
        law: |setup, part, _| {
            drive_flaws(setup).sawtooth += part;
            Ok(())
        },
    }),
};

const ENCODER_SCALE: Effect = Effect {
    name: "encoder_scale",
    title: "encoder scale error within the speed loop",
    edits: "rig.*.drive_flaws.wheel_scale, sensors.encoder.wheel_angle.gain",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [-0.2, 0.2],
        [0.005, 0.02, 0.08],
        Prior::normal(0.03),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "slip_ratio", "driving_torque"],
        bound: Bound::Condition,
        dependence: "all curves shift along slip by (1 - s) e; lug passes stand beside the orders of the \
                     angle read",
    },
    confusers: &[
        "carriage_scale",
        "lug_wear",
        "load_drift",
        "slip_sinkage",
        "clock_error",
    ],
    source: Source::Cited(
        "cmu-single-wheel (tests/data): rims commanded at 12 mm/s ran at 13.0; radius r or r + l is \
         11 % on the paper's wheel",
    ),
    law: |setup, error, _| {
        scale_wheel(setup, 1.0 + error);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "counts are lost in proportion to speed; the same error at 0.4 rad/s",
        not_on: &[],
        law: |setup, error, _| {
            let radius = setup.wheel.radius;
            let speed = setup
                .rig
                .drive()
                .full_wheel_speed(radius)
                .unwrap_or(TYPICAL_SPEED);
            scale_wheel(setup, 1.0 + error * speed.abs() / TYPICAL_SPEED);
            Ok(())
        },
    }),
};

/// The encoder reads so many times the true angle, and the motor turns until it reads what is commanded.
fn scale_wheel(setup: &mut Setup, scale: f64) {
    drive_flaws(setup).wheel_scale /= scale;
    setup.sensors.encoder.wheel_angle.gain *= scale;
}

const CARRIAGE_SCALE: Effect = Effect {
    name: "carriage_scale",
    title: "carriage scale error within its speed loop",
    edits: "rig.*.drive_flaws.carriage_scale, sensors.encoder.forward_speed.gain",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [-0.2, 0.2],
        [0.002, 0.01, 0.04],
        Prior::normal(0.015),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "acceleration_y", "driving_torque"],
        bound: Bound::Condition,
        dependence: "all curves shift along slip by (1 - s) e the other way than by the encoder; lug passes \
                     and orders stay where they are",
    },
    confusers: &["encoder_scale", "load_drift", "slip_sinkage"],
    source: Source::Guess(
        "a measuring wheel or belt pulley of 20 mm that is 0.2 mm too small is 1 % off",
    ),
    law: |setup, error, _| {
        drive_flaws(setup).carriage_scale *= 1.0 + error;
        setup.sensors.encoder.forward_speed.gain /= 1.0 + error;
        Ok(())
    },
    other_form: None,
};

const CARRIAGE_COMPLIANCE: Effect = Effect {
    name: "carriage_compliance",
    title: "softer drive of the carriage than stated",
    edits: "rig.*.carriage.stiffness, rig.*.carriage.damping_ratio",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m/N",
        [0.0, 5.0e-4],
        [2.0e-6, 1.0e-5, 5.0e-5],
        Prior::log_normal(8.0e-6, 3.0),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "slip_ratio", "acceleration_y"],
        bound: Bound::Frequency,
        dependence: "the carriage surges at 1/(2π √(C m)) by the pull over its stiffness, excited by lugs, so pull and \
                     slip swing together; 42 kg on a belt of 2 µm/N at 12, 7 and 3.4 Hz at the three levels; means stay",
    },
    confusers: &["motor_compliance", "servo_ripple", "rig_resonance"],
    source: Source::Cited(
        "ELATECH catalogue, toothed belt ATL5: specific spring rate 632.5 kN at 25 mm, 2 µm/N over 2.5 m to either \
         pulley; a polyurethane belt half as wide, twice as long and badly tensioned has ten times that, a guess",
    ),
    law: |setup, compliance, seated| {
        carriage_spring(setup, seated)?.soften(compliance);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: UNDAMPED,
        not_on: &[],
        law: |setup, compliance, seated| {
            carriage_spring(setup, seated)?.soften_undamped(compliance);
            Ok(())
        },
    }),
};

const MOTOR_COMPLIANCE: Effect = Effect {
    name: "motor_compliance",
    title: "softer shaft between motor and wheel than stated",
    edits: "rig.*.motor.stiffness, rig.*.motor.damping_ratio",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "rad/(N·m)",
        [0.0, 2.0e-2],
        [1.0e-4, 6.0e-4, 4.0e-3],
        Prior::log_normal(5.0e-4, 3.0),
    )],
    signature: Signature {
        channels: &["driving_torque", "slip_ratio", "acceleration_y"],
        bound: Bound::Frequency,
        dependence: "the wheel winds up against its shaft and swings at 1/(2π √(C I)): 0.05 kg·m² on a drive of 0.2 \
                     mrad/(N·m) at 41, 25 and 11 Hz at the three levels; torque peaks of lugs are blunted, means stay",
    },
    confusers: &[
        "carriage_compliance",
        "motor_cogging",
        "low_pass",
        "servo_ripple",
    ],
    source: Source::Cited(
        "Harmonic Drive CSF-17-100: K3 = 1.6e4 N·m/rad, with a torque transducer and couplings (a guess) 5e3; a long \
         shaft or a bellows coupling has 2 to 0.2 kN·m/rad, a guess too",
    ),
    law: |setup, compliance, seated| {
        motor_spring(setup, seated)?.soften(compliance);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: UNDAMPED,
        not_on: &[],
        law: |setup, compliance, seated| {
            motor_spring(setup, seated)?.soften_undamped(compliance);
            Ok(())
        },
    }),
};

/// How a compliance may be added otherwise.
const UNDAMPED: &str =
    "the added spring has no damper of its own: the damping ratio falls with the stiffness";

/// The spring of a drive, in the units of the drive.
struct Spring<'a> {
    stiffness: &'a mut f64,
    damping_ratio: &'a mut f64,
}

impl Spring<'_> {
    /// Puts a compliance in series, in the unit of the stiffness' inverse.
    fn soften(self, compliance: f64) {
        *self.stiffness /= 1.0 + *self.stiffness * compliance;
    }

    /// The same without a damper beside it.
    fn soften_undamped(self, compliance: f64) {
        let stiff = *self.stiffness;
        *self.stiffness /= 1.0 + stiff * compliance;
        *self.damping_ratio *= *self.stiffness / stiff;
    }
}

/// The spring of the carriage, if it is no rigid one.
fn carriage_spring<'a>(setup: &'a mut Setup, seated: Seated) -> Result<Spring<'a>, EffectError> {
    let carriage = setup.rig.drive_mut().carriage.as_mut();
    let carriage = carriage.filter(|carriage| !carriage.is_rigid());
    let spring = carriage.map(|carriage| Spring {
        stiffness: &mut carriage.stiffness,
        damping_ratio: &mut carriage.damping_ratio,
    });
    spring.ok_or(EffectError::Needs {
        effect: seated.effect,
        what: "a rig with a carriage of finite stiffness",
    })
}

/// The spring of the motor, if it is no rigid one.
fn motor_spring<'a>(setup: &'a mut Setup, seated: Seated) -> Result<Spring<'a>, EffectError> {
    let motor = setup.rig.drive_mut().motor.as_mut();
    let motor = motor.filter(|motor| !motor.is_rigid());
    let spring = motor.map(|motor| Spring {
        stiffness: &mut motor.stiffness,
        damping_ratio: &mut motor.damping_ratio,
    });
    spring.ok_or(EffectError::Needs {
        effect: seated.effect,
        what: "a rig with a motor of finite stiffness",
    })
}

fn drive_flaws<'a>(setup: &'a mut Setup) -> &'a mut DriveFlaws {
    &mut setup.rig.drive_mut().flaws
}

fn lugs<'a>(setup: &'a mut Setup, seated: Seated) -> Result<&'a mut Lugs, EffectError> {
    setup.wheel.lugs.as_mut().ok_or(EffectError::Needs {
        effect: seated.effect,
        what: "a wheel with lugs",
    })
}

fn shorten(
    setup: &mut Setup,
    missing: f64,
    shared_by: u32,
    seated: Seated,
) -> Result<(), EffectError> {
    if lugs(setup, seated)?.count < FEWEST_LUGS {
        return Err(EffectError::Needs {
            effect: seated.effect,
            what: "a wheel with four lugs or more",
        });
    }
    setup.wheel.flaws.short_lug += missing;
    setup.wheel.flaws.short_lugs = shared_by;
    Ok(())
}

const DRIVE_VIBRATION: Effect = Effect {
    name: "drive_vibration",
    title: "vibration of motor and gear at the axle",
    edits: "sensors.accelerometer.drive_vibration",
    stage: Stage::Sensors,
    seats: &[Seat::new(
        "m/s^2",
        [0.0, 0.5],
        [5.0e-4, 1.1e-3, 2.9e-3],
        Prior::log_normal(1.1e-3, 2.4),
    )],
    signature: Signature {
        channels: &["acceleration_y"],
        bound: Bound::Condition,
        dependence: "noise below 100 Hz that grows with the square of wheel speed, its root mean square stated at \
                     0.1 rad/s; on every ground, and on the lifted wheel",
    },
    confusers: &["added_noise", "motor_cogging", "mains_hum"],
    source: Source::Cited(
        "ISO 10816-1, class I: 0.71, 1.8 and 4.5 mm/s rms bound the zones of small machines at rated speed; by a gear \
         of 100:1 at 3000 rpm and the square law 0.5, 1.1 and 2.9 mm/s^2 at 0.1 rad/s",
    ),
    law: |setup, rms, _| {
        let vibration = &mut setup.sensors.accelerometer.drive_vibration;
        vibration.broadband = libm::hypot(vibration.broadband, rms);
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "a line at the gear's mesh, order 500 of the wheel, of the same root mean square",
        not_on: &[],
        law: |setup, rms, _| {
            let vibration = &mut setup.sensors.accelerometer.drive_vibration;
            vibration.mesh = libm::hypot(vibration.mesh, rms);
            Ok(())
        },
    }),
};
