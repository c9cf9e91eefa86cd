//! A measured run, with its condition.

use super::super::layout::Layout;
use super::{CaseError, Caveat};
use crate::quantity::SlipRatio;
use crate::scenario::Scenario;
use crate::statistics::batch_means_error;
use crate::trace::{RunAttributes, Trace, slip_tolerance, unwrapped};
use crate::wheel::Wheel;
use std::fmt;

/// Part [-] by which radius or width of another wheel differs.
const OTHER_WHEEL: f64 = 0.02;

/// Clearance [m] by which two heights are the same: rough ground and worn lugs make as much, and a wheel in the air turns
/// alike at both. A campaign with them has the layout, and the random rigs, of one without.
const SAME_CLEARANCE: f64 = 0.005;

/// Which slips hold where channels contradict those stated: one label may be wrong, but not half of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slips {
    Stated,
    Measured,
}

impl Slips {
    pub fn of(measured: &[Trace]) -> Self {
        let both = measured.iter().filter(|trace| {
            let stated = trace.attributes.slip_ratio;
            stated.is_finite() && trace.steady_mean("slip_ratio").is_some()
        });
        let wrong = both.clone().filter(|trace| has_wrong_slip(trace)).count();
        if wrong > 0 && 2 * wrong >= both.count() {
            Self::Stated
        } else {
            Self::Measured
        }
    }

    pub fn caveat(self) -> Option<Caveat> {
        (self == Self::Stated).then_some(Caveat::OtherSlips)
    }
}

/// Whether a run's channel contradicts the slip stated: by more than rigs are off, and than its mean scatters over stones.
fn has_wrong_slip(trace: &Trace) -> bool {
    let scatter = trace
        .channel("slip_ratio")
        .map_or(0.0, |channel| batch_means_error(channel.steady()));
    (trace.slip() - trace.attributes.slip_ratio).abs() > slip_tolerance(scatter)
}

/// A measured run, its condition stated or taken from its channels.
pub(super) struct Record {
    pub run: usize,
    pub attributes: RunAttributes,
    /// The same with 0 for what was not stated.
    pub stated: RunAttributes,
    /// Mean turning speed [rad/s], where the wheel's angle was measured.
    pub turning: Option<f64>,
    /// Clearance [m] of a lifted wheel, where it is measured and another than a simulated one has.
    pub clearance: Option<f64>,
    pub layout: Layout,
}

/// Why a run is not compared.
pub(super) enum Refusal {
    Wheel(CaseError),
    Missing(&'static str),
    NoOverlap(Vec<String>),
}

impl Refusal {
    pub fn other_wheel(self) -> Option<CaseError> {
        match self {
            Self::Wheel(error) => Some(error),
            _ => None,
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wheel(error) => error.fmt(f),
            Self::Missing(what) => write!(f, "its {what} is not stated and no channel gives it"),
            Self::NoOverlap(has) if has.is_empty() => f.write_str("it has no channel and no mean"),
            Self::NoOverlap(has) => {
                write!(f, "none of its channels is simulated: {}", has.join(", "))
            }
        }
    }
}

/// How the runs of a campaign are repeated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Repetition<'s> {
    pub scenario: &'s Scenario,
    /// Longest part [s] of a run that is compared.
    pub longest: f64,
    pub slips: Slips,
}

impl Record {
    /// The record of run number `run`, with what had to be taken from elsewhere.
    pub fn of(
        run: usize,
        trace: &Trace,
        repetition: &Repetition,
    ) -> Result<(Self, Vec<Caveat>), Refusal> {
        let Repetition {
            scenario,
            longest,
            slips,
        } = *repetition;
        let layout = Layout::of(trace, longest);
        if layout.is_empty() {
            return Err(Refusal::NoOverlap(names(trace)));
        }
        let mut attributes = RunAttributes {
            repeat: 0,
            day: String::new(),
            notes: String::new(),
            class: None,
            physics_rate: None,
            ..trace.attributes.clone()
        };
        check_wheel(&attributes, &scenario.wheel).map_err(Refusal::Wheel)?;
        let mut caveats = Vec::new();
        let mut stated = stated(&attributes);
        if slips == Slips::Measured && has_wrong_slip(trace) {
            attributes.slip_ratio = trace.slip();
            stated.slip_ratio = 0.0;
            caveats.push(Caveat::WrongSlip { run });
        }
        let mut record = Self {
            run,
            attributes,
            stated,
            turning: turning_speed(trace),
            clearance: clearance(trace, scenario),
            layout,
        };
        caveats.extend(record.complete(trace, scenario)?);
        Ok((record, caveats))
    }

