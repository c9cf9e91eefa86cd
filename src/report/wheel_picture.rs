//! The wheel on its ground, seen from the side, to scale.

use super::figure::{Anchor, Area, Canvas, Font, GRID, INK, MUTED, Stroke};
use crate::terrain::class::TerrainLabel;
use crate::trace::RunAttributes;
use crate::wheel::Wheel;
use std::f64::consts::TAU;

/// What of a wheel is seen from the side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelShape {
    /// Rim radius \[m\].
    pub radius: f64,
    /// Number of lugs [-]; 0 on a smooth wheel, or where it is unknown.
    pub lug_count: u32,
    /// Lug height \[m\].
    pub lug_height: f64,
    /// Lug thickness \[m\].
    pub lug_thickness: f64,
}

impl From<&Wheel> for WheelShape {
    fn from(wheel: &Wheel) -> Self {
        Self {
            radius: wheel.radius,
            lug_count: wheel.lug_count(),
            lug_height: wheel.lug_height(),
            lug_thickness: wheel.lugs.map_or(0.0, |lugs| lugs.thickness),
        }
    }
}

impl From<&RunAttributes> for WheelShape {
    /// Run files do not hold the thickness of lugs: it is drawn as a fiftieth of the radius, and
    /// as a third of the pitch at most.
    fn from(run: &RunAttributes) -> Self {
        // Lugs of unknown number or height are not drawn.
        let known = run.lug_count.filter(|_| run.lug_height.is_finite());
        let lug_count = known.unwrap_or(0);
        let pitch = TAU * run.wheel_radius / f64::from(lug_count.max(1));
        Self {
            radius: run.wheel_radius,
            lug_count,
            lug_height: if lug_count > 0 { run.lug_height } else { 0.0 },
            lug_thickness: (run.wheel_radius / 50.0).min(pitch / 3.0),
        }
    }
}

impl WheelShape {
    /// Radius to the lugs' edges \[m\], the rim's on a smooth wheel.
    pub fn tip_radius(&self) -> f64 {
        if self.lug_count == 0 {
            return self.radius;
        }
        self.radius + self.lug_height
    }

    /// Height \[m\] at which the axle rests when the wheel stands at `position` \[m\] and
    /// `wheel_angle` \[rad\] on rigid ground of this `surface` (position, height \[m\]).
    pub fn standing_height(&self, position: f64, wheel_angle: f64, surface: &[[f64; 2]]) -> f64 {
        let rim = (0..720).map(|i| TAU * f64::from(i) / 720.0).map(|angle| {
            let (sin, cos) = libm::sincos(angle);
            [self.radius * sin, -self.radius * cos]
        });
        let edges = (0..self.lug_count).map(|lug| {
            let (sin, cos) = libm::sincos(self.lug_position(lug, wheel_angle));
            [self.tip_radius() * sin, -self.tip_radius() * cos]
        });
        rim.chain(edges)
            .filter_map(|[x, y]| height_at(surface, position + x).map(|ground| ground - y))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Angle [rad] of a lug from straight down, positive ahead.
    fn lug_position(&self, lug: u32, wheel_angle: f64) -> f64 {
        TAU * f64::from(lug) / f64::from(self.lug_count) - wheel_angle
    }
}

/// Where the wheel is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position of the axle along the track \[m\].
    pub position: f64,
    /// Height of the axle \[m\].
    pub height: f64,
    /// Angle turned \[rad\]; at 0 lug 0 points straight down.
    pub wheel_angle: f64,
}

/// The ground around the wheel. Polylines run forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground<'a> {
    /// Surface before the wheel came: position, height \[m\].
    pub surface: &'a [[f64; 2]],
    /// Surface the wheel left behind: position, height \[m\]; empty where it left none.
    pub rut: &'a [[f64; 2]],
    /// What the ground is, for its colour; soil where it is not known.
    pub terrain: Option<TerrainLabel>,
}

