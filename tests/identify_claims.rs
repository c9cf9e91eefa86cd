//! `lugwheel identify` claims what the rows know and no more: of which wheel and load, where, on which slope, and
//! where a row or a count is missing.

use crate::common::opened_for_editing;
use crate::identify::{
    campaign, done, folder, identify, json, lugwheel, mean, refused, run, warned, write,
};
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::effects::Application;
use lugwheel::identification::steady_loads;
use lugwheel::quantity::{GRAVITY, Seed};
use lugwheel::scenario::Scenario;
use lugwheel::trace::wheel::Plate;
use lugwheel::trace::{Channel, RunAttributes, Trace};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use tempfile::TempDir;

/// A campaign of `tests/data`, imported as `runs.h5`.
fn imported(campaign: &str) -> TempDir {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(campaign);
    let folder = tempfile::tempdir().unwrap();
    done(lugwheel(
        &folder,
        "import",
        &format!("{} --out runs.h5", path.display()),
    ));
    folder
}

/// A campaign in these words beside this table of means, imported as `runs.h5`.
fn written(campaign: &str, csv: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("campaign.toml"), campaign).unwrap();
    std::fs::write(folder.path().join("means.csv"), csv).unwrap();
    done(lugwheel(&folder, "import", "campaign.toml --out runs.h5"));
    folder
}

fn attributes(folder: &TempDir) -> RunAttributes {
    let file = RunFile::open(folder.path().join("runs.h5")).unwrap();
    file.attributes(&file.runs()[0]).unwrap()
}

fn value(found: &Value, name: &str) -> f64 {
    found["parameters"][name]["value"].as_f64().unwrap()
}

fn is_identified(found: &Value, name: &str) -> bool {
    found["parameters"][name]["identifiable"].as_bool().unwrap()
}

fn reason<'v>(found: &'v Value, name: &str) -> &'v str {
    found["parameters"][name]["reason"].as_str().unwrap()
}

// Of which wheel and load.

#[test]
fn parameters_of_a_lugged_wheel_or_of_one_load_are_effective_ones() {
    let lugged = json(&folder(&campaign()), "--law paper");
    assert!(
        lugged["effective"]
            .as_str()
            .unwrap()
            .contains("24 lugs of 10 mm")
    );
    assert_eq!(lugged["parameters"]["phi"]["effective"], true);
    let said = done(identify(&folder(&campaign()), "--law paper"));
    assert!(
        said.contains("effective, for this wheel and load only"),
        "{said}"
    );
    let smooth = |(id, mut trace): (String, Trace)| {
        (trace.attributes.lug_count, trace.attributes.lug_height) = (Some(0), 0.0);
        (id, trace)
    };
    let smooth: Vec<_> = campaign().into_iter().map(smooth).collect();
    let several_loads = json(&folder(&smooth), "--law paper");
    assert_eq!(several_loads["effective"], Value::Null);
    assert_eq!(several_loads["parameters"]["phi"]["effective"], false);
    let one_load = json(&folder(&smooth[8..16]), "");
    assert!(
        one_load["effective"]
            .as_str()
            .unwrap()
            .contains("one load (109.0 N)")
    );
}

#[test]
fn the_lugged_wheel_of_ding_misses_its_load_by_a_third_and_the_smooth_one_does_not() {
    let found = json(&imported("ding2011/points.toml"), "--law paper");
    let [smooth, lugged] = &found.as_array().unwrap()[..] else {
        panic!("{found}");
    };
    assert!(!warned(smooth, "load_missed") && warned(lugged, "load_missed"));
    for one in [smooth, lugged] {
        assert!(
            one["effective"]
                .as_str()
                .unwrap()
                .contains("one load (80.0 N)")
        );
        // One load does not tell friction from cohesion.
        assert_eq!(one["parameters"]["phi"]["identifiable"], false);
    }
    let warnings = lugged["warnings"].as_array().unwrap();
    let missed = warnings
        .iter()
        .find(|one| one["kind"] == "load_missed")
        .unwrap();
    let message = missed["message"].as_str().unwrap();
    assert!(
        message.contains("deviates by 31 % from the measured load"),
        "{message}"
    );
}

