//! Every effect shows as its entry in the catalogue says.

use crate::common::{drive, leg, mean, ready, recorded, reference, rig, rms, run, steady};
use lugwheel::effects::{Application, Form, Setup, catalogue};
use lugwheel::scenario::Scenario;
use lugwheel::scenario::recording::Recording;
use lugwheel::sensors::Sensors;
use lugwheel::simulation::WheelState;
use lugwheel::simulation::rig::carriage::Carriage;
use lugwheel::simulation::rig::motor::Motor;
use lugwheel::simulation::rig::{Rig, SingleWheel};
use lugwheel::study::Study;
use lugwheel::terrain::TerrainSpec;
use lugwheel::trace::Trace;
use lugwheel::wheel::Wheel;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Steps per second of the physics here: loads and heights, no spectra beyond 200 Hz.
const RATE: f64 = 8_000.0;

const LOAD: f64 = 100.0;

/// An experiment on flat hard ground.
#[derive(Clone)]
struct Bench {
    terrain: TerrainSpec,
    wheel: Wheel,
    rig: Rig,
    sensors: Sensors,
}

impl Bench {
    fn new(wheel: Wheel, rig: Rig) -> Self {
        Self {
            terrain: reference(),
            wheel,
            rig,
            sensors: Sensors::default(),
        }
    }

    fn with(&self, effect: &str, form: Form) -> Self {
        let effect: Application = effect.parse().unwrap();
        let mut bench = self.clone();
        let mut setup = Setup {
            terrain: &mut bench.terrain,
            wheel: &mut bench.wheel,
            rig: &mut bench.rig,
            sensors: &mut bench.sensors,
        };
        effect.in_form(form).unwrap().apply(&mut setup).unwrap();
        bench
    }

    fn states(&self, seconds: f64) -> Vec<WheelState> {
        run(&self.terrain, &self.wheel, &self.rig, RATE, seconds)
    }
}

/// A wheel without lugs and without friction, whose torque is that of the normal force alone.
fn smooth() -> Wheel {
    Wheel {
        lugs: None,
        friction: 0.0,
        ..Wheel::single_wheel()
    }
}

/// The paper's wheel held off the ground.
fn lifted(speed: f64) -> Bench {
    let rig = Rig::SingleWheel(SingleWheel {
        drive: drive(speed, 0.0),
        load: LOAD,
        moving_mass: 12.0,
        lifted: Some(0.01),
        slope_deg: 0.0,
        flaws: Default::default(),
    });
    Bench::new(Wheel::single_wheel(), rig)
}

/// Amplitude of a wave that turns by `phase` [rad] a state, over whole turns of it.
fn amplitude(
    states: &[WheelState],
    phase: impl Fn(&WheelState) -> f64,
    value: impl Fn(&WheelState) -> f64,
) -> f64 {
    let turns = (phase(&states[states.len() - 1]) - phase(&states[0])) / TAU;
    let end = phase(&states[0]) + turns.floor() * TAU;
    let whole: Vec<&WheelState> = states.iter().filter(|s| phase(s) < end).collect();
    let middle = mean(whole.iter().map(|s| value(s)));
    let part = |wave: fn(f64) -> f64| {
        2.0 * mean(whole.iter().map(|s| (value(s) - middle) * wave(phase(s))))
    };
    part(f64::sin).hypot(part(f64::cos))
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found} is not {expected}"
    );
}

#[test]
fn an_eccentric_wheel_heaves_by_its_offset_once_a_turn_and_an_oval_one_twice() {
    // 3 rad/s: two turns in 4.2 s.
    let bench = Bench::new(smooth(), rig(0.42, 0.0, LOAD));
    for (effect, order) in [("wheel_eccentricity", 1.0), ("wheel_ovality", 2.0)] {
        let effect = format!("{effect}=0.0005");
        let states = bench.with(&effect, Form::Own).states(5.5);
        let turned = |s: &WheelState| order * s.wheel_angle;
        // 1 %: hub inertia (12 kg · e ω² = 0.05 N of 100 N) and the ground's give.
        near(
            amplitude(steady(&states), turned, |s| s.height),
            5.0e-4,
            0.01,
        );
        // The load times how fast the axle rises with the angle.
        let torque = amplitude(steady(&states), turned, |s| s.ground.driving_torque);
        near(torque, LOAD * order * 5.0e-4, 0.02);
        // The rim's centre, where the mass of a round wheel is, stays level: its weight is not lifted with the axle.
        let lifted = if order == 1.0 {
            LOAD - bench.wheel.mass * 9.80665
        } else {
            LOAD
        };
        let torque = amplitude(steady(&states), turned, |s| s.hub.driving_torque);
        near(torque, lifted * order * 5.0e-4, 0.03);
        near(
            amplitude(&bench.states(5.5)[8000..], turned, |s| 1.0 + s.height),
            1.0e-9,
            1.0e5,
        );
    }
}

