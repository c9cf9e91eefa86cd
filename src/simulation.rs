//! The motion of the wheel: an iterator of [`WheelState`].
//!
//! Each step the ground, the load, the leg, the carriage and the motor act on the wheel's body, and rapier's integrator moves it.
//! Stones take steps of their own in between. The ground's loads are the sum of its contacts; what a transducer in the hub reads
//! follows from them and from the wheel's inertia.

#[cfg(test)]
mod balance;
mod contact;
mod free_body;
mod ground_force;
mod hard_contact;
mod motion;
mod mount;
mod nearest;
mod outline;
pub mod rig;
#[cfg(test)]
mod rolling;
mod soil_track;
mod stone_bearing;
mod stone_bed;
mod stone_outline;
mod world;

use crate::quantity::{RangeError, SampleRate};
use crate::terrain::Terrain;
use crate::terrain::class::TerrainLabel;
use crate::wheel::Wheel;
use crate::wheel::lug_outline::{self, LugOutline};
use contact::WheelGeometry;
use ground_force::GroundForce;
use motion::{WheelMotion, Wrench};
use mount::{AtLimits, Mount};
use rig::flaws::GuideFriction;
use rig::{Command, Commanded, DriveProfile, Leg, Rig};
use std::sync::Arc;
use stone_bed::OnBed;
use world::{WheelBody, World};

/// Loads on the wheel in the plane of travel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Loads {
    /// Normal force `F_N` \[N\], upward.
    pub normal_force: f64,
    /// Drawbar pull `F_DP` \[N\], above 0 where the ground pulls the wheel forward.
    pub drawbar_pull: f64,
    /// Torque [N·m] about the axle, above 0 where the motor drives forward against the ground.
    pub driving_torque: f64,
}

/// State of the wheel at one instant, the input of the sensors.
///
/// `x` runs forward along the track, `y` away from it; the wheel angle grows when driving forward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelState {
    /// Time \[s\].
    pub time: f64,
    /// Position of the axle along the track \[m\].
    pub position: f64,
    /// Height of the axle above the track's datum \[m\].
    pub height: f64,
    /// Angle turned since the start \[rad\].
    pub wheel_angle: f64,
    /// Speed along the track [m/s].
    pub forward_speed: f64,
    /// Speed away from the track [m/s].
    pub vertical_speed: f64,
    /// Speed of rotation [rad/s].
    pub wheel_speed: f64,
    /// Acceleration along the track [m/s²].
    pub forward_acceleration: f64,
    /// Acceleration away from the track [m/s²]; gravity is not in it.
    pub vertical_acceleration: f64,
    /// Loads of the ground on the wheel.
    pub ground: Loads,
    /// Loads that pass from the wheel to its axle, as a transducer there feels them that was tared
    /// on the level: the ground's, less the wheel's inertia, and less its weight along a slope.
    pub hub: Loads,
    /// Depth of the rim's lowest point below the undisturbed surface \[m\].
    pub sinkage: f64,
    /// Whether the ground under the axle is soil that lugs can enter.
    pub on_soil: bool,
    /// Bit `i` is set while lug `i` carries more than 1 % of the commanded load.
    pub lugs_touching: u64,
    /// Bit `i` is set while the edge of lug `i` lies more than 1 mm below the undisturbed soil.
    pub lugs_entered: u64,
    /// Drives that give all they have.
    pub at_limits: AtLimits,
}

/// Why a run could not go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The wheel sank to its axle.
    #[error(
        "at {time:.3} s the wheel had sunk {sinkage:.4} m, to its axle at {radius} m: the ground does not carry {} N; lower the load or the slip",
        (1.0e3 * load).round() / 1.0e3
    )]
    Sunk {
        /// When \[s\].
        time: f64,
        /// How deep \[m\].
        sinkage: f64,
        /// Rim radius \[m\].
        radius: f64,
        /// Vertical load \[N\].
        load: f64,
    },
    /// A quantity stopped being a number.
    #[error(
        "at {time:.3} s the wheel's motion was no longer a number; raise physics_rate above {rate} Hz"
    )]
    NotFinite {
        /// When \[s\].
        time: f64,
        /// Steps per second \[Hz\].
        rate: f64,
    },
    /// A value of the rig has no meaning.
    #[error(transparent)]
    Range(#[from] RangeError),
}

/// Time [s] for which the wheel is let down onto fixed ground before the run begins.
const LET_DOWN: f64 = 1.0;

/// The same on stones, which its first touch moves.
const LET_DOWN_ON_STONES: f64 = 2.0;

/// Damping [N·s/m] of the let-down, per kilogram of moving mass.
const LET_DOWN_DAMPING: f64 = 150.0;

