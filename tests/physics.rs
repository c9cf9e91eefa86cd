//! The simulator against mechanics: statics, kinematics of the paper, signs, balances.

use crate::common::*;
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::simulation::WheelState;
use lugwheel::simulation::rig::carriage::Carriage;
use lugwheel::simulation::rig::motor::Motor;
use lugwheel::simulation::rig::{Rig, SingleWheel};
use lugwheel::soil::{Soil, StressConvention, wheel_load};
use lugwheel::terrain::TerrainSpec;
use lugwheel::trace::Trace;
use lugwheel::wheel::{Lugs, Wheel};
use std::ops::ControlFlow;

#[test]
fn a_standing_wheel_carries_its_load_and_stands_still_on_rock_and_sand() {
    for terrain in [reference(), sandy()] {
        let mut rig = rig(0.01, 0.0, 100.0);
        if let Rig::SingleWheel(single) = &mut rig {
            single.drive.forward_speed = 0.0;
        }
        let states = run(&terrain, &Wheel::single_wheel(), &rig, 16e3, 2.0);
        let load = mean(states.iter().map(|state| state.ground.normal_force));
        assert!((load - 100.0).abs() < 0.01, "{load}");
        let moved = range(states.iter().map(|state| state.height));
        // A tenth of the indentation of stone; noise that a sensor could not see.
        assert!(moved < 1.0e-6, "{moved}");
    }
}

#[test]
fn solver_noise_of_a_standing_wheel_stays_below_a_third_of_the_slowest_reference_run() {
    let rolling = rms(steady(&run(
        &reference(),
        &Wheel::rover(),
        &leg(0.003, 0.0),
        16e3,
        14.0,
    ))
    .iter()
    .map(|state| state.vertical_acceleration));
    for terrain in [reference(), slate(), sandy()] {
        let mut standing = leg(0.0, 0.0);
        if let Rig::RoverLeg(leg) = &mut standing {
            leg.drive.forward_speed = 0.0;
        }
        let states = run(&terrain, &Wheel::rover(), &standing, 16e3, 3.0);
        let noise = rms(steady(&states)
            .iter()
            .map(|state| state.vertical_acceleration));
        assert!(noise < rolling / 3.0, "standing {noise}, rolling {rolling}");
    }
}

/// Largest deviation [m] of the axle's height on flat ground from `expected` [m] of a lug at its angle [rad] from straight
/// down, a constant apart.
fn off(wheel: &Wheel, rig: &Rig, expected: impl Fn(f64) -> f64) -> f64 {
    let states = run(&reference(), wheel, rig, 16e3, 8.0);
    let alpha = wheel.lug_angle().unwrap();
    let deviation = |state: &WheelState| {
        let phi = state.wheel_angle - alpha * (state.wheel_angle / alpha).round();
        state.height - expected(phi)
    };
    let late = steady(&states);
    let offset = mean(late.iter().map(deviation));
    let deviations = late.iter().map(|state| (deviation(state) - offset).abs());
    deviations.fold(0.0, f64::max)
}

/// Eq. (10): `y(t) = (r + l) (cos φ - cos(α/2))` between lug changes.
#[test]
fn on_flat_ground_the_axle_follows_eq_10_within_1_percent_of_its_amplitude() {
    for (wheel, rig) in [
        (edged(Wheel::single_wheel()), rig(0.01, 0.0, 100.0)),
        (edged(Wheel::rover()), leg(0.01, 0.0)),
    ] {
        let alpha = wheel.lug_angle().unwrap();
        let amplitude = wheel.tip_radius() * (1.0 - (0.5 * alpha).cos());
        let worst = off(&wheel, &rig, |phi| wheel.tip_radius() * phi.cos());
        assert!(worst < 0.01 * amplitude, "{worst} of {amplitude}");
    }
}

