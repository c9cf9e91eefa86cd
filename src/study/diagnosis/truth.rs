//! What the runs of a campaign have and the scenario they are held against has not.

use super::score::Truth;
use crate::diagnosis::parameter::PARAMETERS;
use crate::effects::Application;
use crate::scenario::Scenario;

/// How the scenario of runs differs from what they are held against, load, speed and slip aside, which
/// the runs state.
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
    let (drive, stated) = (rig.drive_mut(), against.rig.drive());
    drive.forward_speed = stated.forward_speed;
    (drive.slip, drive.wheel_speed) = (stated.slip, stated.wheel_speed);
    let same = rig == against.rig
        && runs.wheel == against.wheel
        && runs.terrain == against.terrain
        && runs.sensors == against.sensors;
    if same { Truth::None } else { Truth::Other }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::ready;

    /// What is so where runs of a scenario with these keys are held against it without.
    fn truth(keys: &[&str]) -> Truth {
        let sand = ready::scenario("single_wheel_st").unwrap();
        let scenario = Scenario::ready(sand).unwrap();
        of(&scenario.with_all(keys).unwrap(), &scenario)
    }

    #[test]
    fn what_a_sweep_changes_decides_what_a_campaign_is_to_be_read_as() {
        let of_runs = [
            "rig.single_wheel.slip=0.3",
            "rig.single_wheel.load=60.0",
            "rig.single_wheel.forward_speed=0.03",
            "duration=5.0",
            "effect.slip_sinkage=0.0",
        ];
        assert_eq!(truth(&of_runs), Truth::None);
        assert_eq!(
            truth(&["terrain.sand.soil.cohesion=300.0"]),
            Truth::Parameter
        );
        assert_eq!(truth(&["wheel.lugs.count=12"]), Truth::Other);
        let effects = ["effect.gain_error.drawbar_pull=0.05", "effect.slope=2.0"];
        let names = ["gain_error.drawbar_pull", "slope"].map(str::to_owned);
        assert_eq!(truth(&effects), Truth::Effects(names.into()));
    }
}