/// A wheel on its way, state by state; it never ends by itself.
pub struct Simulation {
    world: World,
    mount: Mount,
    ground: GroundForce,
    wheel: Wheel,
    /// Weight of the wheel, through its centre of mass.
    wheel_weight: Wrench,
    geometry: WheelGeometry,
    rig: Rig,
    command: Command,
    profile: Option<Arc<dyn DriveProfile>>,
    leg: Option<Leg>,
    guide: GuideFriction,
    /// Drawbar pull [N] in the last step.
    pull: f64,
    /// Mass that moves with the axle [kg], and load at rest normal to the track [N].
    mass: f64,
    load: f64,
    rate: SampleRate,
    step: u64,
    failed: bool,
}

impl Simulation {
    /// A wheel let down at the start of `terrain`, at rest.
    ///
    /// # Errors
    /// `Range` where the rig's motion is not defined; `Sunk` where the ground cannot carry it.
    pub fn new(
        terrain: &Terrain,
        wheel: &Wheel,
        rig: &Rig,
        rate: SampleRate,
    ) -> Result<Self, SimulationError> {
        Self::with_lugs(None, terrain, wheel, rig, rate)
    }

    /// The same with lugs of a user's own form in place of plates.
    ///
    /// # Errors
    /// Those of [`new`](Self::new); `Range` where the outline is not that of the wheel's lugs.
    pub fn with_lugs(
        outline: Option<Arc<dyn LugOutline>>,
        terrain: &Terrain,
        wheel: &Wheel,
        rig: &Rig,
        rate: SampleRate,
    ) -> Result<Self, SimulationError> {
        if let Some(outline) = &outline {
            lug_outline::check(&**outline, wheel)?;
        }
        let command = Command::new(rig.drive(), wheel.radius)?;
        let mount = Mount::new(rig, wheel, rate)?;
        let mass = rig.moving_mass(wheel);
        let mut geometry = WheelGeometry::new(wheel, rig.load()).with_lugs(outline);
        geometry.mobility = mount.mobility(mass, wheel.inertia);
        let body = WheelBody {
            mass,
            carriage_mass: mount.carriage_mass(),
            inertia: wheel.inertia,
            clamped: rig.clearance() > 0.0,
        };
        let mut ground = GroundForce::new(terrain, wheel, OnBed::of(rig, wheel));
        ground.follow(0.0, rate.period());
        let mut world = World::new(&body, rate);
        let [_, rim] = wheel.flaws.rim_centre(1.0, 0.0);
        let start = ground.resting_height(&geometry) - rim + rig.clearance();
        world.place(start);
        if let Some(leg) = rig.sprung_mass(wheel) {
            world.add_leg(leg, start);
        }
        let [gx, gy] = rig.gravity();
        let wheel_weight = Wrench {
            fx: wheel.mass * gx,
            fy: wheel.mass * gy,
            torque: 0.0,
        };
        let (leg, wheel, rig) = (rig.leg(wheel), *wheel, *rig);
        let load = rig.normal_load();
        let mut simulation = Self {
            world,
            mount,
            ground,
            wheel,
            wheel_weight,
            geometry,
            rig,
            command,
            profile: None,
            leg,
            guide: GuideFriction::default(),
            pull: 0.0,
            mass,
            load,
            rate,
            step: 0,
            failed: false,
        };
        simulation.let_down()?;
        Ok(simulation)
    }

    /// The wheel driven by a profile from now on, in place of the constant speeds of its rig.
    pub fn following(self, profile: Arc<dyn DriveProfile>) -> Self {
        Self {
            profile: Some(profile),
            ..self
        }
    }

    /// Label of the ground under the axle.
    pub fn label(&mut self) -> TerrainLabel {
        let x = self.world.motion().x;
        self.ground.label(x)
    }

    /// The ground before the wheel came, stones included, every `spacing` \[m\]: position and height \[m\].
    pub fn undisturbed(&mut self, low: f64, high: f64, spacing: f64) -> Vec<[f64; 2]> {
        let nodes = (low / spacing).floor() as i64..=(high / spacing).ceil() as i64;
        nodes
            .map(|node| node as f64 * spacing)
            .map(|x| [x, self.ground.before(x)])
            .collect()
    }

    /// The ground's surface as it is now between two places: position and height \[m\].
    pub fn surface(&mut self, low: f64, high: f64) -> Vec<[f64; 2]> {
        self.ground.surface(low, high)
    }

    fn let_down(&mut self) -> Result<(), SimulationError> {
        let seconds = if self.ground.has_stones() {
            LET_DOWN_ON_STONES
        } else {
            LET_DOWN
        };
        let steps = (seconds * self.rate.hertz()) as u64;
        for step in 0..steps {
            // The damping fades over the second half.
            let hold = (2.0 - 2.0 * step as f64 / steps as f64).min(1.0);
            let state = self.advance(&Commanded::REST, hold * LET_DOWN_DAMPING)?;
            self.check_sinkage(&state)?;
        }
        Ok(())
    }

