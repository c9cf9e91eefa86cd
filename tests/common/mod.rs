//! What the physics tests share: grounds, rigs, runs and means.

pub mod python;
pub mod results;

use lugwheel::quantity::{SampleRate, Seed, SlipRatio};
use lugwheel::scenario::Scenario;
use lugwheel::scenario::recording::Recording;
use lugwheel::simulation::rig::flaws::{DriveFlaws, FrameFlaws};
use lugwheel::simulation::rig::{Drive, Rig, RoverLeg, SingleWheel};
use lugwheel::simulation::{Simulation, WheelState};
use lugwheel::soil::departures::Departures;
use lugwheel::soil::{Soil, StressConvention};
use lugwheel::terrain::{HardContact, Roughness, Terrain, TerrainSpec};
use lugwheel::trace::Trace;
use lugwheel::wheel::{Lugs, Wheel};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

pub const CONTACT: HardContact = HardContact {
    reference_load: 94.0,
    reference_indentation: 1.0e-5,
    exponent: 1.11,
    dissipation: 100.0,
    dust: 0.0,
};

pub fn sand() -> Soil {
    Soil {
        convention: StressConvention::WongReece,
        cohesive_modulus: 15.6e3,
        frictional_modulus: 2407.4e3,
        sinkage_exponent: 1.1,
        sinkage_exponent_slip: 0.0,
        cohesion: 250.0,
        friction_angle_deg: 31.9,
        shear_modulus: 0.0114,
        stress_angle: 0.4,
        stress_angle_slip: 0.2,
        exit_angle: 0.0,
        unloading_stiffness: 2.0e7,
        damping: 3.0e4,
        bulk_density: 1600.0,
        repose_angle_deg: 32.0,
        departures: Departures::NONE,
    }
}

pub fn drive(speed: f64, slip: f64) -> Drive {
    Drive {
        forward_speed: speed,
        slip: Some(SlipRatio::new(slip).unwrap()),
        wheel_speed: None,
        start_up: 0.5,
        stop_at: None,
        motor: None,
        carriage: None,
        flaws: DriveFlaws::default(),
    }
}

pub fn rig(speed: f64, slip: f64, load: f64) -> Rig {
    Rig::SingleWheel(SingleWheel {
        drive: drive(speed, slip),
        load,
        moving_mass: 12.0,
        lifted: None,
        slope_deg: 0.0,
        flaws: FrameFlaws::default(),
    })
}

pub fn run(
    terrain: &TerrainSpec,
    wheel: &Wheel,
    rig: &Rig,
    rate: f64,
    seconds: f64,
) -> Vec<WheelState> {
    let terrain = Terrain::generate(terrain, Seed(1), 0);
    let rate = SampleRate::new(rate).unwrap();
    let steps = (seconds * rate.hertz()) as usize;
    Simulation::new(&terrain, wheel, rig, rate)
        .unwrap()
        .take(steps)
        .map(Result::unwrap)
        .collect()
}

pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value));
    sum / n
}

pub fn leg(speed: f64, slip: f64) -> Rig {
    Rig::RoverLeg(RoverLeg {
        drive: drive(speed, slip),
        load: 284.4,
        stiffness: 1.0e6,
        damping: 1.6e3,
        slope_deg: 0.0,
        flaws: FrameFlaws::default(),
    })
}

pub fn reference() -> TerrainSpec {
    TerrainSpec::Reference { contact: CONTACT }
}

pub fn sandy() -> TerrainSpec {
    TerrainSpec::Sand {
        soil: sand(),
        roughness: None,
    }
}

/// The states after the start-up.
pub fn steady(states: &[WheelState]) -> &[WheelState] {
    let start = states
        .iter()
        .position(|state| state.time > 1.0)
        .expect("a run longer than 1 s");
    &states[start..]
}

pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|value| value * value)).sqrt()
}

/// Largest less smallest.
pub fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    high - low
}

pub fn slate() -> TerrainSpec {
    let roughness = Roughness {
        rms: 4.0e-4,
        hurst: 0.8,
        longest: 0.2,
        shortest: 0.002,
    };
    TerrainSpec::Hard {
        contact: CONTACT,
        roughness,
        joints: None,
        ledge: None,
    }
}

/// A run file opened to be spoilt. A process that another test starts holds the writer's lock from its fork until it
/// is the new program, so the file may be locked for some milliseconds.
pub fn opened_for_editing(path: &Path) -> hdf5::File {
    let attempts = (0..100).map(|_| {
        let file = hdf5::File::open_rw(path);
        if file.is_err() {
            std::thread::sleep(Duration::from_millis(20));
        }
        file
    });
    let mut opened = attempts.filter_map(Result::ok);
    opened.next().expect("a run file that nobody writes")
}

/// A ready scenario with these edits.
pub fn ready(name: &str, edits: &[&str]) -> Scenario {
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::load(path).unwrap().with_all(edits).unwrap()
}

/// Its motion, kept to be measured.
pub fn recorded(scenario: &Scenario) -> Recording {
    let go_on = &mut |_| ControlFlow::Continue(());
    scenario.record(Seed(3), 0, go_on).unwrap()
}

/// Changes every sample of a channel.
pub fn edit_samples(trace: &mut Trace, name: &str, edit: impl Fn(f64) -> f64) {
    let channels = &mut trace.channels;
    let channel = channels.iter_mut().find(|channel| channel.name == name);
    let samples = &mut channel.unwrap().samples;
    samples.iter_mut().for_each(|x| *x = edit(*x));
}

/// This wheel with lugs as thin as the paper's, which are edges.
pub fn edged(wheel: Wheel) -> Wheel {
    let lugs = wheel.lugs.map(|lugs| Lugs {
        thickness: 1.0e-4,
        edge_radius: None,
        ..lugs
    });
    Wheel { lugs, ..wheel }
}
