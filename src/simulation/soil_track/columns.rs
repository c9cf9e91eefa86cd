//! The ground itself: columns that remember what pressed them.

use super::Pressed;
use crate::simulation::contact::WheelGeometry;
use crate::simulation::motion::WheelMotion;
use crate::soil::Soil;
use crate::terrain::profile::Profile;
use libm::{asin, sqrt, tan};
use std::collections::VecDeque;
use std::ops::Range;

/// Width of a column [m].
pub(super) const COLUMN: f64 = 1.0e-3;

/// Columns made at once.
const BLOCK: i64 = 128;

/// Loose slopes are relaxed this often [s].
const RELAX_EVERY: f64 = 0.02;

/// One millimetre of track.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// Height before any wheel came [m].
    undisturbed: f64,
    /// Height of the same soil if nothing had pressed it [m]: lower where soil was taken off.
    virgin: f64,
    /// Height when the wheel arrived [m].
    arrival: f64,
    /// Lowest level it was pressed to [m].
    pressed: f64,
    /// Soil that slid off to the sides, as a height over the wheel's width [m].
    beside: f64,
    /// Whether the rim bears on it.
    loaded: bool,
    /// Whether a stone lies on it.
    covered: bool,
}

/// Where the surface of one column is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Height [m] of the same soil if nothing had pressed it.
    pub virgin: f64,
    /// Height [m] now.
    pub height: f64,
    /// Depth [m] of soil taken off.
    pub dug: f64,
}

/// The columns of one stretch; 48 kB a metre, kept for the run.
pub(super) struct Columns {
    profile: Profile,
    range: [f64; 2],
    first: i64,
    columns: VecDeque<Column>,
    /// Columns under the wheel at the last look.
    under: Range<i64>,
    /// Columns that stones lie on.
    covered: Vec<i64>,
    /// Greatest step between neighbours at the angle of repose [m].
    steepest: f64,
    since_relaxed: f64,
}

impl Columns {
    pub fn new(profile: Profile, soil: &Soil, range: [f64; 2]) -> Self {
        let steepest = COLUMN * tan(soil.repose_angle_deg.to_radians());
        Self {
            profile,
            range,
            first: 0,
            columns: VecDeque::new(),
            under: 0..0,
            covered: Vec::new(),
            steepest,
            since_relaxed: 0.0,
        }
    }

    /// Undisturbed height at `x` [m].
    pub fn undisturbed(&mut self, x: f64) -> f64 {
        self.profile.extend(x, x);
        self.profile.at(x).height
    }

    /// The surface as it is now between two places: position and height [m].
    pub fn surface(&mut self, low: f64, high: f64) -> Vec<[f64; 2]> {
        self.extend(low, high);
        self.indices(low, high)
            .map(|index| [index as f64 * COLUMN, self.column(index).height()])
            .collect()
    }

    /// Keeps up with a wheel at `x` [m]: new columns ahead, old ones left behind, slopes relaxed.
    pub fn follow(&mut self, wheel: &WheelGeometry, x: f64, elapsed: f64) {
        let span = wheel.tip_radius + 10.0 * COLUMN;
        self.extend(x - 1.5 * span, x + 1.5 * span);
        self.leave_behind(x - wheel.radius, x + wheel.radius);
        self.since_relaxed += elapsed;
        if self.since_relaxed >= RELAX_EVERY {
            self.since_relaxed = 0.0;
            self.relax(x - 1.5 * span, x + 1.5 * span);
        }
    }

    /// Columns in `[low, high]` [m] that belong to this stretch.
    pub fn indices(&self, low: f64, high: f64) -> Range<i64> {
        let low = (low.max(self.range[0]) / COLUMN).ceil() as i64;
        let high = (high.min(self.range[1]) / COLUMN).floor() as i64 + 1;
        low..high.max(low)
    }

    /// The column at `x` [m], where it belongs to this stretch.
    pub fn index_at(&self, x: f64) -> Option<i64> {
        let index = (x / COLUMN).round() as i64;
        self.contains(index).then_some(index)
    }

    fn contains(&self, index: i64) -> bool {
        let x = index as f64 * COLUMN;
        x >= self.range[0] && x < self.range[1]
    }

    /// Presses a column down to `level` [m] if it stands higher.
    pub fn press(&mut self, index: i64, level: f64) -> Pressed {
        let column = self.column_mut(index);
        if level < column.arrival {
            column.pressed = column.pressed.min(level);
        }
        Pressed {
            virgin: column.virgin,
            lowest: column.pressed,
            reached: column.pressed - column.dug(),
        }
    }

