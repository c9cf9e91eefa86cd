//! The statements of (55) to (58), tested on the windows of a study.

use super::tally::{Bounded, Empirical, Tally};
use super::{Thresholds, acceleration_columns};
use crate::study::table::{Stored, StoredRow};
use crate::study::{Axis, Study};
use crate::terrain::class::Wtic;
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

enum Value {
    Column(String),
    SquareOf(&'static str),
}

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
    fn of(self, window: &StoredRow) -> Option<f64> {
        let amplitude = window.number("bound_kappa_a");
        match self {
            Self::Amplitude => amplitude,
            Self::MeanSquare => amplitude.map(|bound| bound * bound),
            Self::OnSlope => window.number("bound_on_slope"),
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

/// The limits of displacements: (55) and (56).
fn of_displacement() -> Vec<Limit> {
    let mut limits = of_contact();
    limits.extend(of_spectrum());
    limits
}

fn displacement_limit(
    name: &str,
    equation: &'static str,
    quantity: &str,
    value: Value,
    bound: Bound,
) -> Limit {
    let limit = if bound == Bound::OnSlope {
        SLOPE
    } else {
        PAPER
    };
    Limit {
        name: name.to_owned(),
        equation,
        quantity: quantity.to_owned(),
        limit,
        of: Of::Displacement,
        value,
        bound,
    }
}

/// The limits of the largest or median displacement on a lug.
fn of_contact() -> Vec<Limit> {
    let limit =
        |name, quantity, value, bound| displacement_limit(name, "(55)", quantity, value, bound);
    let column = |name: &str| Value::Column(name.to_owned());
    let contact = "C_M of the window's largest displacement on a lug";
    vec![
        limit("contact", contact, column("c_m_largest"), Bound::Amplitude),
        limit(
            "contact_median",
            "C_M of the window's median displacement on a lug",
            column("c_m_median"),
            Bound::Amplitude,
        ),
        limit(
            "contact_on_slope",
            contact,
            column("c_m_largest"),
            Bound::OnSlope,
        ),
        limit(
            "contact_relative",
            "C_f², the largest displacement on a lug above the line between takeovers",
            Value::SquareOf("c_f_largest"),
            Bound::Amplitude,
        ),
    ]
}

/// The limits of the sum of amplitudes and of the mean square, of the displacement itself and of that above the
/// lines between takeovers.
fn of_spectrum() -> Vec<Limit> {
    let amplitudes = |name: &str, quantity| {
        let column = Value::Column(format!("{name}_kappa_a"));
        let name = format!("{name}_a");
        displacement_limit(&name, "(55)", quantity, column, Bound::Amplitude)
    };
    let mean_square = |name: &str, quantity| {
        let column = Value::Column(format!("{name}_kappa_ms"));
        let name = format!("{name}_ms");
        displacement_limit(&name, "(56)", quantity, column, Bound::MeanSquare)
    };
    vec![
        amplitudes("displacement", "κ_A, sum of amplitudes of the displacement"),
        amplitudes(
            "relative",
            "κ_A of the displacement above the lines between takeovers",
        ),
        mean_square("displacement", "κ_ms, mean square of the displacement"),
        mean_square(
            "relative",
            "κ_ms of the displacement above the lines between takeovers",
        ),
    ]
}

/// The limits of accelerations at a bandwidth [Hz].
fn of_acceleration(bandwidth: f64) -> Vec<Limit> {
    let [kappa_a, kappa_ms] = acceleration_columns(bandwidth);
    let limit = |name: &str, equation, quantity: &str, limit, column: &String, bound| Limit {
        name: format!("{name}_{bandwidth}_hz"),
        equation,
        quantity: format!("{quantity} of the acceleration, {bandwidth} Hz"),
        limit,
        of: Of::Acceleration,
        value: Value::Column(column.clone()),
        bound,
    };
    vec![
        limit(
            "acceleration_a",
            "(57)",
            "κ_A",
            PAPER,
            &kappa_a,
            Bound::Amplitude,
        ),
        limit(
            "acceleration_ms",
            "(58)",
            "κ_ms",
            PAPER,
            &kappa_ms,
            Bound::MeanSquare,
        ),
        limit("jumps_ms", "(58)", "κ_ms", JUMPS, &kappa_ms, Bound::Jumps),
    ]
}

/// Whether the rim clears flat ground between the lugs.
fn is_multi_lugged(window: &StoredRow) -> bool {
    window.text("multi_lugged") == "true"
}

/// Whether all lugs touched in truth and none entered.
fn is_alct(window: &StoredRow) -> bool {
    window.text("truth") == Wtic::Alct.as_str()
}

impl Limit {
    /// The statement for one kind of wheel; `None` where the limit is not for it, or no window is.
    fn put_to(
        &self,
        windows: &Stored,
        study: &Study,
        axes: &[Axis],
        multi: bool,
    ) -> Option<Statement> {
        if !multi && (!self.bound.is_for_olig_lugged() || self.name.contains("relative")) {
            return None;
        }
        let of_kind = windows
            .rows()
            .filter(|window| is_multi_lugged(window) == multi);
        let points: Vec<Point> = of_kind
            .filter_map(|window| self.point(&window, study))
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
    fn point(&self, window: &StoredRow, study: &Study) -> Option<Point> {
        let rolled = || window.number("rolled_touched_share") >= Some(MOST);
        if !is_alct(window) || self.of == Of::Displacement && !rolled() {
            return None;
        }
        let value = match &self.value {
            Value::Column(column) => window.number(column)?,
            Value::SquareOf(column) => window.number(column).map(|value| value * value)?,
        };
        Some(Point {
            entries: study.condition(window.count("condition")).1,
            bounded: Bounded {
                value,
                bound: self.bound.of(window)?,
            },
            repeat: window.count("repeat"),
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

impl Study {
    /// Puts the limits to the table of the windows, where the study has one.
    pub(in crate::study) fn hold_to_thresholds(
        &self,
        windows: Option<&str>,
    ) -> Option<ThresholdScore> {
        let Thresholds { bandwidths } = self.thresholds.as_ref()?;
        let windows = Stored::read(windows?);
        let axes = self.axes();
        let accelerations = bandwidths.iter().flat_map(|b| of_acceleration(*b));
        let limits: Vec<Limit> = of_displacement().into_iter().chain(accelerations).collect();
        let statements = [true, false].iter().flat_map(|multi| {
            let put = |limit: &Limit| limit.put_to(&windows, self, &axes, *multi);
            limits.iter().filter_map(put).collect::<Vec<Statement>>()
        });
        Some(ThresholdScore {
            windows: windows.rows().len(),
            all_touched: windows.rows().filter(is_alct).count(),
            statements: statements.collect(),
            axes,
        })
    }
}
