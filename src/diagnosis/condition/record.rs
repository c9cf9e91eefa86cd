//! A measured run, with its condition.

use super::super::layout::Layout;
use super::{CaseError, Caveat};
use crate::quantity::SlipRatio;
use crate::scenario::Scenario;
use crate::trace::SLIP_TOLERANCE;
use crate::trace::{RunAttributes, Trace, unwrapped};
use crate::wheel::Wheel;
use std::fmt;

/// Part [-] by which radius or width of another wheel differs.
const OTHER_WHEEL: f64 = 0.02;

/// Clearance [m] by which two heights are the same: rough ground and worn lugs make as much, and a wheel in the air turns
/// alike at both. A campaign with them has the layout, and the random rigs, of one without.
const SAME_CLEARANCE: f64 = 0.005;

/// Which slips hold where channels contradict those told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slips {
    Told,
    Measured,
}

impl Slips {
    pub fn of(measured: &[Trace]) -> Self {
        let both = measured.iter().filter(|trace| {
            let told = trace.attributes.slip_ratio;
            told.is_finite() && trace.steady_mean("slip_ratio").is_some()
        });
        let wrong = both.clone().filter(|trace| has_wrong_slip(trace));
        match 2 * wrong.count() > both.count() {
            true => Self::Told,
            false => Self::Measured,
        }
    }

    pub fn caveat(self) -> Option<Caveat> {
        (self == Self::Told).then_some(Caveat::OtherSlips)
    }
}

/// Whether a run's channel contradicts the slip told.
fn has_wrong_slip(trace: &Trace) -> bool {
    (trace.slip() - trace.attributes.slip_ratio).abs() > SLIP_TOLERANCE
}

/// A measured run, its condition told or taken from its channels.
pub(super) struct Record {
    pub run: usize,
    pub attributes: RunAttributes,
    /// The same with 0 for what was not told.
    pub told: RunAttributes,
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
            Self::Missing(what) => write!(f, "nothing tells its {what}"),
            Self::NoOverlap(has) if has.is_empty() => {
                f.write_str("it holds no channel and no mean")
            }
            Self::NoOverlap(has) => {
                write!(f, "no simulation makes what it holds: {}", has.join(", "))
            }
        }
    }
}

impl Record {
    pub fn of(
        (run, trace): (usize, &Trace),
        slips: Slips,
        (scenario, longest): (&Scenario, f64),
    ) -> Result<(Self, Vec<Caveat>), Refusal> {
        let wheel = &scenario.wheel;
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
        check_wheel(&attributes, wheel).map_err(Refusal::Wheel)?;
        let mut caveats = Vec::new();
        let mut told = told(&attributes);
        if slips == Slips::Measured && has_wrong_slip(trace) {
            attributes.slip_ratio = trace.slip();
            told.slip_ratio = 0.0;
            caveats.push(Caveat::WrongSlip { run });
        }
        let turning = turning_speed(trace);
        let mean = |name: &str| trace.steady_mean(name);
        let mut complete = |number: &mut f64, what, sources: [(Option<f64>, &'static str); 2]| {
            if number.is_finite() {
                return Ok(());
            }
            let mut known = sources.into_iter();
            let (value, from) = known
                .find_map(|(value, from)| Some((value.filter(|x| x.is_finite())?, from)))
                .ok_or(Refusal::Missing(what))?;
            *number = value;
            caveats.push(Caveat::Taken { what, from });
            Ok(())
        };
        let nothing = (None, "");
        let of_scenario = |value| [(Some(value), "the scenario"), nothing];
        complete(
            &mut attributes.wheel_radius,
            "wheel radius",
            of_scenario(wheel.radius),
        )?;
        complete(
            &mut attributes.wheel_width,
            "wheel width",
            of_scenario(wheel.width),
        )?;
        let force = (mean("normal_force"), "the measured normal force");
        complete(&mut attributes.load, "load", [force, nothing])?;
        let speed = (mean("forward_speed"), "the measured speed");
        let [own, _] = of_scenario(scenario.rig.drive().forward_speed);
        complete(&mut attributes.speed, "forward speed", [speed, own])?;
        let slip = (mean("slip_ratio"), "the measured slip");
        let of_angle = turning.map(|turning| {
            SlipRatio::from_motion(attributes.wheel_radius, turning, attributes.speed).get()
        });
        let of_angle = (of_angle, "the wheel's measured angle");
        complete(&mut attributes.slip_ratio, "slip", [slip, of_angle])?;
        let record = Self {
            run,
            attributes,
            told,
            turning,
            clearance: clearance(trace, scenario),
            layout,
        };
        Ok((record, caveats))
    }
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
        // Nobody knows a number that is none.
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

/// Clearance [m] between ground and lugs of a lifted wheel, to a millimetre; none where it is about that which the
/// scenario gives a wheel to be lifted, or nobody measured it.
fn clearance(trace: &Trace, scenario: &Scenario) -> Option<f64> {
    if !trace.attributes.is_lifted() {
        return None;
    }
    let measured = -trace.steady_mean("sinkage")? - scenario.wheel.lug_height();
    let given = scenario.rig.lifting_clearance();
    let is_another = (measured - given).abs() > SAME_CLEARANCE && measured > 0.0;
    is_another.then(|| 1.0e-3 * libm::round(1.0e3 * measured))
}

/// A condition with 0 for what nobody told.
fn told(attributes: &RunAttributes) -> RunAttributes {
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
