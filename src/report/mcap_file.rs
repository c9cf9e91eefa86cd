//! A run as an MCAP file, for Foxglove and other viewers of robots.
//!
//! | topic | message |
//! |---|---|
//! | `/channels` | a value of each channel, where most have the same rate, start and length |
//! | `/<name>` | the values of other channels, named as the first of them |
//! | `/tf` | `foxglove.FrameTransform`: frame `wheel`, at its axle, in frame `ground` |
//! | `/scene` | `foxglove.SceneUpdate`: rim and lugs in frame `wheel`, the profile in frame `ground` |
//!
//! Messages are JSON in the order of their times, units stand in the schemas. x is forward and z upward \[m\]; times count from the run's zero
//! \[ns\], or from the first sample where that is earlier.

use super::ReportError;
use super::channel_groups::time_range;
use super::scene::Scene;
use crate::trace::{Channel, Trace, by_clock};
use mcap::records::MessageHeader;
use mcap::{Compression, McapError, Writer};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Poses per second [1/s].
const FRAME_RATE: f64 = 30.0;
/// Corners [-] of the polygon that stands for the rim.
const RIM_CORNERS: u32 = 120;

/// A run as an MCAP file: channels, and wheel and ground where their size is known.
///
/// # Errors
/// `Empty` where no channel can be drawn, `Mcap` where the samples do not fit the format.
pub fn mcap_file(trace: &Trace, id: &str) -> Result<Vec<u8>, ReportError> {
    let span = time_range(trace).ok_or_else(|| ReportError::Empty(id.to_owned()))?;
    let write = || {
        let mut file = File::new(span)?;
        for (index, shared) in by_clock(&trace.channels).into_iter().enumerate() {
            let topic = if index == 0 {
                "channels"
            } else {
                &shared[0].name
            };
            file.channels(&format!("/{topic}"), &shared)?;
        }
        if let Ok(scene) = Scene::on_profile(trace).or_else(|_| Scene::on_level_ground(trace)) {
            file.scene(&scene, trace.attributes.wheel_width)?;
            file.poses(&scene)?;
        }
        file.finish()
    };
    write().map_err(|error: McapError| ReportError::Mcap(error.to_string()))
}

/// A file that is being written.
struct File {
    writer: Writer<Cursor<Vec<u8>>>,
    /// First and last time [s] of the run.
    span: [f64; 2],
    /// What is not written yet, of all topics.
    messages: Vec<(MessageHeader, String)>,
}

impl File {
    fn new(span: [f64; 2]) -> Result<Self, McapError> {
        let options = mcap::WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .library(concat!("lugwheel ", env!("CARGO_PKG_VERSION")));
        let writer = options.create(Cursor::new(Vec::new()))?;
        Ok(Self {
            writer,
            span,
            messages: Vec::new(),
        })
    }

    /// Channels that share their times, as one topic.
    fn channels(&mut self, topic: &str, channels: &[&Channel]) -> Result<(), McapError> {
        let properties = channels.iter().map(|channel| {
            let number =
                json!({"type": ["number", "null"], "description": format!("[{}]", channel.unit)});
            (channel.name.clone(), number)
        });
        let schema = object(properties.collect());
        let topic = self.topic(topic, &format!("lugwheel.{}", &topic[1..]), &schema)?;
        for index in 0..channels[0].samples.len() {
            let values = channels.iter().map(|channel| {
                let sample = channel.samples[index];
                let value = if channel.is_single_precision() {
                    json!(sample as f32)
                } else {
                    json!(sample)
                };
                (channel.name.clone(), value)
            });
            let message = Value::Object(values.collect());
            self.message(topic, index, channels[0].time(index), &message);
        }
        Ok(())
    }

