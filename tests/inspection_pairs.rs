//! Faults that `inspect` finds, each beside a sound run that looks like it.

use crate::common::edit_samples;
use lugwheel::dataset::inspection::{Finding, Severity, findings};
use lugwheel::quantity::GRAVITY;
use lugwheel::terrain::class::TerrainLabel;
use lugwheel::trace::{Channel, Mean, RunAttributes, Trace, unit_of};
use std::f64::consts::TAU;

const RADIUS: f64 = 0.14;
const LOAD: f64 = 100.0;
const SPEED: f64 = 0.014;

/// How long and how often a run is logged.
#[derive(Debug, Clone, Copy)]
struct Log {
    /// Samples a second [Hz].
    rate: f64,
    /// Length [s].
    seconds: f64,
}

const FAST: Log = Log {
    rate: 200.0,
    seconds: 20.0,
};

/// Wheel speed [rad/s] of a forward speed [m/s] at a slip, driving or braking.
fn wheel_speed(slip: f64, forward_speed: f64) -> f64 {
    match slip < 0.0 {
        true => forward_speed * (1.0 + slip) / RADIUS,
        false => forward_speed / (RADIUS * (1.0 - slip)),
    }
}

fn wheel(slip: f64) -> RunAttributes {
    RunAttributes {
        wheel_radius: RADIUS,
        wheel_width: 0.15,
        lug_count: Some(28),
        lug_height: 0.015,
        load: LOAD,
        speed: SPEED,
        slip_ratio: slip,
        terrain: Some(TerrainLabel::Sand),
        ..RunAttributes::default()
    }
}

fn channel(name: &str, log: Log, sample: impl Fn(f64) -> f64) -> Channel {
    let count = (log.rate * log.seconds) as u32;
    Channel {
        name: name.to_owned(),
        unit: unit_of(name).unwrap().to_owned(),
        sample_rate: log.rate,
        start: 0.0,
        samples: (0..count)
            .map(|i| sample(f64::from(i) / log.rate))
            .collect(),
    }
}

/// A load that lives: its mean with some per cent of lug passes and noise.
fn lively(mean: f64) -> impl Fn(f64) -> f64 {
    move |t| mean + 0.02 * mean.abs() * ((TAU * 0.55 * t).sin() + (TAU * 3.1 * t + 1.0).sin())
}

/// A drive over sand at this slip, with these pull [N] and torque [N m].
fn drive(slip: f64, [pull, torque]: [f64; 2], log: Log) -> Trace {
    let turning = wheel_speed(slip, SPEED);
    Trace {
        attributes: wheel(slip),
        channels: vec![
            channel("normal_force", log, lively(LOAD)),
            channel("drawbar_pull", log, lively(pull)),
            channel("driving_torque", log, lively(torque)),
            channel("sinkage", log, lively(0.006)),
            channel("wheel_angle", log, move |t| turning * t),
            channel("forward_speed", log, lively(SPEED)),
        ],
        ..Trace::default()
    }
}

fn sound() -> Trace {
    drive(0.2, [20.0, 5.0], FAST)
}

/// A row of means of the same drive.
fn row(slip: f64, means: &[(&str, f64)]) -> Trace {
    let mean = |&(name, value): &(&str, f64)| Mean {
        name: name.to_owned(),
        unit: unit_of(name).unwrap().to_owned(),
        value,
        sd: f64::NAN,
        n: 0,
    };
    Trace {
        attributes: wheel(slip),
        means: means.iter().map(mean).collect(),
        ..Trace::default()
    }
}

/// `trace` after `edit`.
fn but(mut trace: Trace, edit: impl Fn(&mut Trace)) -> Trace {
    edit(&mut trace);
    trace
}

fn with(trace: Trace, name: &str, edit: impl Fn(f64) -> f64) -> Trace {
    but(trace, |trace| edit_samples(trace, name, &edit))
}

fn without(trace: Trace, names: &[&str]) -> Trace {
    but(trace, |trace| {
        trace
            .channels
            .retain(|channel| !names.contains(&channel.name.as_str()))
    })
}