#[test]
fn the_lugged_wheel_of_ding_is_explained_with_its_slip_from_zero_torque_and_not_by_the_rim() {
    let lugged = |campaign: &str| {
        let found = json(&imported(campaign), "--law own --lug-thickness 0.003");
        found[1].clone()
    };
    let by_rim = lugged("ding2011/points.toml");
    assert!(warned(&by_rim, "misfit") && warned(&by_rim, "peak_at_end"));
    for name in ["c1", "c2"] {
        assert!(!is_identified(&by_rim, name));
        assert!(reason(&by_rim, name).contains("end of the contact"));
    }
    let from_torque = lugged("ding2011/points_from_torque.toml");
    assert!(!warned(&from_torque, "misfit") && !warned(&from_torque, "peak_at_end"));
    let pull = &from_torque["force_error_percent"]["drawbar_pull"];
    // 11.7 % by the rim; the points were read off to 5 % of full scale.
    assert!(pull.as_f64().unwrap() < 4.0, "{pull}");
    for name in ["phi", "c", "k_s", "n0"] {
        assert!(!is_identified(&from_torque, name), "{name}");
    }
    // What is presumed of the stress has a rival beside it.
    let other = &from_torque["other_stress"];
    assert_eq!(other["stress"], "triangular");
    assert!(
        other["parameters"]["K"].as_f64().unwrap() > 0.0 && other["reduced_chi_square"].is_number()
    );
    let together = from_torque["combinations"].as_array().unwrap();
    let named = |name| together.iter().any(|one| one["name"] == name);
    assert!(named("c + sigma tan(phi)") && named("k_s z^(n0 + n1 s)"));
}

#[test]
fn loads_that_are_met_are_not_called_missed_and_loads_off_by_a_sixth_are() {
    let mut runs = campaign();
    assert!(!warned(&json(&folder(&runs), "--law paper"), "load_missed"));
    for (number, (_, trace)) in runs.iter_mut().enumerate() {
        *mean(trace, "normal_force") *= [1.17, 0.83][number % 2];
    }
    assert!(warned(&json(&folder(&runs), "--law paper"), "load_missed"));
}

// How well.

#[test]
fn a_cohesion_at_the_end_of_its_search_is_not_identified_but_bounded() {
    let found = json(
        &imported("claims/rashid.toml"),
        "--cylinder lug-tips --known phi=38",
    );
    assert!(!is_identified(&found, "c"));
    assert!(reason(&found, "c").contains("the search ended at 0.01"));
    let ends = &found["parameters"]["c"]["ci95"];
    assert_eq!(ends[0], 0.0);
    assert!(
        (500.0..2000.0).contains(&ends[1].as_f64().unwrap()),
        "{ends}"
    );
    // K ended at its lower end.
    assert!(!is_identified(&found, "K"));
}

#[test]
fn with_a_pull_that_is_not_tared_no_strength_is_identified() {
    let found = json(&imported("inspection/pull_untared.toml"), "");
    for name in ["c", "phi", "K", "k_s", "n0"] {
        assert!(!is_identified(&found, name), "{name}");
        assert!(!reason(&found, name).is_empty());
    }
}

#[test]
fn an_interval_whose_ends_differ_by_ten_or_more_identifies_no_modulus() {
    let mut runs = campaign();
    let precise = json(&folder(&runs), "--law paper");
    for name in ["k_s", "c", "K"] {
        assert!(is_identified(&precise, name), "{name}");
    }
    for (_, trace) in &mut runs {
        for mean in &mut trace.means {
            mean.sd *= 3000.0;
        }
    }
    let vague = json(&folder(&runs), "--law paper");
    for name in ["k_s", "c", "K"] {
        let ends = [0, 1].map(|end| vague["parameters"][name]["ci95"][end].as_f64());
        let spans = match ends {
            [Some(low), Some(high)] => high >= 10.0 * low,
            _ => true,
        };
        assert_eq!(is_identified(&vague, name), !spans, "{name}: {ends:?}");
    }
    assert!(!is_identified(&vague, "c"));
}

