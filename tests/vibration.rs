//! The paper's kinematic models against the rigid-body simulation.
//!
//! The models' lugs are edges, and so are the simulated ones here, 0.1 mm thick. The simulated wheel presses 10.6 µm into its ground under the load of 100 N; no model of a rigid
//! wheel knows that, and it is the tolerance of what follows.

use crate::common::*;
use lugwheel::quantity::Seed;
use lugwheel::simulation::WheelState;
use lugwheel::terrain::{Joints, Roughness, Terrain, TerrainSpec};
use lugwheel::vibration::outline::{Support, footing};
use lugwheel::vibration::reference::lug_changes;
use lugwheel::vibration::rolling::{self, Pose};
use lugwheel::vibration::soft_ground::{YieldingSoil, rim_height};
use lugwheel::vibration::{flat_ground, harmonics};
use lugwheel::wheel::{Lugs, Wheel};
use std::f64::consts::TAU;

/// Indentation [m] of the simulated ground under 100 N: `δ_0 (W/F_0)^(1/n)`.
const INDENTATION: f64 = 1.057e-5;

fn olig() -> Wheel {
    let lugs = Some(Lugs {
        count: 6,
        height: 0.005,
        thickness: 0.003,
        edge_radius: None,
    });
    Wheel {
        lugs,
        ..Wheel::single_wheel()
    }
}

/// Eq. (5) and (10), for many lugs and for few whose rim comes down between them.
#[test]
fn on_flat_ground_the_axle_follows_eq_5_to_the_indentation_of_the_ground() {
    for (wheel, seconds) in [(edged(Wheel::single_wheel()), 4.0), (edged(olig()), 9.0)] {
        let states = run(&reference(), &wheel, &rig(0.02, 0.0, 100.0), 16e3, seconds);
        for state in steady(&states) {
            let rim = flat_ground::rim_height(&wheel, state.wheel_angle);
            let pressed_in = wheel.radius + rim - state.height;
            // At a lug change both share the load, and the blow presses in deeper.
            assert!(
                (0.4 * INDENTATION..1.2 * INDENTATION).contains(&pressed_in),
                "{pressed_in} at {}",
                state.time
            );
        }
    }
}

/// The reference vibration as an accelerometer sees it, from a 17-bit encoder read at 2 kHz.
#[test]
fn velocity_jumps_when_and_by_as_much_as_the_recorded_wheel_angle_says() {
    for (wheel, seconds) in [(edged(Wheel::single_wheel()), 5.0), (edged(olig()), 9.0)] {
        let states = run(&reference(), &wheel, &rig(0.02, 0.0, 100.0), 16e3, seconds);
        let count = TAU / f64::from(1 << 17);
        let readings: Vec<f64> = states
            .iter()
            .step_by(8)
            .map(|state| (state.wheel_angle / count).round() * count)
            .collect();
        let changes = lug_changes(&wheel, &readings, 2000.0);
        assert!(changes.len() >= 2);
        for change in &changes {
            let time = change.time + states[0].time;
            let around: Vec<&WheelState> = states
                .iter()
                .filter(|state| (state.time - time).abs() < 0.05)
                .collect();
            let blow = around
                .iter()
                .max_by(|a, b| a.vertical_acceleration.total_cmp(&b.vertical_acceleration))
                .unwrap();
            // The next support touches before a rigid one would, by the time in which it closes
            // the indentation.
            let early = time - blow.time;
            assert!(
                (0.0..INDENTATION / change.velocity_jump).contains(&early),
                "{early} s early"
            );
            let jumped = around[around.len() - 1].vertical_speed - around[0].vertical_speed;
            let smooth: f64 = around
                .iter()
                .map(|s| flat_ground::acceleration(&wheel, s.wheel_angle, s.wheel_speed, 0.0))
                .sum::<f64>()
                / 16e3;
            let expected = change.velocity_jump + smooth;
            // One percent is what the counting encoder leaves of the speed.
            assert!(
                (jumped / expected - 1.0).abs() < 0.01,
                "{jumped} {expected}"
            );
        }
    }
}

/// Slip at which a wheel walks on its edges without slipping: over a lug angle it goes
/// `2 (r + l) sin(α/2)`.
fn walking_slip(wheel: &Wheel) -> f64 {
    let half = 0.5 * wheel.lug_angle().unwrap();
    wheel.radius * half / (wheel.tip_radius() * half.sin()) - 1.0
}

