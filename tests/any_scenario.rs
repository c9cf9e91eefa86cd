//! Whatever a scenario may ask for, a run ends in a trace of finite numbers, but for the slip of a wheel at
//! rest, or in a reason.

use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use proptest::prelude::*;
use std::ops::ControlFlow;

fn ready(name: &str) -> Scenario {
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::load(&path).unwrap()
}

/// Runs the scenario after these edits; those it refuses are none of this test's business.
fn run(name: &str, edits: &[String], seed: u64) -> Result<(), TestCaseError> {
    let mut scenario = ready(name).with("duration=0.2").unwrap();
    for edit in edits {
        match scenario.with(edit) {
            Ok(edited) => scenario = edited,
            Err(_) => return Ok(()),
        }
    }
    let Ok(trace) = scenario.run(Seed(seed), 0, &mut |_| ControlFlow::Continue(())) else {
        return Ok(());
    };
    for channel in &trace.channels {
        // The slip of a wheel at rest is no number.
        let may_be_undefined = channel.name == "slip_ratio";
        let is_sound = |sample: f64| sample.is_finite() || may_be_undefined && sample.is_nan();
        prop_assert!(
            channel.samples.iter().all(|&sample| is_sound(sample)),
            "{} of {name} {edits:?}",
            channel.name
        );
    }
    Ok(())
}

fn edits() -> impl Strategy<Value = Vec<String>> {
    let speed = prop_oneof![Just(0.0), -0.1..0.1_f64];
    (
        speed,
        -1.0..1.0_f64,
        1.0..500.0_f64,
        0_u32..=64,
        0.001..0.05_f64,
        -30.0..30.0_f64,
        prop_oneof![Just(8_000), Just(16_000), Just(128_000)],
    )
        .prop_map(|(speed, slip, load, count, height, slope, rate)| {
            vec![
                format!("rig.single_wheel.forward_speed={speed}"),
                format!("rig.single_wheel.slip={slip}"),
                format!("rig.single_wheel.load={load}"),
                format!("wheel.lugs.count={count}"),
                format!("wheel.lugs.height={height}"),
                format!("rig.single_wheel.slope_deg={slope}"),
                format!("physics_rate={rate}"),
            ]
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_wheel_on_fixed_ground_leaves_finite_numbers(edits in edits(), seed in any::<u64>(), on in 0..3_usize) {
        run(["single_wheel_ref", "single_wheel_ht", "single_wheel_st"][on], &edits, seed)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_wheel_on_stones_leaves_finite_numbers(edits in edits(), seed in any::<u64>(), on in 0..3_usize) {
        run(["single_wheel_gt", "single_wheel_hgt", "single_wheel_sgt"][on], &edits[..6], seed)?;
    }
}