    /// Wheel and ground, once: the wheel moves with its frame.
    fn scene(&mut self, scene: &Scene<'_>, width: f64) -> Result<(), McapError> {
        let start = self.span[0];
        let topic = self.topic("/scene", "foxglove.SceneUpdate", &scene_schema())?;
        let sides = sides(width);
        let ground = sides.map(|side| {
            let point = |&[x, z]: &[f64; 2]| point(x, side, z);
            line(LINE_STRIP, scene.surface.iter().map(point).collect())
        });
        let wheel = sides
            .iter()
            .flat_map(|&side| [rim(scene, side), lugs(scene, side)]);
        let time = self.stamp(start);
        let message = json!({
            "deletions": [],
            "entities": [
                entity("ground", &time, ground.to_vec()),
                entity("wheel", &time, wheel.collect()),
            ],
        });
        self.message(topic, 0, start, &message);
        Ok(())
    }

    /// Where the wheel's frame is, until the end of the run.
    fn poses(&mut self, scene: &Scene<'_>) -> Result<(), McapError> {
        let topic = self.topic("/tf", "foxglove.FrameTransform", &transform_schema())?;
        let [start, end] = self.span;
        let frames = ((end - start) * FRAME_RATE).ceil() as usize;
        for frame in 0..=frames {
            let time = (start + frame as f64 / FRAME_RATE).min(end);
            let pose = scene.pose(time, scene.position(time));
            let (sin, cos) = libm::sincos(pose.wheel_angle / 2.0);
            let message = json!({
                "timestamp": self.stamp(time),
                "parent_frame_id": "ground",
                "child_frame_id": "wheel",
                "translation": point(pose.position, 0.0, pose.height),
                "rotation": {"x": 0.0, "y": sin, "z": 0.0, "w": cos},
            });
            self.message(topic, frame, time, &message);
        }
        Ok(())
    }

    fn topic(&mut self, topic: &str, schema: &str, definition: &Value) -> Result<u16, McapError> {
        let definition = definition.to_string();
        let schema = self
            .writer
            .add_schema(schema, "jsonschema", definition.as_bytes())?;
        self.writer
            .add_channel(schema, topic, "json", &BTreeMap::new())
    }

    fn message(&mut self, topic: u16, index: usize, time: f64, message: &Value) {
        let time = self.nanoseconds(time);
        let header = MessageHeader {
            channel_id: topic,
            sequence: index as u32,
            log_time: time,
            publish_time: time,
        };
        self.messages.push((header, message.to_string()));
    }

    /// Time [ns] since the run's zero or its earlier start.
    fn nanoseconds(&self, time: f64) -> u64 {
        ((time - self.span[0].min(0.0)) * 1.0e9).round() as u64
    }

    fn stamp(&self, time: f64) -> Value {
        const SECOND: u64 = 1_000_000_000;
        let time = self.nanoseconds(time);
        json!({"sec": time / SECOND, "nsec": time % SECOND})
    }

    fn finish(mut self) -> Result<Vec<u8>, McapError> {
        self.messages.sort_by_key(|(header, _)| header.log_time);
        for (header, message) in &self.messages {
            self.writer
                .write_to_known_channel(header, message.as_bytes())?;
        }
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// Both sides [m] of a wheel; its middle where its width is not known.
fn sides(width: f64) -> [f64; 2] {
    let half = if width.is_finite() { width / 2.0 } else { 0.0 };
    [-half, half]
}

/// Kinds of lines of Foxglove.
const LINE_STRIP: u8 = 0;
const LINE_LOOP: u8 = 1;
const LINE_LIST: u8 = 2;

fn rim(scene: &Scene<'_>, side: f64) -> Value {
    let corners =
        (0..RIM_CORNERS).map(|corner| around(scene.shape.radius, corner, RIM_CORNERS, side));
    line(LINE_LOOP, corners.collect())
}

/// Lugs from rim to tip; the spoke to lug 0 shows how far the wheel has turned.
fn lugs(scene: &Scene<'_>, side: f64) -> Value {
    let shape = scene.shape;
    let count = shape.lug_count;
    let spoke = [point(0.0, side, 0.0), around(shape.radius, 0, 1, side)];
    let lugs = (0..count).flat_map(|lug| {
        [shape.radius, shape.tip_radius()].map(|radius| around(radius, lug, count, side))
    });
    line(LINE_LIST, spoke.into_iter().chain(lugs).collect())
}

/// The place of the `index`-th of `count` directions at a distance [m] from the axle, the first straight down and the
/// next ahead of it.
fn around(distance: f64, index: u32, count: u32, side: f64) -> Value {
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(index) / f64::from(count));
    point(distance * sin, side, -distance * cos)
}

fn point(x: f64, y: f64, z: f64) -> Value {
    json!({"x": x, "y": y, "z": z})
}

fn line(kind: u8, points: Vec<Value>) -> Value {
    json!({
        "type": kind,
        "pose": {"position": point(0.0, 0.0, 0.0), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}},
        "thickness": 2.0,
        "scale_invariant": true,
        "points": points,
        "color": {"r": 0.3, "g": 0.5, "b": 0.8, "a": 1.0},
        "colors": [],
        "indices": [],
    })
}