// Where a stretch, a channel or a row is missing.

#[test]
fn a_stretch_without_sinkage_is_left_out_and_the_other_two_are_fitted() {
    let gap = imported("claims/gap.toml");
    let found = json(&gap, "--known n0=0.909 --known c=0");
    assert_eq!(found["rows"].as_array().unwrap().len(), 2);
    assert_eq!(found["left_out"], Value::Array(Vec::new()));
    let [stretch] = &found["stretches_left_out"].as_array().unwrap()[..] else {
        panic!("{found}");
    };
    let [from, to] = [0, 1].map(|end| stretch["interval_s"][end].as_f64().unwrap());
    assert!(0.0 < from && from < to && to < 10.0, "{from} {to}");
    assert!(
        stretch["reason"]
            .as_str()
            .unwrap()
            .contains("record the channel or mean sinkage")
    );
    let said = done(identify(&gap, "--known n0=0.909 --known c=0"));
    assert!(
        said.contains("WARNING, 1 stretch left out\nrun run_000000 from"),
        "{said}"
    );
    // Two rows do not fix eight parameters; the reason names the stretch that is missing too.
    refused(&gap, "", 3, &["need 3 rows", "--known", "s: sinkage [m]"]);
}

/// A run of three steady slips whose samples are the closed form's.
fn staircase() -> Trace {
    let steps = [0.1, 0.3, 0.5].map(|slip| run(slip, 109.0));
    let channel = |name: &str, values: [f64; 3]| Channel {
        name: name.to_owned(),
        unit: lugwheel::trace::unit_of(name).unwrap().to_owned(),
        sample_rate: 50.0,
        start: 0.0,
        samples: (0..1500).map(|i| values[i / 500]).collect(),
    };
    let names = ["drawbar_pull", "driving_torque", "normal_force", "sinkage"];
    let of_means = names.map(|name| {
        let values = steps.each_ref().map(|step| step.steady_mean(name).unwrap());
        channel(name, values)
    });
    let slip = channel("slip_ratio", [0.1, 0.3, 0.5]);
    Trace {
        attributes: steps[0].attributes.clone(),
        channels: [&[slip], &of_means[..]].concat(),
        ..Trace::default()
    }
}

#[test]
fn a_gap_in_any_channel_costs_its_stretch_or_less() {
    for (gap, rows, stretches) in [
        ("drawbar_pull", 10, 1),
        ("sinkage", 10, 1),
        // Its command stands for a load that was not measured, and two forces go without a torque.
        ("normal_force", 11, 0),
        ("driving_torque", 11, 0),
    ] {
        let mut trace = staircase();
        let mut channels = trace.channels.iter_mut();
        let channel = channels.find(|channel| channel.name == gap).unwrap();
        channel.samples[500..1000].fill(f64::NAN);
        let mut runs = campaign()[8..16].to_vec();
        runs.push(("staircase".to_owned(), trace));
        let found = json(&folder(&runs), "");
        assert_eq!(found["rows"].as_array().unwrap().len(), rows, "{gap}");
        let left_out = found["stretches_left_out"].as_array().unwrap();
        assert_eq!(left_out.len(), stretches, "{gap}");
        assert_eq!(found["left_out"], Value::Array(Vec::new()), "{gap}");
    }
}

