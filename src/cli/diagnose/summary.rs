//! Result of a diagnosis, as text and as JSON.

use crate::diagnosis::{Answer, Diagnosis, Mechanism, Step, Suspect};
use crate::gap::Colour;
use crate::gap::stages::VibrationStages;
use crate::quantity::hexadecimal;
use crate::trace::behind_number;
use anyhow::Context;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt;
use std::fs;
use std::path::Path;

/// Effects and cells listed.
const LISTED: usize = 6;
/// Causes listed with their probability.
const MOST_PROBABLE: usize = 12;
/// Probability [-] below which an effect is not listed.
const UNLIKELY: f64 = 0.01;

/// What a diagnosis was made of.
#[derive(Debug, Serialize)]
pub struct Inputs {
    /// The run file.
    pub measured: Input,
    /// The scenario as used.
    pub scenario: Input,
    /// Runs chosen; all if empty.
    pub runs: Vec<String>,
    /// Effects left out.
    pub without: Vec<String>,
    /// Seed of the simulations.
    pub seed: u64,
    /// Version of the program.
    pub version: &'static str,
}

impl Inputs {
    /// Names and values, for a page.
    pub fn facts(&self) -> Vec<(String, String)> {
        let Self {
            measured, scenario, ..
        } = self;
        let hash = |input: &Input| format!("{}, SHA-256 {}", input.file, input.sha256);
        let runs = if self.runs.is_empty() {
            "all".to_owned()
        } else {
            self.runs.join(", ")
        };
        let facts = [
            ("program", format!("lugwheel {}", self.version)),
            ("measured", hash(measured)),
            ("runs of it", runs),
            ("scenario as used", hash(scenario)),
        ];
        facts.map(|(name, value)| (name.to_owned(), value)).to_vec()
    }
}

/// A file and its content's hash.
#[derive(Debug, Serialize)]
pub struct Input {
    file: String,
    sha256: String,
}

impl Input {
    /// Of a file's bytes.
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok(Self::new(path, &bytes))
    }

    /// Of a text that came from a file.
    pub fn of_text(path: &Path, text: &str) -> Self {
        Self::new(path, text.as_bytes())
    }

    fn new(path: &Path, bytes: &[u8]) -> Self {
        Self {
            file: path.display().to_string(),
            sha256: hexadecimal(&Sha256::digest(bytes)),
        }
    }
}

/// Inputs and answer.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// Of what.
    pub inputs: Inputs,
    /// The answer and what backs it.
    #[serde(flatten)]
    pub diagnosis: Diagnosis,
    /// Which part of the vibration brings the gap into features and class, at the condition where most differs.
    pub stages: Vec<(Step, VibrationStages)>,
    /// The answer in a sentence.
    #[serde(skip)]
    pub answer: String,
    /// Where the page lies.
    #[serde(skip)]
    pub page: String,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_verdict(f)?;
        self.write_probabilities(f)?;
        self.write_gap(f)?;
        self.write_map(f)?;
        self.write_basis(f)?;
        write!(f, "\n{}", self.page)
    }
}

impl Summary {
    fn write_verdict(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = &self.diagnosis.verdict;
        writeln!(f, "{}", self.verdict())?;
        for reason in &verdict.reasons {
            writeln!(f, "  {reason}")?;
        }
        if let Some(mechanism) = &verdict.mechanism
            && verdict.named.is_empty()
        {
            let Mechanism { of, probability } = mechanism;
            writeln!(
                f,
                "  the cause acts on {of} (probability {:.0} %)",
                100.0 * probability
            )?;
        }
        if verdict.set.len() > 1 {
            writeln!(f, "  90 % prediction set: {}", shortened(&verdict.set))?;
        }
        Ok(())
    }

