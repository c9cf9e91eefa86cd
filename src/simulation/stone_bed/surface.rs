//! What stones lie on and against: floor, ends of a trench, walls of a pour.

use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance [m] between the nodes of an uneven floor.
const NODE: f64 = 0.002;
/// How far [m] the ground beside a trench reaches from its end.
const BANK: f64 = 0.1;

/// Height [m] above the track's datum at a position [m] along it.
pub type Floor = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// A fixed surface across the whole track.
pub enum Surface {
    /// A level floor.
    Level {
        /// Its height [m].
        height: f64,
    },
    /// A floor of straight pieces between nodes.
    Uneven {
        /// Its height.
        floor: Floor,
        /// Heights [m] at the nodes looked at so far.
        nodes: BTreeMap<i64, f64>,
    },
    /// A smooth vertical wall.
    Wall {
        /// Where it stands [m].
        position: f64,
        /// 1 where stones lie ahead of it, -1 behind it.
        inward: f64,
    },
    /// The end of a trench as deep as the bed, and the ground beside it at height 0.
    Bank {
        /// Where it stands [m].
        position: f64,
        /// 1 where stones lie ahead of it, -1 behind it.
        inward: f64,
        /// Height of the trench's floor [m].
        floor: f64,
    },
}

/// The point of a surface nearest to another one.
#[derive(Debug, Clone, Copy)]
pub struct Nearest {
    /// Distance to it [m], below 0 behind the surface.
    pub distance: f64,
    /// Unit vector away from the surface.
    pub normal: Vector3<f64>,
}

impl Surface {
    /// An uneven floor.
    pub fn uneven(floor: Floor) -> Self {
        Self::Uneven {
            floor,
            nodes: BTreeMap::new(),
        }
    }

    /// Whether stones slide on it without friction.
    pub fn is_smooth(&self) -> bool {
        matches!(self, Self::Wall { .. })
    }

    /// Highest point [m] of a floor between two places [m]; `None` for what is no floor.
    pub fn highest(&mut self, [low, high]: [f64; 2]) -> Option<f64> {
        match self {
            Self::Level { height } => Some(*height),
            Self::Uneven { floor, nodes } => {
                let range = node_range([low, high]);
                let heights = range.map(|k| height_at(nodes, floor, k));
                heights.max_by(f64::total_cmp)
            }
            Self::Wall { .. } | Self::Bank { .. } => None,
        }
    }

    /// Looks up the heights that stones between two places [m] may meet.
    pub fn extend(&mut self, range: [f64; 2]) {
        if let Self::Uneven { .. } = self {
            self.highest(range);
        }
    }

    /// The point nearest to `centre` [m], if it is closer than `reach` [m].
    #[inline]
    pub fn nearest(&self, centre: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let nearest = match self {
            Self::Level { height } => Nearest {
                distance: centre.y - height,
                normal: Vector3::y(),
            },
            Self::Wall { position, inward } => Nearest {
                distance: inward * (centre.x - position),
                normal: Vector3::x() * *inward,
            },
            Self::Bank {
                position,
                inward,
                floor,
            } => {
                let outer = position - inward * BANK;
                let path = [[*position, *floor], [*position, 0.0], [outer, 0.0]];
                nearest_of(path.into_iter(), centre, *inward)?
            }
            Self::Uneven { nodes, .. } => {
                let path = node_range([centre.x - reach, centre.x + reach]);
                let path = path.filter_map(|k| Some([k as f64 * NODE, *nodes.get(&k)?]));
                nearest_of(path, centre, -1.0)?
            }
        };
        (nearest.distance.abs() < reach).then_some(nearest)
    }
}

fn node_range([low, high]: [f64; 2]) -> std::ops::RangeInclusive<i64> {
    libm::floor(low / NODE) as i64..=libm::ceil(high / NODE) as i64
}

fn height_at(nodes: &mut BTreeMap<i64, f64>, floor: &Floor, node: i64) -> f64 {
    *nodes
        .entry(node)
        .or_insert_with(|| floor(node as f64 * NODE))
}

/// The point of a path nearest to `centre`; stones lie to its right where `side` is 1, to its left where it is -1.
fn nearest_of(
    path: impl Iterator<Item = [f64; 2]>,
    centre: &Vector3<f64>,
    side: f64,
) -> Option<Nearest> {
    let mut last: Option<[f64; 2]> = None;
    let mut best: Option<(f64, [f64; 2], [f64; 2])> = None;
    for end in path {
        if let Some([x, y]) = last {
            let (along, up) = (end[0] - x, end[1] - y);
            let share = ((centre.x - x) * along + (centre.y - y) * up) / (along * along + up * up);
            let share = share.clamp(0.0, 1.0);
            let away = [centre.x - x - share * along, centre.y - y - share * up];
            let square = away[0] * away[0] + away[1] * away[1];
            if best.is_none_or(|(least, _, _)| square < least) {
                best = Some((square, away, [along, up]));
            }
        }
        last = Some(end);
    }
    let (square, away, [along, up]) = best?;
    // Left of the path is where it turns counter-clockwise.
    let outside = -side * (along * away[1] - up * away[0]) >= 0.0;
    let distance = square.sqrt();
    let normal = if distance > 1e-12 {
        let sign = if outside { 1.0 } else { -1.0 };
        Vector3::new(sign * away[0] / distance, sign * away[1] / distance, 0.0)
    } else {
        let length = (along * along + up * up).sqrt();
        Vector3::new(side * up / length, -side * along / length, 0.0)
    };
    Some(Nearest {
        distance: if outside { distance } else { -distance },
        normal,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(surface: &Surface, [x, y]: [f64; 2]) -> Nearest {
        surface.nearest(&Vector3::new(x, y, 0.3), 0.05).unwrap()
    }

    #[test]
    fn a_point_above_a_slope_is_nearest_to_it_along_the_normal() {
        let mut slope = Surface::uneven(Arc::new(|x| 0.75 * x));
        slope.extend([-0.1, 0.1]);
        let above = at(&slope, [0.0, 0.01]);
        assert!((above.distance - 0.008).abs() < 1e-12, "{above:?}");
        assert!((above.normal - Vector3::new(-0.6, 0.8, 0.0)).norm() < 1e-12);
        let below = at(&slope, [0.0, -0.01]);
        assert!((below.distance + 0.008).abs() < 1e-12, "{below:?}");
        assert!((below.normal - Vector3::new(-0.6, 0.8, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn a_trench_ends_in_an_upright_bank_with_a_corner() {
        for inward in [1.0, -1.0] {
            let bank = Surface::Bank {
                position: 0.2,
                inward,
                floor: -0.1,
            };
            let inside = at(&bank, [0.2 + inward * 0.01, -0.05]);
            assert!((inside.distance - 0.01).abs() < 1e-12, "{inside:?}");
            assert!((inside.normal - Vector3::x() * inward).norm() < 1e-12);
            let on_top = at(&bank, [0.2 - inward * 0.02, 0.01]);
            assert!((on_top.normal - Vector3::y()).norm() < 1e-12, "{on_top:?}");
            let corner = at(&bank, [0.2 + inward * 0.003, 0.004]);
            assert!((corner.distance - 0.005).abs() < 1e-12);
            assert!((corner.normal - Vector3::new(inward * 0.6, 0.8, 0.0)).norm() < 1e-12);
        }
    }
}