/// Whether a wheel presses itself into this ground, as into soil and into unknown ground.
pub(super) fn is_soft(terrain: Option<TerrainLabel>) -> bool {
    use TerrainLabel::{Sand, SandWithGravel};
    matches!(terrain, None | Some(Sand | SandWithGravel))
}

impl Ground<'_> {
    fn colours(&self) -> (&'static str, &'static str) {
        use TerrainLabel::{Gravel, Hard, HardWithGravel, Reference};
        match self.terrain {
            Some(Reference | Hard | HardWithGravel) => ("#b9bec7", "#4b5563"),
            Some(Gravel) => ("#d3cdc3", "#6f665a"),
            _ => ("#ead6ab", "#8a6d3b"),
        }
    }

    /// The ground as it is now: undisturbed, but for the rut and for what the rim has pressed down.
    fn now(&self, wheel: &WheelShape, pose: &Pose, xs: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
        xs.filter_map(|x| {
            let undisturbed = height_at(self.surface, x)?;
            let rut = height_at(self.rut, x).unwrap_or(f64::INFINITY);
            let pressed = if is_soft(self.terrain) {
                rim_bottom(wheel, pose, x)
            } else {
                f64::INFINITY
            };
            Some([x, undisturbed.min(rut).min(pressed)])
        })
        .collect()
    }
}

fn rim_bottom(wheel: &WheelShape, pose: &Pose, x: f64) -> f64 {
    let ahead = x - pose.position;
    let below = wheel.radius * wheel.radius - ahead * ahead;
    if below <= 0.0 {
        return f64::INFINITY;
    }
    pose.height - below.sqrt()
}

/// Height \[m\] of a polyline at `x` \[m\]; `None` beyond its ends.
pub fn height_at(polyline: &[[f64; 2]], x: f64) -> Option<f64> {
    let right = polyline.partition_point(|point| point[0] < x);
    let [x1, y1] = *polyline.get(right)?;
    if x1 == x {
        return Some(y1);
    }
    let [x0, y0] = *polyline.get(right.checked_sub(1)?)?;
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// Wheel and ground as an SVG of `size` (width, height) \[px\].
pub fn wheel_picture(
    wheel: &WheelShape,
    pose: &Pose,
    ground: &Ground<'_>,
    size: [f64; 2],
) -> String {
    let mut canvas = Canvas::new(size, "Wheel and ground, seen from the side");
    let area = Area {
        left: 0.0,
        top: 0.0,
        width: size[0],
        height: size[1],
    };
    draw_wheel_on_ground(&mut canvas, &area, wheel, pose, ground);
    canvas.finish()
}

/// Metres to pixels, the axle in the middle.
struct View {
    area: Area,
    per_metre: f64,
    centre: f64,
    bottom: f64,
}

impl View {
    /// Shows the whole wheel, a tenth of it as sky above and two tenths as ground below.
    fn around(area: &Area, wheel: &WheelShape, pose: &Pose) -> Self {
        let diameter = 2.0 * wheel.tip_radius();
        Self {
            area: *area,
            per_metre: area.height / (1.3 * diameter),
            centre: pose.position,
            bottom: pose.height - 0.7 * diameter,
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.area.left + self.area.width / 2.0 + (x - self.centre) * self.per_metre,
            self.area.bottom() - (y - self.bottom) * self.per_metre,
        ]
    }

    fn all(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|point| self.at(*point)).collect()
    }

    /// Positions [m] of every pixel column.
    fn columns(&self) -> impl Iterator<Item = f64> + use<> {
        let (half, per_metre, centre) = (self.area.width / 2.0, self.per_metre, self.centre);
        (0..=2 * half as usize).map(move |column| centre + (column as f64 - half) / per_metre)
    }
}

/// Draws wheel and ground into `area` of a canvas.
pub fn draw_wheel_on_ground(
    canvas: &mut Canvas,
    area: &Area,
    wheel: &WheelShape,
    pose: &Pose,
    ground: &Ground<'_>,
) {
    let view = View::around(area, wheel, pose);
    canvas.clip(area);
    draw_ground(canvas, &view, wheel, pose, ground);
    draw_wheel(canvas, &view, wheel, pose);
    draw_legend(canvas, &view, wheel, ground);
    canvas.unclip();
}

