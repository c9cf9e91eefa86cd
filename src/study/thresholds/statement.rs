//! The statements of (55) to (58), tested on the windows of a study.

use super::row::{DisplacementRow, WindowRow};
use super::tally::{Bounded, Empirical, Tally};
use crate::study::cells::Number;
use crate::study::{Axis, Study};
use crate::trace::truth::MOST;
use crate::vibration::bounds::mean_square_bound_of_jumps;
use serde::Serialize;

/// Validity of the limits on the windows of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ThresholdScore {
    /// Windows of all runs that did not fail.
    pub windows: usize,
    /// Of these, the true ALCT: nine in ten lugs or more touched.
    pub all_touched: usize,
    /// The sweeps of the study.
    #[serde(skip)]
    pub axes: Vec<Axis>,
    /// Every limit, for multi-lugged wheels and for olig-lugged ones.
    pub statements: Vec<Statement>,
}

/// One limit and the windows of one kind of wheel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// Short name: of a file, for example.
    pub name: String,
    /// The paper's equation, or where the limit comes from.
    pub equation: &'static str,
    /// What is limited.
    pub quantity: String,
    /// What limits it.
    pub limit: &'static str,
    /// Whether the rim of these wheels clears flat ground between the lugs.
    pub multi_lugged: bool,
    /// All windows, and parts of them.
    pub parts: Vec<Part>,
    /// A limit from the even repeats, checked on the odd ones.
    pub empirical: Option<Empirical>,
    /// Every window.
    #[serde(skip)]
    pub points: Vec<Point>,
}

/// The windows at one entry of a sweep, or all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// The sweep's keys, or `all`.
    pub by: String,
    /// The entry's values.
    pub value: String,
    /// Its windows.
    #[serde(flatten)]
    pub tally: Tally,
}

/// A window.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its entry of every [`Axis`].
    pub entries: Vec<usize>,
    /// What was found and what limits it.
    pub bounded: Bounded,
    repeat: u64,
}

/// A limit to be put to the windows.
struct Limit {
    name: String,
    equation: &'static str,
    quantity: String,
    limit: &'static str,
    of: Of,
    value: Value,
    bound: Bound,
}

/// Which motion is limited; it decides on which windows every lug touched.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Displacement,
    Acceleration,
}

/// What of a window is limited.
type Value = Box<dyn Fn(&WindowRow) -> Option<f64>>;

#[derive(Clone, Copy, PartialEq)]
enum Bound {
    /// (57), or the olig-lugged wheel's own.
    Amplitude,
    /// Its square.
    MeanSquare,
    /// With the steepest line between contacts.
    OnSlope,
    /// From velocity jumps.
    Jumps,
}

impl Bound {
    fn of(self, window: &WindowRow) -> Option<f64> {
        let amplitude = window.bound_kappa_a.get();
        match self {
            Self::Amplitude => amplitude,
            Self::MeanSquare => amplitude.map(|bound| bound * bound),
            Self::OnSlope => window.displacement.bound_on_slope.get(),
            Self::Jumps => Some(mean_square_bound_of_jumps(1.0 - MOST)),
        }
    }

    /// Whether it is derived for wheels whose rim comes down between lugs.
    fn is_for_olig_lugged(self) -> bool {
        matches!(self, Self::Amplitude | Self::MeanSquare)
    }
}

impl Statement {
    /// Whether the limit is the one that the paper states.
    pub fn is_the_papers(&self) -> bool {
        self.limit == PAPER
    }
}

/// (57), and its square (58).
const PAPER: &str = "the paper's, 4 cos²(α/4) for amplitudes and its square for mean squares";
const SLOPE: &str = "corrected, with the steepest line between contacts of neighbouring lugs";
const JUMPS: &str = "of velocity jumps without slip, a tenth of the lugs missing singly";
const BUMP: &str = "off a bump off which the next lug still touches, (r + l)(1 - cos(min(α + φ_s, π/2)))/l, squared for mean squares";

/// The limits of displacements, (55) and (56): of the largest or median displacement on a lug, of the sum of
/// amplitudes, and of the mean square.
fn of_displacement() -> Vec<Limit> {
    let limit = |name: &str, quantity: &str, of: Displaced, bound| Limit {
        name: name.to_owned(),
        equation: if bound == MeanSquare { "(56)" } else { "(55)" },
        quantity: quantity.to_owned(),
        limit: if bound == OnSlope { SLOPE } else { PAPER },
        of: Of::Displacement,
        value: Box::new(move |window| of(&window.displacement).get()),
        bound,
    };
    let largest = "C_M of the window's largest displacement on a lug";
    let median = "C_M of the window's median displacement on a lug";
    let longest = "C_f², the largest displacement on a lug above the line between takeovers";
    let sum = "κ_A, sum of amplitudes of the displacement";
    let sum_above = "κ_A of the displacement above the lines between takeovers";
    let square = "κ_ms, mean square of the displacement";
    let square_above = "κ_ms of the displacement above the lines between takeovers";
    let turn: Displaced = |it| it.c_f_largest.get().map(|c_f| c_f * c_f).into();
    use Bound::{Amplitude, MeanSquare, OnSlope};
    vec![
        limit("contact", largest, |it| it.c_m[1], Amplitude),
        limit("contact_median", median, |it| it.c_m[0], Amplitude),
        limit("contact_on_slope", largest, |it| it.c_m[1], OnSlope),
        limit("contact_relative", longest, turn, Amplitude),
        limit("displacement_a", sum, |it| it.kappa[0], Amplitude),
        limit("relative_a", sum_above, |it| it.relative[0], Amplitude),
        limit("displacement_ms", square, |it| it.kappa[1], MeanSquare),
        limit("relative_ms", square_above, |it| it.relative[1], MeanSquare),
    ]
}

