//! Every shipped scenario is sound, and every unsound one says what is wrong and where.

use lugwheel::scenario::{Scenario, ScenarioError};
use lugwheel::simulation::rig::Rig;
use lugwheel::terrain::TerrainSpec;
use lugwheel::wheel::Wheel;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

fn toml_files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    files.sort();
    files
}

fn shipped(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    Scenario::load(folder.join(format!("{name}.toml"))).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shipped_scenario_loads_and_comes_back_from_its_own_toml() {
    let files = toml_files("scenarios");
    assert_eq!(files.len(), 12);
    for file in files {
        let scenario = Scenario::load(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scenario.text(), std::fs::read_to_string(&file).unwrap());
        let written = scenario.to_toml();
        let again = Scenario::from_toml(&written, "written").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(again.terrain, scenario.terrain, "{}", file.display());
        assert_eq!(again.wheel, scenario.wheel, "{}", file.display());
        assert_eq!(again.rig, scenario.rig, "{}", file.display());
        assert_eq!(again.to_toml(), written, "{}", file.display());
    }
}

#[test]
fn the_papers_wheels_loads_and_speeds_are_in_the_files() {
    for terrain in ["ref", "ht", "gt", "hgt", "st", "sgt"] {
        let scenario = shipped(&format!("single_wheel_{terrain}"));
        assert_eq!(scenario.wheel, Wheel::single_wheel());
        assert_eq!(scenario.rig.load(), 100.0);
        assert_eq!(scenario.rig.drive().forward_speed, 0.014);
        assert_eq!(scenario.window(), 15.0);
    }
    for terrain in ["ref", "ht", "gt", "st"] {
        let scenario = shipped(&format!("rover_{terrain}"));
        assert_eq!(scenario.wheel, Wheel::rover());
        // 29 kg in standard gravity, rounded to 0.1 N.
        assert!((scenario.rig.load() - 29.0 * 9.80665).abs() < 0.05);
        assert!(matches!(scenario.rig, Rig::RoverLeg(_)));
    }
}

#[test]
fn the_traverse_spends_seven_of_21_windows_on_each_ground() {
    let traverse = shipped("traverse");
    assert_eq!(traverse.duration / traverse.window(), 21.0);
    let TerrainSpec::Sequence(sections) = &traverse.terrain else {
        panic!("the traverse is a sequence");
    };
    assert_eq!(sections.len(), 3);
    for section in sections {
        let seconds = section.length / traverse.rig.drive().forward_speed;
        assert!((seconds - 105.0).abs() < 1e-9, "{seconds}");
    }
    // The same grounds and leg as in the files of each alone.
    for (section, name) in sections.iter().zip(["rover_st", "rover_ht", "rover_gt"]) {
        assert_eq!(section.ground, shipped(name).terrain, "{name}");
        // The wheel turns at one speed on all of them.
        let mut rig = shipped(name).rig;
        rig.drive_mut().slip = traverse.rig.drive().slip;
        assert_eq!(traverse.rig, rig, "{name}");
    }
}

/// The message after `#^ `, and the number of the line above it.
fn stated_fault(text: &str) -> (usize, &str) {
    let mut lines = text.lines().enumerate();
    lines
        .find_map(|(index, line)| line.strip_prefix("#^ ").map(|message| (index, message)))
        .expect("a bad scenario states its message")
}

#[test]
fn every_bad_scenario_gives_the_message_it_states_at_the_line_it_states() {
    let files = toml_files("tests/scenarios/bad");
    assert!(files.len() >= 15);
    let wrong: Vec<String> = files
        .iter()
        .filter_map(|file| unlike_stated(file))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// How a bad scenario's error differs from the one it states.
fn unlike_stated(file: &Path) -> Option<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let (line, message) = stated_fault(&text);
    match Scenario::load(file) {
        Err(ScenarioError::Invalid(fault)) => {
            let like = fault.line == line && fault.message.contains(message);
            (!like).then(|| format!("line {line}: {message}\nis not\n{fault}"))
        }
        _ => Some(format!("{} is not refused as invalid", file.display())),
    }
}

#[test]
fn a_bad_scenario_is_sound_without_its_fault() {
    // Otherwise a file could be refused for another reason than the one it is there for.
    let file = "tests/scenarios/bad/radius_in_millimetres.toml";
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let repaired = text.replace("radius = 140", "radius = 0.14");
    Scenario::from_toml(&repaired, file).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn an_error_shows_the_file_the_line_and_a_caret_under_the_value() {
    let text = shipped("quick")
        .text()
        .replace("load = 100.0 ", "load = -1.00 ");
    let error = Scenario::from_toml(&text, "quick.toml")
        .unwrap_err()
        .to_string();
    let line = 1 + text
        .lines()
        .position(|line| line.starts_with("load"))
        .unwrap();
    let shown: Vec<&str> = error.lines().collect();
    assert_eq!(
        shown[0],
        format!("quick.toml:{line}:8: load [N] must be above 0 and finite, got -1")
    );
    assert!(
        shown[2].starts_with(&format!("{line} | load = -1.00 ")),
        "{error}"
    );
    assert_eq!(shown[3], "   |        ^^^^^");
}

#[test]
fn a_missing_file_is_named() {
    let error = Scenario::load("scenarios/moon.toml").unwrap_err();
    assert_eq!(
        error.to_string(),
        "cannot read scenario scenarios/moon.toml"
    );
    assert!(std::error::Error::source(&error).is_some());
}

#[test]
fn a_number_with_a_unit_is_refused_with_the_unit_of_its_key() {
    let scenario = shipped("quick");
    for (assignment, reason) in [
        (
            "rig.single_wheel.load=100N",
            "it is a number without its unit, here in N: rig.single_wheel.load=100",
        ),
        (
            "rig.single_wheel.slip=30 %",
            "it is a number without its unit, here a ratio: rig.single_wheel.slip=0.3",
        ),
        (
            "rig.single_wheel.load=0.1kN",
            "it is a number without its unit, here in N: convert 0.1kN first",
        ),
    ] {
        let refused = scenario.with(assignment).unwrap_err().to_string();
        assert!(refused.ends_with(reason), "{refused}");
    }
    assert!(scenario.with("rig.single_wheel.load=1.2e2").is_ok());
}

#[test]
fn a_key_set_on_the_command_line_is_in_the_experiment_and_in_the_recorded_text() {
    let edited = shipped("single_wheel_st")
        .with("rig.single_wheel.slip=0.3")
        .and_then(|scenario| scenario.with("wheel.lugs.count = 24"))
        .and_then(|scenario| scenario.with("physics_rate=32000"))
        .and_then(|scenario| scenario.with("terrain.sand.soil.convention=triangular"))
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(edited.rig.drive().slip.unwrap().get(), 0.3);
    assert_eq!(edited.wheel.lug_count(), 24);
    assert_eq!(edited.physics_rate().hertz(), 32000.0);
    let recorded = Scenario::from_toml(edited.text(), "recorded").unwrap();
    assert_eq!(recorded.to_toml(), edited.to_toml());
    assert!(
        edited.text().contains("# Dry sand of Ding"),
        "the comments stay"
    );
}

#[test]
fn every_key_promised_for_set_can_be_set() {
    for (name, rig) in [
        ("single_wheel_ht", "single_wheel"),
        ("rover_gt", "rover_leg"),
    ] {
        for assignment in [
            "duration=5".to_owned(),
            "physics_rate=64000".to_owned(),
            format!("rig.{rig}.forward_speed=0.02"),
            format!("rig.{rig}.slip=-0.2"),
            format!("rig.{rig}.load=150"),
            "wheel.lugs.count=0".to_owned(),
            "wheel.lugs.height=0.02".to_owned(),
        ] {
            shipped(name)
                .with(&assignment)
                .unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

#[test]
fn an_unknown_key_set_on_the_command_line_is_told_its_neighbours() {
    let message = |assignment| {
        shipped("rover_ht")
            .with(assignment)
            .unwrap_err()
            .to_string()
    };
    let typo = message("rig.rover_leg.slop=0.3");
    assert!(typo.contains("did you mean `slip`?"), "{typo}");
    let other_rig = message("rig.single_wheel.slip=0.3");
    assert!(other_rig.contains("`rig.rover_leg.slip`"), "{other_rig}");
    let no_value = message("duration");
    assert!(no_value.contains("write key=value"), "{no_value}");
    let out_of_range = message("rig.rover_leg.load=-5");
    assert!(out_of_range.starts_with("/"), "{out_of_range}");
    assert!(
        out_of_range.contains("with rig.rover_leg.load=-5:"),
        "{out_of_range}"
    );
}

#[test]
fn the_most_demanding_ground_of_a_track_sets_its_default_rate() {
    assert_eq!(shipped("single_wheel_st").physics_rate().hertz(), 16_000.0);
    assert_eq!(shipped("single_wheel_sgt").physics_rate().hertz(), 8_000.0);
    assert_eq!(shipped("traverse").physics_rate().hertz(), 16_000.0);
}

static TEXTS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let files = toml_files("scenarios");
    files
        .iter()
        .map(|file| std::fs::read_to_string(file).unwrap())
        .collect()
});

/// Pieces that mean something in a scenario file.
const PIECES: [&str; 20] = [
    "=",
    "[",
    "]",
    "{",
    "}",
    ".",
    "\"",
    "'''",
    "#",
    "\n",
    "\r",
    "\t",
    "°",
    "-1",
    "nan",
    "inf",
    "1e400",
    "99999999999999999999",
    "[[terrain.sequence]]",
    "slip = 1",
];

#[derive(Debug, Clone)]
enum Mutation {
    Cut(usize, usize),
    Insert(usize, usize),
    DoubleLine(usize),
    DropLine(usize),
    SwapLines(usize, usize),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let any = 0..100_000_usize;
    prop_oneof![
        (any.clone(), 0..30_usize).prop_map(|(at, length)| Mutation::Cut(at, length)),
        (any.clone(), any.clone()).prop_map(|(at, piece)| Mutation::Insert(at, piece)),
        any.clone().prop_map(Mutation::DoubleLine),
        any.clone().prop_map(Mutation::DropLine),
        (any.clone(), any).prop_map(|(a, b)| Mutation::SwapLines(a, b)),
    ]
}

fn mutate(text: &str, mutation: &Mutation) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    let mut lines: Vec<&str> = text.lines().collect();
    let place = |at: usize| at % (letters.len() + 1);
    let rows = lines.len().max(1);
    let row = |at: usize| at % rows;
    match *mutation {
        _ if lines.is_empty() => return text.to_owned(),
        Mutation::Cut(at, length) => {
            let start = place(at);
            letters.drain(start..(start + length).min(letters.len()));
            return letters.into_iter().collect();
        }
        Mutation::Insert(at, piece) => {
            let start = place(at);
            letters.splice(start..start, PIECES[piece % PIECES.len()].chars());
            return letters.into_iter().collect();
        }
        Mutation::DoubleLine(at) => lines.insert(row(at), lines[row(at)]),
        Mutation::DropLine(at) => drop(lines.remove(row(at))),
        Mutation::SwapLines(a, b) => lines.swap(row(a), row(b)),
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_mutilated_scenario_is_read_or_refused_but_never_panics(
        which in 0..12_usize,
        mutations in prop::collection::vec(mutation(), 1..5),
        key in prop::sample::select(vec!["rig.single_wheel.slip=0.3", "wheel.lugs.x=1", "a.b.c=\"\"", "sensors=1"]),
    ) {
        let text = mutations.iter().fold(TEXTS[which].clone(), |text, m| mutate(&text, m));
        match Scenario::from_toml(&text, "mutilated.toml") {
            Err(error) => prop_assert!(error.to_string().starts_with("mutilated.toml:")),
            Ok(scenario) => {
                let again = Scenario::from_toml(&scenario.to_toml(), "again");
                prop_assert!(again.is_ok(), "{}", again.unwrap_err());
                let _ = scenario.with(key).map_err(|error| error.to_string());
            }
        }
    }

    #[test]
    fn an_assignment_is_applied_or_refused_but_never_panics(
        which in 0..12_usize,
        assignment in "[a-z_.0-9=\\[\\]{}\"'# \n°-]{0,40}",
    ) {
        let scenario = Scenario::from_toml(&TEXTS[which], "good.toml").unwrap();
        let _ = scenario.with(&assignment).map_err(|error| error.to_string());
    }
}

#[test]
fn departures_of_wheel_drive_and_frame_are_keys_like_others_and_come_back() {
    let flawed = shipped("single_wheel_st")
        .with_all(&[
            "wheel.flaws.eccentricity=0.001",
            "rig.single_wheel.drive_flaws.cogging=0.02",
            "rig.single_wheel.frame_flaws.friction=2",
        ])
        .unwrap();
    assert_eq!(flawed.wheel.flaws.eccentricity, 0.001);
    assert_eq!(flawed.rig.drive().flaws.cogging, 0.02);
    assert_eq!(flawed.rig.frame().friction, 2.0);
    let again = Scenario::from_toml(&flawed.to_toml(), "again").unwrap();
    assert_eq!((again.wheel, again.rig), (flawed.wheel, flawed.rig));
    let error = flawed.with("wheel.flaws.eccentricity=0.1").unwrap_err();
    assert!(
        error.to_string().contains("wheel eccentricity [m]"),
        "{error}"
    );
}