fn draw_ground(
    canvas: &mut Canvas,
    view: &View,
    wheel: &WheelShape,
    pose: &Pose,
    ground: &Ground<'_>,
) {
    let (fill, line) = ground.colours();
    let now = view.all(&ground.now(wheel, pose, view.columns()));
    if let (Some(first), Some(last)) = (now.first(), now.last()) {
        let floor = view.area.bottom();
        let mut soil = now.clone();
        soil.extend([[last[0], floor], [first[0], floor]]);
        canvas.polygon(&soil, fill, Stroke::solid("none", 0.0));
    }
    canvas.polyline(&now, Stroke::solid(line, 1.8));
    if is_soft(ground.terrain) {
        let undisturbed: Vec<[f64; 2]> = view
            .columns()
            .filter_map(|x| height_at(ground.surface, x).map(|y| view.at([x, y])))
            .collect();
        canvas.polyline(&undisturbed, Stroke::dashed(line, 1.2));
    }
}

fn draw_wheel(canvas: &mut Canvas, view: &View, wheel: &WheelShape, pose: &Pose) {
    let axle = [pose.position, pose.height];
    let around = |angle: f64, along: f64, radius: f64| {
        let (sin, cos) = libm::sincos(angle);
        view.at([
            axle[0] + radius * sin + along * cos,
            axle[1] - radius * cos + along * sin,
        ])
    };
    let half = wheel.lug_thickness / 2.0;
    for lug in 0..wheel.lug_count {
        let angle = wheel.lug_position(lug, pose.wheel_angle);
        let root = 0.97 * wheel.radius;
        let corners = [
            around(angle, -half, root),
            around(angle, -half, wheel.tip_radius()),
            around(angle, half, wheel.tip_radius()),
            around(angle, half, root),
        ];
        canvas.polygon(&corners, "#39404d", Stroke::solid("#39404d", 0.6));
    }
    let centre = view.at(axle);
    let rim = wheel.radius * view.per_metre;
    canvas.circle(centre, rim, "#eef0f3", Stroke::solid("#39404d", 1.5));
    canvas.circle(centre, 0.9 * rim, "#ffffff", Stroke::solid("#9aa1ad", 1.0));
    for spoke in 0..6 {
        let angle = TAU * f64::from(spoke) / 6.0 - pose.wheel_angle;
        let ends = [
            around(angle, 0.0, 0.12 * wheel.radius),
            around(angle, 0.0, 0.9 * wheel.radius),
        ];
        // Lug 0 is distinguished by its spoke.
        let stroke = if spoke == 0 {
            Stroke::solid("#d55e00", 3.0)
        } else {
            Stroke::solid("#c3c8d0", 2.0)
        };
        canvas.polyline(&ends, stroke);
    }
    canvas.circle(centre, 0.12 * rim, "#39404d", Stroke::solid(INK, 1.0));
}

/// Scale, direction of travel, what the dashed line is.
fn draw_legend(canvas: &mut Canvas, view: &View, wheel: &WheelShape, ground: &Ground<'_>) {
    let [left, right, top] = [
        view.area.left + 16.0,
        view.area.right() - 16.0,
        view.area.top + 24.0,
    ];
    let length = scale_length(wheel.radius);
    let bar = length * view.per_metre;
    let y = top + 10.0;
    canvas.text(
        [left, top],
        Anchor::Start,
        Font::SMALL,
        &format!("{} mm", (length * 1e3).round()),
    );
    canvas.polyline(&[[left, y], [left + bar, y]], Stroke::solid(INK, 2.0));
    for end in [left, left + bar] {
        canvas.polyline(&[[end, y - 4.0], [end, y + 4.0]], Stroke::solid(INK, 2.0));
    }
    canvas.text([right - 34.0, top], Anchor::End, Font::SMALL, "forward");
    canvas.polyline(
        &[[right - 26.0, top - 5.0], [right - 6.0, top - 5.0]],
        Stroke::solid(INK, 2.0),
    );
    let head = [
        [right, top - 5.0],
        [right - 9.0, top - 10.0],
        [right - 9.0, top],
    ];
    canvas.polygon(&head, INK, Stroke::solid(GRID, 0.0));
    if is_soft(ground.terrain) {
        let y = top + 22.0;
        canvas.text(
            [right - 34.0, y],
            Anchor::End,
            Font::SMALL,
            if view.area.width < 600.0 {
                "undisturbed"
            } else {
                "undisturbed surface"
            },
        );
        canvas.polyline(
            &[[right - 26.0, y - 5.0], [right, y - 5.0]],
            Stroke::dashed(MUTED, 1.5),
        );
    }
}

