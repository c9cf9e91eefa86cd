//! Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test
//! rig would.
//!
//! ```text
//! scenario ──▶ terrain + wheel ──▶ simulation ──▶ sensors ──▶ trace ──▶ dataset
//!                   ▲                  ▲                         │
//!                (soil equations, forward)                       └──▶ report
//! ```
//!
//! A tour, in the order in which the modules build on each other. What things are:
//! [`quantity`] holds the few typed numbers, [`wheel`] the wheel, [`soil`] the equations of
//! wheel and soil with the project's symbol table, [`terrain`] the ground along the track. What
//! happens: [`simulation`] moves the wheel, state by state. What is measured: [`trace`] holds
//! channels and truth, [`sensors`] turn states into channels, [`dataset`] keeps runs in files.
//! What is inferred, from simulated and measured runs alike: [`identification`] finds the
//! terrain's parameters in loads, slip and sinkage. What is asked: [`scenario`] is one experiment as a file, [`study`] many of them in one table,
//! [`report`] draws what came of it.
//!
//! The whole experiment, with nothing in it that reads a file or a clock:
//!
//! ```
//! use lugwheel::quantity::Seed;
//! use lugwheel::sensors::SensorChain;
//! use lugwheel::scenario::Scenario;
//! use lugwheel::simulation::Simulation;
//! use lugwheel::terrain::Terrain;
//!
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! let scenario = Scenario::from_toml(&text, "quick.toml")?.with("duration=0.1")?;
//! let (seed, run, rate) = (Seed(1), 0, scenario.physics_rate());
//! let terrain = Terrain::generate(&scenario.terrain, seed, run);
//! let mut chain = SensorChain::new(&scenario.sensors, rate, scenario.wheel.radius, seed, run)?;
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
pub mod wheel;

pub mod soil;
pub mod terrain;

// What happens.
pub mod simulation;

// What is measured.
pub mod trace;

pub mod sensors;

pub mod dataset;

// What is inferred.
pub mod identification;

// What is asked.
pub mod scenario;

pub mod study;

pub mod report;
