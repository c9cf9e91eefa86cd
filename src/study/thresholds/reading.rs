//! The rows of `thresholds.csv` as they are compared with the limits.

use crate::terrain::class::Wtic;
use csv::StringRecord;
use std::collections::HashMap;

/// The table of the windows.
pub(super) struct Windows {
    places: HashMap<String, usize>,
    records: Vec<StringRecord>,
}

/// A window.
pub(super) struct Window<'w> {
    table: &'w Windows,
    record: &'w StringRecord,
}

impl Windows {
    /// Reads a table that this program wrote: its columns are there.
    pub(super) fn read(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().cloned().unwrap_or_default();
        let places = header.iter().map(str::to_owned).zip(0..);
        Self {
            places: places.collect(),
            records: reader.records().flatten().collect(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.records.len()
    }

    pub(super) fn windows(&self) -> impl Iterator<Item = Window<'_>> {
        let window = |record| Window {
            table: self,
            record,
        };
        self.records.iter().map(window)
    }
}

impl Window<'_> {
    /// A number, unless the cell is empty.
    pub(super) fn number(&self, column: &str) -> Option<f64> {
        self.cell(column).parse().ok()
    }

    /// A number that every window has.
    pub(super) fn count(&self, column: &str) -> u64 {
        let count = self.cell(column).parse();
        count.expect("every window has its counts")
    }

    /// Whether the rim clears flat ground between the lugs.
    pub(super) fn is_multi_lugged(&self) -> bool {
        self.cell("multi_lugged") == "true"
    }

    /// Whether all lugs really touched and none entered.
    pub(super) fn is_alct(&self) -> bool {
        self.cell("truth") == Wtic::Alct.as_str()
    }

    fn cell(&self, column: &str) -> &str {
        let place = self.table.places.get(column);
        &self.record[*place.expect("the table of the thresholds has this column")]
    }
}