/// A plate with edges of radius `e` reaches `(r + l - e) cos φ + (t/2 - e) |sin φ| + e` below the axle: what is all round
/// rolls on its arc with an amplitude 1 % below Eq. (10), what has sharp edges with one 17 % below.
#[test]
fn on_flat_ground_a_thick_lug_rolls_over_its_edges() {
    let round = Wheel::single_wheel();
    let lugs = round.lugs.unwrap();
    let sharp = Lugs {
        edge_radius: Some(1.0e-4),
        ..lugs
    };
    let mut amplitudes = Vec::new();
    for lugs in [lugs, sharp] {
        let wheel = Wheel {
            lugs: Some(lugs),
            ..round
        };
        let (e, half) = (lugs.edge_radius(), 0.5 * lugs.thickness);
        let reach =
            |phi: f64| (wheel.tip_radius() - e) * phi.cos() + (half - e) * phi.sin().abs() + e;
        let amplitude = reach(0.0) - reach(0.5 * wheel.lug_angle().unwrap());
        let worst = off(&wheel, &rig(0.01, 0.0, 100.0), reach);
        assert!(worst < 0.012 * amplitude, "{worst} of {amplitude}");
        amplitudes.push(amplitude);
    }
    let of_edges = round.tip_radius() * (1.0 - (0.5 * round.lug_angle().unwrap()).cos());
    assert!(
        (amplitudes[0] / of_edges - 0.99).abs() < 0.001,
        "{amplitudes:?}"
    );
    assert!(
        (amplitudes[1] / of_edges - 0.84).abs() < 0.01,
        "{amplitudes:?}"
    );
}

#[test]
fn the_vertical_velocity_jumps_by_2_w_r_plus_l_sin_half_alpha_at_a_lug_change() {
    let wheel = edged(Wheel::single_wheel());
    let states = run(&reference(), &wheel, &rig(0.02, 0.0, 100.0), 64e3, 5.0);
    let alpha = wheel.lug_angle().unwrap();
    let expected = 2.0 * (0.02 / wheel.radius) * wheel.tip_radius() * (0.5 * alpha).sin();
    // Just before the change, and when the contact's ringing has died away.
    let speed_at = |phase: f64, change: f64| {
        let target = (change + 0.5) * alpha + phase * alpha;
        let at = steady(&states).iter().min_by(|a, b| {
            (a.wheel_angle - target)
                .abs()
                .total_cmp(&(b.wheel_angle - target).abs())
        });
        at.unwrap().vertical_speed
    };
    let slope = wheel.tip_radius() * 0.02 / wheel.radius;
    for change in [1.0, 2.0] {
        let (before, after) = (speed_at(-0.02, change), speed_at(0.15, change));
        // Carried to the change itself along Eq. (10).
        let before = before - slope * 0.02 * alpha;
        let after = after + slope * 0.15 * alpha;
        let jump = after - before;
        assert!(
            (jump / expected - 1.0).abs() < 0.02,
            "{jump} against {expected}"
        );
    }
}

#[test]
fn mean_normal_force_is_the_load_within_half_a_percent() {
    for terrain in [reference(), sandy()] {
        for load in [30.0, 100.0, 300.0] {
            let states = run(
                &terrain,
                &Wheel::single_wheel(),
                &rig(0.03, 0.1, load),
                16e3,
                4.0,
            );
            let force = mean(
                steady(&states)
                    .iter()
                    .map(|state| state.ground.normal_force),
            );
            assert!((force / load - 1.0).abs() < 0.005, "{force} for {load}");
        }
    }
}

#[test]
fn torque_of_the_drive_motor_equals_the_torque_of_the_ground_at_steady_state() {
    for terrain in [reference(), sandy()] {
        let states = run(
            &terrain,
            &Wheel::single_wheel(),
            &rig(0.02, 0.2, 100.0),
            16e3,
            4.0,
        );
        let motor = mean(steady(&states).iter().map(|state| state.hub.driving_torque));
        let ground = mean(
            steady(&states)
                .iter()
                .map(|state| state.ground.driving_torque),
        );
        assert!(
            (motor / ground - 1.0).abs() < 1.0e-3,
            "{motor} against {ground}"
        );
    }
}

