//! Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test
//! rig would.

pub mod dataset;
pub mod quantity;
pub mod report;
pub mod scenario;
pub mod sensors;
pub mod simulation;
pub mod soil;
pub mod study;
pub mod terrain;
pub mod trace;
pub mod wheel;