/// As sensors tared on the level read it on a slope with a wheel of `mass` [kg].
fn on_slope(trace: Trace, slope_deg: f64, mass: f64) -> Trace {
    let (sin, cos) = slope_deg.to_radians().sin_cos();
    but(trace, |trace| {
        (trace.attributes.slope_deg, trace.attributes.wheel_mass) = (slope_deg, Some(mass));
        edit_samples(trace, "drawbar_pull", |pull| pull - mass * GRAVITY * sin);
        edit_samples(trace, "normal_force", |force| {
            force * cos + mass * GRAVITY * (1.0 - cos)
        });
    })
}

fn doubts(trace: &Trace) -> Vec<Finding> {
    let mut found = findings("run", trace);
    found.retain(|finding| finding.severity > Severity::Info);
    found
}

/// Expects a doubt about `channel` that says `part`.
fn is_found(name: &str, trace: &Trace, [channel, part]: [&str; 2]) {
    let found = doubts(trace);
    let is_it = |finding: &Finding| {
        finding.channel.as_deref().unwrap_or_default() == channel && finding.message.contains(part)
    };
    assert!(
        found.iter().any(is_it),
        "{name}: {part:?} is not in {found:#?}"
    );
}

/// Expects no doubt.
fn is_sound(name: &str, trace: &Trace) {
    assert_eq!(doubts(trace), [], "{name}");
}

#[test]
fn a_pull_that_no_torque_pays_for_is_found_and_a_wheels_own_weight_downhill_is_none() {
    const PAYS: &str = "times the input power of the torque";
    let untared = |trace| with(trace, "drawbar_pull", |pull| pull + 50.0);
    is_found("level", &untared(sound()), ["drawbar_pull", PAYS]);
    // 12 kg on -20°: 40.2 N of weight in the reading, more than the torque's 35.7 N at the rim.
    let downhill = on_slope(sound(), -20.0, 12.0);
    is_sound("downhill", &downhill);
    is_found(
        "downhill",
        &untared(downhill.clone()),
        ["drawbar_pull", PAYS],
    );
    let unknown = but(downhill, |trace| trace.attributes.wheel_mass = None);
    is_sound("a wheel of unknown mass downhill", &unknown);
}

#[test]
fn a_towed_wheel_that_pulls_is_found_and_one_that_drags_is_sound() {
    let towed = |pull| drive(-0.1, [pull, 0.02], FAST);
    is_found(
        "pulls",
        &towed(20.0),
        ["drawbar_pull", "times the input power"],
    );
    is_sound("drags", &towed(-8.0));
    let by_means = |pull| {
        row(
            -0.1,
            &[
                ("drawbar_pull", pull),
                ("driving_torque", 0.0),
                ("sinkage", 0.004),
            ],
        )
    };
    is_found(
        "pulls, a row",
        &by_means(20.0),
        ["drawbar_pull", "output power without input power"],
    );
    is_sound("drags, a row", &by_means(-8.0));
    // Braked by its motor, and locked.
    is_sound("braked", &drive(-0.3, [-30.0, -2.5], FAST));
    is_sound("locked", &drive(-1.0, [-45.0, -5.5], FAST));
}

#[test]
fn a_resistance_beyond_load_and_sinkage_is_found_and_a_wheels_own_weight_uphill_is_none() {
    const RESISTS: &str = "leaves a resistance of";
    is_found(
        "pull reversed",
        &with(sound(), "drawbar_pull", |pull| -3.0 * pull),
        ["drawbar_pull", RESISTS],
    );
    is_found(
        "torque in kgf m taken for N m, at an unknown slip",
        &but(
            with(sound(), "driving_torque", |torque| GRAVITY * torque),
            |trace| {
                trace.attributes.slip_ratio = f64::NAN;
                trace
                    .channels
                    .retain(|channel| channel.name != "wheel_angle");
            },
        ),
        ["drawbar_pull", RESISTS],
    );
    // 20 kg on 25°: 83 N of weight against the pull.
    is_sound("uphill", &on_slope(sound(), 25.0, 20.0));
    let smooth_on_hard = but(
        row(
            0.1,
            &[
                ("drawbar_pull", 12.0),
                ("driving_torque", 2.0),
                ("sinkage", 0.0),
            ],
        ),
        |trace| {
            (trace.attributes.lug_count, trace.attributes.lug_height) = (Some(0), 0.0);
            trace.attributes.terrain = Some(TerrainLabel::Hard);
        },
    );
    is_sound("a smooth wheel on stone", &smooth_on_hard);
}