#[test]
fn a_wheel_drops_deeper_where_a_lug_is_short_once_a_turn() {
    let bench = Bench::new(Wheel::single_wheel(), rig(0.05, 0.0, LOAD));
    let short = bench.with("short_lug=0.4", Form::Own);
    let states = short.states(2.6);
    assert!(states.iter().all(|state| state.lugs_touching & 0b100 == 0));
    let (tip, alpha) = (0.155, TAU / 28.0);
    let lowest = |from: f64, to: f64| {
        let within = states
            .iter()
            .filter(|s| (from..to).contains(&(s.wheel_angle / alpha)));
        within.map(|s| s.height).fold(f64::MAX, f64::min)
    };
    // Between lugs 0 and 1 both carry half a pitch off; over lug 2 its neighbours do, a pitch off.
    // 0.1 mm: 0.02 mm of indentation, and the overshoot of the fall.
    assert!((lowest(0.2, 0.8) - tip * (alpha / 2.0).cos()).abs() < 1.0e-4);
    assert!(
        (lowest(1.6, 2.4) - tip * alpha.cos()).abs() < 1.0e-4,
        "{}",
        lowest(1.6, 2.4)
    );
}

#[test]
fn a_worn_wheel_stands_on_lower_lugs_and_an_unevenly_worn_one_on_its_mean() {
    let bench = Bench::new(Wheel::single_wheel(), rig(0.0, 0.0, LOAD));
    let at_rest = |form| bench.with("lug_wear=0.2", form).states(0.1)[700].height;
    let (worn, one_sided) = (at_rest(Form::Own), at_rest(Form::Other));
    // The ground gives 0.01 mm under lug 0, which is not worn on the one-sided wheel.
    assert!((worn - (0.14 + 0.8 * 0.015)).abs() < 2.0e-5, "{worn}");
    assert!((one_sided - 0.155).abs() < 2.0e-5, "{one_sided}");
    let wheel = bench.with("lug_wear=0.2", Form::Other).wheel;
    near(
        mean((0..28).map(|lug| wheel.height_of_lug(lug))),
        0.8 * 0.015,
        1e-12,
    );
}

#[test]
fn cogging_ripples_the_wheel_speed_at_order_200_by_a_part_of_it_or_by_a_fixed_speed() {
    for speed in [0.014, 0.028] {
        let states = |form| lifted(speed).with("motor_cogging=0.02", form).states(4.0);
        let ripple = |form| {
            let turned = |s: &WheelState| 200.0 * s.wheel_angle;
            // The angle is that at the end of a step: the ripple lags by half a step.
            amplitude(steady(&states(form)), turned, |s| s.wheel_speed)
        };
        // 3 %: the waves are even in angle, and sampled in time, 50 steps or more a period.
        near(ripple(Form::Own), 0.02 * speed / 0.14, 0.03);
        near(ripple(Form::Other), 0.02 * 0.4, 0.03);
    }
}

#[test]
fn a_hunting_servo_swings_at_2_3_hz_whatever_the_speed() {
    for speed in [0.014, 0.05] {
        for form in [Form::Own, Form::Other] {
            let states = lifted(speed).with("servo_ripple=0.02", form).states(4.0);
            let time = |s: &WheelState| TAU * 2.3 * s.time;
            let full = speed / 0.14;
            let swing = amplitude(steady(&states), time, |s| s.wheel_speed / full);
            // A saw-tooth of this rms has a fundamental of √3 · 2/π of it.
            let fundamental = match form {
                Form::Own => 2.0_f64.sqrt(),
                Form::Other => 3.0_f64.sqrt() * 2.0 / std::f64::consts::PI,
            };
            near(swing, 0.02 * fundamental, 0.01);
        }
    }
}

