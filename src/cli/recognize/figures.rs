//! The figures of recognition, in a folder.

use super::write_figure;
use crate::recognition::Recognized;
use crate::recognition::confusion::Confusion;
use crate::recognition::known::known_terrain;
use crate::report::{
    FeaturePoint, Group, confusion_figure, feature_planes, feature_values, traverse_figure,
};
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::Trace;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Figures of all runs together: features by ground, their planes, answers and truth.
const TOGETHER: [&str; 3] = ["feature_values.svg", "feature_planes.svg", "confusion.svg"];

/// Names of all figures that runs may have.
pub fn names(runs: &[String]) -> impl Iterator<Item = String> {
    let together = TOGETHER.into_iter().map(str::to_owned);
    runs.iter().map(|id| name_of(id)).chain(together)
}

/// Draws run after run, and in the end what they come to.
pub struct Figures {
    folder: PathBuf,
    points: Vec<Point>,
    /// Numbers of lugs of the wheels.
    lugs: BTreeSet<u32>,
    written: Vec<String>,
}

/// The features of a window and what it may be grouped by.
struct Point {
    p: [f64; 4],
    terrain: Option<TerrainLabel>,
    class: Wtic,
}

impl Figures {
    /// Figures in a folder that the command has claimed.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            points: Vec::new(),
            lugs: BTreeSet::new(),
            written: Vec::new(),
        }
    }

    /// Draws a run and notes its windows.
    pub fn add(&mut self, id: &str, trace: &Trace, windows: &[Recognized]) -> anyhow::Result<()> {
        self.lugs.extend(trace.attributes.lug_count);
        self.points.extend(windows.iter().filter_map(|window| {
            Some(Point {
                p: *window.p.as_ref().ok()?,
                terrain: known_terrain(trace, [window.start, window.end]),
                class: window.answers.first()?.class,
            })
        }));
        // Not every acceleration that was read can be drawn; then there is no figure of the run.
        if let Ok(svg) = traverse_figure(trace, id, windows) {
            self.write(&name_of(id), &svg)?;
        }
        Ok(())
    }

    /// Draws what the runs come to; the names of all figures.
    pub fn finish(mut self, confusion: &Confusion) -> anyhow::Result<Vec<String>> {
        let points = self.grouped();
        let [values, planes, answers] = TOGETHER;
        if !points.is_empty() {
            self.write(values, &feature_values(&points))?;
        }
        // The regions go by the number of lugs: wheels of several have no planes in common.
        if let (1, Some(&lugs), false) = (self.lugs.len(), self.lugs.first(), points.is_empty()) {
            self.write(planes, &feature_planes(&points, lugs))?;
        }
        if confusion.total() > 0 {
            let title = "Classes answered and true";
            self.write(answers, &confusion_figure(confusion, title))?;
        }
        Ok(self.written)
    }

    /// By ground where all windows have one, else by the class recognised.
    fn grouped(&self) -> Vec<FeaturePoint> {
        let grounds = self.points.iter().all(|point| point.terrain.is_some());
        let points = self.points.iter().map(|point| FeaturePoint {
            group: match point.terrain {
                Some(terrain) if grounds => Group::Terrain(terrain),
                _ => Group::Class(point.class),
            },
            p: point.p,
        });
        points.collect()
    }

    fn write(&mut self, name: &str, svg: &str) -> anyhow::Result<()> {
        self.written.push(write_figure(&self.folder, name, svg)?);
        Ok(())
    }
}

/// The figure of a run: its id without what a file's name cannot have.
fn name_of(id: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "-_.".contains(letter);
    let name = id
        .chars()
        .map(|letter| if plain(letter) { letter } else { '_' });
    name.collect::<String>() + ".svg"
}
