//! Measured runs -> the scenario of each condition, and how to read both sides alike.
//!
//! Load, speed and slip of a [`Case`] are those told of the measured runs, its duration the measured one;
//! wheel, ground, rig and sensors are the scenario's. What was not told is taken from the channels. So is the slip
//! of a run whose channel contradicts it: a label is easily wrong. But where most of the runs contradict theirs,
//! the rig drives otherwise than it was told (a wrong encoder, a wrong radius): then the slips told
//! are kept, and the contradiction is a gap to be explained. Rates and channels are those that were
//! measured: what a run has as a mean only, the simulated one has as a mean only.

use super::layout::Layout;
use super::parameter::parameters;
use crate::dataset::inspection::SLIP_TOLERANCE;
use crate::features::Settings;
use crate::features::reference::Reference;
use crate::gap::{self, Condition, Run, Statistician};
use crate::quantity::{RangeError, SampleRate, SlipRatio};
use crate::scenario::Scenario;
use crate::sensors::Sensors;
use crate::simulation::rig::Drive;
use crate::terrain::class::TerrainLabel;
use crate::trace::{RunAttributes, Trace, unit_of, unwrapped};
use crate::wheel::Wheel;
use rand::Rng;
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt;

/// Longest part [s] of a measured run that is compared, unless the caller says otherwise.
pub const LONGEST: f64 = 20.0;

/// Part [-] by which radius or width of another wheel differs.
const OTHER_WHEEL: f64 = 0.02;

/// Part [-] of the longest repeat below which a run is no repeat but broke off.
const BROKE_OFF: f64 = 0.5;

/// Part of a load [-], part of a speed [-] and slip [-] by which repeats may differ where these were
/// not told but measured: a rig holds its load to a tenth, its speeds better.
const SAME_LOAD: f64 = 0.15;
const SAME_SPEED: f64 = 0.05;
const SAME_SLIP: f64 = 0.02;

/// Lug passes [-] in the middle half of a run of means only.
const STEADY_PASSES: f64 = 4.0;

/// Longest run [s] of means only.
const LONGEST_OF_MEANS: f64 = 120.0;

/// One measured condition as the simulator repeats it.
#[derive(Debug, Clone)]
pub struct Case {
    /// Which condition.
    pub condition: Condition,
    /// The scenario at its load, speed and slip, as long as was measured, at the measured rates.
    pub scenario: Scenario,
    /// Wheel and condition as measured; both sides are read with them.
    pub attributes: RunAttributes,
    /// Places of its runs in the campaign: repeats of each other.
    pub runs: Vec<usize>,
    layout: Layout,
}

/// The conditions of a campaign.
#[derive(Debug, Clone)]
pub struct Cases {
    /// One a condition and kind of record, in the order in which they were measured.
    pub cases: Vec<Case>,
    /// What to keep in mind.
    pub caveats: Vec<Caveat>,
}

/// What a comparison with a scenario rests on less than it should.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Caveat {
    /// Lugs of the measured wheel, and those of the scenario's.
    Lugs {
        /// As measured.
        measured: String,
        /// As in the scenario.
        scenario: String,
    },
    /// The ground was called otherwise than the scenario's.
    Ground {
        /// As measured.
        measured: TerrainLabel,
        /// As in the scenario.
        scenario: TerrainLabel,
    },
    /// A number that no run tells, and whence it was taken.
    Taken {
        /// What was missing.
        what: &'static str,
        /// Whence it was taken.
        from: &'static str,
    },
    /// A run whose measured slip contradicts the slip told.
    WrongSlip {
        /// Its place in the campaign.
        run: usize,
    },
    /// Most runs have another slip than told.
    OtherSlips,
    /// Channels that no simulation makes.
    NotSimulated(Vec<String>),
    /// Simulated records begin as the wheel is set down.
    SetDown,
    /// Simulated sensors are without noise.
    Noiseless,
    /// A run that was not compared, and why.
    LeftOut {
        /// Its place in the campaign.
        run: usize,
        /// Why.
        reason: String,
    },
    /// A condition that was not compared, and why.
    Outside {
        /// Which.
        condition: Condition,
        /// Why.
        reason: String,
    },
}

