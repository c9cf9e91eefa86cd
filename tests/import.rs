//! Measured campaigns: what CSV files say is in the run file, and what is wrong is said.

use lugwheel::dataset::Provenance;
use lugwheel::dataset::csv::{Campaign, CampaignError};
use lugwheel::dataset::hdf5::{RunFile, RunFileWriter};
use lugwheel::dataset::inspection::{Inspection, Severity, inspect};
use lugwheel::quantity::GRAVITY;
use lugwheel::terrain::class::{TerrainLabel, Wtic};
use lugwheel::trace::{Mean, Trace};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(path)
}

/// Imports a campaign of `tests` and opens what was written, in a folder that lives as long.
pub fn imported(campaign: &str) -> (TempDir, RunFile) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("runs.h5");
    let campaign = Campaign::load(at(campaign)).unwrap();
    let mut writer = RunFileWriter::create(&out, &Provenance::measured()).unwrap();
    for run in campaign.runs() {
        let (id, trace) = run.unwrap_or_else(|error| panic!("{error}"));
        writer.add(&id, &trace).unwrap();
    }
    writer.finish().unwrap();
    let file = RunFile::open(&out).unwrap();
    (folder, file)
}

fn read(file: &RunFile) -> Vec<Trace> {
    let ids = file.runs().iter();
    ids.map(|id| file.read(id).unwrap()).collect()
}

fn mean<'t>(trace: &'t Trace, name: &str) -> &'t Mean {
    let found = trace.means.iter().find(|mean| mean.name == name);
    found.unwrap_or_else(|| panic!("no mean {name}"))
}

/// Equal to the six digits of single precision.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1.0e-6 * b.abs().max(1.0e-3)
}

/// Findings that are more than a remark.
pub fn doubts(inspection: &Inspection) -> Vec<String> {
    let found = inspection.findings.iter();
    let doubts = found.filter(|finding| finding.severity > Severity::Info);
    doubts.map(ToString::to_string).collect()
}

#[test]
fn a_time_series_has_its_units_offsets_signs_gaps_and_condition() {
    let (_folder, file) = imported("campaigns/sound.toml");
    assert_eq!(file.provenance().scenario, None);
    assert_eq!(file.provenance().seed, None);
    let trace = file.read("first").unwrap();
    let samples = |name| &trace.channel(name).unwrap().samples;
    let force = trace.channel("normal_force").unwrap();
    assert_eq!(
        (force.unit.as_str(), force.sample_rate, force.start),
        ("N", 50.0, 0.0)
    );
    assert!(close(force.samples[0], 100.1) && force.samples.len() == 4);
    let acceleration = samples("acceleration_y");
    assert!((acceleration[0] - 0.001 * GRAVITY).abs() < 1.0e-8);
    assert!(acceleration[2].is_nan() && acceleration[3] == 0.0);
    assert!(close(samples("driving_torque")[0], -5.1));
    let condition = &trace.attributes;
    assert_eq!(
        (condition.wheel_radius, condition.wheel_width),
        (0.14, 0.15)
    );
    assert_eq!(
        (condition.lug_count, condition.lug_height),
        (Some(28), 0.015)
    );
    assert_eq!(
        (condition.load, condition.speed, condition.slip_ratio),
        (100.0, 0.014, 0.1)
    );
    assert_eq!(condition.terrain, Some(TerrainLabel::Sand));
    assert_eq!(condition.class, Some(Wtic::Leis));
    assert_eq!(
        (condition.repeat, condition.day.as_str()),
        (2, "2023-05-01")
    );
    assert_eq!(
        (condition.notes.as_str(), condition.physics_rate),
        ("damp", None)
    );
}

#[test]
fn rows_can_be_picked_and_other_channels_come_along_and_the_unknown_is_no_number() {
    let (_folder, file) = imported("campaigns/sound.toml");
    assert_eq!(
        file.runs(),
        ["first", "run_000001", "run_000002", "run_000003"]
    );
    let trace = file.read("run_000001").unwrap();
    let battery = trace.channel("battery").unwrap();
    assert_eq!(
        (battery.unit.as_str(), &battery.samples[..]),
        ("V", &[2.0, 2.0][..])
    );
    let condition = &trace.attributes;
    let unknown = [
        condition.wheel_radius,
        condition.load,
        condition.speed,
        condition.slip_ratio,
    ];
    assert!(unknown.iter().all(|x| x.is_nan()), "{condition:?}");
    assert_eq!((condition.terrain, condition.lug_count), (None, None));
}