#[test]
fn a_wrong_sign_is_found_and_a_parked_braking_or_reversing_wheel_has_none() {
    let flipped = |name| with(sound(), name, |x| -x);
    is_found(
        "torque",
        &flipped("driving_torque"),
        ["driving_torque", "change its sign"],
    );
    is_found(
        "normal force",
        &flipped("normal_force"),
        ["normal_force", "change its sign"],
    );
    is_found(
        "angle",
        &flipped("wheel_angle"),
        ["wheel_angle", "change its sign"],
    );
    let braking = drive(-0.4, [-30.0, -2.0], FAST);
    let pulls = with(braking.clone(), "drawbar_pull", |pull| -pull);
    is_found("braking pull", &pulls, ["drawbar_pull", "change its sign"]);
    is_sound("braking", &braking);
    // 12 kg on -25°: 49.7 N more than the contact's -30 N.
    is_sound("braking downhill", &on_slope(braking, -25.0, 12.0));

    let by_slip = |slip| {
        row(
            0.3,
            &[
                ("slip_ratio", slip),
                ("drawbar_pull", 20.0),
                ("driving_torque", 5.0),
            ],
        )
    };
    is_found(
        "slip",
        &by_slip(-0.3),
        ["slip_ratio", "same size, other sign"],
    );
    is_sound("slip", &by_slip(0.3));
    let torque_of_a_row = but(
        row(f64::NAN, &[("slip_ratio", 0.3), ("driving_torque", -5.0)]),
        |_| (),
    );
    is_found(
        "torque, slip measured",
        &torque_of_a_row,
        ["driving_torque", "change its sign"],
    );

    let reverse = but(sound(), |trace| {
        for name in [
            "drawbar_pull",
            "driving_torque",
            "wheel_angle",
            "forward_speed",
        ] {
            edit_samples(trace, name, |x| -x);
        }
        trace.attributes.speed = -SPEED;
    });
    is_sound("in reverse", &reverse);
    let uncommanded = but(reverse, |trace| trace.attributes.speed = f64::NAN);
    is_sound("in reverse, speed not commanded", &uncommanded);
    let by_angle = without(uncommanded, &["forward_speed"]);
    is_sound("in reverse, shown by the angle alone", &by_angle);

    let parked = but(sound(), |trace| {
        edit_samples(trace, "wheel_angle", |_| 0.3);
        edit_samples(trace, "forward_speed", |_| 0.0);
        edit_samples(trace, "driving_torque", |torque| -0.6 * torque);
        edit_samples(trace, "drawbar_pull", |pull| -pull);
        trace.attributes.slope_deg = 20.0;
    });
    is_sound("parked on a slope by its brake", &parked);
    let held = but(
        row(f64::NAN, &[("drawbar_pull", 20.0), ("driving_torque", 0.0)]),
        |trace| {
            trace.attributes.speed = 0.0;
        },
    );
    is_sound("a row of a wheel at rest that a rope pulls at", &held);
}

#[test]
fn a_force_in_kilograms_is_found_and_the_part_of_a_load_across_a_slope_is_none() {
    let kilograms = |trace| with(trace, "normal_force", |force| force / GRAVITY);
    is_found(
        "level",
        &kilograms(sound()),
        ["normal_force", "kilogram against newton"],
    );
    let steep = on_slope(sound(), 35.0, 4.0);
    is_sound("35°", &steep);
    is_found(
        "35°",
        &kilograms(steep.clone()),
        ["normal_force", "kilogram against newton"],
    );
    let unknown = but(steep, |trace| trace.attributes.wheel_mass = None);
    is_sound("35°, a wheel of unknown mass", &unknown);
}

/// A vibration of lug strikes and noise [m/s²].
fn vibration(t: f64) -> f64 {
    (TAU * 37.3 * t).sin() + 0.5 * (TAU * 11.7 * t + 0.4).sin()
}

fn shaken(log: Log, mean: f64) -> Trace {
    let acceleration = channel("acceleration_y", log, move |t| mean + vibration(t));
    but(sound(), |trace| {
        trace
            .channels
            .retain(|channel| ["wheel_angle", "forward_speed"].contains(&channel.name.as_str()));
        for channel in &mut trace.channels {
            let step = (FAST.rate / log.rate) as usize;
            channel.samples = channel.samples.iter().copied().step_by(step).collect();
            channel.sample_rate = log.rate;
        }
        trace.channels.push(acceleration.clone());
    })
}

