//! The `[recognition]` of a study file: methods and reference of the recognition.

use super::group::swept;
use super::{RandomNumbers, Reading, Study, in_one_line};
use crate::document::Misfit;
use crate::features::{Settings, Window};
use crate::recognition::Method;
use crate::recognition::confusion::Confusion;
use crate::scenario::Scenario;
use crate::terrain::class::TerrainLabel;
use serde::Deserialize;
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

/// A `[recognition]` before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RecognitionTable {
    methods: Option<Vec<Method>>,
    reference: Option<PathBuf>,
    #[serde(default)]
    settings: Settings,
    published: Option<PublishedTable>,
    baseline: Option<BaselineTable>,
}

/// Published counts of the answers ALCT, SLCT, LEIS and UWTIC, by true class.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "UPPERCASE")]
struct PublishedTable {
    alct: [u64; 4],
    slct: [u64; 4],
    leis: [u64; 4],
}

/// The baseline of a study.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BaselineTable {
    key: String,
}

/// How the windows of a study are recognised.
#[derive(Debug, Clone)]
pub(super) struct Recognition {
    pub(super) methods: Vec<Method>,
    settings: Settings,
    /// Whether the windows are those of the scenario.
    scenario_window: bool,
    pub(super) reference: Option<ReferenceRuns>,
    pub(super) published: Option<Confusion>,
    /// The swept key of which the baseline is tested on values new to it.
    pub(super) baseline: Option<String>,
}

/// The runs on reference ground, one for all conditions that edit its scenario alike.
#[derive(Debug, Clone)]
pub(super) struct ReferenceRuns {
    scenario: Scenario,
    /// The first condition with each run.
    first_conditions: Vec<u64>,
    of_condition: Vec<usize>,
}

impl RecognitionTable {
    /// Checks the table against a study that is sound without it.
    pub(super) fn read(self, file: &Reading) -> Result<Recognition, Misfit> {
        let methods = self
            .methods
            .unwrap_or(vec![Method::Paper, Method::Improved]);
        check_methods(&methods).map_err(file.at("recognition.methods"))?;
        self.settings.check().map_err(|error| Misfit {
            place: file.document.place_of("recognition.settings", &error),
            message: error.to_string(),
        })?;
        let reference = self.reference.map(|path| {
            let scenario = file.folder.scenario(&path)?;
            ReferenceRuns::new(file.study, scenario)
        });
        let baseline = self
            .baseline
            .map(|BaselineTable { key }| check_baseline(file.study, &key).map(|()| key));
        let window = file.document.value("recognition.settings.window");
        Ok(Recognition {
            methods,
            settings: self.settings,
            scenario_window: window.is_none(),
            reference: reference
                .transpose()
                .map_err(file.at("recognition.reference"))?,
            published: self.published.map(PublishedTable::confusion),
            baseline: baseline
                .transpose()
                .map_err(file.at("recognition.baseline.key"))?,
        })
    }
}

fn check_methods(methods: &[Method]) -> Result<(), String> {
    let distinct: BTreeSet<&str> = methods.iter().map(|method| method.as_str()).collect();
    if methods.is_empty() || distinct.len() < methods.len() {
        let message = "name `paper`, `improved` or both, each once; omit `methods` for both";
        return Err(message.to_owned());
    }
    Ok(())
}

fn check_baseline(study: &Study, key: &str) -> Result<(), String> {
    let Some(values) = study.values_of(key) else {
        return Err(format!(
            "`{key}` is not swept, so no value of it can be left out of the training; {}",
            swept(study)
        ));
    };
    let groups: BTreeSet<String> = values.map(magnitude).collect();
    if groups.len() < 2 {
        return Err(format!(
            "`{key}` has one value, up to its sign; the baseline is trained on all values but one, so sweep two or more"
        ));
    }
    if study.random_numbers == RandomNumbers::Common {
        return Err(
            "with `random_numbers = \"common\"` the baseline would be trained on the grounds it is tested on; make them \"independent\""
                .to_owned(),
        );
    }
    if study.repeats < 2 {
        return Err(format!(
            "the baseline is also trained on all repeats but one; it needs `repeats` of 2 or more, got {}",
            study.repeats
        ));
    }
    Ok(())
}