#[test]
fn a_row_of_means_is_a_run_and_a_missing_mean_is_missing_and_told() {
    let (_folder, file) = imported("campaigns/sound.toml");
    let trace = file.read("run_000002").unwrap();
    let pull = mean(&trace, "drawbar_pull");
    assert_eq!(
        (pull.value, pull.sd, pull.n, pull.unit.as_str()),
        (10.0, 0.5, 100, "N")
    );
    assert!(close(trace.attributes.slip_ratio, 0.1));
    assert_eq!(
        (trace.attributes.lug_count, trace.attributes.notes.as_str()),
        (Some(28), "a")
    );
    let bare = file.read("run_000003").unwrap();
    assert!(bare.means.is_empty() && bare.channels.is_empty());
    assert!(close(bare.attributes.slip_ratio, 0.2));
    let campaign = Campaign::load(at("campaigns/sound.toml")).unwrap();
    campaign.runs().for_each(|run| drop(run.unwrap()));
    let gaps: Vec<String> = campaign.gaps().iter().map(ToString::to_string).collect();
    let place = "means.csv:4: column \"pull_N\" holds nothing, which counts as not measured";
    assert!(gaps.iter().any(|gap| gap.ends_with(place)), "{gaps:?}");
}

#[test]
fn the_points_of_ding_are_read_as_published() {
    let (_folder, file) = imported("data/ding2011/points.toml");
    let runs = read(&file);
    assert_eq!(runs.len(), 12);
    let lugged = &runs[11];
    let condition = &lugged.attributes;
    assert_eq!(
        (condition.wheel_radius, condition.wheel_width),
        (0.15735, 0.165)
    );
    assert_eq!(
        (condition.lug_count, condition.lug_height),
        (Some(30), 0.010)
    );
    assert_eq!((condition.load, condition.slip_ratio), (80.0, 0.6));
    assert_eq!(condition.notes, "ding2011_lug10_w80");
    let pull = mean(lugged, "drawbar_pull");
    assert!(
        pull.value == 24.5 && pull.sd == 0.6 && pull.n == 0,
        "read off a figure, to 5 % of full scale"
    );
    assert_eq!(mean(lugged, "sinkage").value, 0.027);
    assert_eq!(mean(lugged, "driving_torque").value, 7.2);
    assert_eq!(runs[5].attributes.lug_count, Some(0), "the smooth wheel");
    let doubts = doubts(&inspect(&file));
    let [torque_free] = &doubts[..] else {
        panic!("{doubts:?}");
    };
    assert!(
        torque_free.contains("slip_zero"),
        "the lugged wheel has no torque at slip 0: {torque_free}"
    );
}

#[test]
fn the_wrong_command_in_the_carnegie_mellon_runs_is_found_and_nothing_else() {
    let (_folder, file) = imported("data/cmu-single-wheel/smooth_wheel_runs.toml");
    let runs = read(&file);
    assert_eq!(runs.len(), 27);
    let locked = &runs[0];
    assert_eq!(
        (locked.attributes.slip_ratio, locked.attributes.repeat),
        (-1.0, 1)
    );
    let sinkage = mean(locked, "sinkage");
    assert!(close(sinkage.value, 0.0501221) && (sinkage.sd - 1.51e-5).abs() < 1e-12);
    assert_eq!(mean(locked, "drawbar_pull").value, -38.1885);
    let doubts = doubts(&inspect(&file));
    assert_eq!(doubts.len(), 3, "{doubts:#?}");
    for (doubt, run) in doubts
        .iter()
        .zip(["run_000015", "run_000016", "run_000017"])
    {
        let commanded = format!("{run} slip_ratio: commanded slip 0.1667 (rim at 12 mm/s)");
        assert!(doubt.contains(&commanded), "{doubt}");
        assert!(
            doubt.ends_with("commanded value incorrect? use the measured value"),
            "{doubt}"
        );
    }
}

#[test]
fn the_plates_are_nine_series_of_force_and_sinkage_without_a_wheel() {
    let (_folder, file) = imported("data/cmu-single-wheel/plates.toml");
    let runs = read(&file);
    let lengths = runs
        .iter()
        .map(|run| run.channel("sinkage").unwrap().samples.len());
    assert_eq!(
        lengths.collect::<Vec<_>>(),
        [220, 199, 223, 197, 304, 208, 307, 194, 231]
    );
    let force = runs[0].channel("normal_force").unwrap();
    assert_eq!((force.sample_rate, force.start), (20.0, 0.01));
    assert!(close(force.samples[2], 0.7118));
    assert!(close(
        runs[0].channel("sinkage").unwrap().samples[2],
        4.875e-4
    ));
    assert_eq!(doubts(&inspect(&file)), [""; 0]);
}

#[test]
fn every_zero_offset_of_the_carnegie_mellon_sensor_is_found() {
    let (_folder, file) = imported("data/cmu-single-wheel/ft_zero_offsets.toml");
    let first = file.read("run_000000").unwrap();
    let force = mean(&first, "sensor_force_y");
    assert_eq!((force.value, force.sd, force.n), (41.806, 0.2002, 1163));
    assert_eq!(first.attributes.day, "3-11-21");
    let doubts = doubts(&inspect(&file));
    // 23 recordings of three forces and three torques; the temperature has no zero.
    assert_eq!(doubts.len(), 23 * 6);
    let expected = "run_000000 sensor_force_y: reads 41.81 N (noise 0.2002) without load";
    assert!(
        doubts.iter().any(|doubt| doubt.contains(expected)),
        "{doubts:#?}"
    );
}