/// The bench with a carriage and a motor of finite stiffness.
fn driven() -> Bench {
    let mut rig = rig(0.05, 0.3, LOAD);
    let drive = rig.drive_mut();
    drive.carriage = Some(Carriage {
        mass: 30.0,
        stiffness: 5.0e5,
        damping_ratio: 0.05,
        force_limit: f64::INFINITY,
    });
    drive.motor = Some(Motor {
        rotor_inertia: 0.2,
        stiffness: 5.0e3,
        damping_ratio: 0.05,
        torque_limit: f64::INFINITY,
        bandwidth: 20.0,
    });
    let wheel = Wheel {
        lugs: None,
        ..Wheel::single_wheel()
    };
    Bench::new(wheel, rig)
}

#[test]
fn a_soft_carriage_lags_by_pull_over_its_stiffness_and_a_soft_shaft_by_torque_over_its() {
    let bench = driven();
    let stiff = bench.states(6.0);
    // Over the last 4 s: with less damping the carriage still swings at 3.4 Hz.
    let last = |states: &[WheelState], value: fn(&WheelState) -> f64| {
        mean(states[states.len() / 3..].iter().map(value))
    };
    let [pull, torque]: [fn(&WheelState) -> f64; 2] =
        [|s| s.hub.drawbar_pull, |s| s.hub.driving_torque];
    for form in [Form::Own, Form::Other] {
        let soft = bench.with("carriage_compliance=5e-5", form).states(6.0);
        let place = |s: &WheelState| s.position;
        // The wheel slips and pulls the carriage ahead.
        let ahead = last(&soft, place) - last(&stiff, place);
        near(ahead, 5.0e-5 * last(&stiff, pull), 0.02);
        let soft = bench.with("motor_compliance=0.004", form).states(6.0);
        let angle = |s: &WheelState| s.wheel_angle;
        let behind = last(&stiff, angle) - last(&soft, angle);
        near(behind, 4.0e-3 * last(&stiff, torque), 0.02);
    }
}

#[test]
fn a_rig_that_is_rigid_along_the_track_has_no_soft_carriage_or_shaft() {
    let mut bench = driven();
    let drive = bench.rig.drive_mut();
    drive.carriage = None;
    drive.motor = None;
    for effect in ["carriage_compliance=1e-5", "motor_compliance=0.0006"] {
        let effect: Application = effect.parse().unwrap();
        let mut setup = Setup {
            terrain: &mut bench.terrain,
            wheel: &mut bench.wheel,
            rig: &mut bench.rig,
            sensors: &mut bench.sensors,
        };
        let error = effect.apply(&mut setup).unwrap_err().to_string();
        assert!(error.contains("of finite stiffness"), "{error}");
    }
}

#[test]
fn a_rig_that_gives_rings_at_the_frequency_of_its_slide_on_its_compliance() {
    let bench = Bench::new(Wheel::single_wheel(), rig(0.05, 0.0, LOAD));
    let [rigid, soft] = [bench.clone(), bench.with("rig_resonance=3e-6", Form::Own)];
    let stiff = bench.with("rig_resonance=4e-8", Form::Own);
    assert_eq!(
        stiff.rig.leg(&stiff.wheel),
        None,
        "too stiff for the steps: rigid"
    );
    let slide = rigid.rig.moving_mass(&rigid.wheel) - rigid.wheel.mass;
    assert_eq!(soft.rig.sprung_mass(&soft.wheel), Some(slide));
    // The ground gives δ/(n F) = 1e-7 m/N on top.
    let expected = 1.0 / (TAU * (3.1e-6 * slide).sqrt());
    let states = soft.states(3.0);
    let level = |frequency: f64| {
        let time = |s: &WheelState| TAU * frequency * s.time;
        amplitude(steady(&states), time, |s| s.ground.normal_force)
    };
    let grid = (0..120).map(|k| 10.0 * 1.02_f64.powi(k));
    let peak = grid.max_by(|a, b| level(*a).total_cmp(&level(*b))).unwrap();
    // 6 %: lugs strike the ringing anew 1.6 times a second, and it dies away in between.
    near(peak, expected, 0.06);
}