#[test]
fn a_run_without_torque_among_others_counts_with_its_pull_and_load() {
    let mut runs = campaign();
    runs[5].1.means.retain(|mean| mean.name != "driving_torque");
    let found = json(&folder(&runs), "--law paper");
    assert_eq!(found["rows"].as_array().unwrap().len(), 24);
    assert_eq!(found["left_out"], Value::Array(Vec::new()));
    for (name, expected) in [("phi", 29.67), ("n0", 0.8169), ("c", 308.6)] {
        let found = value(&found, name);
        assert!((found / expected - 1.0).abs() < 2e-3, "{name}: {found}");
    }
    // Most without a torque: the stages cannot be fitted, all forces together can.
    for (_, trace) in &mut runs[2..] {
        trace.means.retain(|mean| mean.name != "driving_torque");
    }
    let few = json(&folder(&runs), "--law paper");
    assert_eq!(few["staged"], Value::Null);
    assert!((value(&few, "n0") / 0.8169 - 1.0).abs() < 2e-2);
}

#[test]
fn braking_rows_are_left_out_by_the_option_that_the_warning_names() {
    let runs = imported("claims/grousers.toml");
    let all = json(&runs, "");
    let warnings = all["warnings"].as_array().unwrap();
    let braking = warnings
        .iter()
        .find(|one| one["kind"] == "braking")
        .unwrap();
    assert!(braking["meaning"].as_str().unwrap().contains("--slip 0:1"));
    let driven = json(&runs, "--slip 0:1");
    assert!(!warned(&driven, "braking"));
    let slips = driven["rows"].as_array().unwrap().iter();
    assert!(
        slips
            .map(|row| row["slip"].as_f64().unwrap())
            .all(|slip| slip >= 0.0)
    );
    for (words, part) in [
        ("--slip 0", "LOW:HIGH"),
        ("--slip 0.5:0.1", "above 0.1"),
        ("--slip 0:7", "slip ratio"),
    ] {
        refused(&runs, words, 2, &[part]);
    }
    refused(
        &runs,
        "--slip 0.95:1",
        3,
        &["no row has a slip in --slip 0.95:1"],
    );
}

// Which way is down.

#[test]
fn a_sinkage_that_is_counted_upward_is_refused_by_either_cylinder() {
    let runs = imported("inspection/sinkage_upward.toml");
    for words in ["", "--cylinder lug-tips"] {
        refused(
            &runs,
            words,
            3,
            &["below 0 and falls as slip grows", "scale = -1.0"],
        );
    }
    // The closed form's own sinkages, turned over.
    let mut turned = campaign()[8..16].to_vec();
    turned
        .iter_mut()
        .for_each(|(_, trace)| *mean(trace, "sinkage") *= -1.0);
    refused(&folder(&turned), "", 3, &["counted upward"]);
}

#[test]
fn a_rim_that_its_lugs_hold_above_the_soil_is_still_a_case_for_the_lugs_circle() {
    let mut carried = campaign()[8..16].to_vec();
    // The lug tips sink as the rim did.
    carried
        .iter_mut()
        .for_each(|(_, trace)| *mean(trace, "sinkage") -= 0.030);
    for (_, trace) in &mut carried {
        trace.attributes.lug_height = 0.030;
    }
    refused(
        &folder(&carried),
        "--law paper",
        3,
        &["--cylinder lug-tips"],
    );
    let found = json(&folder(&carried), "--cylinder lug-tips");
    assert_eq!(found["rows"].as_array().unwrap().len(), 8);
}

// On a slope.

/// The closed form's rows as sensors tared on the level read them on a slope: `m g (1 - cos)` more load and `m g sin`
/// less pull than the contact's.
fn on_slope(slope_deg: f64, mass: f64) -> Vec<(String, Trace)> {
    let (sin, cos) = slope_deg.to_radians().sin_cos();
    let mut runs = campaign();
    for (_, trace) in &mut runs {
        *mean(trace, "normal_force") += mass * GRAVITY * (1.0 - cos);
        *mean(trace, "drawbar_pull") -= mass * GRAVITY * sin;
        trace.attributes.slope_deg = slope_deg;
        trace.attributes.wheel_mass = Some(mass);
    }
    runs
}

