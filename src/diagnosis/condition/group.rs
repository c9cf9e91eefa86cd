//! Repeats of one condition, and the scenario that repeats them.

use super::super::layout::Layout;
use super::record::Record;
use super::{Case, Caveat};
use crate::gap::{self, Condition};
use crate::quantity::{SampleRate, SlipRatio};
use crate::scenario::Scenario;
use crate::sensors::Sensors;
use crate::simulation::rig::Drive;
use crate::trace::RunAttributes;
use crate::wheel::Wheel;
use std::f64::consts::TAU;
use std::fmt;

/// Part [-] of the longest repeat below which a run is no repeat but broke off.
const BROKE_OFF: f64 = 0.5;

/// Part of a load [-], part of a speed [-] and slip [-] by which repeats may differ where these were
/// not stated but measured: a rig holds its load to a tenth, its speeds better.
const SAME_LOAD: f64 = 0.15;
const SAME_SPEED: f64 = 0.05;
const SAME_SLIP: f64 = 0.02;

/// Lug passes [-] in the middle half of a run of means only.
const STEADY_PASSES: f64 = 4.0;

/// Longest run [s] of means only.
const LONGEST_OF_MEANS: f64 = 120.0;

/// Repeats of one condition with one kind of record; there is at least one.
pub(super) struct Group {
    stated: Condition,
    kind: String,
    records: Vec<Record>,
}

pub(super) fn grouped(records: Vec<Record>) -> Vec<Group> {
    let attributes: Vec<&RunAttributes> = records.iter().map(|it| &it.stated).collect();
    let conditions = gap::conditions(&attributes);
    let mut groups: Vec<Group> = Vec::new();
    for (stated, record) in conditions.into_iter().zip(records) {
        let kind = record.layout.kind();
        let mut known = groups.iter_mut();
        let is_its = |group: &&mut Group| {
            group.stated == stated && group.kind == kind && group.records[0].is_near(&record)
        };
        match known.find(is_its) {
            Some(group) => group.records.push(record),
            None => groups.push(Group {
                stated,
                kind,
                records: vec![record],
            }),
        }
    }
    groups
}

impl Record {
    /// Whether what was measured of a condition, where it was not stated, may be that of a repeat.
    fn is_near(&self, other: &Self) -> bool {
        let [here, there] = [self, other].map(|record| &record.attributes);
        let near = |a: f64, b: f64, part: f64| (a - b).abs() <= part * a.abs().max(b.abs());
        near(here.load, there.load, SAME_LOAD)
            && near(here.speed, there.speed, SAME_SPEED)
            && (here.slip_ratio - there.slip_ratio).abs() <= SAME_SLIP
    }
}

impl Group {
    /// Wheel and condition: what was stated, and the mean over the repeats of what was not.
    pub fn attributes(&self) -> RunAttributes {
        let Record {
            attributes, stated, ..
        } = &self.records[0];
        let number = |of: fn(&RunAttributes) -> f64| {
            if of(stated) == of(attributes) {
                return of(stated);
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

    /// # Errors
    /// In words, why the scenario cannot have this condition.
    pub fn case(&self, scenario: &Scenario, condition: &Condition) -> Result<Case, String> {
        let first = &self.records[0];
        let mut layout = first.layout.clone();
        for record in &self.records[1..] {
            layout.shorten(&record.layout);
        }
        let attributes = self.attributes();
        let mut scenario = scenario.clone();
        let words = |error: &dyn fmt::Display| error.to_string();
        let carried = scenario.rig.carry(attributes.load, first.clearance);
        carried.map_err(|error| words(&error))?;
        command(scenario.rig.drive_mut(), &attributes, first.turning)?;
        // Runs without a stated slope are driven on the scenario's.
        if attributes.slope_deg != 0.0 {
            *scenario.rig.slope_deg_mut() = attributes.slope_deg;
        }
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

/// A group without the runs that broke off, and why they are left out.
pub(super) fn without_broken(group: Group) -> (Group, Vec<Caveat>) {
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

/// Commands what was commanded: slip, or the turning speed where slip does not determine it.
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
    let turning = turning.ok_or("at slip 1 only a measured wheel_angle determines the speed")?;
    (drive.slip, drive.wheel_speed) = (None, Some(turning));
    Ok(())
}

/// Duration [s] of a run of means only: its middle half holds whole lug passes, four at least, and
/// a wheel's width of track or more; half of that goes before, for the wheel to sink in.
fn duration_of_means(wheel: &Wheel, attributes: &RunAttributes, turning: f64) -> f64 {
    let measured = attributes.lug_count.filter(|count| *count > 0);
    let lugs = measured.unwrap_or(wheel.lug_count());
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