#[test]
fn gravity_is_found_in_series_and_rows_and_a_slope_and_seldom_samples_are_no_offset() {
    for (mean, part) in [
        (GRAVITY, "gravity is still in it"),
        (1.0, "in units of g"),
        (-GRAVITY, "gravity taken off twice"),
        (1.5, "an offset"),
    ] {
        is_found("series", &shaken(FAST, mean), ["acceleration_y", part]);
        let row = row(0.1, &[("acceleration_y", mean)]);
        is_found("row", &row, ["acceleration_y", part]);
    }
    is_sound("series", &shaken(FAST, 0.0));
    is_sound("row", &row(0.1, &[("acceleration_y", 0.02)]));
    // A sensor tared on the level loses g (1 - cos 20°).
    let on_slope = |mean| {
        but(shaken(FAST, mean), |trace| {
            trace.attributes.slope_deg = -20.0
        })
    };
    is_sound("downhill", &on_slope(-0.59));
    is_found(
        "downhill",
        &on_slope(9.215),
        ["acceleration_y", "gravity is still in it"],
    );
    is_found("downhill", &on_slope(0.59), ["acceleration_y", "an offset"]);
}

#[test]
fn a_time_in_milliseconds_is_found_by_the_turning_and_a_slow_log_is_at_most_too_slow() {
    let milliseconds = |trace| {
        but(trace, |trace| {
            for channel in &mut trace.channels {
                channel.sample_rate /= 1000.0;
            }
        })
    };
    let part = "time in milliseconds?";
    is_found(
        "with an angle",
        &milliseconds(sound()),
        ["wheel_angle", part],
    );
    is_found(
        "an acceleration",
        &milliseconds(shaken(FAST, 0.0)),
        ["wheel_angle", part],
    );
    let loads = milliseconds(without(sound(), &["wheel_angle"]));
    is_found("loads alone", &loads, ["", part]);
    for rate in [1.0, 2.0, 10.0] {
        let log = Log {
            rate,
            seconds: 120.0,
        };
        is_sound(&format!("{rate} Hz"), &drive(0.2, [20.0, 5.0], log));
        let by_angle = without(drive(0.2, [20.0, 5.0], log), &["forward_speed"]);
        is_sound(&format!("{rate} Hz, by the angle alone"), &by_angle);
        let mislabelled = but(by_angle, |trace| trace.attributes.slip_ratio = 0.4);
        is_found("label", &mislabelled, ["wheel_angle", "measured slip 0.2"]);
        for finding in doubts(&shaken(
            Log {
                seconds: 20.0,
                ..log
            },
            0.0,
        )) {
            assert!(finding.severity < Severity::Error, "{rate} Hz: {finding}");
            assert!(
                finding.message.contains("too slow to show a vibration"),
                "{rate} Hz: {finding}"
            );
        }
    }
}

/// A rover's wheel at 20 rad/s, logged twice a second.
fn fast_wheel(reading: impl Fn(f64) -> f64) -> Trace {
    let log = Log {
        rate: 2.0,
        seconds: 60.0,
    };
    let (slip, turning) = (0.05, 20.0);
    let forward = turning * RADIUS * (1.0 - slip);
    let mut trace = drive(slip, [10.0, 2.5], log);
    trace.attributes.speed = forward;
    trace
        .channels
        .retain(|channel| !["wheel_angle", "forward_speed"].contains(&channel.name.as_str()));
    trace
        .channels
        .push(channel("forward_speed", log, lively(forward)));
    trace
        .channels
        .push(channel("wheel_angle", log, |t| reading(turning * t)));
    trace
}

#[test]
fn a_wheel_that_turns_by_more_than_a_turn_between_samples_is_not_doubted() {
    is_sound("10 rad a sample", &fast_wheel(|angle| angle));
    is_sound(
        "10 rad a sample, wrapped",
        &fast_wheel(|angle| angle.rem_euclid(TAU)),
    );
    let told = findings("run", &fast_wheel(|angle| angle.rem_euclid(TAU)));
    assert!(
        told.iter()
            .any(|finding| finding.message.contains("read too seldom")),
        "{told:?}"
    );
    let degrees = fast_wheel(|angle| angle.to_degrees());
    is_found("in degrees", &degrees, ["wheel_angle", "in degrees?"]);
    let integrated = but(fast_wheel(|angle| angle), |trace| {
        trace.attributes.angle_zero_unknown = true;
    });
    is_sound("integrated from 20 rad/s", &integrated);
}