#[test]
fn a_guide_that_rubs_takes_its_friction_off_a_sinking_wheel_and_adds_it_to_a_rising_one() {
    let bench = Bench::new(Wheel::single_wheel(), rig(0.02, 0.0, LOAD));
    let states = bench.with("rail_friction=2", Form::Own).states(4.0);
    let median = |rising: f64| {
        let mut forces: Vec<f64> = steady(&states)
            .iter()
            .filter(|s| s.vertical_speed * rising > 5.0e-4)
            .map(|s| s.ground.normal_force)
            .collect();
        forces.sort_by(f64::total_cmp);
        forces[forces.len() / 2]
    };
    // 0.3 N: inertia of the lug's arc, 14 kg · v²/r = 0.05 N, and ringing.
    assert!((median(1.0) - LOAD - 2.0).abs() < 0.3, "{}", median(1.0));
    assert!((median(-1.0) - LOAD + 2.0).abs() < 0.3, "{}", median(-1.0));
}

#[test]
fn load_grows_with_commanded_slip_and_not_without() {
    let loads = [
        (0.0, Form::Own, 1.0),
        (0.4, Form::Own, 1.04),
        (0.0, Form::Other, 1.0),
        (0.3, Form::Other, 1.03),
        (0.6, Form::Other, 1.12),
    ];
    for (slip, form, factor) in loads {
        let bench = Bench::new(smooth(), rig(0.02, slip, LOAD));
        let states = bench.with("load_drift=0.1", form).states(1.5);
        // 0.1 %: what is left of the let-down.
        near(
            mean(steady(&states).iter().map(|s| s.ground.normal_force)),
            factor * LOAD,
            1.0e-3,
        );
    }
}

#[test]
fn a_load_takes_the_part_of_the_pull_that_its_linkage_gives_it() {
    // The pull is the friction of a sliding rim.
    let sliding = Wheel {
        friction: 0.4,
        ..smooth()
    };
    let bench = Bench::new(sliding, rig(0.02, 0.5, LOAD));
    let states = bench.with("load_transfer=0.1", Form::Own).states(1.5);
    let [load, pull] = [
        |s: &WheelState| s.ground.normal_force,
        |s: &WheelState| s.ground.drawbar_pull,
    ]
    .map(|value| mean(steady(&states).iter().map(value)));
    near(pull, 0.4 * load, 0.01);
    near(load, LOAD + 0.1 * pull, 1.0e-3);
}

#[test]
fn a_rover_leg_can_have_every_effect_of_a_rig() {
    let bench = Bench::new(Wheel::rover(), leg(0.02, 0.1));
    let effects = [
        ("rig_resonance=5e-7", Form::Own),
        ("rig_resonance=5e-7", Form::Other),
        ("rail_friction=2", Form::Own),
        ("rail_friction=2", Form::Other),
        ("load_drift=0.1", Form::Own),
        ("load_drift=0.1", Form::Other),
        ("load_transfer=0.1", Form::Own),
    ];
    for (effect, form) in effects {
        let states = bench.with(effect, form).states(1.5);
        // 10 %: a tenth of a pull of some 170 N is transferred.
        near(
            mean(steady(&states).iter().map(|s| s.ground.normal_force)),
            284.4,
            0.1,
        );
    }
}

// ---- what sensors make of one motion ----

/// Two seconds of the paper's wheel on sand, and on slate.
static SAND: LazyLock<(Scenario, Recording)> = LazyLock::new(|| motion("single_wheel_st"));
static SLATE: LazyLock<(Scenario, Recording)> = LazyLock::new(|| motion("single_wheel_ht"));

fn motion(name: &str) -> (Scenario, Recording) {
    let edits = [
        "duration=2",
        "lead_in=1",
        "rig.single_wheel.forward_speed=0.05",
    ];
    let scenario = ready(name, &edits);
    let recording = recorded(&scenario);
    (scenario, recording)
}

/// The motion as sensors with an effect see it.
fn seen((scenario, recording): &(Scenario, Recording), effect: &str, form: Form) -> Trace {
    let effect: Application = effect.parse().unwrap();
    let scenario = scenario
        .with_effect(&effect.in_form(form).unwrap())
        .unwrap();
    let sensors = scenario.experiment().unwrap().sensors;
    recording.measure(&sensors).unwrap()
}

fn ideal((scenario, recording): &(Scenario, Recording)) -> Trace {
    recording.measure(&scenario.sensors).unwrap()
}

fn samples<'a>(trace: &'a Trace, name: &str) -> &'a [f64] {
    let found = trace.channels.iter().find(|channel| channel.name == name);
    &found.unwrap().samples
}