/// A swept value without its sign: a wheel in reverse has the speed it has forward.
pub(super) fn magnitude(value: &str) -> String {
    value.trim_start_matches('-').to_owned()
}

impl PublishedTable {
    fn confusion(self) -> Confusion {
        Confusion {
            counts: [self.alct, self.slct, self.leis, [0; 4]],
        }
    }
}

/// Features by their default settings over the computed reference, and no answers.
pub(super) static BY_DEFAULT: Recognition = Recognition {
    methods: Vec::new(),
    settings: Settings::DEFAULT,
    scenario_window: true,
    reference: None,
    published: None,
    baseline: None,
};

impl Recognition {
    /// How windows and features of a scenario's runs are taken.
    pub(super) fn settings(&self, scenario: &Scenario) -> Settings {
        let mut settings = self.settings;
        if self.scenario_window {
            settings.window = Window::Seconds(scenario.window());
        }
        settings
    }

    pub(super) fn reference_text(&self) -> Option<&str> {
        let runs = self.reference.as_ref()?;
        Some(runs.scenario.text())
    }
}

impl ReferenceRuns {
    fn new(study: &Study, scenario: Scenario) -> Result<Self, String> {
        let label = scenario.terrain.label();
        if label != TerrainLabel::Reference {
            return Err(format!(
                "the reference is the wheel on flat hard ground, `[terrain.reference]`; this scenario is of {label}"
            ));
        }
        let mut runs = Self {
            scenario,
            first_conditions: Vec::new(),
            of_condition: Vec::new(),
        };
        let mut known: HashMap<String, usize> = HashMap::new();
        for condition in 0..study.condition_count() {
            let edited = runs.edited(study, condition)?;
            check_same_wheel(&study.scenario_of(condition), &edited)?;
            let next = known.len();
            let number = *known.entry(edited.text().to_owned()).or_insert(next);
            if number == next {
                runs.first_conditions.push(condition);
            }
            runs.of_condition.push(number);
        }
        Ok(runs)
    }

    /// Number of the run for a condition, from 0.
    pub(super) fn of_condition(&self, condition: u64) -> usize {
        self.of_condition[condition as usize]
    }

    /// The first condition of a run.
    pub(super) fn first_condition(&self, number: usize) -> u64 {
        self.first_conditions[number]
    }

    /// The scenario of a run.
    pub(super) fn scenario(&self, study: &Study, number: usize) -> Scenario {
        let edited = self.edited(study, self.first_conditions[number]);
        edited.expect("every condition was checked when the study was read")
    }

    /// The scenario with what the study sets and sweeps, the ground aside: the reference has its
    /// own.
    fn edited(&self, study: &Study, condition: u64) -> Result<Scenario, String> {
        let (_, entries) = study.condition(condition);
        let mut assignments = study.assignments(&entries);
        assignments.retain(|assignment| {
            !assignment.starts_with("terrain.") || assignment.starts_with("terrain.reference.")
        });
        let edited = self.scenario.with_all(&assignments);
        edited.map_err(|error| in_one_line(&error))
    }
}

fn check_same_wheel(scenario: &Scenario, reference: &Scenario) -> Result<(), String> {
    let outline = |scenario: &Scenario| {
        let wheel = &scenario.wheel;
        (wheel.radius, wheel.lug_count(), wheel.lug_height())
    };
    let (wheel, reference) = (outline(scenario), outline(reference));
    if wheel == reference {
        return Ok(());
    }
    let describe = |(radius, count, height): (f64, u32, f64)| {
        format!("{count} lugs of {height} m on a rim of {radius} m")
    };
    Err(format!(
        "the reference has to be of the same wheel: it has {}, the runs have {}",
        describe(reference),
        describe(wheel)
    ))
}