#[test]
fn units_of_turning_are_found_in_angle_speed_and_rows() {
    let turning = wheel_speed(0.2, SPEED);
    for (factor, of_angle, of_speed) in [
        (360.0 / TAU, "in degrees?", "in degrees per second?"),
        (1.0 / TAU, "in turns?", "in turns per second?"),
        (
            60.0 / TAU,
            "revolutions per minute?",
            "in revolutions per minute?",
        ),
        (RADIUS, "", "the rim's speed in m/s?"),
    ] {
        let scaled = with(sound(), "wheel_angle", |angle| factor * angle);
        if !of_angle.is_empty() {
            is_found("angle", &scaled, ["wheel_angle", of_angle]);
        }
        let integrated = but(scaled, |trace| trace.attributes.angle_zero_unknown = true);
        is_found("speed", &integrated, ["wheel_speed", of_speed]);
        let of_row = row(0.2, &[("wheel_speed", factor * turning)]);
        is_found("row", &of_row, ["wheel_speed", of_speed]);
    }
    is_sound("row", &row(0.2, &[("wheel_speed", turning)]));
}

#[test]
fn a_counter_that_rolls_over_and_an_encoder_of_few_counts_are_not_doubted_and_a_wrong_label_is() {
    type Reading = fn(f64) -> f64;
    let readings: [(&str, Reading); 7] = [
        ("0 to 360°", |angle| angle.rem_euclid(TAU)),
        ("-180° to 180°", |angle| {
            (angle + 3.0).rem_euclid(TAU) - 0.5 * TAU
        }),
        ("8 bits of 1024 counts a turn", |angle| {
            (angle / TAU * 1024.0).floor().rem_euclid(256.0) * TAU / 1024.0
        }),
        ("12 counts a turn", |angle| {
            (angle / TAU * 12.0).floor() * TAU / 12.0
        }),
        ("28 counts a turn", |angle| {
            (angle / TAU * 28.0).floor() * TAU / 28.0
        }),
        ("28 counts of a turn that starts again", |angle| {
            ((angle / TAU * 28.0).floor() * TAU / 28.0).rem_euclid(TAU)
        }),
        ("4096 counts a turn", |angle| {
            (angle / TAU * 4096.0).floor() * TAU / 4096.0
        }),
    ];
    let log = Log {
        rate: 50.0,
        seconds: 80.0,
    };
    for (name, reading) in readings {
        let read = with(drive(0.2, [20.0, 5.0], log), "wheel_angle", reading);
        is_sound(name, &read);
        let alone = without(read, &["forward_speed"]);
        is_sound(name, &alone);
        let mislabelled = but(alone, |trace| trace.attributes.slip_ratio = 0.4);
        is_found(name, &mislabelled, ["wheel_angle", "measured slip"]);
    }
}

#[test]
fn a_pull_before_the_wheel_turns_is_an_offset_and_one_before_the_first_count_is_not() {
    let log = Log {
        rate: 50.0,
        seconds: 60.0,
    };
    let coarse = |angle: f64| (angle / TAU * 12.0 - 0.9).floor() * TAU / 12.0;
    is_sound(
        "counts",
        &with(drive(0.2, [20.0, 5.0], log), "wheel_angle", coarse),
    );
    let waits = |trace: Trace| {
        let turning = wheel_speed(0.2, SPEED);
        but(trace, |trace| {
            edit_samples(trace, "wheel_angle", |angle| {
                (angle - 10.0 * turning).max(0.0)
            });
        })
    };
    let offset = waits(drive(0.2, [20.0, 5.0], log));
    is_found("waits", &offset, ["drawbar_pull", "before the wheel turns"]);
    let on_slope = but(offset, |trace| {
        (trace.attributes.slope_deg, trace.attributes.wheel_mass) = (10.0, Some(0.0));
        edit_samples(trace, "normal_force", |force| {
            force * 10.0_f64.to_radians().cos()
        });
    });
    let held = |finding: &Finding| finding.message.contains("before the wheel turns");
    assert!(!doubts(&on_slope).iter().any(held), "held on a slope");
}