/// What an effect adds to a channel on sand.
fn added(channel: &str, effect: &str, form: Form) -> Vec<f64> {
    let (before, after) = (ideal(&SAND), seen(&SAND, effect, form));
    let pairs = samples(&before, channel)
        .iter()
        .zip(samples(&after, channel));
    pairs.map(|(before, after)| after - before).collect()
}

/// Amplitude of a tone [Hz] in samples at 2 kHz.
fn tone(samples: &[f64], frequency: f64) -> f64 {
    let part = |wave: fn(f64) -> f64| {
        let waves = samples.iter().enumerate();
        2.0 * mean(waves.map(|(k, x)| x * wave(TAU * frequency * k as f64 / 2000.0)))
    };
    part(f64::sin).hypot(part(f64::cos))
}

#[test]
fn hum_stands_at_50_hz_and_behind_a_rectifier_half_of_it_at_100_hz_too() {
    for effect in ["mains_hum.normal_force=0.1", "mains_hum.normal_force=0.4"] {
        let amount = effect.split('=').nth(1).unwrap().parse().unwrap();
        for (form, second) in [(Form::Own, 0.0), (Form::Other, 0.5)] {
            let hum = added("normal_force", effect, form);
            near(tone(&hum, 50.0), amount, 1e-3);
            near(amount + tone(&hum, 100.0), amount * (1.0 + second), 1e-3);
            // Nothing else is added.
            let both = amount * 1.0_f64.hypot(second);
            near(rms(hum.iter().copied()), both / 2.0_f64.sqrt(), 2e-3);
        }
    }
}

#[test]
fn a_leaning_force_sensor_reads_part_of_the_load_as_pull_and_leaves_sinkage_alone() {
    let (before, after) = (ideal(&SAND), seen(&SAND, "sensor_tilt=2", Form::Own));
    let read = |trace: &Trace, name: &str| mean(samples(trace, name).iter().copied());
    let [load, pull] = ["normal_force", "drawbar_pull"].map(|name| read(&before, name));
    let (sin, cos) = 2.0_f64.to_radians().sin_cos();
    near(read(&after, "drawbar_pull"), pull * cos + load * sin, 1e-9);
    near(read(&after, "normal_force"), load * cos - pull * sin, 1e-9);
    assert_eq!(samples(&after, "sinkage"), samples(&before, "sinkage"));
    // An accelerometer misses part of gravity.
    let lean = added("acceleration_y", "sensor_tilt.acceleration_y=2", Form::Own);
    near(mean(lean.into_iter()), 9.80665 * (cos - 1.0), 0.05);
}

#[test]
fn crosstalk_copies_the_load_into_the_pull_or_the_pull_into_the_load() {
    let before = ideal(&SAND);
    let copies = [
        ("drawbar_pull", "normal_force"),
        ("normal_force", "drawbar_pull"),
    ];
    for (on, of) in copies {
        let effect = format!("force_crosstalk.{on}=0.02");
        let copied = added(on, &effect, Form::Own);
        for (added, load) in copied.iter().zip(samples(&before, of)) {
            assert!((added - 0.02 * load).abs() < 1e-9);
        }
    }
}

#[test]
fn a_wrong_gain_is_in_proportion_and_a_curved_one_right_at_zero() {
    let before = ideal(&SAND);
    let force = samples(&before, "normal_force");
    let linear = added("normal_force", "gain_error.normal_force=0.05", Form::Own);
    let curved = added("normal_force", "nonlinearity.normal_force=0.05", Form::Own);
    for ((linear, curved), force) in linear.iter().zip(&curved).zip(force) {
        assert!((linear - 0.05 * force).abs() < 1e-9);
        // 0.01 N: the filter works on the square, not the square on the filtered.
        assert!((curved - 0.05 * force * force / LOAD).abs() < 0.01);
    }
}

#[test]
fn a_moved_zero_is_constant_or_grows_to_its_size_in_ten_seconds() {
    let offset = added("drawbar_pull", "bias_drift=0.6", Form::Own);
    assert!(offset.iter().all(|added| (added - 0.6).abs() < 1e-9));
    let drift = added("drawbar_pull", "bias_drift=0.6", Form::Other);
    // 3e-4 N: the first and last values are held beyond the ends.
    for (k, added) in drift.iter().enumerate() {
        assert!((added - 0.6 / 10.0 * k as f64 / 2000.0).abs() < 3e-4);
    }
}

