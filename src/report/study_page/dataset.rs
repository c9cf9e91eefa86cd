//! What a data set for learners holds.

use super::Shown;
use crate::learning::DataSet;
use crate::learning::balance::{ByClass, OfPart};
use crate::learning::splits::Part;
use crate::recognition::confusion::CLASSES;
use crate::report::page::{Cell, Figure, Section, Table};
use crate::report::{FeaturePoint, Group, feature_values};
use crate::terrain::class::LABELS;

impl Shown for DataSet {
    fn stem(&self) -> Option<&'static str> {
        None
    }

    /// How large it is, and how its classes are balanced.
    fn answer(&self) -> String {
        let windows = self.windows().rows.len();
        let classes = CLASSES.iter().zip(self.by_class());
        let classes = classes.filter(|(_, count)| *count > 0);
        let classes: Vec<String> = classes
            .map(|(class, count)| format!("{count} {}", class.as_str()))
            .collect();
        format!(
            "The data set has {windows} windows of {} runs: {}.",
            self.runs(),
            classes.join(", ")
        )
    }

    /// Balance, splits and features.
    fn sections(&self) -> Vec<Section> {
        let section = Section::new("Contents of the data set")
            .prose(
                "True classes by the contacts of lugs and ground. dataset.h5 contains the data, dataset.windows.csv \
                 one row per window with its features and its part in every split, dataset.datasheet.md the \
                 datasheet, dataset.croissant.json the same metadata as JSON-LD.",
            )
            .table(balance(self))
            .table(parts(self));
        let points: Vec<FeaturePoint> = points(self).collect();
        if points.is_empty() {
            return vec![section];
        }
        vec![section.figure(Figure::new(
            feature_values(&points),
            "The four features of every window by ground.",
        ))]
    }
}

fn columns(first: &[&'static str]) -> impl Iterator<Item = &'static str> {
    let first = first.iter().copied();
    first.chain(CLASSES.map(|class| class.as_str()))
}

fn counts(windows: ByClass) -> impl Iterator<Item = Cell> {
    windows.into_iter().map(|count| Cell::Count(count as u64))
}

fn balance(set: &DataSet) -> Table {
    let grounds = set.by_ground();
    let row = |(ground, windows): (&&str, &ByClass)| {
        let all = windows.iter().sum::<usize>() as u64;
        let first = [Cell::text(*ground), Cell::Count(all)];
        first.into_iter().chain(counts(*windows)).collect()
    };
    let rows = grounds.iter().map(row);
    Table::of(columns(&["ground", "windows"]), rows).captioned("Windows by ground and true class")
}

fn parts(set: &DataSet) -> Table {
    let row = |of: &OfPart| {
        let first = [
            Cell::Code(of.split.column().to_owned()),
            Cell::text(of.part.map_or("in none", Part::as_str)),
            Cell::Count(of.runs as u64),
        ];
        first.into_iter().chain(counts(of.windows)).collect()
    };
    let rows = set.by_part();
    Table::of(columns(&["split", "part", "runs"]), rows.iter().map(row)).captioned(
        "Recommended splits: runs, and windows by true class. The parts of a split are disjoint in runs, in \
         realisations of ground and noise, in conditions, or in both",
    )
}

/// The features of every window whose ground is known.
fn points(set: &DataSet) -> impl Iterator<Item = FeaturePoint> {
    let windows = set.windows();
    let feature = |name| {
        windows
            .column(name)
            .map(|cell| cell.parse().unwrap_or(f64::NAN))
    };
    let features = feature("p1")
        .zip(feature("p2"))
        .zip(feature("p3"))
        .zip(feature("p4"));
    let rows = windows.column("terrain").zip(features);
    rows.filter_map(|(terrain, (((p1, p2), p3), p4))| {
        let label = LABELS.into_iter().find(|label| label.as_str() == terrain)?;
        Some(FeaturePoint {
            group: Group::Terrain(label),
            p: [p1, p2, p3, p4],
        })
    })
}