    fn write_probabilities(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\nprobabilities, of effects alone and, joined by +, together:"
        )?;
        let likeliest = self.likeliest();
        for (name, probability) in likeliest.iter().take(MOST_PROBABLE) {
            writeln!(f, "  {:>5.1} %  {name}", 100.0 * probability)?;
        }
        if let Some((_, most)) = likeliest.get(MOST_PROBABLE) {
            let others = likeliest.len() - MOST_PROBABLE;
            writeln!(f, "  {others} others of at most {:.1} % each", 100.0 * most)?;
        }
        let effects = self.diagnosis.verdict.effects.iter();
        let listed = effects.filter(|it| it.probability > UNLIKELY);
        for suspect in listed.take(LISTED) {
            writeln!(f, "  {}", described(suspect))?;
        }
        Ok(())
    }

    fn write_gap(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnosis {
            verdict,
            gap,
            closed,
            closed_with,
            ..
        } = &self.diagnosis;
        let added = if closed_with.is_empty() {
            "no effect".to_owned()
        } else {
            closed_with.join(" and ")
        };
        if let Some(gap) = gap {
            writeln!(
                f,
                "\ngap (standard deviations per statistic): nominal {:.2}, recalibrated {:.2}, with {added} {:.2}, \
                 noise floor {:.2}{}",
                gap.as_shipped,
                gap.recalibrated,
                gap.with_effect,
                gap.floor,
                gap.floor_with_discrepancy
                    .map_or_else(String::new, |floor| format!(
                        ", with the assumed discrepancy {floor:.2}"
                    ))
            )?;
        }
        if let Some(closed) = closed {
            let [low, high] = closed.ci95.map(|share| 100.0 * share);
            let interval = match closed.clusters {
                1 => ", of one condition and so without an interval".to_owned(),
                _ if closed.is_shown() => format!(" [{low:.0}, {high:.0}]"),
                _ => {
                    format!(" [{low:.0}, {high:.0}], which contains 0: not shown to close the gap")
                }
            };
            writeln!(f, "closed: {:.0} %{interval}", 100.0 * closed.value)?;
        }
        if gap.is_some_and(|gap| gap.is_within_discrepancy()) {
            writeln!(
                f,
                "the gap left is no larger than the discrepancy assumed for any simulator would leave"
            )?;
        }
        if let Some(next) = &verdict.next_run {
            writeln!(
                f,
                "next run: {}, where {} and {} differ by {:.2} standard deviations per statistic (here {:.2})",
                next.run, next.between[0], next.between[1], next.separation[1], next.separation[0]
            )?;
        }
        Ok(())
    }

    fn write_map(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnosis {
            verdict,
            map,
            global,
            ..
        } = &self.diagnosis;
        let differ = map.iter().filter(|entry| entry.colour == Colour::Gap);
        let located = if verdict.located.is_empty() {
            "none is significant"
        } else {
            "the strongest are"
        };
        writeln!(
            f,
            "\nmap: {} of {} statistics differ (energy test p = {:.3}, strongest p = {:.3}); after recalibration \
             {located}",
            differ.count(),
            map.len(),
            global.energy.p,
            global.strongest.p
        )?;
        for located in verdict.located.iter().take(LISTED) {
            writeln!(
                f,
                "  {:>6.1}  {}, {}",
                located.deviations, located.cell, located.condition
            )?;
        }
        Ok(())
    }

    fn write_basis(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnosis {
            compared,
            self_test: test,
            caveats,
            ..
        } = &self.diagnosis;
        writeln!(
            f,
            "\ncompared: {} conditions, {} effects, {} parameters; trained on {} random rigs, {:.0} s of driving",
            compared.conditions.len(),
            compared.candidates.len(),
            compared.parameters.len(),
            compared.rigs,
            compared.driven
        )?;
        writeln!(
            f,
            "self-test on {} campaigns of them: {:.0} % right, probability of the true cause {:.2}, an effect falsely \
             named in {:.1} %, calibration error {:.2}",
            test.campaigns,
            100.0 * test.right,
            test.probability_of_truth,
            100.0 * test.falsely_named,
            test.calibration_error
        )?;
        caveats
            .iter()
            .try_for_each(|caveat| writeln!(f, "  {caveat}"))
    }

    fn verdict(&self) -> String {
        let verdict = &self.diagnosis.verdict;
        let sets = verdict.named.iter().map(|set| set.join(" or "));
        let named = sets.collect::<Vec<_>>().join(", and ");
        match verdict.verdict {
            Answer::None => "none: the scenario explains the measured runs".to_owned(),
            Answer::Parameter => {
                "parameter: recalibrated parameters explain the difference".to_owned()
            }
            Answer::Effect => format!("effect: {named}"),
            Answer::Effects => format!("effects: {named}"),
            Answer::Unknown => {
                "unknown: no effect of the catalogue explains the difference".to_owned()
            }
            Answer::Undecided => {
                "undecided: these runs do not discriminate between the causes".to_owned()
            }
        }
    }

    fn likeliest(&self) -> Vec<(&String, f64)> {
        let all = self.diagnosis.verdict.probabilities.iter();
        let mut likely: Vec<(&String, f64)> = all
            .map(|(name, probability)| (name, *probability))
            .filter(|(_, probability)| *probability > UNLIKELY)
            .collect();
        likely.sort_by(|a, b| b.1.total_cmp(&a.1));
        likely
    }
}

/// The first names, and how many others there are.
fn shortened(names: &[String]) -> String {
    match names.get(LISTED..) {
        Some(others @ [_, ..]) => format!(
            "{} and {} others (diagnosis.json has all)",
            names[..LISTED].join(", "),
            others.len()
        ),
        _ => names.join(", "),
    }
}

fn described(suspect: &Suspect) -> String {
    let Suspect {
        name,
        magnitude,
        unit,
        ci95: [low, high],
        equivalent_to,
        absorbed,
        ..
    } = suspect;
    let alike = if equivalent_to.is_empty() {
        String::new()
    } else {
        format!(
            "; cannot be distinguished from {}",
            equivalent_to.join(", ")
        )
    };
    let unit = behind_number(unit);
    format!(
        "{name} = {magnitude:.3}{unit} [{low:.3}, {high:.3}], {:.0} % absorbed by parameters{alike}",
        100.0 * absorbed
    )
}
