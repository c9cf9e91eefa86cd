//! Points of the feature space, each with the mark of its terrain or class.

use super::figure::{Anchor, Canvas, Font, INK, MUTED, PALETTE, Stroke};
use crate::terrain::class::{TerrainLabel, Wtic};

/// Names of the features, as panels head them.
pub(super) const FEATURES: [&str; 4] = [
    "p_{1} = lg κ_{f}, frequency",
    "p_{2} = lg κ_{A}, sum of amplitudes",
    "p_{3} = lg κ_{mv}, mean value",
    "p_{4} = lg κ_{ms}, mean square",
];

/// What a point belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// The ground the wheel was on.
    Terrain(TerrainLabel),
    /// How its lugs met the ground.
    Class(Wtic),
}

/// The features of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeaturePoint {
    /// What it belongs to.
    pub group: Group,
    /// Feature vector `P` [-].
    pub p: [f64; 4],
}

/// The points all of whose features are numbers, and the groups among them in their order.
pub(super) fn drawable(points: &[FeaturePoint]) -> (Vec<FeaturePoint>, Vec<Group>) {
    let finite = |point: &&FeaturePoint| point.p.iter().all(|p| p.is_finite());
    let points: Vec<FeaturePoint> = points.iter().filter(finite).copied().collect();
    let mut groups: Vec<Group> = points.iter().map(|point| point.group).collect();
    groups.sort();
    groups.dedup();
    (points, groups)
}

/// Shape of a mark.
#[derive(Clone, Copy)]
enum Shape {
    Circle,
    Square,
    Diamond,
    Up,
    Down,
}

impl Group {
    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Terrain(label) => label.as_str(),
            Self::Class(class) => class.as_str(),
        }
    }

    /// Its name, and what that stands for.
    pub(super) fn long_name(self) -> String {
        let meaning = match self {
            Self::Terrain(TerrainLabel::Reference) => "flat hard ground",
            Self::Terrain(TerrainLabel::Hard) => "hard",
            Self::Terrain(TerrainLabel::Gravel) => "gravel",
            Self::Terrain(TerrainLabel::Sand) => "sand",
            Self::Terrain(TerrainLabel::HardWithGravel) => "hard with gravel",
            Self::Terrain(TerrainLabel::SandWithGravel) => "sand with gravel",
            Self::Class(_) => return self.name().to_owned(),
        };
        format!("{}, {meaning}", self.name())
    }

    /// Its colour.
    pub(super) fn colour(self) -> &'static str {
        match self {
            Self::Terrain(TerrainLabel::Hard) | Self::Class(Wtic::Alct) => PALETTE[0],
            Self::Terrain(TerrainLabel::Gravel) | Self::Class(Wtic::Slct) => PALETTE[2],
            Self::Terrain(TerrainLabel::Sand) | Self::Class(Wtic::Leis) => PALETTE[5],
            Self::Terrain(TerrainLabel::Reference) => PALETTE[4],
            Self::Terrain(TerrainLabel::HardWithGravel) => PALETTE[3],
            Self::Terrain(TerrainLabel::SandWithGravel) => PALETTE[1],
            Self::Class(Wtic::Uwtic) => MUTED,
        }
    }

    fn shape(self) -> Shape {
        match self {
            Self::Terrain(TerrainLabel::Reference) | Self::Class(Wtic::Uwtic) => Shape::Down,
            Self::Terrain(TerrainLabel::Hard) | Self::Class(Wtic::Alct) => Shape::Circle,
            Self::Terrain(TerrainLabel::Gravel) | Self::Class(Wtic::Slct) => Shape::Square,
            Self::Terrain(TerrainLabel::HardWithGravel) => Shape::Diamond,
            Self::Terrain(TerrainLabel::Sand) | Self::Class(Wtic::Leis) => Shape::Up,
            Self::Terrain(TerrainLabel::SandWithGravel) => Shape::Down,
        }
    }

    /// Its mark, centred at `at` [px].
    pub(super) fn mark(self, canvas: &mut Canvas, [x, y]: [f64; 2]) {
        let outline = Stroke::solid("#ffffff", 0.8);
        let corners: &[[f64; 2]] = match self.shape() {
            Shape::Circle => return canvas.circle([x, y], 4.5, self.colour(), outline),
            Shape::Square => &[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]],
            Shape::Diamond => &[[0.0, -5.5], [5.5, 0.0], [0.0, 5.5], [-5.5, 0.0]],
            Shape::Up => &[[0.0, -5.5], [5.0, 3.8], [-5.0, 3.8]],
            Shape::Down => &[[0.0, 5.5], [5.0, -3.8], [-5.0, -3.8]],
        };
        let points: Vec<[f64; 2]> = corners.iter().map(|[dx, dy]| [x + dx, y + dy]).collect();
        canvas.polygon(&points, self.colour(), outline);
    }
}

/// Marks and names of `groups` in a line from `at` [px] on; where the line ends.
pub(super) fn draw_marks(canvas: &mut Canvas, groups: &[Group], [left, y]: [f64; 2]) -> f64 {
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let mut left = left;
    for group in groups {
        group.mark(canvas, [left + 6.0, y - 5.0]);
        let name = group.long_name();
        canvas.text([left + 18.0, y], Anchor::Start, font, &name);
        left += 18.0 + font.width(&name) + 18.0;
    }
    left
}

/// What the reader has to know of points that are not drawn.
pub(super) fn left_out(all: usize, drawn: usize) -> Option<String> {
    (drawn < all).then(|| {
        let missing = all - drawn;
        format!("{missing} of {all} windows have a feature that is 0 or no number and are left out")
    })
}