/// Sign of pull and torque when driving, braking and reversing; the guide's table.
#[test]
fn pull_and_torque_have_the_signs_of_the_table() {
    let signs = |speed: f64, slip: f64| {
        let states = run(
            &reference(),
            &Wheel::single_wheel(),
            &rig(speed, slip, 100.0),
            16e3,
            3.0,
        );
        let pull = mean(
            steady(&states)
                .iter()
                .map(|state| state.ground.drawbar_pull),
        );
        let torque = mean(
            steady(&states)
                .iter()
                .map(|state| state.ground.driving_torque),
        );
        [pull.signum(), torque.signum()]
    };
    assert_eq!(signs(0.02, 0.3), [1.0, 1.0], "driving forward");
    assert_eq!(signs(0.02, -0.3), [-1.0, -1.0], "braking forward");
    assert_eq!(signs(-0.02, 0.3), [-1.0, -1.0], "driving in reverse");
    assert_eq!(signs(-0.02, -0.3), [1.0, 1.0], "braking in reverse");
}

/// In the limit of stiff drives the wheel moves as if these imposed its motion.
#[test]
fn on_stiff_drives_loads_and_vibration_are_those_of_a_rigid_rig_within_2_percent() {
    let (wheel, rate) = (Wheel::single_wheel(), 64e3);
    let mut stiff = rig(0.02, 0.1, 100.0);
    stiff.drive_mut().carriage = Some(Carriage {
        mass: 30.0,
        stiffness: 1.0e9,
        damping_ratio: 0.2,
        force_limit: 1.0e4,
    });
    stiff.drive_mut().motor = Some(Motor {
        rotor_inertia: 10.0,
        stiffness: 1.0e7,
        damping_ratio: 0.2,
        torque_limit: 1.0e3,
        bandwidth: 300.0,
    });
    let read = |rig: &Rig| {
        let states = run(&reference(), &wheel, rig, rate, 5.0);
        // Two seconds for the drives to wind up; then two lug changes.
        let late = &states[(2.0 * rate) as usize..];
        // Below some 400 Hz, where features are taken: means over 2.5 ms.
        let slow = late
            .chunks_exact((0.0025 * rate) as usize)
            .map(|states| mean(states.iter().map(|state| state.vertical_acceleration)));
        [
            mean(late.iter().map(|state| state.ground.drawbar_pull)),
            mean(late.iter().map(|state| state.ground.normal_force)),
            mean(late.iter().map(|state| state.ground.driving_torque)),
            rms(slow),
        ]
    };
    let (rigid, stiff) = (read(&rig(0.02, 0.1, 100.0)), read(&stiff));
    for (rigid, stiff) in rigid.iter().zip(stiff) {
        assert!((stiff / rigid - 1.0).abs() < 0.02, "{stiff} on {rigid}");
    }
}

/// A wheel on slate that runs into a step of this height [m], its carriage able to push with a force [N].
fn into_a_step(height: f64, force_limit: f64) -> Trace {
    let step = format!("terrain.hard.ledge={{ position = 0.15, height = {height} }}");
    let limit = format!("rig.single_wheel.carriage.force_limit={force_limit}");
    let edits = [
        step.as_str(),
        limit.as_str(),
        "rig.single_wheel.forward_speed=0.05",
        "duration=4",
        "lead_in=0",
    ];
    let go_on = &mut |_| ControlFlow::Continue(());
    let scenario = ready("single_wheel_ht", &edits);
    scenario.run(Seed(1), 0, go_on).unwrap()
}

/// A sixth of the wheel's diameter is climbed over, on lugs that hook over its edge. At a wall a carriage that pushes with
/// less than the load over the friction stalls.
#[test]
fn a_wheel_climbs_a_step_of_50_mm_and_stalls_at_a_wall() {
    let [climbed, stalled] = [into_a_step(0.05, 1000.0), into_a_step(0.31, 40.0)];
    let mean_of_last_second = |trace: &Trace, name: &str| {
        let channel = trace.channel(name).unwrap();
        let last = channel.samples.len() - channel.sample_rate as usize;
        mean(channel.samples[last..].iter().copied())
    };
    let pulls = &climbed.channel("drawbar_pull").unwrap().samples;
    assert!(pulls.iter().all(|pull| pull.abs() < 1.0e3));
    assert!(!climbed.truth.as_ref().unwrap().at_limit.any());
    assert!((mean_of_last_second(&climbed, "forward_speed") / 0.05 - 1.0).abs() < 0.1);

    assert!(stalled.truth.as_ref().unwrap().at_limit.any());
    assert!(mean_of_last_second(&stalled, "slip_ratio") > 0.7);
    // It pushes with its limit; lugs that scrape past the face swing it by more.
    let push = -mean_of_last_second(&stalled, "drawbar_pull");
    assert!((push / 40.0 - 1.0).abs() < 0.15, "{push}");
    let mut samples = stalled.channels.iter().flat_map(|channel| &channel.samples);
    assert!(samples.all(|x| x.is_finite()));
}

