//! Simulates a lugged rover wheel on hard, gravel and sandy ground, and measures it as a test
//! rig does.
//!
//! ```text
//! scenario ─▶ terrain, wheel ─▶ simulation ─▶ sensors ─▶ trace ─▶ dataset
//!                   ▲               ▲                      │
//!                   └── soil ───────┘                      ├─▶ features ─▶ recognition
//!                                                          ├─▶ identification
//!                                                          └─▶ gap ◀─ measured traces
//!                                                               │
//!                          effects, parameters ─▶ diagnosis ◀───┘
//! ```
//!
//! The sections below follow the pipeline; the modules at the bottom of this page stand in the same order, and each
//! uses only those before it. The [`guide`] explains the program and its files.
//!
//! # 1. Simulate
//!
//! A [`Scenario`](scenario::Scenario) is one experiment as a file; some are part of the program
//! ([`scenario::ready`]), and [`scenario::keys`] lists the keys of a file. From it come the [`terrain`] along the track, the
//! [`wheel`], and the rig that carries and drives it; [`simulation`] integrates the motion, state by state, with the
//! equations of [`soil`] on sand. The kinematics of a rigid wheel are in [`vibration`]. [`quantity`] holds the typed
//! numbers, [`statistics`] the moments and quantiles used by all modules. A stream of random numbers belongs to seed, run
//! and stage, so that results do not depend on threads.
//!
//! ```
//! use lugwheel::quantity::Seed;
//! use lugwheel::scenario::Scenario;
//! use lugwheel::sensors::{Observed, SensorChain};
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
//!
//! # 2. Measure
//!
//! [`sensors`] convert states to sampled channels; a [`Trace`](trace::Trace) holds the channels and the ground truth
//! of one run; [`signal`] has their transforms, spectra and filters; [`dataset`] reads and writes runs as HDF5 and
//! imports a rig's CSV files. One motion can be measured by many sets of sensors.
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::Scenario};
//! # use std::ops::ControlFlow;
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! let scenario = Scenario::from_toml(&text, "quick.toml")?.with("duration=0.2")?;
//! let recording = scenario.record(Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! let mut sensors = scenario.sensors.clone();
//! let ideal = recording.measure(&sensors)?;
//! sensors.force_torque.drawbar_pull.gain = 1.05;
//! let biased = recording.measure(&sensors)?;
//! let pull = |trace: &lugwheel::trace::Trace| trace.channel("drawbar_pull").unwrap().samples[300];
//! assert!((pull(&biased) / pull(&ideal) - 1.05).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # 3. Recognise and identify
//!
//! [`features`] are the paper's four vibration features of a window, [`recognition`] the class of wheel-terrain
//! interaction (WTIC), [`identification`] the terrain parameters that explain loads, slip and sinkage. All three
//! accept measured and simulated traces.
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::Scenario};
//! # use std::ops::ControlFlow;
//! use lugwheel::features::{Settings, reference::Reference};
//! use lugwheel::recognition::{Method, Recognizer};
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! # let scenario = Scenario::from_toml(&text, "quick.toml")?.with("duration=1.0")?;
//! let trace = scenario.run(Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! let methods = [Method::Improved];
//! let mut recognizer = Recognizer::new(Settings::default(), Reference::computed(), &methods)?;
//! for window in recognizer.recognize(&trace)? {
//!     println!("{window:?}");
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # 4. Compare a rig with its simulation
//!
//! [`effects`] are named departures from the ideal rig, each with a magnitude. [`gap`] compares the statistics of
//! measured and simulated runs; [`diagnosis`] attributes their difference to parameters, to an effect or to none of the
//! known ones. [`challenge`] measures its performance on blind cases.
//!
//! ```
//! use lugwheel::effects::{Application, catalogue};
//! assert!(catalogue().any(|effect| effect.name == "rail_friction"));
//! let friction: Application = "rail_friction=2".parse()?;
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! # let scenario = lugwheel::scenario::Scenario::from_toml(&text, "quick.toml")?;
//! let worn_rig = scenario.with_effect(&friction)?;
//! assert_eq!(worn_rig.effects, [friction]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # 5. Many runs
//!
//! [`study`] runs sweeps and Monte Carlo designs, on one machine or a cluster, and scores recognition, limits,
//! identification and diagnosis; [`learning`] makes data sets with splits without leakage; [`report`] draws figures and
//! pages. [`document`] parses the files that describe experiments and reports faults by line; [`whole_file`] writes
//! every file completely or not at all.
//!
//! # Extension points
//!
//! Ground, soil, lugs, drive and sensors of a user's own need no change of the program: each is a small trait, and
//! [`run_with`](scenario::Scenario::run_with) runs a scenario with them.
//!
//! A scanned profile is added to the ground's own heights:
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::Scenario};
//! # use std::ops::ControlFlow;
//! use lugwheel::scenario::extensions::Extensions;
//! use lugwheel::{signal::cubic, terrain::profile::Heights};
//!
//! /// Heights [m] every `spacing` [m] from `start` on.
//! #[derive(Debug)]
//! struct Scan { start: f64, spacing: f64, heights: Vec<f64> }
//!
//! impl Heights for Scan {
//!     fn height(&self, x: f64) -> f64 {
//!         cubic(&self.heights, (x - self.start) / self.spacing)
//!     }
//! }
//!
//! # let text = std::fs::read_to_string("scenarios/single_wheel_ref.toml")?;
//! # let scenario = Scenario::from_toml(&text, "ref.toml")?.with_all(&["duration=0.1", "lead_in=0.0"])?;
//! let heights = (0..500).map(|i| 0.01 * libm::sin(0.05 * f64::from(i))).collect();
//! let scan = Scan { start: -1.0, spacing: 0.005, heights };
//! let own = Extensions::default().heights(scan);
//! let trace = scenario.run_with(own, Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! assert!(trace.truth.unwrap().profile.iter().any(|[_, height]| *height > 0.005));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A soil law states pressure over sinkage, and how much of the strength a shear displacement mobilises:
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::{Scenario, extensions::Extensions}};
//! # use std::ops::ControlFlow;
//! use lugwheel::soil::law::SoilLaw;
//!
//! /// A weak crust: its pressure approaches a limit, its shear stress has a peak.
//! #[derive(Debug)]
//! struct Crust { limit: f64, depth: f64, peak: f64 }
//!
//! impl SoilLaw for Crust {
//!     fn pressure(&self, sinkage: f64, _width: f64, _slip: f64) -> f64 {
//!         self.limit * -libm::expm1(-sinkage / self.depth)
//!     }
//!     fn mobilised(&self, displacement: f64) -> f64 {
//!         let j = displacement / self.peak;
//!         j * libm::exp(1.0 - j.abs())
//!     }
//! }
//!
//! # let text = std::fs::read_to_string("scenarios/quick.toml")?;
//! # let scenario = Scenario::from_toml(&text, "quick.toml")?.with_all(&["duration=0.2", "lead_in=0.0"])?;
//! let own = Extensions::default().soil_law(Crust { limit: 3.0e4, depth: 0.02, peak: 0.02 });
//! let trace = scenario.run_with(own, Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! assert!(trace.steady_mean("sinkage").unwrap() > 0.005);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lugs of another form than plates are the distance of a point from their outline:
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::{Scenario, extensions::Extensions}};
//! # use std::ops::ControlFlow;
//! use lugwheel::wheel::lug_outline::LugOutline;
//!
//! /// Round bars, half sunk into the rim.
//! #[derive(Debug)]
//! struct Bar { radius: f64 }
//!
//! impl LugOutline for Bar {
//!     fn distance(&self, height: f64, across: f64) -> f64 {
//!         libm::hypot(height, across) - self.radius
//!     }
//!     fn height(&self) -> f64 {
//!         self.radius
//!     }
//!     fn half_width(&self) -> f64 {
//!         self.radius
//!     }
//! }
//!
//! # let text = std::fs::read_to_string("scenarios/single_wheel_ref.toml")?;
//! # let scenario = Scenario::from_toml(&text, "ref.toml")?;
//! let scenario = scenario.with_all(&["wheel.lugs.count=20", "wheel.lugs.height=0.01", "duration=0.2", "lead_in=0.0"])?;
//! let own = Extensions::default().lugs(Bar { radius: 0.01 });
//! let trace = scenario.run_with(own, Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! assert!(trace.steady_mean("normal_force").unwrap() > 50.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A drive profile commands the speeds over time, and a sensor looks at every state:
//!
//! ```
//! # use lugwheel::{quantity::Seed, scenario::{Scenario, extensions::Extensions}};
//! # use std::ops::ControlFlow;
//! use lugwheel::sensors::Sensor;
//! use lugwheel::simulation::WheelState;
//! use lugwheel::simulation::rig::{DriveProfile, Speeds};
//! use lugwheel::trace::Channel;
//!
//! /// There and back again, without slip.
//! #[derive(Debug)]
//! struct Swing { speed: f64, radius: f64 }
//!
//! impl DriveProfile for Swing {
//!     fn speeds(&self, time: f64) -> Speeds {
//!         let forward = self.speed * libm::sin(20.0 * time);
//!         Speeds { forward, wheel: forward / self.radius }
//!     }
//! }
//!
//! /// Height of the axle, step by step.
//! struct Laser(Channel);
//!
//! impl Sensor for Laser {
//!     fn push(&mut self, state: &WheelState) { self.0.samples.push(state.height); }
//!     fn finish(self: Box<Self>) -> Channel { self.0 }
//! }
//!
//! # let text = std::fs::read_to_string("scenarios/single_wheel_ref.toml")?;
//! # let scenario = Scenario::from_toml(&text, "ref.toml")?.with_all(&["duration=0.2", "lead_in=0.0"])?;
//! let swing = Swing { speed: 0.05, radius: scenario.wheel.radius };
//! let (name, unit, sample_rate) = ("height".to_owned(), "m".to_owned(), scenario.physics_rate().hertz());
//! let laser = Laser(Channel { name, unit, sample_rate, start: 0.0, samples: Vec::new() });
//! let own = Extensions::default().drive(swing).sensor(laser);
//! let trace = scenario.run_with(own, Seed(1), 0, &mut |_| ControlFlow::Continue(()))?;
//! assert!(trace.channel("height").is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Extending the program
//!
//! | to add | edit |
//! |---|---|
//! | a terrain of a scenario file | a variant of [`TerrainSpec`](terrain::TerrainSpec), its contact forces in `src/simulation/ground_force.rs` and its label in `src/terrain/class.rs`; the compiler lists the other places |
//! | a soil law of a scenario file | a file in `src/soil`, used by the columns (`src/simulation/soil_track`) and the quadrature (`src/soil/wheel_load`) |
//! | a sensor stage | a file in `src/sensors`, neutral by default, and a line of [`SensorChain`](sensors::SensorChain) |
//! | an effect | one entry in a file of `src/effects`: a law that edits a parameter whose ideal value is neutral |
//! | a recognition method | a file in `src/recognition` and a variant of [`Method`](recognition::Method) |
//! | a rig | a variant of [`Rig`](simulation::rig::Rig) |
//! | a statistic of the comparison | a variant of [`Statistic`](gap::Statistic) and a file in `src/gap/statistics` |
//! | a parameter of the recalibration | one entry in `src/diagnosis/parameter.rs` |
//! | a distribution of a study | a variant of `Distribution` in `src/study/sweep/distribution.rs` |
//! | an analysis of a study | a file with an implementation of `Analysis` (`src/study/analysis.rs`), its line in `src/study/scores.rs`, and how its result is shown (`src/report/study_page.rs`) |
//!
//! # Glossary
//!
//! | term | meaning |
//! |---|---|
//! | ALCT, SLCT, LEIS, UWTIC | all lugs contact the terrain; some lugs contact; lugs enter soil; unknown class |
//! | arm | a variant of a scenario: with changed parameters, with effects |
//! | axle load, `W` | vertical force on the wheel \[N\] |
//! | campaign | the runs that one rig measured, with their conditions |
//! | case | a simulated condition: the scenario at the load, speed and slip of a measured condition; in a blind trial, a campaign with its hidden cause |
//! | cell | a statistic of one channel |
//! | closed form | equations (62)-(66): loads of a smooth cylinder with triangular stresses |
//! | condition | commanded slip, speed and load of a run |
//! | drawbar pull, `F_DP` | force along the track that the wheel exerts on the rig \[N\] |
//! | effect | a named departure from the ideal rig, with a magnitude |
//! | feature, `κ` | one of the paper's four numbers of a window: frequency, amplitudes, mean value, mean square |
//! | lug | a grouser: a plate across the rim |
//! | lug pass | rotation by one lug angle, and the time it takes |
//! | motion | the simulated states of a run, before any sensor |
//! | order | frequency over the wheel's rate of rotation |
//! | physics rate | integration rate: time steps of the simulation per second \[Hz\] |
//! | quadrature | integration of the stresses over rim, lug edges and lug faces |
//! | reference | the features' values on flat hard ground, by which they are normalised |
//! | run | one record: a trace with its attributes |
//! | seat | the affected channel of an effect |
//! | shear deformation modulus, `K` | displacement at which shear stress reaches 63 % of its limit \[m\] |
//! | sinkage, `z` | depth of the rim below the undisturbed surface \[m\] |
//! | sinkage exponent, `N = n_0 + n_1 abs(s)` | exponent of pressure over sinkage, and its growth with slip |
//! | slip ratio, `s` | `1 - v/(r ω)` driving, `r ω/v - 1` braking, with the rim's radius |
//! | slip-sinkage | sinkage that grows with slip |
//! | stream | the random numbers of one stage of one run |
//! | study | a set of runs by a design, with a score |
//! | truth | the simulated quantities of a run that no sensor measures |
//! | window | the part of a record from which one set of features is computed |

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

// Quantities, wheel, ground.
pub mod quantity;

pub mod statistics;

pub mod document;
pub mod wheel;
pub mod whole_file;

pub mod soil;
pub mod terrain;

pub mod vibration;

// Simulation.
pub mod simulation;

// Records, and the sensors that make them.
pub mod trace;

pub mod signal;

pub mod sensors;

pub mod dataset;

// Analysis of records.
pub mod features;

pub mod recognition;

pub mod table;

pub mod identification;

pub mod gap;

// Experiments: scenarios, effects, diagnosis, studies.
pub mod effects;

pub mod scenario;

pub mod diagnosis;

#[cfg(feature = "study")]
pub mod learning;

#[cfg(feature = "study")]
pub mod study;

#[cfg(feature = "study")]
pub mod challenge;

#[cfg(feature = "report")]
pub mod report;

// The user's guide.
pub mod guide;

// The program.
#[cfg(feature = "cli")]
pub mod cli;
