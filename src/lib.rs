//! Simulates a lugged rover wheel on hard, gravel and granular ground, and measures it as a test rig would.

pub mod quantity;
pub mod report;
pub mod simulation;
pub mod soil;
pub mod terrain;
pub mod trace;
pub mod wheel;