#[test]
fn the_wheels_own_weight_on_a_slope_does_not_change_the_soil() {
    let level = json(&folder(&campaign()), "");
    for slope_deg in [20.0, -15.0] {
        let found = json(&folder(&on_slope(slope_deg, 4.0)), "");
        for name in ["k_s", "n0", "phi", "c", "K"] {
            let [found, expected] = [&found, &level].map(|found| value(found, name));
            assert!(
                (found / expected - 1.0).abs() < 5e-3,
                "{slope_deg}° {name}: {found}"
            );
        }
    }
}

#[test]
fn the_wheels_own_weight_in_the_forces_of_a_slope_is_not_doubted() {
    let doubted = |runs: &[(String, Trace)]| {
        let inspected = lugwheel(&folder(runs), "inspect", "runs.h5");
        let text = String::from_utf8(inspected.stdout).unwrap();
        text.contains(" drawbar_pull: ")
    };
    let mut uphill = on_slope(20.0, 12.0);
    assert!(!doubted(&uphill));
    uphill
        .iter_mut()
        .for_each(|(_, trace)| trace.attributes.slope_deg = 0.0);
    assert!(doubted(&uphill));
}

#[test]
fn a_slope_without_the_wheels_mass_is_refused_with_the_way_out() {
    let mut runs = on_slope(20.0, 4.0);
    runs.iter_mut()
        .for_each(|(_, trace)| trace.attributes.wheel_mass = None);
    refused(
        &folder(&runs),
        "",
        3,
        &["the track slopes by 20°", "mass_kg"],
    );
}

#[test]
fn a_load_that_was_only_commanded_presses_on_a_slope_by_its_cosine() {
    let mut trace = run(0.2, 109.0);
    trace.means.retain(|mean| mean.name != "normal_force");
    (trace.attributes.slope_deg, trace.attributes.wheel_mass) = (10.0, Some(0.0));
    let row = steady_loads(&trace).unwrap()[0];
    assert!((row.load - 109.0 * 10.0_f64.to_radians().cos()).abs() < 1e-9);
}

#[test]
fn a_campaign_states_its_slope_and_the_wheels_mass() {
    let runs = written(
        "version = 1\n[table]\nfile = \"means.csv\"\nwheel = { radius_m = 0.14, width_m = 0.15, mass_kg = 4.0 }\n\
         slope_deg = { column = \"slope\" }\ncolumns = { drawbar_pull = \"pull\" }\n",
        "slope,pull\n-12.5,3.0\n",
    );
    let found = attributes(&runs);
    assert_eq!((found.slope_deg, found.wheel_mass), (-12.5, Some(4.0)));
}

#[test]
fn a_simulated_slope_is_an_attribute_and_its_steady_load_the_contacts() {
    let root = env!("CARGO_MANIFEST_DIR");
    let scenario = Scenario::load(format!("{root}/scenarios/single_wheel_st.toml")).unwrap();
    let edits = [
        "duration=4",
        "lead_in=4",
        "sensors.output_rate=100",
        "rig.single_wheel.slip=0.2",
    ];
    let scenario = scenario.with_all(&edits).unwrap();
    let sloped = scenario
        .with_all(&["rig.single_wheel.slope_deg=20"])
        .unwrap();
    let go_on = &mut |_| ControlFlow::Continue(());
    let trace = sloped.run(Seed(1), 0, go_on).unwrap();
    assert_eq!(trace.attributes.slope_deg, 20.0);
    let row = steady_loads(&trace).unwrap()[0];
    let carried = 100.0 * 20.0_f64.to_radians().cos();
    assert!((row.load / carried - 1.0).abs() < 5e-3, "{}", row.load);
    // A slope that nobody commanded is a departure, and no attribute tells it.
    let mut hidden = scenario.with_all(&["duration=0.25"]).unwrap();
    hidden
        .effects
        .push("slope=5".parse::<Application>().unwrap());
    let trace = hidden.run(Seed(1), 0, go_on).unwrap();
    assert_eq!(trace.attributes.slope_deg, 0.0);
}

// Plates.

