//! Runs that could be made beside those that were.

use super::condition::Case;
use crate::gap;
use crate::quantity::SlipRatio;
use crate::trace::RunAttributes;
use crate::wheel::Wheel;

/// Slip [-] of a run under high slip, and part of it from which on one was made.
const HIGH_SLIP: f64 = 0.5;
/// Factor by which another load or speed differs.
const OTHER: f64 = 2.0;

/// A run that could be made: what it is, and the case that it would be.
#[derive(Debug, Clone)]
pub struct Further {
    /// What it is, in words.
    pub name: String,
    /// Its case.
    pub case: Case,
}

/// Runs that differ from a measured case in one thing: in reverse, at twice the load, at twice the
/// speed and the same slip, under high slip, on the same wheel without lugs, with the wheel held off the
/// ground. Those that the rig cannot make are left out; of a lifted wheel there are none.
pub fn further_runs(case: &Case) -> Vec<Further> {
    let RunAttributes {
        load,
        speed,
        slip_ratio,
        ..
    } = case.attributes;
    if case.is_lifted() {
        return Vec::new();
    }
    let mut runs = vec![
        changed(case, "with the wheel lifted", |it, _| it.load = 0.0),
        changed(case, "in reverse", |attributes, _| {
            attributes.speed = -speed
        }),
        changed(case, &format!("at {:.0} N", OTHER * load), |it, _| {
            it.load = OTHER * load;
        }),
        changed(
            case,
            &format!("at {:.1} mm/s and the same slip", 1.0e3 * OTHER * speed),
            |it, _| it.speed = OTHER * speed,
        ),
    ];
    if slip_ratio.abs() < 0.8 * HIGH_SLIP {
        let name = format!("at slip {HIGH_SLIP}");
        runs.push(changed(case, &name, |it, _| it.slip_ratio = HIGH_SLIP));
    }
    if case.scenario.wheel.lugs.is_some() {
        runs.push(changed(case, "with a smooth wheel", |it, wheel| {
            (it.lug_count, it.lug_height) = (Some(0), 0.0);
            wheel.lugs = None;
        }));
    }
    runs.into_iter().flatten().collect()
}

/// The case with other attributes, with their drive and load.
fn changed(
    case: &Case,
    name: &str,
    change: impl FnOnce(&mut RunAttributes, &mut Wheel),
) -> Option<Further> {
    let mut case = case.clone();
    case.runs.clear();
    change(&mut case.attributes, &mut case.scenario.wheel);
    let load = case.attributes.load;
    case.scenario.rig.carry(load, None).ok()?;
    let drive = case.scenario.rig.drive_mut();
    drive.forward_speed = case.attributes.speed;
    let slip = SlipRatio::new(case.attributes.slip_ratio).ok()?;
    if slip.get() >= 1.0 {
        return None;
    }
    (drive.slip, drive.wheel_speed) = (Some(slip), None);
    case.scenario.check().ok()?;
    case.scenario.experiment().ok()?;
    case.condition = gap::conditions(&[&case.attributes]).swap_remove(0);
    Some(Further {
        name: name.to_owned(),
        case,
    })
}
