//! Which arms a diagnosis needs, and what they cost.
//!
//! Replicates of the scenario as shipped tell its spread; each parameter, one standard deviation up
//! and down, its slope; each effect that can be there, at its low, typical and high magnitude, its
//! signature. Differences are taken stream by stream, so that ground and noise fall out of them.
//! How many replicates and streams there are is the [`Depth`]: the deepest of [`DEPTHS`] whose
//! driving a budget allows. The budget is simulated time, not time of a clock: the same campaign has
//! the same plan on every machine.

use super::arm::Arm;
use super::bank::{Request, changes_motion, is_possible};
use super::condition::Case;
use super::cost::Cost;
use super::parameter::{Offsets, Parameter, parameters};
use crate::effects::{Application, Effect, Seat, catalogue};
use crate::gap::FEWEST_REPLICATES;
use serde::Serialize;

/// How much is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Depth {
    /// Replicates of each case as shipped.
    pub replicates: u64,
    /// Streams with which parameters and effects are simulated.
    pub streams: u64,
    /// Magnitudes of each effect: 1 is its typical one, 3 are low, typical and high.
    pub levels: usize,
}

/// From the least that tells a spread to where more tells little more. A replicate costs one run,
/// a stream some hundred, and both spread and correlation of hundreds of statistics are learned
/// from replicates alone: they are many.
pub const DEPTHS: [Depth; 8] = [
    depth(FEWEST_REPLICATES as u64, 1, 1),
    depth(6, 1, 3),
    depth(12, 2, 3),
    depth(30, 2, 3),
    depth(60, 3, 3),
    depth(80, 4, 3),
    depth(100, 6, 3),
    depth(120, 8, 3),
];

const fn depth(replicates: u64, streams: u64, levels: usize) -> Depth {
    Depth {
        replicates,
        streams,
        levels,
    }
}

/// A parameter one standard deviation up and down.
#[derive(Debug, Clone)]
pub struct Slope {
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Offset of each arm from the scenario's value, in the parameter's coordinate.
    pub offsets: [f64; 2],
    /// Down and up.
    pub arms: [Arm; 2],
}

/// An effect on one of its seats, at some magnitudes.
#[derive(Debug, Clone)]
pub struct Signature {
    /// The effect.
    pub effect: &'static Effect,
    /// Where it sits.
    pub seat: &'static Seat,
    /// Magnitudes, in the seat's unit.
    pub magnitudes: Vec<f64>,
    /// An arm a magnitude.
    pub arms: Vec<Arm>,
}

impl Signature {
    /// Name of the effect with its channel, as in files.
    pub fn name(&self) -> String {
        full_name(self.effect, self.seat)
    }
}

/// What a diagnosis simulates.
#[derive(Debug, Clone)]
pub struct Plan {
    /// How much.
    pub depth: Depth,
    /// Parameters of the scenario.
    pub slopes: Vec<Slope>,
    /// Effects that can be there and show in what was measured.
    pub signatures: Vec<Signature>,
    pub(super) cases: usize,
}

/// A budget that does not do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{budget:.0} s of driving are too few: the least is {least:.0} s; allow more, compare fewer or \
     shorter runs, or leave effects out"
)]
pub struct TooSmall {
    /// Driving allowed [s].
    pub budget: f64,
    /// Driving of the shallowest depth [s].
    pub least: f64,
}

impl Plan {
    /// All that these cases ask for at a depth; effects named in `without` are left out.
    pub fn at(depth: Depth, cases: &[Case], without: &[String]) -> Self {
        Self {
            depth,
            slopes: slopes(cases),
            signatures: signatures(cases, without, depth.levels),
            cases: cases.len(),
        }
    }