#[test]
fn the_plates_of_carnegie_mellon_give_exponent_and_moduli_for_their_wheel() {
    let plates = imported("cmu-single-wheel/plates.toml");
    let found = json(&plates, "");
    assert_eq!(found["class"], Value::Null);
    let n = &found["parameters"]["n0"];
    let [low, high] = [0, 1].map(|end| n["ci95"][end].as_f64().unwrap());
    assert!(low < 1.46 && 1.46 < high && high - low < 0.3, "{n}");
    let sizes = found["plates"].as_array().unwrap();
    let sizes: Vec<f64> = sizes
        .iter()
        .map(|size| size["diameter_m"].as_f64().unwrap())
        .collect();
    assert_eq!(sizes, [0.06, 0.08, 0.1]);
    assert_eq!(found["known"][0]["option"], "n0=1.459");
    // Passed on as it is printed, to the wheel of the same testbed.
    let wheel = imported("claims/grousers.toml");
    let fitted = json(&wheel, "--slip 0:1 --known n0=1.459");
    assert_eq!(fitted["parameters"]["n0"]["standing"], "given");
    let said = done(identify(&plates, ""));
    assert!(said.contains("\n  --known n0=1.459\n"), "{said}");
}

#[test]
fn sides_of_plates_and_means_row_by_row_part_the_moduli_of_the_wheels_beside_them() {
    let law = |z: f64, b: f64| (2.0e4 / b + 1.5e6) * z.powf(1.1);
    let mut csv = "length,width,sinkage_mm,force_n\n".to_owned();
    for [length, width] in [[0.2, 0.05], [0.1, 0.3]] {
        for millimetres in [5.0, 10.0, 20.0, 30.0] {
            let force = law(1.0e-3 * millimetres, f64::min(length, width)) * length * width;
            csv.push_str(&format!("{length},{width},{millimetres},{force}\n"));
        }
    }
    let plates = written(
        "version = 1\n[table]\nfile = \"means.csv\"\nplate_length_m = { column = \"length\" }\n\
         plate_width_m = { column = \"width\" }\nterrain = \"ST\"\n\
         columns = { sinkage = { column = \"sinkage_mm\", unit = \"mm\" }, normal_force = \"force_n\" }\n",
        &csv,
    );
    let found = json(&plates, "");
    for (name, expected) in [("n0", 1.1), ("k_c", 2.0e4), ("k_phi", 1.5e6)] {
        let found = value(&found, name);
        assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found}");
    }
    write(&plates.path().join("wheels.h5"), &campaign());
    let together = json(&plates, "wheels.h5");
    let [wheel, of_plates] = &together.as_array().unwrap()[..] else {
        panic!("{together}");
    };
    assert_eq!(
        (&wheel["class"], &of_plates["class"]),
        (&"LEIS".into(), &Value::Null)
    );
    let k_s = &of_plates["known"][1];
    assert_eq!(k_s["wheel_width_m"], wheel["wheel"]["width_m"]);
    // 2e4/0.15 + 1.5e6.
    assert_eq!(k_s["option"], "k_s=1.633e6");
}

