"""What the Python package `mcap` finds in a run's file.

mcap_file.py FILE FOLDER SPEED SLIP RADIUS    FOLDER/<channel>.csv: times and values as they were simulated
"""

import json
import math
import sys

from mcap.reader import make_reader


def check(holds, what):
    if not holds:
        sys.exit(what)


def messages(path, topic):
    with open(path, "rb") as file:
        return [
            (schema, message.log_time / 1e9, json.loads(message.data))
            for schema, _, message in make_reader(file, validate_crcs=True).iter_messages(topics=[topic])
        ]


def check_channel(path, folder, topic, name, unit):
    with open(f"{folder}/{name}.csv") as text:
        expected = [tuple(map(float, line.split(","))) for line in text]
    found = messages(path, topic)
    check(len(found) == len(expected) > 0, f"{name}: {len(found)} messages for {len(expected)} samples")
    for (_, time, message), (moment, value) in zip(found, expected):
        check(abs(time - moment) < 2e-9, f"{name}: {time} s, not {moment} s")
        check(math.isclose(message[name], value, rel_tol=1e-6, abs_tol=1e-12), f"{name} at {time} s: {message[name]}")
    schema = json.loads(found[0][0].data)
    check(found[0][0].encoding == "jsonschema", "encoding of the schema")
    check(schema["properties"][name]["description"] == f"[{unit}]", f"unit of {name}")


def check_poses(path, speed, slip, radius):
    poses = messages(path, "/tf")
    check(poses[0][0].name == "foxglove.FrameTransform", "schema of poses")
    (_, start, first), (_, end, last) = poses[0], poses[-1]
    moved = last["translation"]["x"] - first["translation"]["x"]
    check(abs(moved / (end - start) / speed - 1) < 0.01, f"the wheel moved {moved} m in {end - start} s")
    turns = [2 * math.atan2(pose["rotation"]["y"], pose["rotation"]["w"]) for _, _, pose in poses]
    turned = (turns[-1] - turns[0]) % (2 * math.pi)
    commanded = speed / (1 - slip) / radius * (end - start) % (2 * math.pi)
    check(abs(turned - commanded) < 0.02, f"the wheel turned by {turned}, not {commanded} rad")
    heights = [pose["translation"]["z"] for _, _, pose in poses]
    check(all(0.8 * radius < height < 1.3 * radius for height in heights), f"axle at {heights[0]} m")


def check_scene(path, radius):
    ((schema, _, scene),) = messages(path, "/scene")
    check(schema.name == "foxglove.SceneUpdate", "schema of the scene")
    ground, wheel = scene["entities"]
    check([ground["frame_id"], wheel["frame_id"]] == ["ground", "wheel"], "frames")
    rim = wheel["lines"][0]["points"]
    check(all(abs(math.hypot(it["x"], it["z"]) - radius) < 1e-9 for it in rim), "the rim is a circle")
    check(wheel["lines"][1]["points"][1]["z"] == -radius, "lug 0 points straight down")
    check(len(ground["lines"][0]["points"]) > 1, "no ground")


if __name__ == "__main__":
    path, folder = sys.argv[1:3]
    speed, slip, radius = map(float, sys.argv[3:])
    check_channel(path, folder, "/channels", "drawbar_pull", "N")
    check_channel(path, folder, "/sinkage", "sinkage", "m")
    check_poses(path, speed, slip, radius)
    check_scene(path, radius)
