//! The terrain parameters of the demo's sand, from the loads of a wheel.

use crate::cli::interrupt::{self, Interrupted};
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::series::Jobs;
use lugwheel::identification::Parameter;
use lugwheel::report::page::{Figure, Section, four_digits};
use lugwheel::report::{force_curves, study_page};
use lugwheel::study::identification::score::{GroupScore, IdentificationScore, Source};
use lugwheel::study::{self, Options, Study, StudyError};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Sand, as shipped.
const SAND: &str = include_str!("../../../scenarios/single_wheel_st.toml");
const STUDY: &str = include_str!("identification.toml");

/// A study of steady loads on sand, in the folder of the demo.
pub struct Loads {
    study: Study,
    /// Its file.
    pub file: PathBuf,
    /// Its results.
    pub folder: PathBuf,
}

impl Loads {
    /// Writes the study into a folder.
    ///
    /// Its results go to a folder of their own, named by all that decides them: a demo that was
    /// run before, and the same, is not computed again.
    pub fn prepare(folder: &Path, seed: u64) -> anyhow::Result<Self> {
        let file = folder.join("identification.toml");
        output::write_file(&folder.join("sand.toml"), SAND)?;
        output::write_file(
            &file,
            &STUDY.replace("seed = 1\n", &format!("seed = {seed}\n")),
        )?;
        let study = Study::load(&file)?;
        let name = format!("identification_{}", &study.fingerprint()[..8]);
        Ok(Self {
            folder: folder.join(name),
            study,
            file,
        })
    }

    /// Simulated time [s].
    pub fn simulated(&self) -> f64 {
        let runs = self.study.runs();
        runs.map(|run| self.study.scenario(&run).driven()).sum()
    }

    /// Runs the study and identifies.
    pub fn identify(&self, jobs: Jobs, progress: &Progress) -> anyhow::Result<Identified> {
        let options = Options {
            out: self.folder.clone(),
            jobs: NonZeroUsize::new(jobs.count()),
            resume: true,
            shard: None,
        };
        let each = self.simulated() / self.study.run_count() as f64;
        let heard = AtomicU64::new(0);
        let outcome = self.study.execute(&options, &|now: study::Progress| {
            let before = heard.fetch_max(now.done, Ordering::Relaxed);
            progress.advance(now.done.saturating_sub(before) as f64 * each);
            match interrupt::is_requested() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let outcome = match outcome {
            Err(stopped @ StudyError::Stopped { .. }) => {
                return Err(Interrupted(stopped.to_string()).into());
            }
            other => other?,
        };
        let score = outcome.identification;
        let score = score.ok_or_else(|| anyhow::anyhow!("the demo's study identifies nothing"))?;
        Ok(Identified { score })
    }
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
        let told = found.find(|told| told.parameter == Parameter::FrictionAngle)?;
        let [low, high] = told.ci95;
        Some(format!(
            "From pull, load, torque and sinkage of a smooth wheel the sand's friction angle comes out as {}° [{}, {}]; it is {}°.",
            four_digits(told.value),
            four_digits(low?),
            four_digits(high?),
            four_digits(told.own?)
        ))
    }

    /// The section of the page.
    pub fn section(&self) -> Section {
        let section = Section::new("What do the loads say of the sand?");
        let section = match self.answer() {
            Some(answer) => section.answer(answer),
            None => section,
        };
        let section = section
            .prose(
                "Fifteen runs at five slips under three loads, first of a smooth wheel on the stresses that equations (62) to \
                 (66) assume: what was put in should come out. Then of the lugged wheel on Wong and Reece's stresses: a rim \
                 stands for it in the equations, so that its parameters are those of wheel and sand together, need not be \
                 the sand's, and give the forces back less well.",
            )
            .table(study_page::identified_parameters(&self.score));
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