    /// Notes whether the rim bears on a column.
    pub fn set_loaded(&mut self, index: i64, loaded: bool) {
        self.column_mut(index).loaded = loaded;
    }

    /// Extends the columns to cover `[low, high]` [m].
    pub fn reach(&mut self, low: f64, high: f64) {
        self.extend(low, high);
    }

    /// Takes the soil above `level` [m] out: what lies below counts as undisturbed.
    pub fn dig_out(&mut self, index: i64, level: f64) {
        let column = self.column_mut(index);
        if level < column.pressed {
            *column = Column {
                undisturbed: level,
                virgin: level,
                arrival: level,
                pressed: level,
                ..*column
            };
        }
        self.cover(index);
    }

    /// Notes that a stone lies on a column, until [`Columns::uncover`].
    pub fn cover(&mut self, index: i64) {
        self.column_mut(index).covered = true;
        self.covered.push(index);
    }

    /// Forgets where stones lay.
    pub fn uncover(&mut self) {
        for index in std::mem::take(&mut self.covered) {
            self.column_mut(index).covered = false;
        }
    }

    /// Whether the rim bears on a column.
    pub fn is_loaded(&self, index: i64) -> bool {
        self.column(index).loaded
    }

    /// Whether soil may come onto a column and leave it: not below a stone.
    pub fn can_pass(&self, index: i64) -> bool {
        !self.column(index).covered
    }

    /// Puts soil of this height [m] on a column, or takes it off where it is below 0.
    pub fn carry(&mut self, index: i64, height: f64) {
        self.column_mut(index).carry(height);
    }

    /// A column's surface.
    pub fn surface_at(&self, index: i64) -> Surface {
        let column = self.column(index);
        Surface {
            virgin: column.virgin,
            height: column.height(),
            dug: column.dug(),
        }
    }

    /// Lets soil that stands above undisturbed ground in `[low, high]` [m] slide to both sides of a wheel of `width` [m].
    ///
    /// A berm as high as the soil beside it, at the angle of repose, holds `h²/(b tan β)` of it, as a height over the
    /// wheel's width; it does not slide back.
    pub fn spread(&mut self, [low, high]: [f64; 2], width: f64) {
        let slope = self.steepest / COLUMN;
        for index in self.indices(low, high) {
            let column = self.column_mut(index);
            let above = column.height() - column.undisturbed;
            if above <= 0.0 || column.loaded || column.covered {
                continue;
            }
            let berm = above * above / (width * slope);
            let slides = (0.5 * (berm - column.beside)).clamp(0.0, 0.5 * above);
            column.carry(-slides);
            column.beside += slides;
        }
    }

    /// Leaves a print down to `level` [m] where no rim lies above it.
    pub fn print(&mut self, index: i64, level: f64) {
        let column = self.column_mut(index);
        if !column.loaded {
            column.pressed = column.pressed.min(level);
        }
    }

    /// Angle [rad] from straight down at which the rim meets the soil it has come upon.
    ///
    /// Met only behind, as on a bump there under a wheel just let down, it counts as if met ahead:
    /// the contact of a wheel at rest reaches alike to both sides.
    pub fn entry_angle(&self, radius: f64, motion: &WheelMotion, direction: f64) -> f64 {
        let reach = (radius * 0.95 / COLUMN) as i64;
        let middle = (motion.x / COLUMN).round() as i64;
        let mut ahead: Option<[f64; 2]> = None;
        for step in (-reach..=reach).rev() {
            let index = middle + step * direction as i64;
            if !self.contains(index) {
                continue;
            }
            let u = (index as f64 * COLUMN - motion.x) * direction;
            let rim = motion.y - sqrt(radius * radius - u * u);
            let depth = self.column(index).arrival - rim;
            if depth > 0.0 {
                let entry = match ahead {
                    Some([u_ahead, above]) => u + (u_ahead - u) * depth / (depth - above),
                    None => u,
                };
                return asin((entry.abs() / radius).min(1.0));
            }
            ahead = Some([u, depth]);
        }
        0.0
    }

    fn extend(&mut self, low: f64, high: f64) {
        let wanted = [
            (low / COLUMN).floor() as i64,
            (high / COLUMN).ceil() as i64 + 1,
        ];
        if self.columns.is_empty() {
            self.first = wanted[0];
        } else if self.first <= wanted[0] && self.first + (self.columns.len() as i64) >= wanted[1] {
            return;
        }
        let margin = BLOCK as f64 * COLUMN;
        self.profile.extend(low - margin, high + margin);
        while self.first > wanted[0] {
            for _ in 0..BLOCK {
                self.first -= 1;
                let column = self.fresh(self.first);
                self.columns.push_front(column);
            }
        }
        while self.first + (self.columns.len() as i64) < wanted[1] {
            for _ in 0..BLOCK {
                let column = self.fresh(self.first + self.columns.len() as i64);
                self.columns.push_back(column);
            }
        }
    }