    /// One step under this command; `damping` [1/s] of the moving mass slows the let-down.
    fn advance(
        &mut self,
        commanded: &Commanded,
        damping: f64,
    ) -> Result<WheelState, SimulationError> {
        let dt = self.rate.period();
        let before = self.world.motion();
        let rim = self.geometry.rim_centre(&before);
        self.ground.follow(before.x, dt);
        let mut reach = self.ground.push(&self.geometry, &before.at(rim), dt);
        reach.wrench = reach.wrench.acting_at(rim);
        let spring = self.push_leg(&before, damping);
        let mut wrench = reach.wrench;
        wrench.torque += self.imbalance(&before);
        wrench.fy += spring - self.weight(&before) - damping * self.mass * before.vy;
        let actions = self.mount.act(commanded, &before);
        self.world.step(wrench, &actions);
        let after = self.world.motion();
        self.check(&after)?;
        let state = self.read(&before, &after, reach);
        self.pull = state.ground.drawbar_pull;
        Ok(state)
    }

    /// Moment [N·m] about the axle of the weight of a wheel whose mass is not centred on it. What its acceleration adds, `m e ω²`,
    /// is some millinewton at the speeds of rovers.
    fn imbalance(&self, motion: &WheelMotion) -> f64 {
        let centre = self.wheel.flaws.mass_centre(motion.cos, motion.sin);
        self.wheel_weight.acting_at(centre).torque
    }

    /// All that presses the wheel down [N] but the leg's spring: weight, what the linkage adds, friction of the guide.
    fn weight(&mut self, motion: &WheelMotion) -> f64 {
        let frame = self.rig.frame();
        let friction = self
            .guide
            .push(frame, motion.vy, self.pull, self.rate.period());
        let own = if self.world.has_leg() {
            self.rig.unsprung_weight(&self.wheel)
        } else {
            self.load
        };
        own + frame.load_transfer * self.pull - friction
    }

    /// Loads the leg's body; returns the force [N] of its spring and damper on the wheel.
    fn push_leg(&mut self, wheel: &WheelMotion, damping: f64) -> f64 {
        let (Some([stretch, rate]), Some(leg)) = (self.world.leg_stretch(wheel), &self.leg) else {
            return 0.0;
        };
        let body_weight = self.load - self.rig.unsprung_weight(&self.wheel);
        // At rest the spring carries the body; stretch counts from there.
        let spring = leg.spring_force(stretch, rate) - body_weight;
        self.world.push_leg(-spring - body_weight, damping);
        spring
    }

    fn check_sinkage(&self, state: &WheelState) -> Result<(), SimulationError> {
        if state.sinkage < self.wheel.radius {
            return Ok(());
        }
        Err(SimulationError::Sunk {
            time: state.time,
            sinkage: state.sinkage,
            radius: self.wheel.radius,
            load: self.rig.load(),
        })
    }

    fn check(&self, motion: &WheelMotion) -> Result<(), SimulationError> {
        let time = self.step as f64 * self.rate.period();
        if !motion.is_finite() {
            return Err(SimulationError::NotFinite {
                time,
                rate: self.rate.hertz(),
            });
        }
        Ok(())
    }

    /// The state after a step in which the ground acted on the wheel with `reach`.
    fn read(
        &mut self,
        before: &WheelMotion,
        after: &WheelMotion,
        reach: contact::Reach,
    ) -> WheelState {
        let rate = self.rate.hertz();
        let (ax, ay) = ((after.vx - before.vx) * rate, (after.vy - before.vy) * rate);
        let spin_up = self.wheel.inertia * (after.omega - before.omega) * rate;
        let Wrench { fx, fy, torque } = reach.wrench;
        let ground = Loads {
            normal_force: fy,
            drawbar_pull: fx,
            driving_torque: -torque,
        };
        let [gained, carried] = self.rig.wheel_weight(&self.wheel);
        let hub = Loads {
            normal_force: ground.normal_force - self.wheel.mass * ay + gained,
            drawbar_pull: ground.drawbar_pull - self.wheel.mass * ax - carried,
            driving_torque: ground.driving_torque + spin_up - self.imbalance(before),
        };
        let [_, rim] = self.geometry.rim_centre(after);
        let (undisturbed, on_soil) = self.ground.undisturbed(after.x);
        WheelState {
            time: self.step as f64 / rate,
            position: after.x,
            height: after.y,
            wheel_angle: after.angle,
            forward_speed: after.vx,
            vertical_speed: after.vy,
            wheel_speed: after.omega,
            forward_acceleration: ax,
            vertical_acceleration: ay,
            ground,
            hub,
            sinkage: undisturbed - (after.y + rim - self.wheel.radius),
            on_soil,
            lugs_touching: reach.touching,
            lugs_entered: reach.entered,
            at_limits: self.mount.at_limits(),
        }
    }
}

impl Iterator for Simulation {
    type Item = Result<WheelState, SimulationError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        self.step += 1;
        let time = self.step as f64 * self.rate.period();
        let commanded = match &self.profile {
            None => self.command.at(time),
            Some(profile) => self.command.of(profile.speeds(time), time),
        };
        let result = self.advance(&commanded, 0.0).and_then(|state| {
            self.check_sinkage(&state)?;
            Ok(state)
        });
        self.failed = result.is_err();
        Some(result)
    }
}