/// States a hundredth of a second apart, and the path of the model through their wheel angles.
fn simulated_and_rolled(
    spec: &TerrainSpec,
    wheel: &Wheel,
    speed: f64,
    distance: f64,
) -> (Vec<WheelState>, Vec<Pose>) {
    let rig = rig(speed, walking_slip(wheel), 100.0);
    let all = run(spec, wheel, &rig, 16e3, distance / speed);
    let states: Vec<WheelState> = all.into_iter().step_by(160).collect();
    let wheel_angles: Vec<f64> = states.iter().map(|state| state.wheel_angle).collect();
    let terrain = Terrain::generate(spec, Seed(1), 0);
    let mut profile = terrain.profile(&terrain.stretches()[0]);
    let ground = |x: f64| {
        profile.extend(x, x);
        profile.at(x).height
    };
    let path = rolling::path(wheel, ground, 0.0, &wheel_angles);
    (states, path)
}

/// Root mean square [m] of the difference in the axle's height.
fn height_error(wheel: &Wheel, states: &[WheelState], path: &[Pose]) -> f64 {
    let pairs = states.iter().zip(path);
    rms(pairs.map(|(state, pose)| state.height - wheel.radius - pose.rim_height))
}

fn touched_in_simulation(states: &[WheelState]) -> u64 {
    states
        .iter()
        .fold(0, |lugs, state| lugs | state.lugs_touching)
}

fn touched_on_path(path: &[Pose]) -> u64 {
    path.iter().fold(0, |lugs, pose| match pose.support {
        Support::Lug(lug) => lugs | 1 << lug,
        Support::Rim => lugs,
    })
}

/// Eq. (11)-(22), ALCT. The axle's height differs by the indentation, its position by what the rig,
/// whose speeds are fixed, makes the edges slip: 0.03 mm over 100 mm.
#[test]
fn on_slate_the_axle_follows_the_rolling_wheel_to_a_fifth_more_than_the_indentation() {
    for (wheel, speed, distance) in [
        (Wheel::single_wheel(), 0.01, 0.1),
        (Wheel::rover(), 0.005, 0.06),
    ] {
        let (states, path) = simulated_and_rolled(&slate(), &wheel, speed, distance);
        let error = height_error(&wheel, &states, &path);
        assert!(error < 1.2 * INDENTATION, "{error}");
        let swing = range(path.iter().map(|pose| pose.rim_height));
        assert!(swing > 1.0e-3, "{swing}");
        let astray = states
            .iter()
            .zip(&path)
            .map(|(state, pose)| (state.position - pose.position).abs())
            .fold(0.0, f64::max);
        assert!(astray < 5.0e-5, "{astray}");
        assert_eq!(touched_in_simulation(&states), touched_on_path(&path));
        // All lugs: those that came by are neighbours, and each was counted once.
        let last = path[path.len() - 1];
        assert_eq!(
            i64::from(touched_on_path(&path).count_ones()),
            last.lugs_counted
        );
    }
}

/// Bricks of 60 mm and gaps as wide, 10 mm deep: fixed stones.
fn bricks() -> TerrainSpec {
    TerrainSpec::Hard {
        contact: CONTACT,
        roughness: Roughness {
            rms: 1.0e-4,
            hurst: 0.8,
            longest: 0.2,
            shortest: 0.002,
        },
        joints: Some(Joints {
            spacing: 0.12,
            width: 0.06,
            depth: 0.01,
            step: 0.004,
            edge_radius: None,
        }),
        ledge: None,
    }
}

