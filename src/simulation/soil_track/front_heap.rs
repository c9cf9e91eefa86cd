//! The heap ahead of the wheel and its push against the travel.

use super::{Contact, Field, STANDING};
use crate::simulation::contact::WheelGeometry;
use crate::simulation::motion::Wrench;
use crate::soil::bulldozing::{Heap, resistance};

/// The heap that travels with the wheel.
#[derive(Default)]
pub(super) struct FrontHeap {
    heap: Heap,
    /// Direction of the travel that made it, +1 or -1.
    direction: f64,
}

impl FrontHeap {
    /// Grows the heap and pushes the wheel back, where it advances; a heap left behind on a
    /// reversal is not met again.
    pub fn push(&mut self, wheel: &WheelGeometry, contact: &Contact, field: &mut Field) {
        if contact.forward_speed < STANDING {
            return;
        }
        if self.direction != contact.direction {
            *self = Self {
                direction: contact.direction,
                ..Self::default()
            };
        }
        let (soil, sinkage) = (&contact.soil, contact.depth.sinkage);
        let way = contact.forward_speed * contact.elapsed;
        self.heap.advance(soil, wheel.width, sinkage, way);
        field.reach.wrench += Wrench {
            fx: -contact.direction * resistance(soil, wheel.width, sinkage, &self.heap),
            ..Wrench::default()
        };
    }
}
