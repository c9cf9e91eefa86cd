//! Identified parameters by ground, as bars with intervals (Fig. 23 and 24).

use super::feature_points::Group;
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, Panel, Stroke, reading};
use crate::identification::{Identified, Parameter, Standing};
use crate::table::four_digits;
use crate::terrain::class::TerrainLabel;

/// The parameters of a ground.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifiedGround {
    /// What stands below its bars.
    pub name: String,
    /// Its label, which gives its colour.
    pub label: TerrainLabel,
    /// What was identified, in the order of [`Parameter::ALL`].
    pub parameters: Vec<Identified>,
    /// The values its scenario has, in the same order and units, where it has them.
    pub own: Vec<Option<f64>>,
}

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Height of title and remarks [px].
const TITLE: f64 = 86.0;
/// Room left of a panel for its tick labels [px].
const TICKS: f64 = 66.0;
/// Room right of a panel [px].
const RIGHT: f64 = 14.0;
/// Height of a panel [px].
const HEIGHT: f64 = 260.0;
/// Room below a panel for names and values [px].
const NAMES: f64 = 54.0;
/// Half of a bar's width, in columns [-].
const HALF_BAR: f64 = 0.26;

/// One panel: a parameter, its header, and the factor from its unit to the header's.
struct Shown {
    parameter: Parameter,
    header: &'static str,
    factor: f64,
}

const SHOWN: [Shown; 6] = [
    shown(Parameter::SinkageModulus, "k_{s} [N/m^{N+2}]", 1.0),
    shown(Parameter::SinkageExponent, "n_{0} [-]", 1.0),
    shown(Parameter::SinkageExponentSlip, "n_{1} [-]", 1.0),
    shown(Parameter::Cohesion, "c_{} [Pa]", 1.0),
    shown(Parameter::FrictionAngle, "φ_{} [°]", 1.0),
    shown(Parameter::ShearModulus, "K_{} [mm]", 1.0e3),
];

const fn shown(parameter: Parameter, header: &'static str, factor: f64) -> Shown {
    Shown {
        parameter,
        header,
        factor,
    }
}