#[test]
fn a_force_at_the_end_of_its_sensor_is_found_and_one_in_coarse_steps_is_not() {
    let swinging = |t: f64| 20.0 + 12.0 * (TAU * 0.3 * t).sin();
    let pulls = |edit: fn(f64) -> f64| {
        but(sound(), |trace| {
            let pull = channel("drawbar_pull", FAST, |t| edit(swinging(t)));
            trace.channels[1] = pull;
        })
    };
    is_found(
        "clipped",
        &pulls(|pull| pull.min(27.0)),
        ["drawbar_pull", "clipped by the sensor's range?"],
    );
    is_sound("steps of 1 N", &pulls(|pull| pull.round()));
    is_sound("steps of 5 N", &pulls(|pull| (pull / 5.0).round() * 5.0));
    // A cell that is logged once in ten samples and held.
    let held = but(pulls(|pull| pull), |trace| {
        let pulls = &mut trace.channels[1].samples;
        for i in 0..pulls.len() {
            pulls[i] = pulls[i / 10 * 10];
        }
    });
    is_sound("held for ten samples", &held);
}

/// A row of Wang & Han (2016), KLS-1 under 58.86 N, as `data/inspection/kls1.csv` has it: slip, pull [N], sinkage [m],
/// torque [N m].
type Published = [f64; 4];

const SMOOTH: [Published; 5] = [
    [0.1, -0.5, 0.0010, 1.30],
    [0.2, 1.0, 0.0043, 1.55],
    [0.3, 2.0, 0.0045, 1.90],
    [0.4, 2.5, 0.0057, 2.05],
    [0.5, 0.5, 0.0080, 2.05],
];

const LUGGED: [Published; 5] = [
    [0.1, 7.7, 0.0022, 2.85],
    [0.2, 9.0, 0.0043, 2.95],
    [0.3, 10.0, 0.0078, 3.05],
    [0.4, 12.7, 0.0096, 3.10],
    [0.5, 6.4, 0.0135, 2.85],
];

/// Slips of the rows that are doubted after `edit`.
fn doubted_slips(rows: &[Published], lugs: (u32, f64), edit: impl Fn(&mut Trace)) -> Vec<f64> {
    let trace = |&[slip, pull, sinkage, torque]: &Published| {
        let means = [
            ("drawbar_pull", pull),
            ("sinkage", sinkage),
            ("driving_torque", torque),
        ];
        but(row(slip, &means), |trace| {
            (trace.attributes.wheel_radius, trace.attributes.load) = (0.085, 58.86);
            (trace.attributes.lug_count, trace.attributes.lug_height) = (Some(lugs.0), lugs.1);
            edit(trace);
        })
    };
    let traces = rows.iter().map(|row| (row[0], trace(row)));
    traces
        .filter(|(_, trace)| !doubts(trace).is_empty())
        .map(|(slip, _)| slip)
        .collect()
}

fn scaled(name: &'static str, factor: f64) -> impl Fn(&mut Trace) {
    move |trace| {
        let mean = trace.means.iter_mut().find(|mean| mean.name == name);
        mean.unwrap().value *= factor;
    }
}

#[test]
fn published_rows_are_doubted_where_no_wheel_can_have_them_or_their_unit_was_lost() {
    type Edit = Box<dyn Fn(&mut Trace)>;
    const ALL: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];
    // At slip 0.1 the smooth wheel meets 15.8 N of resistance, and ground as deep as it is in gives 10.8 N.
    let cases: [(&str, Edit, &[f64], &[f64]); 9] = [
        (
            "as published",
            Box::new(scaled("drawbar_pull", 1.0)),
            &[0.1],
            &[],
        ),
        (
            "torque x 9.81",
            Box::new(scaled("driving_torque", GRAVITY)),
            &ALL,
            &ALL,
        ),
        (
            "torque x 1000",
            Box::new(scaled("driving_torque", 1e3)),
            &ALL,
            &ALL,
        ),
        (
            "torque reversed",
            Box::new(scaled("driving_torque", -1.0)),
            &ALL,
            &ALL,
        ),
        // The smooth wheel's pull is so small that a tenth of the torque still pays for it.
        (
            "torque / 9.81",
            Box::new(scaled("driving_torque", 1.0 / GRAVITY)),
            &[],
            &ALL[..4],
        ),
        (
            "pull x 9.81",
            Box::new(scaled("drawbar_pull", GRAVITY)),
            &[0.1],
            &ALL,
        ),
        (
            "sinkage / 1000",
            Box::new(scaled("sinkage", 1e-3)),
            &ALL,
            &[],
        ),
        (
            "sinkage x 1000",
            Box::new(scaled("sinkage", 1e3)),
            &ALL,
            &ALL,
        ),
        (
            "load in kg",
            Box::new(|trace| trace.attributes.load = 6.0),
            &ALL,
            &ALL,
        ),
    ];
    for (name, edit, smooth, lugged) in cases {
        let found = [
            doubted_slips(&SMOOTH, (0, 0.0), &edit),
            doubted_slips(&LUGGED, (16, 0.010), &edit),
        ];
        assert_eq!(found, [smooth, lugged], "{name}");
    }
}

