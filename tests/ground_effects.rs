//! What soil and ground leave ideal, as a wheel feels it.

use lugwheel::effects::{Application, Form};
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::trace::Trace;
use std::ops::ControlFlow;

/// A ready scenario on a rigid rig, cut short and led fast; keys set.
fn scenario(name: &str, set: &[&str]) -> Scenario {
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let short = [
        "duration=2",
        "physics_rate=8000",
        "rig.single_wheel.forward_speed=0.05",
        "rig.single_wheel.carriage.stiffness=inf",
        "rig.single_wheel.motor.stiffness=inf",
    ];
    let set: Vec<&str> = short.iter().chain(set).copied().collect();
    Scenario::load(&path).unwrap().with_all(&set).unwrap()
}

/// With an effect.
fn with(scenario: &Scenario, name: &str, magnitude: f64, form: Form) -> Scenario {
    let effect = Application::new(name, magnitude).unwrap();
    scenario
        .with_effect(&effect.in_form(form).unwrap())
        .unwrap()
}

fn run(scenario: &Scenario) -> Trace {
    scenario
        .run(Seed(4), 0, &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

/// Mean and standard deviation of a channel over the last half of a run.
fn late(trace: &Trace, name: &str) -> [f64; 2] {
    let samples = &trace.channel(name).unwrap().samples;
    let late = &samples[samples.len() / 2..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    let square = late.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    [mean, (square / late.len() as f64).sqrt()]
}

/// Mean of a channel over the last half of the run of a scenario.
fn mean(scenario: &Scenario, name: &str) -> f64 {
    late(&run(scenario), name)[0]
}

const FORMS: [Form; 2] = [Form::Own, Form::Other];

fn sand(slip: f64) -> Scenario {
    scenario(
        "single_wheel_st",
        &[&format!("rig.single_wheel.slip={slip}")],
    )
}

#[test]
fn a_wheel_that_slips_sinks_deeper_in_sand_that_it_digs_and_one_that_rolls_does_not() {
    for form in FORMS {
        let deeper = |slip| {
            // Soil flows with the slip of the last half contact length, and sinks over as long again.
            let ideal = sand(slip).with("duration=5").unwrap();
            mean(&with(&ideal, "slip_sinkage", 0.8, form), "sinkage") - mean(&ideal, "sinkage")
        };
        // The soil's own n_1 makes 12 mm at this slip.
        assert!(deeper(0.4) > 0.006, "{form}: {}", deeper(0.4));
        assert!(deeper(0.0).abs() < 1.0e-5, "{form}: {}", deeper(0.0));
    }
}

#[test]
fn lugs_of_10_mm_on_a_smooth_wheel_raise_its_pull_by_as_much_as_ding_measured() {
    let smooth = sand(0.3).with("wheel.lugs.count=0").unwrap();
    let lugged = with(&smooth, "lug_action", 0.010, Form::Own);
    let ratio = mean(&lugged, "drawbar_pull") / mean(&smooth, "drawbar_pull");
    // 47 % at this slip and another load; 27 to 63 % at all slips.
    assert!(ratio > 1.27 && ratio < 1.63, "{ratio}");
}

#[test]
fn bulldozing_takes_pull_and_leaves_torque_and_sinkage() {
    let ideal = run(&sand(0.4));
    for form in FORMS {
        let pushing = run(&with(&sand(0.4), "bulldozing", 2.5, form));
        let change = |name| late(&pushing, name)[0] - late(&ideal, name)[0];
        let pull = change("drawbar_pull");
        assert!(pull < -1.0 && pull > -10.0, "{form}: {pull} N");
        assert!(change("driving_torque").abs() < 1.0e-3);
        assert!(change("sinkage").abs() < 1.0e-5);
    }
}

#[test]
fn a_wheel_sinks_less_on_soil_that_a_wheel_has_compacted() {
    let ideal = mean(&sand(0.1), "sinkage");
    for form in FORMS {
        let again = mean(&with(&sand(0.1), "multipass", 0.5, form), "sinkage");
        assert!(
            again < 0.9 * ideal && again > 0.4 * ideal,
            "{form}: {again}"
        );
    }
}

#[test]
fn a_faster_wheel_sinks_less_only_where_soil_depends_on_rate() {
    let at = |speed: f64, effect: Option<Form>| {
        // The same way at either speed.
        let keys = [
            format!("rig.single_wheel.forward_speed={speed}"),
            format!("duration={}", 0.16 / speed),
        ];
        let ideal = sand(0.1).with_all(&keys).unwrap();
        let scenario = effect.map_or(ideal.clone(), |form| {
            with(&ideal, "rate_dependent_soil", 0.08, form)
        });
        mean(&scenario, "sinkage")
    };
    let change = |effect| at(0.08, effect) / at(0.04, effect) - 1.0;
    let ideal = change(None);
    assert!(ideal.abs() < 0.02, "{ideal}");
    for form in FORMS {
        // Twice the rate: 2^(-0.08/0.97) = 0.944 for the power law; for the logarithm
        // ((1 + 0.08 ln 3)/(1 + 0.08 ln 5))^(1/0.97) = 0.963, at a deeper contact 0.97.
        let change = change(Some(form)) - ideal;
        assert!(change < -0.02 && change > -0.08, "{form}: {change}");
    }
}

#[test]
fn cohesion_adds_a_pull_that_a_third_of_the_load_does_not_take_to_a_third() {
    let gain = |load: &str| {
        let ideal = sand(0.4)
            .with(&format!("rig.single_wheel.load={load}"))
            .unwrap();
        let moist = with(&ideal, "apparent_cohesion", 700.0, Form::Own);
        mean(&moist, "drawbar_pull") - mean(&ideal, "drawbar_pull")
    };
    let ratio = gain("100") / gain("300");
    assert!(ratio > 0.5 && ratio < 1.0, "{ratio}");
}

#[test]
fn over_a_hard_base_sinkage_saturates_against_load() {
    let growth = |effect: Option<Form>| {
        let at = |load: &str| {
            let ideal = sand(0.1)
                .with(&format!("rig.single_wheel.load={load}"))
                .unwrap();
            let scenario = effect.map_or(ideal.clone(), |form| {
                with(&ideal, "thin_soft_layer", 50.0, form)
            });
            mean(&scenario, "sinkage")
        };
        at("300") - at("100")
    };
    let ideal = growth(None);
    for form in FORMS {
        let growth = growth(Some(form));
        assert!(
            growth > 0.0 && growth < 0.7 * ideal,
            "{form}: {growth} of {ideal}"
        );
    }
}

#[test]
fn dust_takes_a_sliding_wheel_on_stone_to_the_friction_of_grains() {
    let clean = scenario("single_wheel_ref", &["rig.single_wheel.slip=0.3"]);
    let dusty = with(&clean, "dust_cover", 0.001, Form::Own);
    let ratio = mean(&dusty, "drawbar_pull") / mean(&clean, "drawbar_pull");
    assert!((ratio - 0.33 / 0.6).abs() < 0.005, "{ratio}");
    let less = with(&clean, "dust_cover", 1.0e-4, Form::Other);
    let ratio = mean(&less, "drawbar_pull") / mean(&clean, "drawbar_pull");
    assert!((ratio - 0.775).abs() < 0.005, "{ratio}");
}

#[test]
fn a_slope_takes_the_weight_of_the_wheel_along_it_off_the_measured_pull() {
    let clean = scenario("single_wheel_ref", &["rig.single_wheel.slip=0.3"]);
    let sloped = with(&clean, "slope", 5.0, Form::Own);
    let change = mean(&sloped, "drawbar_pull") - mean(&clean, "drawbar_pull");
    let cosine = 5f64.to_radians().cos();
    // The wheel of 4 kg down the slope, and friction on a load less by the cosine.
    let expected = -4.0 * 9.80665 * 5f64.to_radians().sin() - 60.0 * (1.0 - cosine);
    assert!(
        (change / expected - 1.0).abs() < 0.01,
        "{change} of {expected}"
    );
}