impl fmt::Display for Caveat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lugs { measured, scenario } => write!(
                f,
                "the measured wheel has {measured}, the scenario's {scenario}"
            ),
            Self::Ground { measured, scenario } => write!(
                f,
                "the ground was called {measured}, the scenario's is {scenario}"
            ),
            Self::Taken { what, from } => write!(f, "{what} is not told: taken from {from}"),
            Self::WrongSlip { run } => write!(
                f,
                "run {run} ran at another slip than told: the measured one is taken"
            ),
            Self::OtherSlips => f.write_str(
                "most runs ran at another slip than told, as by a fault of the rig: the slips told are kept",
            ),
            Self::NotSimulated(channels) => {
                write!(f, "no simulation makes {}", channels.join(", "))
            }
            Self::SetDown => f.write_str(
                "simulated runs begin as the wheel is set down, which jolts it more than rolling does: where \
                 the measured ones begin in steady rolling, give the scenario a lead-in (--set lead_in=2)",
            ),
            Self::Noiseless => f.write_str(
                "simulated sensors are without noise, and agree better than any rig's: give the scenario's \
                 sensors the noise of the rig's",
            ),
            Self::LeftOut { run, reason } => write!(f, "run {run} is left out: {reason}"),
            Self::Outside { condition, reason } => {
                write!(f, "{condition} is left out: {reason}")
            }
        }
    }
}

/// Why a campaign cannot be compared with a scenario.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CaseError {
    /// There are no runs.
    #[error("there are no measured runs")]
    NoRuns,
    /// All runs were made with another wheel.
    #[error(
        "the measured wheel has a {quantity} of {measured} m, the scenario's {scenario} m: more \
         than 2 % apart; set wheel.{quantity} to the measured one"
    )]
    OtherWheel {
        /// `radius` or `width`.
        quantity: &'static str,
        /// As measured [m].
        measured: f64,
        /// As in the scenario [m].
        scenario: f64,
    },
    /// No run and no condition is left.
    #[error("none of the measured runs can be repeated: {}", .0.join("; "))]
    NoneLeft(Vec<String>),
}

/// The reader of runs of both sides: features over the computed reference.
///
/// # Errors
/// None with the default settings.
pub fn statistician() -> Result<Statistician, RangeError> {
    Statistician::new(Settings::default(), Reference::computed())
}

impl Cases {
    /// The conditions of measured runs, each as `scenario` repeats it; of a run its first `longest`
    /// [s] at most.
    ///
    /// Radius and width have to be the scenario's within 2 %; other lugs are a caveat. Runs and
    /// conditions that cannot be repeated are left out with a caveat.
    ///
    /// # Errors
    /// `NoRuns`; `OtherWheel` where all runs have one; `NoneLeft` with the reasons where nothing
    /// is left.
    pub fn of(scenario: &Scenario, measured: &[Trace], longest: f64) -> Result<Self, CaseError> {
        if measured.is_empty() {
            return Err(CaseError::NoRuns);
        }
        let slips = Slips::of(measured);
        let mut caveats = Vec::new();
        caveats.extend(slips.caveat());
        let mut records = Vec::new();
        let mut other_wheel = None;
        for (run, trace) in measured.iter().enumerate() {
            match Record::of((run, trace), slips, (scenario, longest)) {
                Ok((record, taken)) => {
                    caveats.extend(taken);
                    records.push(record);
                }
                Err(refusal) => {
                    let reason = refusal.to_string();
                    caveats.push(Caveat::LeftOut { run, reason });
                    other_wheel = other_wheel.or(refusal.other_wheel());
                }
            }
        }
        if let (true, Some(error)) = (records.is_empty(), other_wheel) {
            return Err(error);
        }
        caveats.extend(differences(scenario, &records));
        caveats.extend(not_simulated(measured));
        let (groups, broken): (Vec<Group>, Vec<Vec<Caveat>>) =
            grouped(records).into_iter().map(without_broken).unzip();
        caveats.extend(broken.into_iter().flatten());
        let attributes: Vec<RunAttributes> = groups.iter().map(Group::attributes).collect();
        let conditions = gap::conditions(&attributes.iter().collect::<Vec<_>>());
        let mut cases = Vec::new();
        for (group, condition) in groups.iter().zip(conditions) {
            match group.case(scenario, &condition) {
                Ok(case) => cases.push(case),
                Err(reason) => caveats.push(Caveat::Outside { condition, reason }),
            }
        }
        caveats.extend(unlike_a_rig(scenario, &cases));
        caveats.sort();
        caveats.dedup();
        if cases.is_empty() {
            let reasons = caveats
                .iter()
                .filter(|caveat| matches!(caveat, Caveat::LeftOut { .. } | Caveat::Outside { .. }));
            return Err(CaseError::NoneLeft(
                reasons.map(Caveat::to_string).collect(),
            ));
        }
        Ok(Self { cases, caveats })
    }

