//! How many windows and runs of each kind a data set has.

use super::DataSet;
use super::splits::{GROUPINGS, Grouping, PARTS, Part};
use crate::recognition::confusion::CLASSES;
use std::collections::BTreeMap;

/// Windows by true class, in the order of [`CLASSES`].
pub type ByClass = [usize; CLASSES.len()];

/// One part of a split.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OfPart {
    /// The split.
    pub split: Grouping,
    /// Its subset; none for one excluded by a split by both.
    pub part: Option<Part>,
    /// Runs in it.
    pub runs: usize,
    /// Their windows.
    pub windows: ByClass,
}

impl DataSet {
    /// Windows of every ground, by its label.
    pub fn by_ground(&self) -> BTreeMap<&str, ByClass> {
        let mut grounds = BTreeMap::new();
        let columns = self.windows.column("terrain");
        for (terrain, class) in columns.zip(self.windows.column("class")) {
            let own: &mut ByClass = grounds.entry(terrain).or_default();
            for (count, known) in own.iter_mut().zip(CLASSES) {
                *count += usize::from(class == known.as_str());
            }
        }
        grounds
    }

    /// Windows of all grounds.
    pub fn by_class(&self) -> ByClass {
        let mut sums = ByClass::default();
        for counts in self.by_ground().values() {
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum += count;
            }
        }
        sums
    }

    /// Parts of every split that have runs; none of a split with too few groups.
    pub fn by_part(&self) -> Vec<OfPart> {
        let splits = GROUPINGS.into_iter().enumerate();
        let parts = splits.flat_map(|(index, split)| {
            let parts = PARTS.map(|(part, _)| Some(part)).into_iter().chain([None]);
            parts.map(move |part| self.of_part(index, split, part))
        });
        parts.filter(|of| of.runs > 0).collect()
    }

    fn of_part(&self, index: usize, split: Grouping, part: Option<Part>) -> OfPart {
        let runs = self.parts[index].iter().flatten();
        let name = part.map_or("", Part::as_str);
        let cells = || {
            let parts = self.windows.column(split.column());
            parts.zip(self.windows.column("class"))
        };
        OfPart {
            split,
            part,
            runs: runs.filter(|of| **of == part).count(),
            windows: CLASSES.map(|class| {
                let here = cells().filter(|&(of, is)| of == name && is == class.as_str());
                here.count()
            }),
        }
    }
}
