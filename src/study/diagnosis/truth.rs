//! What the runs of a campaign have and the scenario they are held against has not.

use super::score::Truth;
use crate::diagnosis::parameter::PARAMETERS;
use crate::effects::Application;
use crate::scenario::Scenario;

/// How the scenario of runs differs from what they are held against, load, speed and slip aside, which
/// the runs tell.
pub(super) fn of(runs: &Scenario, against: &Scenario) -> Truth {
    let is_withheld = |effect: &&Application| {
        effect.magnitude() != effect.seat().neutral && !against.effects.contains(effect)
    };
    let withheld = runs.effects.iter().filter(is_withheld);
    let withheld: Vec<String> = withheld.map(Application::name).collect();
    if !withheld.is_empty() {
        return Truth::Effects(withheld);
    }
    let differs = |scenario: &Scenario| {
        let mut parameters = PARAMETERS.iter();
        parameters.any(|parameter| parameter.values(scenario) != parameter.values(against))
    };
    if differs(runs) {
        return Truth::Parameter;
    }
    let mut rig = runs.rig;
    *rig.load_mut() = against.rig.load();
    let (drive, told) = (rig.drive_mut(), against.rig.drive());
    drive.forward_speed = told.forward_speed;
    (drive.slip, drive.wheel_speed) = (told.slip, told.wheel_speed);
    let same = rig == against.rig
        && runs.wheel == against.wheel
        && runs.terrain == against.terrain
        && runs.sensors == against.sensors;
    if same { Truth::None } else { Truth::Other }
}
