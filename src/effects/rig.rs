//! Effects of rig and load.

use super::{Bound, Effect, OtherForm, Prior, Seat, Signature, Source, Stage};

/// The effects of rig and load.
pub(super) const EFFECTS: &[Effect] = &[RIG_RESONANCE, RAIL_FRICTION, LOAD_DRIFT, LOAD_TRANSFER];

/// Drawbar pull over load [-] at which both forms of guide friction are alike.
const TYPICAL_PULL: f64 = 0.2;

/// Slip [-] at which both forms of a load that drifts are alike.
const TYPICAL_SLIP: f64 = 0.3;

const RIG_RESONANCE: Effect = Effect {
    name: "rig_resonance",
    title: "compliance of the frame between wheel and slide",
    edits: "rig.*.frame_flaws.compliance",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m/N",
        [0.0, 1.0e-4],
        [1.0e-7, 5.0e-7, 3.0e-6],
        Prior::log_normal(5.0e-7, 3.0),
    )],
    signature: Signature {
        channels: &["acceleration_y", "normal_force"],
        bound: Bound::Frequency,
        dependence: "rings at 1/(2π √(C m)): a slide of 10 kg at 159, 71 and 29 Hz at the three levels, a \
                     little lower on ground that gives, none below 5e-8 m/N; struck by lugs, so more with \
                     speed",
    },
    confusers: &["mounting_resonance", "servo_ripple", "mains_hum"],
    source: Source::Guess(
        "no figure of a soil bin found; a force sensor of 9 N/µm under 10 kg rings at 150 Hz",
    ),
    law: |setup, compliance, _| {
        setup.rig.frame_mut().compliance += compliance;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "the frame stiffens to twice its stiffness from 5 µm on, so that the frequency \
                      depends on amplitude",
        not_on: &[],
        law: |setup, compliance, _| {
            let frame = setup.rig.frame_mut();
            frame.compliance += compliance;
            frame.stiffening = if compliance > 0.0 {
                1.0
            } else {
                frame.stiffening
            };
            Ok(())
        },
    }),
};

const RAIL_FRICTION: Effect = Effect {
    name: "rail_friction",
    title: "friction in the vertical guide",
    edits: "rig.*.frame_flaws.friction",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "N",
        [0.0, 50.0],
        [0.5, 2.0, 6.0],
        Prior::log_normal(1.5, 2.2),
    )],
    signature: Signature {
        channels: &["normal_force", "sinkage", "acceleration_y"],
        bound: Bound::WheelAngle,
        dependence: "normal force lower by F while the wheel sinks and higher while it rises; small \
                     motion stops; the same at every load",
    },
    confusers: &[
        "quantization",
        "load_drift",
        "thin_soft_layer",
        "channel_delay",
    ],
    source: Source::Cited(
        "Rollon, Linear Line catalogue: F = μ F_n + f, μ = 0.002 to 0.003, seals 0.15 to 1 N a carriage; \
         four carriages and the moment of the pull make 0.7 to 4.5 N",
    ),
    law: |setup, friction, _| {
        setup.rig.frame_mut().friction += friction;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "in proportion to the drawbar pull that leans on the guide; the same at a pull of a \
                      fifth of the load",
        not_on: &[],
        law: |setup, friction, _| {
            let pull = TYPICAL_PULL * setup.rig.load();
            setup.rig.frame_mut().friction_of_pull += friction / pull;
            Ok(())
        },
    }),
};

const LOAD_DRIFT: Effect = Effect {
    name: "load_drift",
    title: "load increase with slip",
    edits: "rig.*.load",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [-0.5, 0.5],
        [0.03, 0.1, 0.25],
        Prior::Normal {
            mean: 0.05,
            sd: 0.08,
        },
    )],
    signature: Signature {
        channels: &["normal_force", "sinkage", "drawbar_pull"],
        bound: Bound::Condition,
        dependence: "load W (1 + m s) at commanded slip s; none at slip 0; sinkage follows, which distinguishes \
                     it from a wrong reading",
    },
    confusers: &[
        "load_transfer",
        "gain_error",
        "force_crosstalk",
        "rail_friction",
    ],
    source: Source::Cited(
        "cmu-single-wheel (tests/data): +0.107 ± 0.016 per unit of slip over -1 to 0.9, of which most \
         on the braking side",
    ),
    law: |setup, per_slip, _| {
        let slip = setup.rig.drive().commanded_slip(setup.wheel.radius);
        *setup.rig.load_mut() *= 1.0 + per_slip * slip;
        Ok(())
    },
    other_form: Some(OtherForm {
        description: "with the square of slip, on either side; the same at slip 0.3",
        not_on: &[],
        law: |setup, per_slip, _| {
            let slip = setup.rig.drive().commanded_slip(setup.wheel.radius);
            *setup.rig.load_mut() *= 1.0 + per_slip * slip * slip.abs() / TYPICAL_SLIP;
            Ok(())
        },
    }),
};

const LOAD_TRANSFER: Effect = Effect {
    name: "load_transfer",
    title: "transfer of pull to the load by the linkage",
    edits: "rig.*.frame_flaws.load_transfer",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [-0.5, 0.5],
        [0.01, 0.03, 0.1],
        Prior::normal(0.05),
    )],
    signature: Signature {
        channels: &["normal_force", "acceleration_y", "sinkage"],
        bound: Bound::WheelAngle,
        dependence: "normal force follows the pull at every frequency, so lug passes too; in the mean by \
                     slip, as a load that drifts",
    },
    confusers: &["load_drift", "force_crosstalk", "rail_friction"],
    source: Source::Guess("an arm of 0.3 m whose pivot is 3, 10 or 30 mm off the line of the pull"),
    law: |setup, of_pull, _| {
        setup.rig.frame_mut().load_transfer += of_pull;
        Ok(())
    },
    other_form: None,
};
