//! A row for every window of a run: when, on what, its class, its features.
//!
//! Features are those of [`features`](crate::features) at their default settings, over the reference
//! given, and the power of the vibration in bands. A window in which they cannot be had has empty
//! cells.

use crate::dataset::records::{Field, cell};
use crate::features::band_powers::BANDS;
use crate::features::record::Record;
use crate::features::reference::Reference;
use crate::features::{Extractor, Settings};
use crate::quantity::RangeError;
use crate::trace::{LugTally, Trace};
use std::ops::Range;

/// The columns of a window.
pub fn fields() -> Vec<Field> {
    let mut fields = vec![
        Field::number("start_s", "s", "begin of the window"),
        Field::number("end_s", "s", "end of the window"),
        Field::text(
            "terrain",
            "label of the ground for most of it: HT, GT, ST, HGT, SGT, REF",
        ),
        Field::text("class", "true interaction class: ALCT, SLCT, LEIS, UWTIC"),
        Field::number(
            "touched_share",
            "1",
            "share of the lugs passing the bottom that touched",
        ),
        Field::number(
            "entered_share",
            "1",
            "share of the lugs passing the bottom that entered",
        ),
        Field::number("lug_passes", "1", "how far the wheel turned, in lug angles"),
        Field::number("p1", "1", "lg of the frequency ratio (Eq. 51)"),
        Field::number(
            "p2",
            "1",
            "lg of the ratio of the sums of amplitudes (Eq. 52)",
        ),
        Field::number("p3", "1", "lg of the ratio of the rectified means (Eq. 53)"),
        Field::number("p4", "1", "lg of the ratio of the mean squares (Eq. 54)"),
    ];
    let power = |band| {
        let name = format!("power_{band}");
        Field::number(
            name,
            "lg (m/s^2)^2",
            "power of the acceleration in a band, the lowest first",
        )
    };
    fields.extend((1..=BANDS).map(power));
    fields
}

/// Cuts runs into windows.
pub struct Windower {
    extractor: Extractor,
    reference: Reference,
}

impl Windower {
    /// Windows and features by `settings`, over `reference`.
    ///
    /// # Errors
    /// Those of [`Settings::check`].
    pub fn new(settings: Settings, reference: Reference) -> Result<Self, RangeError> {
        Ok(Self {
            extractor: Extractor::new(settings)?,
            reference,
        })
    }

    /// The cells of every window of a run, in the order of [`fields`]. A run whose vibration cannot be
    /// used has its true class windows.
    pub fn rows(&mut self, trace: &Trace) -> Vec<Vec<String>> {
        let Ok(record) = Record::of(trace) else {
            let known = trace.truth.iter().flat_map(|truth| &truth.class_windows);
            let without = vec![String::new(); 1 + 4 + BANDS];
            let row = |times: [f64; 2]| [labels(trace, times), without.clone()].concat();
            return known
                .map(|window| row([window.start, window.end]))
                .collect();
        };
        let windows = record.windows(self.extractor.settings().window);
        let row = |window: Range<usize>| {
            let times = [record.time(window.start), record.time(window.end)];
            [labels(trace, times), self.values(&record, window)].concat()
        };
        windows.into_iter().map(row).collect()
    }

    fn values(&mut self, record: &Record, window: Range<usize>) -> Vec<String> {
        let mut cells = vec![cell(Some(record.lug_passes(&window)))];
        let features = self
            .extractor
            .features(record, window.clone(), &self.reference);
        let p = features.ok().map(|features| features.p());
        cells.extend((0..4).map(|number| cell(p.map(|p| p[number]))));
        let powers = self.extractor.band_powers(record, window).ok();
        cells.extend((0..BANDS).map(|band| cell(powers.map(|powers| powers[band]))));
        cells
    }
}

/// Times, ground and class of a window, and the shares of the lugs behind the class.
fn labels(trace: &Trace, times: [f64; 2]) -> Vec<String> {
    let known = trace.truth.as_ref();
    let truth = known.and_then(|truth| truth.window_of(times));
    let terrain = truth.map(|truth| truth.terrain);
    let terrain = terrain.or(trace.attributes.terrain);
    let class = truth.map(|truth| truth.class).or(trace.attributes.class);
    let shares = truth.and_then(|truth| truth.lugs).map(LugTally::shares);
    let mut cells: Vec<String> = times.map(|time| cell(Some(time))).into();
    cells.push(terrain.map_or_else(String::new, |terrain| terrain.to_string()));
    cells.push(class.map_or_else(String::new, |class| class.to_string()));
    cells.push(cell(shares.map(|[touched, _]| touched)));
    cells.push(cell(shares.map(|[_, entered]| entered)));
    cells
}