/// What stays for good in the frame of its name.
fn entity(name: &str, time: &Value, lines: Vec<Value>) -> Value {
    json!({
        "timestamp": time,
        "frame_id": name,
        "id": name,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": true,
        "metadata": [],
        "arrows": [],
        "cubes": [],
        "spheres": [],
        "cylinders": [],
        "lines": lines,
        "triangles": [],
        "texts": [],
        "models": [],
    })
}

fn object(properties: Map<String, Value>) -> Value {
    json!({"type": "object", "properties": properties})
}

/// An object of numbers.
fn numbers(names: &[&str]) -> Value {
    let number = |name: &&str| ((*name).to_owned(), json!({"type": "number"}));
    object(names.iter().map(number).collect())
}

fn time_schema() -> Value {
    let count = json!({"type": "integer", "minimum": 0});
    json!({"type": "object", "title": "time", "properties": {"sec": count, "nsec": count}})
}

fn transform_schema() -> Value {
    json!({
        "title": "foxglove.FrameTransform",
        "type": "object",
        "properties": {
            "timestamp": time_schema(),
            "parent_frame_id": {"type": "string"},
            "child_frame_id": {"type": "string"},
            "translation": numbers(&["x", "y", "z"]),
            "rotation": numbers(&["x", "y", "z", "w"]),
        },
    })
}

fn scene_schema() -> Value {
    let list = |items: Value| json!({"type": "array", "items": items});
    let anything = || list(json!({"type": "object"}));
    let pose = json!({
        "type": "object",
        "properties": {"position": numbers(&["x", "y", "z"]), "orientation": numbers(&["x", "y", "z", "w"])},
    });
    let colour = numbers(&["r", "g", "b", "a"]);
    let line = json!({
        "type": "object",
        "properties": {
            "type": {"type": "integer"},
            "pose": pose,
            "thickness": {"type": "number"},
            "scale_invariant": {"type": "boolean"},
            "points": list(numbers(&["x", "y", "z"])),
            "color": colour,
            "colors": list(colour.clone()),
            "indices": list(json!({"type": "integer"})),
        },
    });
    let entity = json!({
        "type": "object",
        "properties": {
            "timestamp": time_schema(),
            "frame_id": {"type": "string"},
            "id": {"type": "string"},
            "lifetime": time_schema(),
            "frame_locked": {"type": "boolean"},
            "metadata": anything(),
            "arrows": anything(),
            "cubes": anything(),
            "spheres": anything(),
            "cylinders": anything(),
            "lines": list(line),
            "triangles": anything(),
            "texts": anything(),
            "models": anything(),
        },
    });
    json!({
        "title": "foxglove.SceneUpdate",
        "type": "object",
        "properties": {"deletions": anything(), "entities": list(entity)},
    })
}