#[test]
fn a_sliding_wheel_on_rock_pulls_with_its_friction() {
    let states = run(
        &reference(),
        &Wheel::single_wheel(),
        &rig(0.02, 0.3, 100.0),
        16e3,
        3.0,
    );
    let late = steady(&states);
    let pull = mean(late.iter().map(|state| state.ground.drawbar_pull));
    let load = mean(late.iter().map(|state| state.ground.normal_force));
    assert!((pull / load - 0.6).abs() < 0.006, "{}", pull / load);
}

#[test]
fn forward_and_reverse_are_mirror_images_on_sand() {
    let at = |speed: f64| {
        let states = run(
            &sandy(),
            &Wheel::single_wheel(),
            &rig(speed, 0.2, 100.0),
            16e3,
            4.0,
        );
        let late = steady(&states);
        [
            mean(late.iter().map(|s| s.ground.drawbar_pull)),
            mean(late.iter().map(|s| s.ground.driving_torque)),
            mean(late.iter().map(|s| s.sinkage)),
        ]
    };
    let (forward, reverse) = (at(0.02), at(-0.02));
    assert!(
        (forward[0] + reverse[0]).abs() < 0.01 * forward[0].abs(),
        "{forward:?} {reverse:?}"
    );
    assert!(
        (forward[1] + reverse[1]).abs() < 0.01 * forward[1].abs(),
        "{forward:?} {reverse:?}"
    );
    assert!(
        (forward[2] - reverse[2]).abs() < 0.01 * forward[2].abs(),
        "{forward:?} {reverse:?}"
    );
}

#[test]
fn a_lifted_wheel_feels_no_ground() {
    let mut lifted = rig(0.02, 0.2, 100.0);
    if let Rig::SingleWheel(SingleWheel { lifted, .. }) = &mut lifted {
        *lifted = Some(0.02);
    }
    let states = run(&reference(), &Wheel::single_wheel(), &lifted, 16e3, 2.0);
    for state in steady(&states) {
        assert!(state.ground.normal_force.abs() < 1e-9 && state.lugs_touching == 0);
        assert!(
            state.ground.driving_torque.abs() < 1e-6,
            "{}",
            state.ground.driving_torque
        );
        assert!(
            (state.sinkage + 0.02 + 0.015).abs() < 1e-3,
            "{}",
            state.sinkage
        );
    }
}

#[test]
fn on_a_slope_the_ground_carries_the_normal_part_of_the_load() {
    let mut sloped = rig(0.02, 0.1, 100.0);
    if let Rig::SingleWheel(SingleWheel { slope_deg, .. }) = &mut sloped {
        *slope_deg = 20.0;
    }
    let states = run(&sandy(), &Wheel::single_wheel(), &sloped, 16e3, 3.0);
    let load = mean(
        steady(&states)
            .iter()
            .map(|state| state.ground.normal_force),
    );
    assert!(
        (load / (100.0 * 20.0_f64.to_radians().cos()) - 1.0).abs() < 0.005,
        "{load}"
    );
}