/// `k_s`, `n_0`, `n_1` above and `c`, `φ`, `K` below, a bar for every ground: the value and its
/// 95 % interval. Outlines without colour are values that the rows do not fix; a diamond is the
/// value the scenario has. `k_s` is on a logarithmic axis. One SVG 1200 px wide.
pub fn parameter_figure(grounds: &[IdentifiedGround]) -> String {
    let title = "Identified terrain parameters";
    let mut canvas = Canvas::new([WIDTH, 0.0], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let remarks = [
        "Bars are values, whiskers 95 % intervals. Dashed outline: the loads do not fix the parameter. Set: the class sets it.",
        "Diamond: what the scenario's ground has; explicit lugs act in the loads, so that an interval need not hold it.",
    ];
    for (line, remark) in remarks.into_iter().enumerate() {
        let at = [16.0, 53.0 + 19.0 * line as f64];
        canvas.text(at, Anchor::Start, Font::SMALL, remark);
    }
    let pitch = [WIDTH / 3.0, Panel::HEADER + HEIGHT + NAMES];
    for (place, shown) in SHOWN.iter().enumerate() {
        let area = Area {
            left: (place % 3) as f64 * pitch[0] + TICKS,
            top: TITLE + (place / 3) as f64 * pitch[1] + Panel::HEADER,
            width: pitch[0] - TICKS - RIGHT,
            height: HEIGHT,
        };
        draw_parameter(&mut canvas, area, shown, grounds);
    }
    canvas.set_height(TITLE + 2.0 * pitch[1]);
    canvas.finish()
}

/// A bar, in the panel's unit.
struct Bar {
    value: f64,
    ends: [Option<f64>; 2],
    own: Option<f64>,
    standing: Standing,
    label: TerrainLabel,
}

impl Bar {
    fn of(shown: &Shown, ground: &IdentifiedGround) -> Option<Self> {
        let place = shown.parameter as usize;
        let identified = ground.parameters.get(place)?;
        let scaled = |value: f64| value * shown.factor;
        Some(Self {
            value: scaled(identified.value),
            ends: identified.ci95().map(|end| end.map(scaled)),
            own: ground.own.get(place).copied().flatten().map(scaled),
            standing: identified.standing,
            label: ground.label,
        })
    }

    /// The value, its interval and the scenario's own value, with their unit.
    fn reading(&self, header: &str) -> String {
        let interval = match self.ends {
            [Some(low), Some(high)] if self.standing == Standing::Identified => {
                format!(" [{}, {}]", four_digits(low), four_digits(high))
            }
            _ => String::new(),
        };
        let standing = match self.standing {
            Standing::Identified => "",
            Standing::NotIdentifiable => ", not identifiable",
            Standing::SetByClass | Standing::Given => ", set",
        };
        let own = self
            .own
            .map(|own| format!("; the scenario's own {}", four_digits(own)));
        let value = reading(header, self.value);
        format!("{value}{interval}{standing}{}", own.unwrap_or_default())
    }

    /// Values that the axis has to show. That of a parameter that is not fixed may lie anywhere:
    /// only decades have room for it, else its bar is cut off.
    fn extent(&self, parameter: Parameter) -> impl Iterator<Item = f64> {
        let decades = parameter == Parameter::SinkageModulus;
        let fixed = decades || self.standing == Standing::Identified;
        let values = [Some(self.value), self.ends[0], self.ends[1]];
        values
            .into_iter()
            .filter(move |_| fixed)
            .chain([self.own])
            .flatten()
            .filter(|value| value.is_finite())
    }
}

fn draw_parameter(canvas: &mut Canvas, area: Area, shown: &Shown, grounds: &[IdentifiedGround]) {
    let bars: Vec<Option<Bar>> = grounds.iter().map(|g| Bar::of(shown, g)).collect();
    let columns = grounds.len().max(1) as f64;
    let panel = Panel {
        area,
        x: Axis::exact([0.0, columns], [area.left, area.right()]),
        y: upright(shown.parameter, &bars, &area),
    };
    panel.draw_category_frame(canvas, shown.header);
    let base = match shown.parameter {
        Parameter::SinkageModulus => area.bottom(),
        _ => panel.y.pixel(0.0),
    };
    canvas.clip(&area);
    canvas.polyline(
        &[[area.left, base], [area.right(), base]],
        Stroke::solid(MUTED, 1.2),
    );
    for (column, bar) in bars.iter().enumerate() {
        if let Some(bar) = bar {
            let middle = column as f64 + 0.5;
            let name = format!("{}: {}", grounds[column].name, bar.reading(shown.header));
            canvas.mark(&name, |canvas| draw_bar(canvas, &panel, middle, base, bar));
        }
    }
    canvas.unclip();
    for (column, (bar, ground)) in bars.iter().zip(grounds).enumerate() {
        let x = panel.x.pixel(column as f64 + 0.5);
        let room = area.width / columns;
        let name = Font {
            colour: INK,
            ..Font::SMALL
        };
        let below = area.bottom();
        let text = name.fit(&ground.name, room);
        canvas.text([x, below + 19.0], Anchor::Middle, name, &text);
        let text = bar.as_ref().map_or_else(|| "-".to_owned(), label);
        let text = Font::SMALL.fit(&text, room);
        canvas.text([x, below + 37.0], Anchor::Middle, Font::SMALL, &text);
    }
}

/// The upright axis: decades for `k_s`, from 0 for the others.
fn upright(parameter: Parameter, bars: &[Option<Bar>], area: &Area) -> Axis {
    let shown = bars.iter().flatten().flat_map(|bar| bar.extent(parameter));
    let [low, high] = shown.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    let pixels = [area.bottom(), area.top];
    match parameter {
        Parameter::SinkageModulus if low > 0.0 && low.is_finite() => {
            // Room for a bar of the least.
            Axis::decades([low / 3.0, high], pixels)
        }
        Parameter::SinkageModulus => Axis::decades([1.0e3, 1.0e10], pixels),
        _ if low.is_finite() => Axis::roomy([low.min(0.0), high.max(0.0)], pixels),
        _ => Axis::exact([0.0, 1.0], pixels),
    }
}

fn draw_bar(canvas: &mut Canvas, panel: &Panel, middle: f64, base: f64, bar: &Bar) {
    let [left, right] = [-HALF_BAR, HALF_BAR].map(|half| panel.x.pixel(middle + half));
    let top = panel.y.pixel(bar.value);
    let colour = Group::Terrain(bar.label).colour();
    let corners = [[left, base], [right, base], [right, top], [left, top]];
    match bar.standing {
        Standing::Identified => canvas.polygon(&corners, colour, Stroke::solid(INK, 1.0)),
        Standing::NotIdentifiable => canvas.polygon(&corners, "none", Stroke::dashed(MUTED, 1.2)),
        Standing::SetByClass | Standing::Given => {}
    }
    if bar.standing == Standing::Identified {
        draw_whisker(canvas, panel, middle, bar.ends);
    }
    if let Some(own) = bar.own {
        let [x, y] = panel.at([middle, own]);
        const SIZE: f64 = 7.0;
        let corners = [[x, y - SIZE], [x + SIZE, y], [x, y + SIZE], [x - SIZE, y]];
        canvas.polygon(&corners, "#ffffff", Stroke::solid(INK, 1.6));
    }
}

/// From end to end, to the frame where an end is open.
fn draw_whisker(canvas: &mut Canvas, panel: &Panel, middle: f64, [low, high]: [Option<f64>; 2]) {
    let x = panel.x.pixel(middle);
    let end = |end: Option<f64>, open: f64| end.map_or(open, |value| panel.y.pixel(value));
    let [bottom, top] = [end(low, panel.area.bottom()), end(high, panel.area.top)];
    canvas.polyline(&[[x, bottom], [x, top]], Stroke::solid(INK, 1.6));
    for (y, closed) in [(bottom, low.is_some()), (top, high.is_some())] {
        if closed {
            canvas.polyline(&[[x - 7.0, y], [x + 7.0, y]], Stroke::solid(INK, 1.6));
        }
    }
}

/// What stands below a bar.
fn label(bar: &Bar) -> String {
    match bar.standing {
        Standing::Identified => three_digits(bar.value),
        Standing::NotIdentifiable => "not fixed".to_owned(),
        Standing::SetByClass => "set to 0".to_owned(),
        Standing::Given => format!("{} given", three_digits(bar.value)),
    }
}

fn three_digits(value: f64) -> String {
    let size = value.abs();
    let text = if size >= 1.0e5 {
        format!("{value:.2e}")
    } else if size >= 100.0 || size == 0.0 {
        format!("{value:.0}")
    } else {
        let before = libm::floor(libm::log10(size)) as i32;
        let decimals = (2 - before).clamp(0, 4) as usize;
        format!("{value:.decimals$}")
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_below_bars_have_three_digits() {
        let shown = [2.5114e6, 308.6, 29.67, -0.577, 0.0].map(three_digits);
        assert_eq!(shown, ["2.51e6", "309", "29.7", "−0.577", "0"]);
    }
}