    /// Takes attributes that are not stated from channels or scenario.
    fn complete(&mut self, trace: &Trace, scenario: &Scenario) -> Result<Vec<Caveat>, Refusal> {
        let attributes = &mut self.attributes;
        let mean = |name: &str, from| Source {
            value: trace.steady_mean(name),
            from,
        };
        let of_scenario = |value| Source {
            value: Some(value),
            from: "the scenario",
        };
        let mut caveats = Vec::new();
        let mut complete = |number: &mut f64, what, sources: &[Source]| {
            let taken = taken(number, what, sources)?;
            caveats.extend(taken);
            Ok(())
        };
        let (radius, width) = (scenario.wheel.radius, scenario.wheel.width);
        complete(
            &mut attributes.wheel_radius,
            "wheel radius",
            &[of_scenario(radius)],
        )?;
        complete(
            &mut attributes.wheel_width,
            "wheel width",
            &[of_scenario(width)],
        )?;
        let force = mean("normal_force", "the measured normal force");
        complete(&mut attributes.load, "load", &[force])?;
        let speed = mean("forward_speed", "the measured speed");
        let own = of_scenario(scenario.rig.drive().forward_speed);
        complete(&mut attributes.speed, "forward speed", &[speed, own])?;
        let slip = mean("slip_ratio", "the measured slip");
        let of_angle = Source {
            value: self.turning.map(|turning| {
                SlipRatio::from_motion(attributes.wheel_radius, turning, attributes.speed).get()
            }),
            from: "the wheel's measured angle",
        };
        complete(&mut attributes.slip_ratio, "slip", &[slip, of_angle])?;
        Ok(caveats)
    }
}

/// A value for an attribute that is not stated.
struct Source {
    value: Option<f64>,
    from: &'static str,
}

/// Sets a `number` that is not finite to the first finite value of the `sources`.
fn taken(
    number: &mut f64,
    what: &'static str,
    sources: &[Source],
) -> Result<Option<Caveat>, Refusal> {
    if number.is_finite() {
        return Ok(None);
    }
    let is_known = |source: &&Source| source.value.is_some_and(f64::is_finite);
    let source = sources.iter().find(is_known);
    let Source { value, from } = source.ok_or(Refusal::Missing(what))?;
    *number = value.unwrap_or(f64::NAN);
    Ok(Some(Caveat::Taken { what, from }))
}

pub(super) fn names(trace: &Trace) -> Vec<String> {
    let channels = trace.channels.iter().map(|channel| &channel.name);
    let means = trace.means.iter().map(|mean| &mean.name);
    channels.chain(means).cloned().collect()
}

fn check_wheel(attributes: &RunAttributes, wheel: &Wheel) -> Result<(), CaseError> {
    for (quantity, measured, scenario) in [
        ("radius", attributes.wheel_radius, wheel.radius),
        ("width", attributes.wheel_width, wheel.width),
    ] {
        // A NaN is not stated.
        if (measured - scenario).abs() > OTHER_WHEEL * scenario {
            return Err(CaseError::OtherWheel {
                quantity,
                measured,
                scenario,
            });
        }
    }
    Ok(())
}

/// Mean speed [rad/s] at which the wheel turned.
fn turning_speed(trace: &Trace) -> Option<f64> {
    let channel = trace.channel("wheel_angle")?;
    let angles = unwrapped(&channel.samples);
    let mut known = angles.iter().enumerate().filter(|(_, a)| a.is_finite());
    let (first, from) = known.next()?;
    let (last, to) = known.next_back()?;
    let seconds = (last - first) as f64 / channel.sample_rate;
    Some((to - from) / seconds).filter(|speed| speed.is_finite())
}

/// Clearance [m] between ground and lugs of a lifted wheel, to a millimetre; none where it is about the scenario's for
/// lifted wheels, or is not measured. A wheel hangs above the stones near it, and is measured from the ground under it, so
/// that over stones it may be measured higher by a stone.
fn clearance(trace: &Trace, scenario: &Scenario) -> Option<f64> {
    if !trace.attributes.is_lifted() {
        return None;
    }
    let measured = -trace.steady_mean("sinkage")? - scenario.wheel.lug_height();
    let given = scenario.rig.lifting_clearance();
    let higher = SAME_CLEARANCE + scenario.terrain.largest_stone();
    let is_another = !(-SAME_CLEARANCE..=higher).contains(&(measured - given)) && measured > 0.0;
    is_another.then(|| 1.0e-3 * libm::round(1.0e3 * measured))
}

/// Attributes with 0 for numbers that are not stated.
fn stated(attributes: &RunAttributes) -> RunAttributes {
    let known = |number: f64| if number.is_finite() { number } else { 0.0 };
    RunAttributes {
        wheel_radius: known(attributes.wheel_radius),
        wheel_width: known(attributes.wheel_width),
        load: known(attributes.load),
        speed: known(attributes.speed),
        slip_ratio: known(attributes.slip_ratio),
        ..attributes.clone()
    }
}