#[test]
fn the_campaign_in_the_guide_is_one() {
    let page = fs::read_to_string(at("../src/guide/measured_data.md")).unwrap();
    let after = page.split("<!-- campaign -->\n```toml\n").nth(1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("campaign.toml", after.split("```").next().unwrap());
    write(
        "run_01.csv",
        "t,Fz_N,az,Mx_Nmm\n0.0,100,1.1,-5000\n0.1,101,0.9,-5000\n",
    );
    write(
        "means.csv",
        "slip [%],Fx [kN],sd [kN],samples\n30,0.02,0.001,500\n",
    );
    let campaign = Campaign::load(folder.path().join("campaign.toml")).unwrap();
    let runs = campaign.runs().map(|run| run.unwrap().1);
    let [series, steady] = &runs.collect::<Vec<_>>()[..] else {
        panic!("two runs")
    };
    let torque = &series.channel("driving_torque").unwrap().samples;
    assert!(torque.iter().all(|torque| close(*torque, 5.0)));
    let acceleration = &series.channel("acceleration_y").unwrap().samples;
    assert!(close(acceleration[0], 0.1 * GRAVITY));
    let pull = mean(steady, "drawbar_pull");
    assert!(close(pull.value, 20.0) && close(pull.sd, 1.0) && pull.n == 500);
    assert!(close(steady.attributes.slip_ratio, 0.3));
}

fn bad_campaigns() -> Vec<PathBuf> {
    let entries = fs::read_dir(at("campaigns/bad")).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The first error of a campaign, at its reading or at one of its runs.
fn first_error(file: &Path) -> Option<CampaignError> {
    match Campaign::load(file) {
        Ok(campaign) => campaign.runs().find_map(Result::err),
        Err(error) => Some(error),
    }
}

/// How a bad campaign's error differs from the one it states.
fn unlike_stated(file: &Path) -> Option<String> {
    let text = fs::read_to_string(file).unwrap();
    let stated = |(index, line): (usize, &'_ str)| {
        let message = line.strip_prefix("#^ ")?;
        Some((index, message.to_owned()))
    };
    let (line, message) = text
        .lines()
        .enumerate()
        .find_map(stated)
        .expect("a message");
    match first_error(file) {
        Some(CampaignError::Invalid(fault)) => {
            let like = fault.line == line && fault.message.contains(&message);
            (!like).then(|| format!("line {line}: {message}\nis not\n{fault}"))
        }
        other => Some(format!("{}: {other:?}", file.display())),
    }
}

#[test]
fn every_bad_campaign_gives_the_message_it_states_at_the_line_it_states() {
    let files = bad_campaigns();
    assert!(files.len() >= 45);
    let wrong: Vec<String> = files
        .iter()
        .filter_map(|file| unlike_stated(file))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_campaign_that_is_not_there_is_named() {
    let error = Campaign::load("moon.toml").unwrap_err();
    assert_eq!(error.to_string(), "cannot read campaign moon.toml");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_cells_become_a_run_or_a_reason_that_names_the_campaign(
        cells in prop::collection::vec(("[-0-9.eNa\",;# ]{0,6}", "[-0-9.eINfa ]{0,8}"), 0..12),
        times in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let rows = cells.iter().enumerate().map(|(i, (t, f))| match times {
            true => format!("{i},{f}\n"),
            false => format!("{t},{f}\n"),
        });
        fs::write(folder.path().join("a.csv"), format!("t,F\n{}", rows.collect::<String>())).unwrap();
        let campaign = folder.path().join("a.toml");
        let columns = "columns = { time_s = \"t\", drawbar_pull = \"F\" }";
        fs::write(&campaign, format!("version = 1\n[[run]]\nfile = \"a.csv\"\n{columns}\n")).unwrap();
        let read = Campaign::load(&campaign).unwrap().runs().next().unwrap();
        match read {
            Ok((_, trace)) => {
                let channel = trace.channel("drawbar_pull").unwrap();
                prop_assert!(channel.samples.len() >= 2 && channel.sample_rate > 0.0);
            }
            Err(error) => prop_assert!(error.to_string().contains("a.toml:")),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_mutilated_campaign_is_read_or_refused_but_never_panics(
        cuts in prop::collection::vec((0..2_000_usize, 0..12_usize, "[-a-z0-9\"{}=,.\n°]{0,6}"), 1..4),
    ) {
        let sound = fs::read_to_string(at("campaigns/sound.toml")).unwrap();
        let mut letters: Vec<char> = sound.chars().collect();
        for (start, length, instead) in cuts {
            let start = start % letters.len();
            let end = (start + length).min(letters.len());
            letters.splice(start..end, instead.chars());
        }
        let folder = tempfile::tempdir().unwrap();
        for name in ["sound.csv", "means.csv"] {
            fs::copy(at("campaigns").join(name), folder.path().join(name)).unwrap();
        }
        let campaign = folder.path().join("a.toml");
        fs::write(&campaign, letters.into_iter().collect::<String>()).unwrap();
        if let Some(error) = first_error(&campaign) {
            prop_assert!(error.to_string().contains("a.toml:"));
        }
    }
}