#[test]
fn added_noise_has_the_rms_stated_and_its_other_form_is_slow() {
    let white = added("normal_force", "added_noise.normal_force=0.2", Form::Own);
    let slow = added("normal_force", "added_noise.normal_force=0.2", Form::Other);
    // The output's filter keeps 0.8 to 1 of the band of 1 kHz: √0.9 within 6 %.
    near(rms(white.iter().copied()), 0.2 * 0.95, 0.06);
    // 2 s hold some 60 independent values of slow noise: 10 % is one standard error.
    near(rms(slow.iter().copied()), 0.2, 0.35);
    let step = |noise: &[f64]| rms(noise.windows(2).map(|pair| pair[1] - pair[0]));
    assert!(
        step(&slow) < 0.25 * step(&white),
        "{} {}",
        step(&slow),
        step(&white)
    );
}

#[test]
fn a_drive_shakes_the_axle_by_noise_or_by_a_line_of_its_mesh_that_grow_with_the_square_of_speed() {
    // The wheel turns at 0.05 m/s / 0.14 m / (1 - 0.1) = 0.397 rad/s: (3.97)² of what it is at 0.1.
    let expected = 2.0e-3 * 3.97 * 3.97;
    for form in [Form::Own, Form::Other] {
        let shaken = added("acceleration_y", "drive_vibration=0.002", form);
        // 2 s of a band of 157 Hz hold some 600 independent values; 15 % is five standard errors.
        near(rms(shaken.iter().copied()), expected, 0.15);
        assert!(
            added("normal_force", "drive_vibration=0.002", form)
                .iter()
                .all(|x| *x == 0.0)
        );
    }
    // 500 periods a turn.
    let line = added("acceleration_y", "drive_vibration=0.002", Form::Other);
    let mesh = 500.0 * 0.397 / TAU;
    assert!(tone(&line, mesh) > 0.8 * expected * 2.0_f64.sqrt());
}

#[test]
fn a_saturated_channel_stops_at_its_rail_and_a_soft_one_before_it() {
    let peak = |trace: &Trace| {
        samples(trace, "acceleration_y")
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()))
    };
    assert!(peak(&ideal(&SLATE)) > 0.5);
    // The down-sampling filter rings behind the rail, by 9 % of a step from rail to rail (Gibbs) and more behind two.
    let hard = peak(&seen(&SLATE, "clipping.acceleration_y=0.2", Form::Own));
    assert!((0.15..0.26).contains(&hard), "{hard}");
    let soft = peak(&seen(&SLATE, "clipping.acceleration_y=0.2", Form::Other));
    assert!((0.1..0.24).contains(&soft), "{soft}");
}

#[test]
fn coarse_steps_quantise_the_sinkage_and_dead_bands_silence_small_motion() {
    let coarse = seen(&SAND, "quantization.sinkage=1e-3", Form::Own);
    for sinkage in samples(&coarse, "sinkage") {
        assert!(
            (sinkage * 1e3 - (sinkage * 1e3).round()).abs() < 1e-9,
            "{sinkage}"
        );
    }
    let dead = seen(&SAND, "quantization.acceleration_y=5", Form::Other);
    assert!(
        samples(&dead, "acceleration_y")
            .iter()
            .all(|a| a.abs() < 1e-12)
    );
}

#[test]
fn a_slow_clock_sees_all_motion_faster_and_a_delayed_channel_all_of_it_later() {
    let (before, slow) = (ideal(&SAND), seen(&SAND, "clock_error=0.01", Form::Own));
    let turned =
        |trace: &Trace| samples(trace, "wheel_angle")[3000] - samples(trace, "wheel_angle")[0];
    // The wheel turns evenly but for what the motor yields to a lug: 0.1 mrad in 0.6 rad.
    near(turned(&slow), 1.01 * turned(&before), 1e-4);
    let late = seen(&SAND, "channel_delay.normal_force=0.01", Form::Own);
    let (now, then) = (
        samples(&late, "normal_force"),
        samples(&before, "normal_force"),
    );
    for k in 200..3900 {
        // 20 samples of 2 kHz: whole ones of the sensor rate too.
        assert!((now[k] - then[k - 20]).abs() < 1e-9, "{k}");
    }
    assert_eq!(
        samples(&late, "acceleration_y"),
        samples(&before, "acceleration_y")
    );
}

