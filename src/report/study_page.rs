//! The page of a study: question, results, provenance.

mod conditions;
mod dataset;
mod diagnosis;
mod identification;
mod recognition;
mod thresholds;

pub use identification::{force_errors, identified_parameters, not_steady, parameter_drawing};
pub use recognition::answers_and_truth;

use super::figure::Layout;
use super::laid_out_trace_figure;
use super::page::{Cell, Figure, Page, Provenance, Section, Table, prose, section_text};
use crate::study::{Outcome, Scores, Study};
use crate::trace::Trace;

/// A study and what came of it.
#[derive(Debug, Clone, Copy)]
pub struct StudyReport<'a> {
    /// The study.
    pub study: &'a Study,
    /// What it is called where its file has no title.
    pub name: &'a str,
    /// What came of it; no shard is missing.
    pub outcome: &'a Outcome,
    /// Runs to look at: the name of the scenario, and the run.
    pub stills: &'a [(String, Trace)],
    /// Facts on the execution that the study does not contain: version, machine.
    pub facts: &'a [(String, String)],
    /// Commands that run it again.
    pub commands: &'a [String],
}

/// The result of an analysis, as it is shown.
trait Shown {
    /// Name of its text file, without the ending; none where it has none.
    fn stem(&self) -> Option<&'static str>;

    /// The result in a sentence or two.
    fn answer(&self) -> String;

    /// Its part of the page.
    fn sections(&self) -> Vec<Section>;

    /// Its figures as files of their own.
    fn drawings(&self) -> Vec<Drawing> {
        Vec::new()
    }
}

/// A figure in a file of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// Name of the file.
    pub file: String,
    /// The figure as SVG.
    pub svg: String,
}

impl Drawing {
    fn new(file: impl Into<String>, svg: String) -> Self {
        let file = file.into();
        Self { file, svg }
    }
}

/// The results of a study, in the order of its page.
fn shown(scores: &Scores) -> Vec<&dyn Shown> {
    let Scores {
        recognition,
        thresholds,
        identification,
        diagnosis,
        dataset,
    } = scores;
    let shown = [
        any(recognition),
        any(thresholds),
        any(identification),
        any(diagnosis),
        any(dataset),
    ];
    shown.into_iter().flatten().collect()
}

fn any(score: &Option<impl Shown>) -> Option<&dyn Shown> {
    score.as_ref().map(|score| score as &dyn Shown)
}

/// The figures of all results as files.
pub fn drawings(scores: &Scores) -> Vec<Drawing> {
    let shown = shown(scores).into_iter();
    shown.flat_map(Shown::drawings).collect()
}

/// A result as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultText {
    /// Name of its file, without the ending.
    pub stem: &'static str,
    /// Its part of the page without figures.
    pub text: String,
}

/// The results as texts, with the tables of the page.
pub fn texts(scores: &Scores) -> Vec<ResultText> {
    let text = |score: &dyn Shown| {
        let stem = score.stem()?;
        let text = format!(
            "{}\n{}",
            prose(&score.answer()),
            section_text(&score.sections())
        );
        Some(ResultText { stem, text })
    };
    shown(scores).into_iter().filter_map(text).collect()
}

/// The page of a study, of the same parts for every study: answer, scores with tables and
/// figures, means of every condition, what a run looks like, runs that failed, how to run it again.
pub fn study_page(report: &StudyReport) -> Page {
    let StudyReport { study, outcome, .. } = *report;
    let shown = shown(&outcome.scores);
    let mut answers: Vec<String> = shown.iter().map(|it| it.answer()).collect();
    let mut sections: Vec<Section> = shown.iter().flat_map(|it| it.sections()).collect();
    if answers.is_empty() {
        answers.push(conditions::answer(study, &outcome.conditions));
    }
    answers.extend(failed(outcome));
    sections.push(conditions::section(study, &outcome.conditions));
    sections.extend(looks(report.stills));
    sections.extend(failures(outcome));
    Page {
        title: or(&study.title, report.name),
        question: or(&study.question, &asked(study)),
        answer: answers.join(" "),
        intro: String::new(),
        sections,
        provenance: provenance(report),
    }
}

fn or(text: &str, otherwise: &str) -> String {
    let text = if text.is_empty() { otherwise } else { text };
    text.to_owned()
}

/// The question of a study that does not state one.
fn asked(study: &Study) -> String {
    let scenarios: Vec<&str> = study.first_runs().map(|(name, _)| name).collect();
    let scenarios = scenarios.join(", ");
    let keys: Vec<String> = study.axes().into_iter().map(|axis| axis.name).collect();
    if keys.is_empty() {
        return format!("What are the results of the runs of {scenarios}?");
    }
    format!(
        "How do the results depend on {} in {scenarios}?",
        keys.join(" and ")
    )
}

fn failed(outcome: &Outcome) -> Option<String> {
    let failed = outcome.failures.len();
    (failed > 0).then(|| format!("{failed} of {} runs failed.", outcome.runs))
}

/// The runs to look at, in full.
fn looks(stills: &[(String, Trace)]) -> Option<Section> {
    let figure = |(scenario, trace): &(String, Trace)| {
        let caption = format!(
            "The first run of {scenario}: wheel and ground to scale, what the sensors recorded, and the \
             vibration by order of the wheel's turn."
        );
        let draw = |layout| laid_out_trace_figure(trace, scenario, layout).ok();
        Some(Figure::new(draw(Layout::SCREEN)?, caption).narrow(draw(Layout::TELEPHONE)?))
    };
    let figures: Vec<Figure> = stills.iter().filter_map(figure).collect();
    let section = Section::new("Example runs");
    (!figures.is_empty()).then(|| figures.into_iter().fold(section, Section::figure))
}

fn failures(outcome: &Outcome) -> Option<Section> {
    let rows = outcome.failures.iter().map(|failure| {
        vec![
            Cell::Count(failure.run),
            Cell::text(&failure.condition),
            Cell::text(&failure.reason),
        ]
    });
    let table = Table::of(["run", "condition", "reason"], rows).captioned("Runs without values");
    let answer = format!(
        "{} Failed runs are excluded from all results above.",
        failed(outcome)?
    );
    let section = Section::new("Failed runs");
    Some(section.answer(answer).table(table))
}

fn provenance(report: &StudyReport) -> Provenance {
    let StudyReport { study, outcome, .. } = *report;
    let sweeps = study.axes().into_iter().map(|axis| axis.values.len());
    let counts: Vec<String> = std::iter::once(study.first_runs().count())
        .chain(sweeps)
        .chain([study.repeats() as usize])
        .map(|count| count.to_string())
        .collect();
    let ours = [
        ("seed", study.seed.0.to_string()),
        (
            "runs",
            format!(
                "{} = {} (scenarios × entries of each sweep × repeats), {} failed",
                outcome.runs,
                counts.join(" × "),
                outcome.failures.len()
            ),
        ),
        ("fingerprint", study.fingerprint()),
    ];
    let ours = ours.map(|(name, value)| (name.to_owned(), value));
    let texts = study.scenario_texts();
    let texts = texts.map(|(name, text)| (format!("{name}.toml"), text.to_owned()));
    Provenance {
        facts: report.facts.iter().cloned().chain(ours).collect(),
        commands: report.commands.to_vec(),
        files: std::iter::once(("study.toml".to_owned(), study.text().to_owned()))
            .chain(texts)
            .collect(),
    }
}