/// A value of the displacement in a window.
type Displaced = fn(&DisplacementRow) -> Number;

/// The limits of accelerations at the bandwidth [Hz] of this number.
fn of_acceleration(number: usize, bandwidth: f64) -> [Limit; 3] {
    let limit = |name: &str, equation, limit, kappa: usize, bound| Limit {
        name: format!("{name}_{bandwidth}_hz"),
        equation,
        quantity: format!(
            "{} of the acceleration, {bandwidth} Hz",
            ["κ_A", "κ_ms"][kappa]
        ),
        limit,
        of: Of::Acceleration,
        value: Box::new(move |window| window.acceleration[number][kappa].get()),
        bound,
    };
    [
        limit("acceleration_a", "(57)", PAPER, 0, Bound::Amplitude),
        limit("acceleration_ms", "(58)", PAPER, 1, Bound::MeanSquare),
        limit("jumps_ms", "(58)", JUMPS, 1, Bound::Jumps),
    ]
}

impl Limit {
    /// The statement for one kind of wheel; `None` where the limit is not for it, or no window is.
    fn put_to(
        &self,
        windows: &[WindowRow],
        study: &Study,
        axes: &[Axis],
        multi: bool,
    ) -> Option<Statement> {
        if !multi && (!self.bound.is_for_olig_lugged() || self.name.contains("relative")) {
            return None;
        }
        let of_kind = windows.iter().filter(|it| it.multi_lugged == multi);
        let points: Vec<Point> = of_kind
            .filter_map(|window| self.point(window, study))
            .collect();
        let repeats = |odd: u64| -> Vec<Bounded> {
            let chosen = points.iter().filter(|point| point.repeat % 2 == odd);
            chosen.map(|point| point.bounded).collect()
        };
        let limit = if multi { self.limit } else { BUMP };
        Some(Statement {
            name: self.name.clone(),
            equation: self.equation,
            quantity: self.quantity.clone(),
            limit,
            multi_lugged: multi,
            parts: parts(&points, axes)?,
            empirical: Empirical::of(&repeats(0), &repeats(1)),
            points,
        })
    }

    /// A window on which every lug touched: in truth, and for displacements also where the wheel
    /// is rolled without slip.
    fn point(&self, window: &WindowRow, study: &Study) -> Option<Point> {
        let rolled = window.displacement.rolled_touched_share.get() >= Some(MOST);
        if !window.is_alct() || self.of == Of::Displacement && !rolled {
            return None;
        }
        Some(Point {
            entries: study.condition(window.place.condition).1,
            bounded: Bounded {
                value: (self.value)(window)?,
                bound: self.bound.of(window)?,
            },
            repeat: u64::from(window.place.repeat),
        })
    }
}

/// All windows, then those at each entry of each sweep that has some.
fn parts(points: &[Point], axes: &[Axis]) -> Option<Vec<Part>> {
    let bounded: Vec<Bounded> = points.iter().map(|point| point.bounded).collect();
    let mut parts = vec![Part {
        by: "all".to_owned(),
        value: String::new(),
        tally: Tally::of(&bounded)?,
    }];
    for (number, axis) in axes.iter().enumerate() {
        for (entry, value) in axis.values.iter().enumerate() {
            let within = points.iter().filter(|point| point.entries[number] == entry);
            let bounded: Vec<Bounded> = within.map(|point| point.bounded).collect();
            parts.extend(Tally::of(&bounded).map(|tally| Part {
                by: axis.name.clone(),
                value: value.clone(),
                tally,
            }));
        }
    }
    Some(parts)
}

impl ThresholdScore {
    /// Puts the limits to the windows of a study with accelerations at these bandwidths [Hz].
    pub(super) fn of(study: &Study, bandwidths: &[f64], windows: &[WindowRow]) -> Self {
        let axes = study.axes();
        let accelerations = bandwidths.iter().enumerate();
        let accelerations = accelerations.flat_map(|(number, b)| of_acceleration(number, *b));
        let limits: Vec<Limit> = of_displacement().into_iter().chain(accelerations).collect();
        let statements = [true, false].iter().flat_map(|multi| {
            let put = |limit: &Limit| limit.put_to(windows, study, &axes, *multi);
            limits.iter().filter_map(put).collect::<Vec<Statement>>()
        });
        Self {
            windows: windows.len(),
            all_touched: windows.iter().filter(|it| it.is_alct()).count(),
            statements: statements.collect(),
            axes,
        }
    }
}