    /// The runs of all cases, case by case, read as their replicates are.
    pub fn read(&self, statistician: &mut Statistician, measured: &[Trace]) -> Vec<Run> {
        let runs = self.cases.iter().flat_map(|case| {
            let runs = case.runs.iter().filter_map(|run| measured.get(*run));
            runs.map(move |trace| (case, trace))
        });
        runs.map(|(case, trace)| case.read_measured(statistician, trace))
            .collect()
    }
}

impl Case {
    /// Reads a measured run of this case.
    pub fn read_measured(&self, statistician: &mut Statistician, measured: &Trace) -> Run {
        let RunAttributes {
            repeat, day, notes, ..
        } = measured.attributes.clone();
        let mut trace = self.cut(measured);
        trace.attributes = RunAttributes {
            repeat,
            day,
            notes,
            ..self.attributes.clone()
        };
        Run::read(statistician, &trace)
    }

    /// Reads a simulated run of this case, cut to what was measured; means are as uncertain as those,
    /// by draws of `rng`.
    pub fn read_simulated(
        &self,
        statistician: &mut Statistician,
        simulated: &Trace,
        rng: &mut impl Rng,
    ) -> Run {
        let mut trace = self.imitate(simulated);
        self.layout.blur(&mut trace, rng);
        trace.attributes = self.attributes.clone();
        Run::read(statistician, &trace)
    }

    /// A measured run of this case: its channels and means that are compared, as long as they are.
    pub fn cut(&self, measured: &Trace) -> Trace {
        self.layout.cut(measured)
    }

    /// A simulated run of this case as the rig would have written it: the channels, rates and means
    /// that were measured.
    pub fn imitate(&self, simulated: &Trace) -> Trace {
        self.layout.imitate(simulated)
    }

    /// Whether a channel of this name was measured, as a series or as a mean.
    pub fn has(&self, channel: &str) -> bool {
        self.layout.has(channel)
    }

    /// What both sides are read with, as text.
    pub(super) fn reading(&self) -> String {
        let RunAttributes {
            wheel_radius,
            wheel_width,
            lug_count,
            lug_height,
            load,
            speed,
            slip_ratio,
            ..
        } = self.attributes;
        let numbers = [
            wheel_radius,
            wheel_width,
            lug_height,
            load,
            speed,
            slip_ratio,
        ];
        format!("read {lug_count} {numbers:?}\n{}", self.layout)
    }
}

/// Which slips hold where channels contradict those told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Slips {
    Told,
    Measured,
}

