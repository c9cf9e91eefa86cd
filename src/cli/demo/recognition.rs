//! The classes of the demo's windows, recognised from their vibration.

use super::Finding;
use crate::cli::interrupt;
use crate::dataset::hdf5::RunFile;
use crate::features::reference::Reference;
use crate::features::{Settings, Window};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::recognition::{Method, Recognizer};
use crate::report::page::{Cell, Column, Figure, Section, Table};
use crate::report::study_page::answers_and_truth;
use crate::report::{FeaturePoint, Group, feature_planes};
use crate::terrain::class::TerrainLabel;
use crate::trace::Trace;

/// Length of a window [s]: some six lug passes.
pub const WINDOW: f64 = 8.0;

const METHODS: [Method; 2] = [Method::Improved, Method::Paper];

/// What was answered to the windows of all grounds but the reference.
#[derive(Default)]
pub struct Recognition {
    /// Answers of each of [`METHODS`]; the class that the ground stands for is taken for true.
    confusions: [Confusion; METHODS.len()],
    points: Vec<FeaturePoint>,
    lugs: u32,
}

/// Recognises the runs of all files but that of flat hard ground, over which features are taken.
pub fn recognize(findings: &[Finding]) -> anyhow::Result<Recognition> {
    let settings = Settings {
        window: Window::Seconds(WINDOW),
        ..Settings::default()
    };
    let is_reference = |finding: &&Finding| label(finding) == Some(TerrainLabel::Reference);
    let (flat, others): (Vec<&Finding>, Vec<&Finding>) = findings.iter().partition(is_reference);
    let flat = flat
        .into_iter()
        .map(runs)
        .collect::<anyhow::Result<Vec<_>>>()?;
    let reference = Reference::measured(flat.concat(), settings)?;
    let mut recognizer = Recognizer::new(settings, reference, &METHODS)?;
    let mut found = Recognition::default();
    for finding in others {
        for trace in runs(finding)? {
            interrupt::check()?;
            found.add(&trace, &mut recognizer)?;
        }
    }
    Ok(found)
}

fn label(finding: &Finding) -> Option<TerrainLabel> {
    finding.first.1.attributes.terrain
}

/// The runs of a ground, read back from its file.
fn runs(finding: &Finding) -> anyhow::Result<Vec<Trace>> {
    let file = RunFile::open(&finding.run_file)?;
    let traces = file.runs().iter().map(|id| file.read(id));
    Ok(traces.collect::<Result<_, _>>()?)
}

impl Recognition {
    fn add(&mut self, trace: &Trace, recognizer: &mut Recognizer) -> anyhow::Result<()> {
        self.lugs = trace.attributes.lug_count.unwrap_or(self.lugs);
        let Some(terrain) = trace.attributes.terrain else {
            return Ok(());
        };
        for window in recognizer.recognize(trace)? {
            for (confusion, answer) in self.confusions.iter_mut().zip(&window.answers) {
                confusion.add(terrain.class(), answer.class);
            }
            self.points.extend(window.p.ok().map(|p| FeaturePoint {
                group: Group::Terrain(terrain),
                p,
            }));
        }
        Ok(())
    }

    /// How many windows the first method recognised, in a sentence.
    pub fn answer(&self) -> String {
        let [ours, papers] = self.confusions.map(|confusion| right(&confusion));
        format!(
            "From {WINDOW} s of vibration the class of the ground is recognised in {ours} windows, by the paper's regions in {papers}."
        )
    }

    /// The section of the page.
    pub fn section(&self) -> Section {
        let section = Section::new("Recognition of the ground from vibration")
            .answer(self.answer())
            .prose(
                "ALCT: all lugs contact the surface, as on slate. SLCT: some do, as on gravel. LEIS: lugs enter soil, \
                 as in sand. UWTIC: the class is unknown. No training data are used: lugwheel recognize tests each lug \
                 pass (improved), or uses the regions of the paper for four features (paper), each relative to the \
                 same wheel on flat hard ground. Intervals of shares are Wilson's, of 95 %.",
            )
            .table(self.table());
        let matrices = METHODS
            .iter()
            .zip(&self.confusions)
            .map(|(method, confusion)| {
                let method = method.as_str();
                Figure::new(
                    answers_and_truth(method, confusion),
                    format!("What {method} answered to the windows of each class."),
                )
            });
        matrices.fold(section, Section::figure).figure(Figure::new(
            feature_planes(&self.points, self.lugs),
            "Every window in the planes of two features, with the paper's regions.",
        ))
    }

    fn table(&self) -> Table {
        let rows = METHODS
            .iter()
            .zip(&self.confusions)
            .flat_map(|(method, confusion)| {
                let rows = CLASSES.into_iter().zip(confusion.counts);
                rows.filter_map(|(class, counts)| {
                    let recall = confusion.recall(class)?;
                    let first = [Cell::text(method.as_str()), Cell::text(class.as_str())];
                    let row = first.into_iter().chain(counts.map(Cell::Count));
                    Some(row.chain([Cell::share(&recall)]).collect())
                })
                .collect::<Vec<_>>()
            });
        let answers = CLASSES.map(|class| class.as_str());
        let names = ["method", "true class"].into_iter().chain(answers);
        Table {
            caption: "Answers to the windows of each class".to_owned(),
            columns: Column::named(names.chain(["right"])),
            rows: rows.collect(),
        }
    }
}

/// `11 of 12, 92 % [65, 99]`.
fn right(confusion: &Confusion) -> String {
    let of = format!("{} of {}", confusion.correct(), confusion.total());
    let share = confusion.accuracy().map(|share| {
        let [value, low, high] = share.percent();
        format!(" ({value:.0} % [{low:.0}, {high:.0}])")
    });
    format!("{of}{}", share.unwrap_or_default())
}
