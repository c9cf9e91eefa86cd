//! The terrain parameters of the demo's sand, from the loads of a wheel.

use super::small_study::{SmallStudy, shipped};
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::series::Jobs;
use crate::identification::Parameter;
use crate::report::page::{Figure, Section};
use crate::report::{force_curves, study_page};
use crate::study::identification::score::{GroupScore, IdentificationScore, Source};
use crate::table::four_digits;
use std::path::Path;

const STUDY: &str = include_str!("identification.toml");

/// A study of steady loads on sand.
pub fn loads(folder: &Path, seed: u64) -> anyhow::Result<SmallStudy> {
    output::write_file(&folder.join("sand.toml"), shipped("st").text)?;
    SmallStudy::prepare(folder, "identification", STUDY, seed)
}

/// Runs the study and identifies.
pub fn identify(loads: &SmallStudy, jobs: Jobs, progress: &Progress) -> anyhow::Result<Identified> {
    let score = loads.execute(jobs, progress)?.scores.identification;
    let score = score.ok_or_else(|| anyhow::anyhow!("the demo's study identifies nothing"))?;
    Ok(Identified { score })
}

/// What the loads gave.
pub struct Identified {
    score: IdentificationScore,
}

impl Identified {
    /// The friction angle found, and the sand's own, in a sentence.
    pub fn answer(&self) -> Option<String> {
        let (_, parameters) = self.score.groups.first()?.parameters()?;
        let mut found = parameters.iter();
        let parameter = found.find(|it| it.parameter == Parameter::FrictionAngle)?;
        let [low, high] = parameter.ci95;
        Some(format!(
            "From pull, load, torque and sinkage of a smooth wheel the sand's friction angle comes out as {}° [{}, {}]; it is {}°.",
            four_digits(parameter.value),
            four_digits(low?),
            four_digits(high?),
            four_digits(parameter.own?)
        ))
    }

    /// The section of the page.
    pub fn section(&self) -> Section {
        let section = Section::new("Identification of the sand");
        let section = match self.answer() {
            Some(answer) => section.answer(answer),
            None => section,
        };
        let section = section
            .prose(
                "Fifteen runs at five slips under three loads, first of a smooth wheel on the stresses that equations \
                 (62) to (66) assume: the true parameters should be recovered. Then of the lugged wheel on Wong and \
                 Reece's stresses: the equations represent it by its rim, so that the parameters are effective ones of \
                 wheel and sand together, may differ from the sand's, and reproduce the forces less accurately.",
            )
            .table(study_page::identified_parameters(&self.score));
        let section = match study_page::not_steady(&self.score) {
            Some(table) => section.table(table),
            None => section,
        };
        let curves = self.score.groups.iter().filter_map(curves);
        curves
            .fold(section, Section::figure)
            .table(study_page::force_errors(&self.score))
    }
}

fn curves(group: &GroupScore) -> Option<Figure> {
    let source = group.source.as_ref()?;
    let Source {
        estimate, loads, ..
    } = source;
    let smooth = source.setting.lug_height == 0.0;
    let wheel = if smooth {
        "The smooth wheel"
    } else {
        "The lugged wheel"
    };
    let title = format!("{wheel}: forces measured, and given back by the parameters");
    let caption =
        format!("{wheel} on sand. Marks are measured, lines computed from the parameters found.");
    Some(Figure::new(
        force_curves(&title, estimate, &source.predictor()?, loads),
        caption,
    ))
}