/// A round length [m] near the wheel's radius, for the scale bar.
fn scale_length(radius: f64) -> f64 {
    [1.0, 0.5, 0.2, 0.1, 0.05, 0.02]
        .into_iter()
        .find(|length| *length <= radius)
        .unwrap_or(0.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat() -> Vec<[f64; 2]> {
        vec![[-2.0, 0.0], [2.0, 0.0]]
    }

    #[test]
    fn a_lugged_wheel_stands_on_one_lug_or_between_two() {
        let wheel = WheelShape::from(&Wheel::single_wheel());
        let on_a_lug = wheel.standing_height(0.0, 0.0, &flat());
        assert!((on_a_lug - 0.155).abs() < 1e-12);
        let half_a_pitch = TAU / 56.0;
        let between = wheel.standing_height(0.0, half_a_pitch, &flat());
        assert!((between - 0.155 * libm::cos(half_a_pitch)).abs() < 1e-12);
    }

    #[test]
    fn a_wheel_stands_on_the_highest_stone_under_it() {
        let smooth = WheelShape {
            lug_count: 0,
            ..WheelShape::from(&Wheel::single_wheel())
        };
        let bump = [
            [-2.0, 0.0],
            [-0.01, 0.0],
            [-0.005, 0.02],
            [0.005, 0.02],
            [0.01, 0.0],
            [2.0, 0.0],
        ];
        // A rim point lies every half degree: 0.14 m (1 - cos 0.25°) = 1.4 µm.
        assert!((smooth.standing_height(0.0, 0.0, &bump) - 0.16).abs() < 2e-6);
    }

    #[test]
    fn soil_under_a_sunken_rim_takes_the_rims_shape_and_hard_ground_does_not() {
        let wheel = WheelShape::from(&Wheel::single_wheel());
        let pose = Pose {
            position: 0.0,
            height: 0.13,
            wheel_angle: 0.0,
        };
        let surface = flat();
        let rut = [[-1.0, -0.01], [0.0, -0.01]];
        let mut ground = Ground {
            surface: &surface,
            rut: &rut,
            terrain: Some(TerrainLabel::Sand),
        };
        let xs = [-0.5, 0.0, 0.5];
        let now = ground.now(&wheel, &pose, xs.into_iter());
        assert_eq!(now.iter().map(|p| p[0]).collect::<Vec<_>>(), xs);
        assert_eq!(now[0][1], -0.01);
        assert!((now[1][1] + 0.01).abs() < 1e-12);
        assert_eq!(now[2][1], 0.0);
        ground.terrain = Some(TerrainLabel::Hard);
        ground.rut = &[];
        let now = ground.now(&wheel, &pose, xs.into_iter());
        assert!(now.iter().all(|point| point[1] == 0.0));
    }

    #[test]
    fn height_between_points_is_linear_and_ends_end() {
        let line = [[0.0, 1.0], [2.0, 3.0]];
        assert_eq!(height_at(&line, 0.0), Some(1.0));
        assert_eq!(height_at(&line, 0.5), Some(1.5));
        assert_eq!(height_at(&line, 2.0), Some(3.0));
        assert_eq!(height_at(&line, 2.1), None);
        assert_eq!(height_at(&line, -0.1), None);
        assert_eq!(height_at(&[], 0.0), None);
    }
}