impl Slips {
    fn of(measured: &[Trace]) -> Self {
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

    fn caveat(self) -> Option<Caveat> {
        (self == Self::Told).then_some(Caveat::OtherSlips)
    }
}

/// Whether a run's channel contradicts the slip told.
fn has_wrong_slip(trace: &Trace) -> bool {
    (trace.slip() - trace.attributes.slip_ratio).abs() > SLIP_TOLERANCE
}

/// A measured run, its condition told or taken from its channels.
struct Record {
    run: usize,
    attributes: RunAttributes,
    /// The same with 0 for what was not told.
    told: RunAttributes,
    /// Mean turning speed [rad/s], where the wheel's angle was measured.
    turning: Option<f64>,
    layout: Layout,
}

/// Why a run is not compared.
enum Refusal {
    Wheel(CaseError),
    Missing(&'static str),
    NoOverlap(Vec<String>),
}

impl Refusal {
    fn other_wheel(self) -> Option<CaseError> {
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
    fn of(
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
            layout,
        };
        Ok((record, caveats))
    }
}

fn names(trace: &Trace) -> Vec<String> {
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

/// In what measured wheels and grounds differ from the scenario's.
fn differences(scenario: &Scenario, records: &[Record]) -> Vec<Caveat> {
    let lugs = |count: u32, height: f64| match count {
        0 => "no lugs".to_owned(),
        count => format!("{count} lugs of {:.1} mm", 1.0e3 * height),
    };
    let told = lugs(scenario.wheel.lug_count(), scenario.wheel.lug_height());
    let ground = scenario.terrain.label();
    let mut caveats = Vec::new();
    for Record { attributes, .. } in records {
        let measured = lugs(attributes.lug_count, attributes.lug_height);
        caveats.extend((measured != told).then(|| Caveat::Lugs {
            measured,
            scenario: told.clone(),
        }));
        let other = attributes.terrain.filter(|label| *label != ground);
        caveats.extend(other.map(|measured| Caveat::Ground {
            measured,
            scenario: ground,
        }));
    }
    caveats
}

/// What no rig's records are like, where there are records.
fn unlike_a_rig(scenario: &Scenario, cases: &[Case]) -> Vec<Caveat> {
    let set_down = scenario.lead_in == 0.0;
    let noiseless = parameters(scenario).all(|parameter| parameter.name != "sensor_noise");
    let known = [(set_down, Caveat::SetDown), (noiseless, Caveat::Noiseless)];
    let mut cases = cases.iter();
    let has_series = cases.any(|case| !case.layout.series.is_empty());
    let told = known.into_iter().filter(|(is, _)| has_series && *is);
    told.map(|(_, caveat)| caveat).collect()
}

fn not_simulated(measured: &[Trace]) -> Option<Caveat> {
    let mut foreign: Vec<String> = measured.iter().flat_map(names).collect();
    foreign.retain(|name| unit_of(name).is_none());
    foreign.sort();
    foreign.dedup();
    (!foreign.is_empty()).then_some(Caveat::NotSimulated(foreign))
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

/// Repeats of one condition with one kind of record; there is at least one.
struct Group {
    told: Condition,
    kind: String,
    records: Vec<Record>,
}

fn grouped(records: Vec<Record>) -> Vec<Group> {
    let attributes: Vec<&RunAttributes> = records.iter().map(|it| &it.told).collect();
    let conditions = gap::conditions(&attributes);
    let mut groups: Vec<Group> = Vec::new();
    for (told, record) in conditions.into_iter().zip(records) {
        let kind = record.layout.kind();
        let mut known = groups.iter_mut();
        let is_its = |group: &&mut Group| {
            group.told == told && group.kind == kind && group.records[0].is_near(&record)
        };
        match known.find(is_its) {
            Some(group) => group.records.push(record),
            None => groups.push(Group {
                told,
                kind,
                records: vec![record],
            }),
        }
    }
    groups
}

impl Record {
    /// Whether what was measured of a condition, where it was not told, may be that of a repeat.
    fn is_near(&self, other: &Self) -> bool {
        let [here, there] = [self, other].map(|record| &record.attributes);
        let near = |a: f64, b: f64, part: f64| (a - b).abs() <= part * a.abs().max(b.abs());
        near(here.load, there.load, SAME_LOAD)
            && near(here.speed, there.speed, SAME_SPEED)
            && (here.slip_ratio - there.slip_ratio).abs() <= SAME_SLIP
    }
}

impl Group {
    /// Wheel and condition: what was told, and the mean over the repeats of what was not.
    fn attributes(&self) -> RunAttributes {
        let Record {
            attributes, told, ..
        } = &self.records[0];
        let number = |of: fn(&RunAttributes) -> f64| {
            if of(told) == of(attributes) {
                return of(told);
            }
            let all = self.records.iter().map(|record| of(&record.attributes));
            all.sum::<f64>() / self.records.len() as f64
        };
        RunAttributes {
            load: number(|it| it.load),
            speed: number(|it| it.speed),
            slip_ratio: number(|it| it.slip_ratio),
            ..attributes.clone()
        }
    }
}

/// A group without the runs that broke off, and why they are left out.
fn without_broken(group: Group) -> (Group, Vec<Caveat>) {
    let durations = group.records.iter().map(|record| record.layout.duration());
    let longest = durations.fold(0.0, f64::max);
    let broke_off = |record: &Record| record.layout.duration() < BROKE_OFF * longest;
    let (broken, records): (Vec<Record>, Vec<Record>) =
        group.records.into_iter().partition(broke_off);
    let caveat = |record: Record| Caveat::LeftOut {
        run: record.run,
        reason: format!(
            "it lasts {:.1} s, its repeats up to {longest:.1} s",
            record.layout.duration()
        ),
    };
    let caveats = broken.into_iter().map(caveat).collect();
    (Group { records, ..group }, caveats)
}

impl Group {
    /// # Errors
    /// In words, why the scenario cannot have this condition.
    fn case(&self, scenario: &Scenario, condition: &Condition) -> Result<Case, String> {
        let first = &self.records[0];
        let mut layout = first.layout.clone();
        for record in &self.records[1..] {
            layout.shorten(&record.layout);
        }
        let attributes = self.attributes();
        let mut scenario = scenario.clone();
        *scenario.rig.load_mut() = attributes.load;
        command(scenario.rig.drive_mut(), &attributes, first.turning)?;
        let words = |error: &dyn fmt::Display| error.to_string();
        let turning = scenario.rig.drive().full_wheel_speed(scenario.wheel.radius);
        let turning = turning.map_err(|error| words(&error))?;
        scenario.duration = match layout.duration() {
            0.0 => duration_of_means(&scenario.wheel, &attributes, turning),
            duration => duration,
        };
        scenario.window = None;
        sample_alike(&mut scenario.sensors, &layout);
        scenario.check().map_err(|error| words(&error))?;
        scenario.experiment().map_err(|error| words(&error))?;
        Ok(Case {
            condition: condition.clone(),
            scenario,
            attributes,
            runs: self.records.iter().map(|record| record.run).collect(),
            layout,
        })
    }
}

/// Commands what was commanded: slip, or the turning speed where slip does not tell it.
fn command(
    drive: &mut Drive,
    attributes: &RunAttributes,
    turning: Option<f64>,
) -> Result<(), String> {
    let slip = SlipRatio::new(attributes.slip_ratio).map_err(|error| error.to_string())?;
    drive.forward_speed = attributes.speed;
    if slip.get() < 1.0 {
        (drive.slip, drive.wheel_speed) = (Some(slip), None);
        return Ok(());
    }
    let turning = turning.ok_or("at slip 1 nothing but a measured wheel_angle tells its speed")?;
    (drive.slip, drive.wheel_speed) = (None, Some(turning));
    Ok(())
}

/// Duration [s] of a run of means only: its middle half holds whole lug passes, four at least, and
/// a wheel's width of track or more; half of that goes before, for the wheel to sink in.
fn duration_of_means(wheel: &Wheel, attributes: &RunAttributes, turning: f64) -> f64 {
    let lugs = match attributes.lug_count {
        0 => wheel.lug_count(),
        count => count,
    };
    let width = wheel.width / attributes.speed.abs();
    let pass = TAU / f64::from(lugs) / turning.abs();
    let duration = match [pass.is_finite(), width.is_finite()] {
        [true, true] => {
            let passes = libm::ceil(f64::max(STEADY_PASSES, width / pass));
            2.0 * passes * pass
        }
        [true, false] => 2.0 * STEADY_PASSES * pass,
        _ => 2.0 * width,
    };
    duration.min(LONGEST_OF_MEANS)
}

/// Sensors that sample as the measured run was: the fast channels at the highest of their rates,
/// or the next that the sensors' own rate is a multiple of, the camera at its own.
fn sample_alike(sensors: &mut Sensors, layout: &Layout) {
    let highest = |of_camera: bool| {
        let channels = layout.series.iter().filter(|series| {
            let is_camera = ["sinkage", "slip_ratio"].contains(&series.name.as_str());
            is_camera == of_camera
        });
        channels.map(|series| series.rate).reduce(f64::max)
    };
    if let Some(rate) = highest(false) {
        let own = sensors.rate.whole();
        let mut divisors = (1..=own).filter(|rate| own.is_multiple_of(*rate));
        let next = divisors.find(|divisor| f64::from(*divisor) >= rate);
        sensors.output_rate = next
            .and_then(|rate| SampleRate::new(f64::from(rate)).ok())
            .unwrap_or(sensors.rate);
    }
    if let Some(rate) = highest(true) {
        let camera = &mut sensors.vision;
        // Frames that are matched for slip stay as far apart in time.
        let frames = f64::from(camera.slip_frames) * rate / camera.frame_rate;
        camera.slip_frames = libm::round(frames).max(1.0) as u32;
        camera.frame_rate = rate;
    }
}
