//! From a measured campaign and a scenario to simulated statistics of the same conditions.
//!
//! ```text
//! measured runs ──▶ cases ──┐
//!      scenario ──▶         ├──▶ plan ──▶ bank ──▶ readings, read as the measured ones are
//!    parameters ──▶ arms  ──┘              ▲ ▼
//!       effects ──▶                   cache folder
//! ```
//!
//! A [`Case`](condition::Case) is one measured condition as the simulator repeats it, an
//! [`Arm`](arm::Arm) a way in which the scenario may be wrong: [parameters](parameter) off their
//! values, [effects](crate::effects) left out. A [`Plan`](plan::Plan) lists what is to be simulated
//! within a budget, a [`Bank`](bank::Bank) does it, each thing once.

pub mod arm;
pub mod bank;
pub mod condition;
pub mod cost;
pub mod parameter;
pub mod plan;
mod layout;