#[test]
fn start_and_stop_hold_the_slip_and_leave_the_wheel_at_rest() {
    let mut stopping = rig(0.02, 0.2, 100.0);
    if let Rig::SingleWheel(single) = &mut stopping {
        single.drive.stop_at = Some(2.0);
    }
    let states = run(&sandy(), &Wheel::single_wheel(), &stopping, 16e3, 3.0);
    let last = states.last().unwrap();
    // What the engine's joints yield under load: a hundred thousandth of the speed.
    assert!(
        last.forward_speed.abs() < 2e-7 && last.wheel_speed.abs() < 2e-6,
        "{last:?}"
    );
    for state in states.iter().filter(|state| state.forward_speed > 1e-3) {
        let slip = 1.0 - state.forward_speed / (0.14 * state.wheel_speed);
        assert!((slip - 0.2).abs() < 1e-4, "{slip} at {}", state.time);
    }
}

#[test]
fn a_wheel_that_spins_in_place_digs_on_sand_and_pulls_with_its_friction_on_rock() {
    let mut spinning = rig(0.0, 1.0, 100.0);
    if let Rig::SingleWheel(single) = &mut spinning {
        single.drive.forward_speed = 0.0;
        single.drive.slip = None;
        single.drive.wheel_speed = Some(0.2);
    }
    let states = run(&reference(), &Wheel::single_wheel(), &spinning, 16e3, 3.0);
    let pull = mean(
        steady(&states)
            .iter()
            .map(|state| state.ground.drawbar_pull),
    );
    assert!((pull - 60.0).abs() < 0.6, "{pull}");
    let states = run(&sandy(), &Wheel::single_wheel(), &spinning, 16e3, 3.0);
    let pull = mean(
        steady(&states)
            .iter()
            .map(|state| state.ground.drawbar_pull),
    );
    assert!(pull > 10.0, "{pull}");
}

/// In steady rolling the columns under a smooth wheel carry what the quadrature of the soil's
/// stress convention says at the same sinkage and slip.
#[test]
fn column_forces_of_a_smooth_wheel_agree_with_the_quadrature_within_3_percent() {
    let smooth = Wheel {
        lugs: None,
        ..Wheel::single_wheel()
    };
    for convention in [StressConvention::WongReece, StressConvention::Triangular] {
        for (exit_angle, slip) in [(0.0, 0.1), (-0.3, 0.3), (0.0, 0.6), (-0.2, 0.2)] {
            let soil = Soil {
                convention,
                exit_angle,
                sinkage_exponent_slip: 0.4,
                ..sand()
            };
            let terrain = TerrainSpec::Sand {
                soil,
                roughness: None,
            };
            let states = run(&terrain, &smooth, &rig(0.05, slip, 100.0), 16e3, 5.0);
            let late = &states[states.len() / 2..];
            let sinkage = mean(late.iter().map(|state| state.sinkage));
            let expected = wheel_load::loads(&smooth, &soil, sinkage, slip);
            let found = [
                mean(late.iter().map(|state| state.ground.normal_force)) / expected.normal_force,
                mean(late.iter().map(|state| state.ground.driving_torque))
                    / expected.driving_torque,
            ];
            let pull =
                mean(late.iter().map(|state| state.ground.drawbar_pull)) - expected.drawbar_pull;
            println!(
                "{convention:>10?} c_3 {exit_angle:4} slip {slip}: sinkage {:5.2} mm, over quadrature: F_N {:.4}, torque {:.4}; pull {:6.2} N, by quadrature {:6.2} N",
                1e3 * sinkage,
                found[0],
                found[1],
                pull + expected.drawbar_pull,
                expected.drawbar_pull
            );
            assert!(
                found.iter().all(|ratio| (ratio - 1.0).abs() < 0.03),
                "{convention:?} {slip} {found:?}"
            );
            assert!(
                pull.abs() < 0.03 * expected.normal_force.abs().min(100.0),
                "{convention:?} {slip} {pull}"
            );
        }
    }
}

#[test]
fn a_smooth_wheel_sinks_deeper_the_more_it_slips() {
    let smooth = Wheel {
        lugs: None,
        ..Wheel::single_wheel()
    };
    let sinkage = |slip: f64| {
        let terrain = TerrainSpec::Sand {
            soil: Soil {
                sinkage_exponent_slip: 0.4,
                ..sand()
            },
            roughness: None,
        };
        mean(
            steady(&run(&terrain, &smooth, &rig(0.05, slip, 100.0), 16e3, 3.0))
                .iter()
                .map(|state| state.sinkage),
        )
    };
    assert!(sinkage(0.3) > 1.05 * sinkage(0.0));
    assert!(sinkage(0.6) > 1.05 * sinkage(0.3));
}