#[test]
fn a_wrong_zero_shifts_the_wheel_angle_and_nothing_else() {
    for angle in added("wheel_angle", "angle_zero=2", Form::Own) {
        near(angle, 2.0 * TAU / 360.0, 1e-9);
    }
    let torque = added("driving_torque", "angle_zero=2", Form::Own);
    assert!(torque.iter().all(|difference| *difference == 0.0));
}

#[test]
fn a_low_pass_quiets_impacts_and_keeps_means() {
    let (before, loads) = (ideal(&SLATE), "normal_force");
    let loud = rms(samples(&before, "acceleration_y").iter().copied());
    for (form, share) in [(Form::Own, 0.6), (Form::Other, 0.8)] {
        let after = seen(&SLATE, "low_pass.acceleration_y=20", form);
        let quiet = rms(samples(&after, "acceleration_y").iter().copied());
        assert!(quiet < share * loud, "{quiet} of {loud}");
        let after = seen(&SLATE, "low_pass.normal_force=20", form);
        let [before, after] = [&before, &after].map(|t| mean(samples(t, loads).iter().copied()));
        near(after, before, 2e-3);
    }
}

#[test]
fn a_resonant_mount_rings_in_the_acceleration_alone() {
    let (before, after) = (
        ideal(&SLATE),
        seen(&SLATE, "mounting_resonance=450", Form::Own),
    );
    let damped = seen(&SLATE, "mounting_resonance=450", Form::Other);
    let band = |trace: &Trace| {
        let tones =
            (0..60).map(|k| tone(samples(trace, "acceleration_y"), 435.0 + 0.5 * f64::from(k)));
        rms(tones)
    };
    // Damping ratio 0.05 raises the middle of this band tenfold, 0.15 by 3.3.
    let [ringing, glued] = [&after, &damped].map(|trace| band(trace) / band(&before));
    assert!(ringing > 4.0, "{ringing}");
    assert!((2.0..4.0).contains(&glued), "{glued}");
    assert_eq!(
        samples(&after, "normal_force"),
        samples(&before, "normal_force")
    );
}

#[test]
fn a_loose_sensor_adds_shocks_where_the_axle_falls_and_fewer_on_a_pad() {
    let shocks = |motion, effect: &str, form| {
        let [loose, bolted] = [seen(motion, effect, form), ideal(motion)];
        let pairs = samples(&loose, "acceleration_y").iter();
        rms(pairs
            .zip(samples(&bolted, "acceleration_y"))
            .map(|(a, b)| a - b))
    };
    // The axle falls by at most 0.8 m/s² on slate, and by less than 0.3 in sand.
    assert_eq!(shocks(&SLATE, "loose_mount=9.8", Form::Own), 0.0);
    assert_eq!(shocks(&SAND, "loose_mount=0.3", Form::Own), 0.0);
    let [held, loose] =
        ["loose_mount=0.5", "loose_mount=0.3"].map(|it| shocks(&SLATE, it, Form::Own));
    let on_pad = shocks(&SLATE, "loose_mount=0.3", Form::Other);
    assert!(
        held < loose && on_pad < loose && on_pad > 0.0,
        "{held} {loose} {on_pad}"
    );
}

#[test]
fn without_its_filter_a_channel_is_louder_and_a_mean_leaves_less() {
    let level = |trace: &Trace| rms(samples(trace, "acceleration_y").iter().copied());
    let filtered = level(&ideal(&SLATE));
    let [picked, part] = ["aliasing=1", "aliasing=0.3"].map(|e| level(&seen(&SLATE, e, Form::Own)));
    let averaged = level(&seen(&SLATE, "aliasing=1", Form::Other));
    assert!(
        picked > part && part > filtered,
        "{picked} {part} {filtered}"
    );
    assert!(averaged < picked, "{averaged} {picked}");
    let unfiltered = SLATE.0.with("sensors.anti_alias=false").unwrap();
    let direct = SLATE.1.measure(&unfiltered.sensors).unwrap();
    near(level(&direct), picked, 1e-9);
}