/// A drive of 40 s that moves while `moves` says so, slowing down within a sample, with what a sensor makes of rest.
fn pausing(moves: impl Fn(f64) -> bool, log: Log) -> Trace {
    let turning = wheel_speed(0.2, SPEED);
    let count = (log.rate * log.seconds) as u32;
    // The encoder trembles by its step.
    let step = TAU / 4096.0;
    let mut turned = 0.0_f64;
    let angle = |i: u32| {
        let tremble = if i.is_multiple_of(17) { step } else { 0.0 };
        let read = (turned / step).floor() * step + tremble;
        turned += if moves(f64::from(i) / log.rate) {
            turning / log.rate
        } else {
            0.0
        };
        read
    };
    let angles = (0..count).map(angle).collect();
    let noise = |t: f64| (t * 9137.0).sin() * (t * 517.3).cos();
    let speed = |t: f64| if moves(t) { SPEED } else { 1.0e-5 * noise(t) };
    // Of two speeds of nil, a slip of anything.
    let slip = |t: f64| {
        if moves(t) {
            0.2 + 0.002 * noise(t)
        } else {
            noise(t)
        }
    };
    let mut trace = drive(0.2, [20.0, 5.0], log);
    trace
        .channels
        .retain(|channel| !["wheel_angle", "forward_speed"].contains(&channel.name.as_str()));
    trace.channels.push(channel("forward_speed", log, speed));
    trace.channels.push(channel("slip_ratio", log, slip));
    trace.channels.push(Channel {
        samples: angles,
        ..channel("wheel_angle", log, |_| 0.0)
    });
    trace
}

#[test]
fn a_slip_of_rest_counts_for_nothing_wherever_the_rest_is_and_a_wrong_slip_of_the_drive_is_found() {
    type Moves = fn(f64) -> bool;
    let drives: [(&str, Moves); 5] = [
        ("parks at the end", |t| t < 22.0),
        ("starts late", |t| t > 18.0),
        ("stops twice", |t| {
            !(8.0..14.0).contains(&t) && !(24.0..31.0).contains(&t)
        }),
        ("moves for a while only", |t| (15.0..22.0).contains(&t)),
        ("never stops", |_| true),
    ];
    for rate in [100.0, 20.0] {
        let log = Log {
            rate,
            seconds: 40.0,
        };
        for (name, moves) in drives {
            let trace = pausing(moves, log);
            // A pull that is there before the wheel turns is another matter.
            let of_slip = |trace: &Trace| {
                let mut found = doubts(trace);
                found.retain(|finding| !finding.message.contains("before the wheel turns"));
                found
            };
            assert_eq!(of_slip(&trace), [], "{name}");
            let undefined = but(trace.clone(), |trace| {
                let slip = trace
                    .channels
                    .iter_mut()
                    .find(|channel| channel.name == "slip_ratio")
                    .unwrap();
                let rate = slip.sample_rate;
                for (i, sample) in slip.samples.iter_mut().enumerate() {
                    if !moves(i as f64 / rate) {
                        *sample = f64::NAN;
                    }
                }
            });
            assert_eq!(of_slip(&undefined), [], "{name}, slip undefined at rest");
            let by_turning = without(trace.clone(), &["slip_ratio"]);
            assert_eq!(of_slip(&by_turning), [], "{name}, slip by the turning");
            for (trace, channel) in [(trace, "slip_ratio"), (by_turning, "wheel_angle")] {
                let mislabelled = but(trace, |trace| trace.attributes.slip_ratio = 0.5);
                is_found(name, &mislabelled, [channel, "measured slip 0."]);
            }
        }
        let stands = pausing(|_| false, log);
        assert_eq!(doubts(&stands), [], "never moves");
    }
}