#[test]
fn a_plate_of_one_size_gives_its_modulus_and_a_plate_without_force_its_reason() {
    let trace = |sinkages: &[f64], sign: f64| {
        let force: Vec<f64> = sinkages.iter().map(|z| sign * 8.0e3 * z).collect();
        let channel = |name: &str, samples: Vec<f64>| Channel {
            name: name.to_owned(),
            unit: lugwheel::trace::unit_of(name).unwrap().to_owned(),
            sample_rate: 10.0,
            start: 0.0,
            samples,
        };
        Trace {
            attributes: RunAttributes {
                plate: Some(Plate::Disc { diameter: 0.1 }),
                ..RunAttributes::default()
            },
            channels: vec![
                channel("sinkage", sinkages.to_vec()),
                channel("normal_force", force),
            ],
            ..Trace::default()
        }
    };
    let down: Vec<f64> = (1..80).map(|i| 5.0e-4 * f64::from(i)).collect();
    let found = json(&folder(&[("p".to_owned(), trace(&down, 1.0))]), "");
    // Channels are stored in single precision.
    assert!((value(&found, "n0") - 1.0).abs() < 1e-6);
    assert_eq!(found["intervals_from"], "parts");
    let area = 0.25 * std::f64::consts::PI * 0.01;
    let k = found["plates"][0]["k"]["value"].as_f64().unwrap();
    assert!((k / (8.0e3 / area) - 1.0).abs() < 1e-5, "{k}");
    let turned = folder(&[("p".to_owned(), trace(&down, -1.0))]);
    refused(
        &turned,
        "",
        3,
        &["each with sinkage and pressure above 0", "signs"],
    );
    let mut wheelless = trace(&down, 1.0);
    wheelless.channels.remove(1);
    refused(
        &folder(&[("p".to_owned(), wheelless)]),
        "",
        3,
        &["normal_force is missing"],
    );
    let mut unstated = trace(&down, 1.0);
    (unstated.attributes.plate, unstated.attributes.load) = (None, f64::NAN);
    refused(
        &folder(&[("p".to_owned(), unstated)]),
        "",
        3,
        &[
            "drawbar_pull is missing",
            "plate test, state plate_diameter_m",
        ],
    );
}

// How many lugs.

#[test]
fn lugs_that_nobody_counted_are_not_no_lugs() {
    let runs = imported("claims/grousers.toml");
    let found = json(&runs, "--slip 0:1");
    assert_eq!(found["wheel"]["lug_count"], Value::Null);
    assert_eq!(found["wheel"]["lug_height_m"], 0.005);
    assert!(
        found["effective"]
            .as_str()
            .unwrap()
            .contains("lugs of 5 mm, count not given")
    );
    let inspected = lugwheel(&runs, "inspect", "runs.h5");
    let inspected = String::from_utf8(inspected.stdout).unwrap();
    assert!(
        inspected.contains("lugs of 5 mm, count not given"),
        "{inspected}"
    );
    assert!(!inspected.contains("one of them is wrong"), "{inspected}");
    let recognized = lugwheel(&runs, "recognize", "runs.h5");
    let recognized = String::from_utf8(recognized.stderr).unwrap();
    assert!(recognized.contains("count not given"), "{recognized}");
}

#[test]
fn a_campaign_tells_a_smooth_wheel_from_an_unknown_one() {
    let lugs = |wheel: &str| {
        let campaign = format!(
            "version = 1\n[table]\nfile = \"means.csv\"\nwheel = {{ radius_m = 0.14, width_m = 0.15{wheel} }}\n\
             columns = {{ drawbar_pull = \"pull\" }}\n"
        );
        attributes(&written(&campaign, "pull\n3.0\n"))
            .lugs()
            .to_string()
    };
    assert_eq!(lugs(""), "lugs not given");
    assert_eq!(
        lugs(", lug_height_m = 0.005"),
        "lugs of 5 mm, count not given"
    );
    assert_eq!(lugs(", lug_height_m = 0.0"), "no lugs");
    assert_eq!(lugs(", lug_count = 0"), "no lugs");
    assert_eq!(lugs(", lug_count = 12"), "12 lugs, height not given");
}

#[test]
fn a_file_of_an_earlier_version_has_0_lugs_of_some_height_where_it_is_unknown() {
    let mut runs = campaign();
    runs.truncate(1);
    (
        runs[0].1.attributes.lug_count,
        runs[0].1.attributes.lug_height,
    ) = (None, 0.005);
    let folder = folder(&runs);
    let path = folder.path().join("runs.h5");
    let file = opened_for_editing(&path);
    let group = file.group("runs/p00").unwrap();
    assert!(group.attr("lug_count").is_err());
    let attribute = group.new_attr::<u32>().create("lug_count").unwrap();
    attribute.write_scalar(&0_u32).unwrap();
    file.close().unwrap();
    assert_eq!(
        attributes(&folder).lugs().to_string(),
        "lugs of 5 mm, count not given"
    );
}