#[test]
fn a_wheel_whose_rim_first_meets_sand_behind_straight_down_is_let_down_as_any_other() {
    let text = include_str!("../scenarios/single_wheel_st.toml");
    let scenario = Scenario::from_toml(text, "single_wheel_st.toml").unwrap();
    let states = run(
        &scenario.terrain,
        &scenario.wheel,
        &scenario.rig,
        16e3,
        0.01,
    );
    assert!(states.iter().all(|state| state.sinkage > 0.0));
}

/// A wheel that is free to heave from lug to lug sinks, pulls and resists on the mean as the quadrature says.
#[test]
fn a_lugged_wheel_sinks_as_the_quadrature_says_within_a_tenth_of_a_millimetre() {
    for (count, slip, load) in [
        (6, 0.2, 100.0),
        (12, 0.0, 30.0),
        (12, 0.4, 100.0),
        (28, 0.2, 30.0),
        (28, 0.2, 300.0),
        (48, 0.6, 100.0),
    ] {
        let lugs = Lugs {
            count,
            ..Wheel::single_wheel().lugs.unwrap()
        };
        let wheel = Wheel {
            lugs: Some(lugs),
            ..Wheel::single_wheel()
        };
        let states = run(&sandy(), &wheel, &rig(0.05, slip, load), 16e3, 12.0);
        // Whole lug passes, once the wheel has sunk in.
        let pass = wheel.lug_angle().unwrap();
        let end = states.last().unwrap().wheel_angle;
        let passes = (0.5 * end / pass).floor();
        let late = || {
            states
                .iter()
                .filter(|state| state.wheel_angle > end - passes * pass)
        };
        let sinkage = mean(late().map(|state| state.sinkage));
        let expected = wheel_load::sinkage_at(&wheel, &sand(), load, slip).unwrap();
        let loads = wheel_load::loads(&wheel, &sand(), expected, slip);
        let pull = mean(late().map(|state| state.ground.drawbar_pull)) - loads.drawbar_pull;
        let torque = mean(late().map(|state| state.ground.driving_torque)) - loads.driving_torque;
        let missed = [pull / load, torque / load / wheel.radius];
        assert!(
            (sinkage - expected).abs() < 1e-4,
            "{sinkage}, quadrature {expected}"
        );
        assert!(missed.iter().all(|part| part.abs() < 0.01), "{missed:?}");
    }
}

/// Pulls of six wheels on the level add up to nothing: by hand, lugs of 24 that do not slide roll by the polygon of their
/// tips; on sand the wheel is where soil takes and gives alike.
#[test]
fn a_leg_of_the_ready_rover_neither_tows_the_others_nor_is_towed() {
    let slip_of = |name: &str| ready(name, &[]).rig.drive().slip.unwrap().get();
    let polygon = 24.0 * 2.0 * 0.165 * (std::f64::consts::PI / 24.0).sin();
    let rolling = 1.0 - polygon / std::f64::consts::TAU / 0.155;
    for name in ["rover_ref", "rover_ht", "rover_gt", "traverse"] {
        assert!((slip_of(name) - rolling).abs() < 1e-4, "{name}");
    }
    let pull_over_load = |name: &str| {
        let scenario = ready(name, &["lead_in=6.0", "duration=12.0"]);
        let trace = scenario
            .run(Seed(1), 0, &mut |_| ControlFlow::Continue(()))
            .unwrap();
        let pulls = &trace.channel("drawbar_pull").unwrap().samples;
        mean(pulls.iter().copied()) / scenario.rig.load()
    };
    let on_sand = pull_over_load("rover_st");
    assert!(on_sand.abs() < 0.02, "{on_sand}");
    // Half of what it has at any slip to speak of: 0.6 of friction.
    let on_stone = pull_over_load("rover_ht");
    assert!(on_stone.abs() < 0.3, "{on_stone}");
}