    fn fresh(&self, index: i64) -> Column {
        let virgin = self.profile.at(index as f64 * COLUMN).height;
        Column {
            undisturbed: virgin,
            virgin,
            arrival: virgin,
            pressed: virgin,
            beside: 0.0,
            loaded: false,
            covered: false,
        }
    }

    fn column(&self, index: i64) -> &Column {
        &self.columns[(index - self.first) as usize]
    }

    fn column_mut(&mut self, index: i64) -> &mut Column {
        &mut self.columns[(index - self.first) as usize]
    }

    /// Columns the rim has left meet the next pass as they are now.
    fn leave_behind(&mut self, low: f64, high: f64) {
        let under = self.indices(low, high);
        let before = std::mem::replace(&mut self.under, under.clone());
        for index in before {
            if !under.contains(&index) {
                let column = self.column_mut(index);
                column.arrival = column.height();
                column.loaded = false;
            }
        }
    }

    /// Slopes beyond the angle of repose slide, soil for soil, where the wheel is not.
    fn relax(&mut self, low: f64, high: f64) {
        let indices = self.indices(low, high);
        for index in indices.start..(indices.end - 1).max(indices.start) {
            let (left, right) = (*self.column(index), *self.column(index + 1));
            if left.loaded || right.loaded || left.covered || right.covered {
                continue;
            }
            let step = right.pressed - left.pressed;
            let slide = 0.5 * (step.abs() - self.steepest).max(0.0) * step.signum();
            if slide != 0.0 {
                self.column_mut(index).settle(slide);
                self.column_mut(index + 1).settle(-slide);
            }
        }
    }
}

impl Column {
    fn height(&self) -> f64 {
        self.pressed.min(self.arrival)
    }

    /// Depth [m] of soil taken off.
    fn dug(&self) -> f64 {
        (self.undisturbed - self.virgin).max(0.0)
    }

    /// Takes up loose soil of this height [m], or gives away soil as dense as it lies.
    fn carry(&mut self, height: f64) {
        if height > 0.0 {
            self.settle(height);
        } else {
            self.virgin += height;
            self.arrival += height;
            self.pressed += height;
        }
    }

    /// Takes up or gives away soil of this height [m].
    fn settle(&mut self, height: f64) {
        self.pressed += height;
        self.arrival += height;
        self.virgin = self.virgin.max(self.pressed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::simulation::soil_track::tests::sand;
    use crate::terrain::Relief;

    fn flat() -> Columns {
        let profile = Profile::new(&Relief::default(), 1.0e-3, Seed(0), 0);
        let mut columns = Columns::new(profile, &sand(), [f64::NEG_INFINITY, f64::INFINITY]);
        columns.reach(-0.5, 0.5);
        columns
    }

    /// Soil [m] in all columns and beside them, over columns of one width.
    fn soil_of(columns: &Columns) -> f64 {
        let all = columns.indices(-0.4, 0.4);
        all.map(|index| columns.column(index))
            .map(|column| column.height() + column.beside)
            .sum()
    }

    #[test]
    fn soil_carried_slid_and_spread_is_conserved() {
        let mut columns = flat();
        let mut moved = 0.0;
        for step in 0..20_000 {
            // A hole dug at 0 and heaped 50 mm on.
            let height = 2.0e-6;
            columns.carry(0, -height);
            columns.carry(50, height);
            moved += height;
            if step % 10 == 0 {
                columns.relax(-0.4, 0.4);
                columns.spread([-0.4, 0.4], 0.15);
            }
        }
        let lost = soil_of(&columns).abs();
        assert!(lost < 1e-6 * moved, "{lost} of {moved}");
        let heap = columns.column(50);
        assert!(heap.height() > 0.003, "{}", heap.height());
        assert!(heap.beside > 0.5 * heap.height() * heap.height() / (0.15 * 0.62));
    }

    #[test]
    fn a_column_is_no_denser_for_soil_taken_off_it_and_looser_for_soil_put_on() {
        let mut columns = flat();
        columns.press(0, -0.010);
        columns.carry(0, -0.002);
        let dug = columns.surface_at(0);
        assert!((dug.virgin - dug.height - 0.010).abs() < 1e-15);
        assert!((dug.dug - 0.002).abs() < 1e-15);
        columns.carry(0, 0.003);
        let filled = columns.surface_at(0);
        assert!((filled.virgin - filled.height - 0.007).abs() < 1e-15);
    }
}