/// Eq. (26)-(41), SLCT. Where the wheel is when it has turned so far depends on slip: the rig's
/// speeds are fixed, the model never slips, and after 240 mm they are some 3 mm apart. So heights are
/// compared at the simulated position, and the path by its share of the swing.
#[test]
fn over_fixed_stones_the_axle_stands_where_the_outline_says_and_the_same_lugs_miss() {
    for wheel in [Wheel::single_wheel(), Wheel::rover()].map(edged) {
        let (states, path) = simulated_and_rolled(&bricks(), &wheel, 0.02, 0.24);
        let terrain = Terrain::generate(&bricks(), Seed(1), 0);
        let mut profile = terrain.profile(&terrain.stretches()[0]);
        profile.extend(-1.0, 1.0);
        let mut touched = 0_u64;
        for state in &states {
            let ground = |x: f64| profile.at(x).height;
            let stands = footing(&wheel, ground, state.position, state.wheel_angle);
            if let Support::Lug(lug) = stands.support {
                touched |= 1 << lug;
            }
            let pressed_in = stands.axle_height - state.height;
            // On a stone's flank the ground carries more than the load, and gives way as much more. There an edge of 50 µm
            // radius stands higher than one of none, by 50 µm (1/cos 30° - 1) where lugs meet the roundest bricks.
            let higher = 5.0e-5 * (1.0 / 30.0_f64.to_radians().cos() - 1.0);
            assert!(
                (0.4 * INDENTATION - higher..3.0 * INDENTATION).contains(&pressed_in),
                "{pressed_in}"
            );
        }
        let swing = range(path.iter().map(|pose| pose.rim_height));
        let error = height_error(&wheel, &states, &path);
        assert!(error < 0.06 * swing, "{error} of {swing}");
        assert_eq!(touched_in_simulation(&states), touched);
        let counted = path[path.len() - 1].lugs_counted;
        assert!(
            i64::from(touched.count_ones()) < counted,
            "no lug missed: {touched:b}"
        );
    }
}

/// Eq. (43), (48): the height repeats itself with every lug, weaker than on hard ground. Fig. 7b has
/// it highest with a lug straight down; simulated sand carries a lug most while it still comes down,
/// and the wheel is highest a fifth of a lug angle earlier.
#[test]
fn on_sand_the_height_repeats_itself_every_lug_and_is_highest_before_a_lug_points_down() {
    let wheel = Wheel::single_wheel();
    let alpha = wheel.lug_angle().unwrap();
    let states = run(&sandy(), &wheel, &rig(0.028, 0.2, 100.0), 16e3, 10.0);
    let end = states[states.len() - 1].wheel_angle;
    let late: Vec<&WheelState> = states
        .iter()
        .filter(|state| state.wheel_angle > end - 4.0 * alpha)
        .collect();
    // Amplitude and phase of the height by lug order.
    let harmonic = |order: f64| {
        let turn = |state: &WheelState| order * TAU * state.wheel_angle / alpha;
        let along = 2.0 * mean(late.iter().map(|s| s.height * turn(s).cos()));
        let across = 2.0 * mean(late.iter().map(|s| s.height * turn(s).sin()));
        (along.hypot(across), across.atan2(along))
    };
    let (first, phase) = harmonic(1.0);
    for between in [0.5, 1.5, 2.5] {
        let share = harmonic(between).0 / first;
        assert!(share < 0.05, "{share} at order {between}");
    }
    let amplitude = first / harmonics::displacement_harmonic(&wheel, 1);
    // Near the 0.5 that (61) sets for κ_A of soil: lugs enter ground that stands higher than the rim's.
    assert!((0.2..0.6).contains(&amplitude), "C_M {amplitude}");
    let early = -phase / TAU;
    assert!((0.1..0.3).contains(&early), "{early} of a lug angle");

    let soil = YieldingSoil {
        tip_sinkage: wheel.lug_height() + mean(late.iter().map(|state| state.sinkage)),
        amplitude,
    };
    // What Eq. (43) misses of the height's root mean square, its lugs taken that much earlier or not;
    // what stays is the second harmonic, which sand has the other way round.
    let missed = |early: f64| {
        let entry = soil.entry_angle(&wheel).unwrap();
        let difference: Vec<f64> = late
            .iter()
            .map(|state| {
                let turned = state.wheel_angle + early * alpha + entry;
                let depth = |since| soil.tip_depth(&wheel, since).unwrap();
                state.height - rim_height(&wheel, entry, turned, depth).unwrap()
            })
            .collect();
        let about_mean = |values: &[f64]| {
            let middle = mean(values.iter().copied());
            rms(values.iter().map(|value| value - middle))
        };
        let heights: Vec<f64> = late.iter().map(|state| state.height).collect();
        about_mean(&difference) / about_mean(&heights)
    };
    assert!(missed(early) < 0.6 && missed(0.0) > 1.0);
}
