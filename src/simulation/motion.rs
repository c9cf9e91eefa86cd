//! Motion of the wheel and loads on it, as all parts of the simulation exchange them.

/// Pose and motion of the wheel; `y` up, angles and angular speed positive when driving forward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelMotion {
    /// Axle along the track [m].
    pub x: f64,
    /// Axle above the track's datum [m].
    pub y: f64,
    /// Angle turned [rad].
    pub angle: f64,
    /// Cosine of the angle.
    pub cos: f64,
    /// Sine of the angle.
    pub sin: f64,
    /// Speed along the track [m/s].
    pub vx: f64,
    /// Speed away from the track [m/s].
    pub vy: f64,
    /// Angular speed [rad/s].
    pub omega: f64,
}

/// A force on the wheel through its axle and a moment about it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Along the track [N].
    pub fx: f64,
    /// Away from the track [N].
    pub fy: f64,
    /// About the axle [N·m], positive where it turns the wheel as driving forward does.
    pub torque: f64,
}

impl WheelMotion {
    /// The motion of the wheel's point that stands `[x, y]` [m] from the axle.
    pub fn at(&self, [x, y]: [f64; 2]) -> Self {
        Self {
            x: self.x + x,
            y: self.y + y,
            vx: self.vx + self.omega * y,
            vy: self.vy - self.omega * x,
            ..*self
        }
    }

    /// The motion a short `time` [s] later at the same speeds; the angle's sine and cosine err by a sixth of the cube of what
    /// it turns.
    pub fn after(&self, time: f64) -> Self {
        let turn = self.omega * time;
        let (sin, cos) = (turn, 1.0 - 0.5 * turn * turn);
        Self {
            x: self.x + self.vx * time,
            y: self.y + self.vy * time,
            angle: self.angle + turn,
            cos: self.cos * cos - self.sin * sin,
            sin: self.sin * cos + self.cos * sin,
            ..*self
        }
    }

    /// Whether every coordinate is a number.
    pub fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.omega.is_finite()
    }
}

impl Wrench {
    /// The same force where it acts at `[x, y]` [m] from the axle instead of at the axle.
    pub fn acting_at(self, [x, y]: [f64; 2]) -> Self {
        Self {
            torque: self.torque + (y * self.fx - x * self.fy),
            ..self
        }
    }

    /// Magnitude of the force [N].
    pub fn force(&self) -> f64 {
        libm::sqrt(self.fx * self.fx + self.fy * self.fy)
    }
}

impl std::ops::AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        self.fx += other.fx;
        self.fy += other.fy;
        self.torque += other.torque;
    }
}
