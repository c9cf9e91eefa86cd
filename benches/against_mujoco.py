#!/usr/bin/env python3
"""Cost of a step of the whole chain (physics, sensors, ground truth, file) beside a bare step of MuJoCo.

    pip install mujoco
    cargo build --release
    python3 benches/against_mujoco.py

Both step the same lugged wheel at 128 kHz: MuJoCo a hinge on two slides, a cylinder with a box for every lug on a plane,
loaded by its weight and driven in speed. The two take turns, so that a machine that slows down slows both; what is
printed is the median of the ratios of neighbours, with the smallest and the greatest.
"""

import json
import math
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import mujoco

RATE = 128_000
SECONDS = 4
TURNS = 7
ROOT = Path(__file__).resolve().parent.parent


def model(radius, lugs, height, mass, inertia, load, speed, slip):
    boxes = "".join(
        f'<geom type="box" size="0.0015 0.075 {height / 2}" mass="0"'
        f' pos="{(radius + height / 2) * math.sin(a)} 0 {-(radius + height / 2) * math.cos(a)}"'
        f' euler="0 {-math.degrees(a)} 0"/>'
        for a in (math.tau * lug / lugs for lug in range(lugs))
    )
    omega = speed / radius / (1 - slip)
    text = f"""<mujoco><option timestep="{1 / RATE}" gravity="0 0 -{load / mass}"/>
      <worldbody><geom type="plane" size="10 10 1" friction="0.6 0 0"/>
        <body pos="0 0 {radius + height}"><joint name="x" type="slide" axis="1 0 0"/>
          <joint type="slide" axis="0 0 1"/><joint name="turn" type="hinge" axis="0 1 0"/>
          <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
          <geom type="cylinder" size="{radius} 0.075" euler="90 0 0" mass="0" friction="0.6 0 0"/>{boxes}
        </body></worldbody>
      <actuator><velocity joint="x" kv="1e5"/><velocity joint="turn" kv="1e3"/></actuator></mujoco>"""
    compiled = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(compiled)
    state.ctrl[:] = [speed, omega]
    mujoco.mj_step(compiled, state, RATE // 10)
    return compiled, state


def mujoco_step(compiled, state):
    """Seconds a step."""
    start = time.perf_counter()
    mujoco.mj_step(compiled, state, RATE)
    return (time.perf_counter() - start) / RATE


def lugwheel_step(scenario, rate):
    """Seconds a step, and how many times faster than real time."""
    with tempfile.TemporaryDirectory() as folder:
        command = [ROOT / "target/release/lugwheel", "simulate", f"scenarios/{scenario}.toml", "--json"]
        command += ["--out", f"{folder}/run.h5", "--set", f"duration={SECONDS}"]
        if rate:
            command += ["--set", f"physics_rate={rate}"]
        finished = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    summary = json.loads(finished.stdout)
    return summary["computing_s"] / SECONDS / RATE, summary["real_time_factor"]


def spread(values):
    return f"{statistics.median(values):.3f} [{min(values):.3f}, {max(values):.3f}]"


def main():
    wheel = model(0.14, 28, 0.015, 12.0, 0.05, 100.0, 0.014, 0.1)
    steps = [mujoco_step(*wheel) for _ in range(TURNS)]
    print(f"MuJoCo {mujoco.__version__}, bare step: {statistics.median(steps) * 1e6:.2f} us")
    for scenario in ["single_wheel_ht", "single_wheel_st", "rover_ht", "rover_st"]:
        ratios, factors = [], []
        for _ in range(TURNS):
            theirs = mujoco_step(*wheel)
            ratios.append(lugwheel_step(scenario, RATE)[0] / theirs)
            factors.append(lugwheel_step(scenario, None)[1])
        print(f"{scenario:<16} at 128 kHz {spread(ratios)} of MuJoCo's step;"
              f" default rate {statistics.median(factors):.0f} x real time")


if __name__ == "__main__":
    main()