#[test]
fn a_wrong_encoder_reads_what_was_commanded_while_the_camera_sees_the_slip() {
    let edits = ["duration=2", "lead_in=1", "rig.single_wheel.lifted=0.01"];
    let scenario = ready("single_wheel_ht", &edits);
    let trace = |scenario: &Scenario| {
        let sensors = scenario.experiment().unwrap().sensors;
        recorded(scenario).measure(&sensors).unwrap()
    };
    let before = trace(&scenario);
    let turned = |trace: &Trace| {
        let angles = samples(trace, "wheel_angle");
        angles[3999] - angles[0]
    };
    let slip = |trace: &Trace| mean(samples(trace, "slip_ratio").iter().copied());
    // Counts lost in proportion to speed: 0.05 at 0.4 rad/s.
    let drive = *scenario.experiment().unwrap().rig.drive();
    let radius = scenario.wheel.radius;
    let share = drive.full_wheel_speed(radius).unwrap() / 0.4;
    let effects = [
        ("encoder_scale=0.05", Form::Own, 1.05),
        ("encoder_scale=0.05", Form::Other, 1.0 + 0.05 * share),
        ("carriage_scale=0.05", Form::Own, 1.05),
    ];
    for (effect, form, scale) in effects {
        let effect: Application = effect.parse().unwrap();
        let after = trace(
            &scenario
                .with_effect(&effect.in_form(form).unwrap())
                .unwrap(),
        );
        near(turned(&after), turned(&before), 1e-9);
        let speed = |trace: &Trace| mean(samples(trace, "forward_speed").iter().copied());
        near(speed(&after), speed(&before), 1e-9);
        // s = 1 - v/(r ω): the true ω is 1/1.05 of what is read, or the true v 1.05 times.
        near(1.0 - slip(&after), scale * (1.0 - slip(&before)), 1e-6);
    }
}

// ---- the catalogue itself ----

#[test]
fn every_name_is_given_once_and_every_level_and_neutral_value_is_allowed() {
    let mut names = HashSet::new();
    for effect in catalogue() {
        assert!(names.insert(effect.name), "{}", effect.name);
        assert!(!effect.confusers.contains(&effect.name), "{}", effect.name);
        for seat in effect.seats {
            let [low, high] = seat.range;
            for magnitude in seat.levels.into_iter().chain([seat.neutral]) {
                assert!(
                    (low..=high).contains(&magnitude),
                    "{}: {magnitude}",
                    effect.name
                );
            }
            let [first, second, third] = seat.levels.map(|level| match seat.neutral {
                0.0 => level,
                _ => -level,
            });
            assert!(
                first < second && second < third,
                "{}: levels depart from neutral",
                effect.name
            );
        }
    }
}

#[test]
fn every_level_of_every_effect_can_be_built_in_either_form() {
    // Sand, and a ground with all that sand has not.
    let stony = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenarios/single_wheel_hgt.toml"
    );
    let grounds = [SAND.0.clone(), Scenario::load(stony).unwrap()];
    for effect in catalogue() {
        for seat in effect.seats {
            let name = [effect.name, seat.channel].join(".");
            for level in seat.levels {
                let own = Application::new(name.trim_end_matches('.'), level).unwrap();
                for effect in [Ok(own), own.in_form(Form::Other)].into_iter().flatten() {
                    let built = grounds.iter().find_map(|on| on.with_effect(&effect).ok());
                    assert!(built.is_some(), "{effect}");
                }
            }
        }
    }
}

#[test]
fn a_study_sweeps_an_effect_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let text = format!(
        "version = 1\nscenarios = [\"{scenarios}/quick.toml\"]\nseed = 1\nrepeats = 1\n\
         random_numbers = \"common\"\n[set.effect]\nsensor_tilt = 1.0\n\
         [[sweep]]\nkey = \"effect.gain_error.normal_force\"\nvalues = [0.0, 0.05]\n"
    );
    let file = folder.path().join("study.toml");
    std::fs::write(&file, text.clone()).unwrap();
    let study = Study::load(&file).unwrap();
    let effects: Vec<Vec<String>> = study
        .runs()
        .map(|run| study.scenario(&run).effects)
        .map(|effects| effects.iter().map(Application::to_string).collect())
        .collect();
    let tilt = "sensor_tilt.drawbar_pull=1.0";
    assert_eq!(effects[0], [tilt, "gain_error.normal_force=0.0"]);
    assert_eq!(effects[1], [tilt, "gain_error.normal_force=0.05"]);
    std::fs::write(&file, text.replace("0.05]", "0.9]")).unwrap();
    let error = Study::load(&file).unwrap_err().to_string();
    assert!(error.contains("study.toml:10:"), "{error}");
    assert!(
        error.contains("gain_error [-] must be in [-0.5, 0.5], got 0.9"),
        "{error}"
    );
}
