//! Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test
//! rig would.
//!
//! ```text
//! scenario ──▶ terrain + wheel ──▶ simulation ──▶ sensors ──▶ trace ──▶ dataset
//!                   ▲                  ▲                         │
//!                (soil equations, forward)                       ├──▶ features ──▶ recognition ──▶ class
//!                                                                 └──▶ gap ◀── measured traces
//! ```
//!
//! A tour, in the order in which the modules build on each other. What things are:
//! [`quantity`] holds the few typed numbers, [`document`] the texts that describe experiments and
//! campaigns and the faults in them, [`whole_file`] the only way to write a file, [`wheel`] the wheel, [`soil`] the equations of wheel and soil
//! with the project's symbol table, [`terrain`] the ground along the track, [`vibration`] the
//! kinematics of a rigid wheel that rolls over it. What happens: [`simulation`] moves the wheel,
//! state by state. What is measured: [`trace`] holds channels and truth, [`sensors`] turn states
//! into channels, [`dataset`] keeps runs in files, simulated or imported from a rig. What is
//! inferred, on measured runs as on simulated ones: [`features`] of a window's vibration,
//! [`recognition`] of how the wheel met the ground, [`identification`] of the terrain's parameters
//! from loads, slip and sinkage, [`gap`] of where measured and simulated runs differ. What is
//! asked: [`effects`] are named departures from the ideal, [`scenario`] is one experiment as a file,
//! [`diagnosis`] repeats measured conditions with parameters and effects otherwise than the scenario
//! has them and tells which of them, or what unknown, explains what was measured, [`learning`] makes
//! data sets of runs for those who train on them, [`study`] runs many scenarios into one table with a
//! score of the classes recognised and of the limits that the paper sets to vibration, [`challenge`]
//! puts the diagnosis to blind trials and scores its answers, [`report`] draws what came of it and
//! makes pages of it.
//!
//! The whole experiment, with nothing in it that reads a file or a clock:
//!
//! ```
//! use lugwheel::quantity::Seed;
//! use lugwheel::sensors::{Observed, SensorChain};
//! use lugwheel::scenario::Scenario;
//! use lugwheel::simulation::Simulation;
//! use lugwheel::terrain::Terrain;
//!
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! let scenario = Scenario::from_toml(&text, "quick.toml")?.with("duration=0.1")?;
//! let (seed, run, rate) = (Seed(1), 0, scenario.physics_rate());
//! let terrain = Terrain::generate(&scenario.terrain, seed, run);
//! let wheel_radius = scenario.wheel.radius;
//! let observed = Observed { physics_rate: rate, wheel_radius, seed, run };
//! let mut chain = SensorChain::new(&scenario.sensors, &observed)?;
//! let steps = (scenario.duration * rate.hertz()) as usize;
//! for state in Simulation::new(&terrain, &scenario.wheel, &scenario.rig, rate)?.take(steps) {
//!     chain.push(&state?);
//! }
//! let channels = chain.finish();
//! assert!(channels.iter().any(|channel| channel.name == "acceleration_y"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// What things are.
pub mod quantity;

pub mod document;
pub mod wheel;
pub mod whole_file;

pub mod soil;
pub mod terrain;

pub mod vibration;

// What happens.
pub mod simulation;

// What is measured.
pub mod trace;

pub mod sensors;

pub mod dataset;

// What is inferred.
pub mod features;

pub mod recognition;

pub mod identification;

pub mod gap;

// What is asked.
pub mod effects;

pub mod scenario;

pub mod diagnosis;

pub mod learning;

pub mod study;

pub mod challenge;

pub mod report;