    /// The deepest plan that a budget [s] of simulated driving does; what is in a bank already does
    /// not count, so that a diagnosis that goes on has the plan with which it began.
    ///
    /// # Errors
    /// `TooSmall` where it does not do for the shallowest.
    pub fn within(budget: f64, cases: &[Case], without: &[String]) -> Result<Self, TooSmall> {
        let mut deepest = None;
        for depth in DEPTHS {
            let plan = Self::at(depth, cases, without);
            let cost = plan.cost(cases);
            if cost.driven > budget {
                let least = cost.driven;
                return deepest.ok_or(TooSmall { budget, least });
            }
            deepest = Some(plan);
        }
        deepest.ok_or(TooSmall { budget, least: 0.0 })
    }

    /// The arms that are not the scenario as shipped.
    pub fn arms(&self) -> impl Iterator<Item = &Arm> {
        let slopes = self.slopes.iter().flat_map(|slope| &slope.arms);
        slopes.chain(self.signatures.iter().flat_map(|it| &it.arms))
    }

    /// What a bank is asked for: the replicates of all cases, then stream by stream the others.
    pub fn requests(&self) -> Vec<Request> {
        let mut requests = Vec::new();
        let mut ask = |arm: &Arm, stream: u64| {
            requests.extend((0..self.cases).map(|case| Request {
                arm: arm.clone(),
                case,
                stream,
            }));
        };
        let shipped = Arm::as_shipped();
        (0..self.depth.replicates).for_each(|stream| ask(&shipped, stream));
        for stream in 0..self.depth.streams {
            self.arms().for_each(|arm| ask(arm, stream));
        }
        requests
    }

    /// What it costs where nothing is in the bank yet.
    pub fn cost(&self, cases: &[Case]) -> Cost {
        let Depth {
            replicates,
            streams,
            ..
        } = self.depth;
        let mut cost = Cost::default();
        for case in cases {
            cost += Cost::of(case, replicates, replicates);
            for arm in self.arms() {
                let motions = if changes_motion(arm, case) {
                    streams
                } else {
                    0
                };
                cost += Cost::of(case, motions, streams);
            }
        }
        cost
    }
}

/// Every parameter that a case has, a standard deviation either way.
fn slopes(cases: &[Case]) -> Vec<Slope> {
    let Some(case) = cases.first() else {
        return Vec::new();
    };
    let both_ways = |parameter: &'static Parameter| {
        let offsets = [-parameter.sd, parameter.sd];
        Slope {
            parameter,
            offsets,
            arms: offsets.map(|offset| Arm::of_offsets(Offsets::default().with(parameter, offset))),
        }
    };
    parameters(&case.scenario).map(both_ways).collect()
}

/// Every effect on every seat that the cases can have, and whose channel was measured in one.
fn signatures(cases: &[Case], without: &[String], levels: usize) -> Vec<Signature> {
    let seats = catalogue().flat_map(|effect| effect.seats.iter().map(move |seat| (effect, seat)));
    seats
        .filter(|(effect, seat)| {
            let names = [effect.name.to_owned(), full_name(effect, seat)];
            let measured = cases.iter().any(|case| case.has(seat.channel));
            let is_known = |case: &Case| {
                let mut known = case.scenario.effects.iter();
                known.any(|known| known.name() == names[1])
            };
            !without.iter().any(|left_out| names.contains(left_out))
                && (seat.channel.is_empty() || measured)
                && !cases.iter().any(is_known)
        })
        .filter_map(|(effect, seat)| {
            let [_, typical, _] = seat.levels;
            let magnitudes = match levels {
                1 => vec![typical],
                _ => seat.levels.to_vec(),
            };
            let arms: Option<Vec<Arm>> = magnitudes
                .iter()
                .map(|magnitude| {
                    let effect = Application::new(&full_name(effect, seat), *magnitude).ok()?;
                    Some(Arm::as_shipped().with_effect(effect))
                })
                .collect();
            let arms = arms?;
            let possible = cases
                .iter()
                .all(|case| arms.iter().all(|arm| is_possible(arm, case)));
            possible.then_some(Signature {
                effect,
                seat,
                magnitudes,
                arms,
            })
        })
        .collect()
}

fn full_name(effect: &Effect, seat: &Seat) -> String {
    match seat.channel {
        "" => effect.name.to_owned(),
        channel => format!("{}.{channel}", effect.name),
    }
}
