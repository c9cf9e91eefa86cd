//! Where wheel and ground are at any time of a run, as far as its channels show.

use super::channel_groups::{drawable, time_range};
use super::wheel_picture::{Pose, WheelShape, height_at, is_soft};
use crate::terrain::class::TerrainLabel;
use crate::trace::{Channel, Trace};

/// Points [-] of a rut at most, roughly.
const RUT_POINTS: usize = 2000;

/// The wheel on its ground during a run.
///
/// The axle's position is the integral of the forward speed, 0 where the wheel set out; its height follows from
/// the sinkage, or on rigid ground from where the wheel stands.
pub(super) struct Scene<'a> {
    trace: &'a Trace,
    /// What of the wheel is seen.
    pub shape: WheelShape,
    /// The ground before the wheel came: position, height [m].
    pub surface: Vec<[f64; 2]>,
    /// Time [s] and position of the axle [m].
    path: Vec<[f64; 2]>,
}

impl<'a> Scene<'a> {
    /// The scene of a run over the ground profile in its truth.
    ///
    /// # Errors
    /// What it lacks.
    pub fn on_profile(trace: &'a Trace) -> Result<Self, &'static str> {
        let surface = trace.truth.as_ref().map_or(&[][..], |t| &t.profile);
        let finite = surface.iter().flatten().all(|value| value.is_finite());
        if surface.len() < 2 || !finite {
            sized(trace)?;
            return Err("ground profile");
        }
        let shape = sized(trace)?;
        let mut path = axle_path(trace);
        let ahead = lead_in(trace, &path, surface, shape.radius);
        for point in &mut path {
            point[1] += ahead;
        }
        Ok(Self {
            trace,
            shape,
            surface: surface.to_vec(),
            path,
        })
    }

    /// The scene of a run over level ground, where no profile was recorded.
    ///
    /// # Errors
    /// What it lacks.
    pub fn on_level_ground(trace: &'a Trace) -> Result<Self, &'static str> {
        let shape = sized(trace)?;
        let path = axle_path(trace);
        let reach = 4.0 * shape.tip_radius();
        let positions = || path.iter().map(|point| point[1]);
        let first = positions().fold(f64::INFINITY, f64::min) - reach;
        let last = positions().fold(f64::NEG_INFINITY, f64::max) + reach;
        Ok(Self {
            trace,
            shape,
            surface: vec![[first, 0.0], [last, 0.0]],
            path,
        })
    }

    /// Position [m] of the axle at `time` [s].
    pub fn position(&self, time: f64) -> f64 {
        height_at(&self.path, time).unwrap_or(0.0)
    }

    /// Whether the profile lies under the axle at a position [m].
    pub fn reaches(&self, position: f64) -> bool {
        height_at(&self.surface, position).is_some()
    }

    /// Where the wheel is at `time` [s] with its axle at `position` [m].
    pub fn pose(&self, time: f64, position: f64) -> Pose {
        let wheel_angle = value_at(self.trace, "wheel_angle", time).unwrap_or(0.0);
        let height = match (self.sinkage(time), self.datum(time, position)) {
            (Some(sinkage), Some(datum)) => datum + self.shape.radius - sinkage,
            _ => self
                .shape
                .standing_height(position, wheel_angle, &self.surface),
        };
        Pose {
            position,
            height,
            wheel_angle,
        }
    }

    /// Depth [m] of the rim where that and not the ground's shape places the wheel: rigid ground carries a
    /// wheel that is not held off it where it stands, whatever a sensor says.
    pub fn sinkage(&self, time: f64) -> Option<f64> {
        use TerrainLabel::{Hard, Reference};
        let is_rigid = matches!(self.terrain(time), Some(Reference | Hard));
        let stands = is_rigid && !self.trace.attributes.is_lifted();
        value_at(self.trace, "sinkage", time).filter(|_| !stands)
    }

    /// Height [m] from which sinkage counts. The profile holds the stones, sinkage counts from what they
    /// lie on, which is level but for its roughness.
    fn datum(&self, time: f64, position: f64) -> Option<f64> {
        use TerrainLabel::{Gravel, HardWithGravel, SandWithGravel};
        match self.terrain(time) {
            Some(Gravel | HardWithGravel | SandWithGravel) => Some(0.0),
            _ => height_at(&self.surface, position),
        }
    }

    /// What the rim leaves behind in soil, from the start of the run to `end` [s]: position and height
    /// [m], by position.
    pub fn rut(&self, end: f64) -> Vec<[f64; 2]> {
        let steps = RUT_POINTS.min(self.path.len().max(500));
        let [start, last] = time_range(self.trace).unwrap_or([0.0, 0.0]);
        let end = end.min(last);
        let heading = (self.position(end) - self.position(start)).signum();
        let mut rut: Vec<[f64; 2]> = Vec::new();
        for step in 0..=steps {
            let time = start + (end - start) * step as f64 / steps as f64;
            let position = self.position(time);
            let farther = |last: &[f64; 2]| heading * (position - last[0]) > 0.0;
            if !self.is_soft(time) || !rut.last().is_none_or(farther) {
                continue;
            }
            if let (Some(sinkage), Some(datum)) = (self.sinkage(time), self.datum(time, position)) {
                rut.push([position, datum - sinkage.max(0.0)]);
            }
        }
        if heading < 0.0 {
            rut.reverse();
        }
        rut
    }

    /// Whether the wheel presses itself into the ground at `time` [s].
    pub fn is_soft(&self, time: f64) -> bool {
        is_soft(self.terrain(time))
    }

    /// The ground under the axle at `time` [s], where it is known.
    pub fn terrain(&self, time: f64) -> Option<TerrainLabel> {
        let windows = self.trace.truth.iter().flat_map(|it| &it.class_windows);
        let mut windows = windows.filter(|window| window.start <= time && time < window.end);
        let window = windows.next();
        window
            .map(|window| window.terrain)
            .or(self.trace.attributes.terrain)
    }
}

/// The wheel's shape, if its radius is known.
fn sized(trace: &Trace) -> Result<WheelShape, &'static str> {
    let shape = WheelShape::from(&trace.attributes);
    let is_sized = shape.radius > 0.0 && shape.tip_radius().is_finite();
    is_sized.then_some(shape).ok_or("wheel radius")
}

/// Time [s] and position of the axle [m], 0 at the start: the forward speed's integral, or the
/// commanded speed's where it was not recorded.
fn axle_path(trace: &Trace) -> Vec<[f64; 2]> {
    let commanded = trace.attributes.speed;
    let [start, end] = time_range(trace).unwrap_or([0.0, 0.0]);
    let whole = |channel: &&Channel| channel.samples.iter().all(|v| v.is_finite());
    let Some(channel) = drawable(trace, "forward_speed").filter(whole) else {
        let commanded = if commanded.is_finite() {
            commanded
        } else {
            0.0
        };
        return vec![[start, 0.0], [end, commanded * (end - start)]];
    };
    let step = 1.0 / channel.sample_rate;
    let mut position = 0.0;
    let mut before = channel.samples[0];
    let samples = channel.samples.iter().enumerate();
    samples
        .map(|(i, &speed)| {
            if i > 0 {
                position += step * (before + speed) / 2.0;
            }
            before = speed;
            [channel.time(i), position]
        })
        .collect()
}

/// How far [m] the wheel of a simulated run had come when its record began, after a lead-in; to 1 mm.
///
/// Its profile ends a radius beyond the farthest position of the axle.
fn lead_in(trace: &Trace, path: &[[f64; 2]], surface: &[[f64; 2]], radius: f64) -> f64 {
    const SHORTEST: f64 = 0.05;
    if path[0][0] < SHORTEST || trace.attributes.physics_rate.is_none() {
        return 0.0;
    }
    let positions = || path.iter().map(|point| point[1]);
    if path[path.len() - 1][1] < 0.0 {
        surface[0][0] + radius - positions().fold(0.0, f64::min)
    } else {
        surface[surface.len() - 1][0] - radius - positions().fold(0.0, f64::max)
    }
}

/// The value at `time` [s] between the two samples around it; the nearest sample's beside a gap and
/// within a period of either end.
fn value_at(trace: &Trace, name: &str, time: f64) -> Option<f64> {
    let channel = drawable(trace, name)?;
    let last = channel.samples.len() as f64 - 1.0;
    let place = (time - channel.start) * channel.sample_rate;
    if !(-1.0..=last + 1.0).contains(&place) {
        return None;
    }
    let place = place.clamp(0.0, last);
    let [below, above] = [place.floor(), place.ceil()].map(|it| channel.samples[it as usize]);
    let between = below + (place - place.floor()) * (above - below);
    let nearest = channel.samples[place.round() as usize];
    let value = if between.is_finite() {
        between
    } else {
        nearest
    };
    value.is_finite().then_some(value)
}
