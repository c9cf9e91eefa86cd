"""A single-wheel test bed in MuJoCo with one cause of error put in: measurements that lugwheel did not make.

mujoco_rig.py FOLDER    writes one run file per cause and wheel.toml, the scenario to diagnose them with;
                        needs `pip install mujoco h5py`

    lugwheel diagnose --measured FOLDER/axle_off.h5 --scenario FOLDER/wheel.toml --bank FOLDER/bank --out FOLDER/axle_off

The wheel is that of mujoco_wheel.py and scenarios/single_wheel_ref.toml, on flat hard ground. Carriage and wheel follow their commands through a belt and a gear of the stiffness
and damping in that scenario; 12 kg move vertically. Contact: MuJoCo's soft constraints, another law than lugwheel's. Time step 0.1 ms, integrator implicitfast, Newton solver; samples
at 1 kHz behind a low pass. Each campaign has five conditions of slip, speed and load, each twice, and the lifted wheel at two speeds.
Sensors have white noise, drawn from `SEED`; nothing else is random.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

try:
    import h5py
    import mujoco
    import numpy as np
except ImportError as missing:
    sys.exit(f"a module is missing ({missing}): run `pip install mujoco h5py`")

from mujoco_wheel import CONTACT, HEIGHT, LEAD_IN, LUGS, RADIUS, STEP, STEPS_PER_SAMPLE, THICKNESS, WIDTH, lug

WHEEL, SLIDE, CARRIAGE = 4.0, 8.0, 30.0  # kg
BELT, GEAR = 5.0e5, 5.0e3  # N/m, N·m/rad
ROTOR = 0.12  # kg·m²
GRAVITY = 9.81  # m/s²
CLEARANCE = 0.02  # m, of the lifted wheel
# Low pass before every tenth step is kept: windowed sine cardinal, -6 dB at 430 Hz.
TAPS = 161
DURATION = 8.0  # s
# Slip [-], forward speed [m/s], load [N], 0 for the lifted wheel.
CONDITIONS = [(0.1, 0.02, 100.0), (0.3, 0.02, 100.0), (0.3, 0.1, 100.0), (0.1, 0.1, 60.0), (0.3, 0.02, 60.0)]
LIFTED = [(0.1, 0.02, 0.0), (0.1, 0.1, 0.0)]
SEED = 1
# Channel, unit, standard deviation of its white noise at 1 kHz.
CHANNELS = [
    ("acceleration_y", "m/s^2", 1.1e-3), ("drawbar_pull", "N", 0.045), ("normal_force", "N", 0.045),
    ("driving_torque", "N m", 2.7e-3), ("forward_speed", "m/s", 2.2e-5), ("wheel_angle", "rad", 0.0),
]


@dataclass
class Cause:
    """What differs from the nominal rig."""

    name: str
    offset: float = 0.0  # m, of the rim's centre from the axle, towards the lug that points down at angle 0
    encoder: float = 0.0  # -, the encoder reads so much more than the wheel turns
    friction: float = 0.0  # N, of the vertical guide
    tilt: float = 0.0  # rad, of the force sensor
    ripple: float = 0.0  # -, of the wheel's speed, amplitude
    frequency: float = 3.0  # Hz, of the ripple


CAUSES = [
    Cause("nothing"), Cause("axle_off", offset=1.5e-3), Cause("encoder_off", encoder=0.04),
    Cause("guide_rubs", friction=4.0), Cause("sensor_leans", tilt=math.radians(2.0)), Cause("speed_ripples", ripple=0.03),
]


def model(cause, is_lifted):
    lugs = "\n".join(lug(index, cause.offset) for index in range(LUGS))
    height = RADIUS + HEIGHT + (CLEARANCE if is_lifted else 0.0)
    held = 'stiffness="1e7" damping="3e3"' if is_lifted else f'frictionloss="{cause.friction}"'
    belt = 2.0 * 0.05 * math.sqrt(BELT * (CARRIAGE + SLIDE + WHEEL))
    gear = 2.0 * 0.2 * math.sqrt(GEAR * ROTOR)
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{STEP}" integrator="implicitfast" solver="Newton" gravity="0 0 {-GRAVITY}"/>
  <worldbody>
    <geom type="plane" size="5 5 0.1" {CONTACT}/>
    <body name="carriage" pos="0 0 {height}">
      <joint name="forward" type="slide" axis="1 0 0"/>
      <geom type="sphere" size="0.01" mass="{CARRIAGE}" contype="0" conaffinity="0"/>
      <body name="slide">
        <joint name="upward" type="slide" axis="0 0 1" {held}/>
        <geom type="sphere" size="0.01" mass="{SLIDE}" contype="0" conaffinity="0"/>
        <site name="axle"/>
        <body name="wheel">
          <joint name="turn" type="hinge" axis="0 1 0" armature="{ROTOR}"/>
          <geom type="cylinder" size="{RADIUS} {0.5 * WIDTH}" pos="0 0 {-cause.offset}" euler="{0.5 * math.pi} 0 0"
                mass="{WHEEL}" {CONTACT}/>
          {lugs}
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general name="belt" joint="forward" gainprm="1" biastype="none"/>
    <general name="gear" joint="turn" gainprm="1" biastype="none"/>
  </actuator>
  <sensor><accelerometer site="axle"/></sensor>
</mujoco>"""), belt, gear


def rolled(cause, slip, speed, load, start):
    """Samples of all channels, one column each, of a run whose wheel starts at the angle `start` [rad]."""
    wheel, belt, gear = model(cause, load == 0.0)
    state = mujoco.MjData(wheel)
    turning = speed / (RADIUS * (1.0 - slip)) / (1.0 + cause.encoder)
    state.qpos[2] = start
    state.qvel[0], state.qvel[2] = speed, turning
    slide = mujoco.mj_name2id(wheel, mujoco.mjtObj.mjOBJ_BODY, "slide")
    carried = 0.0 if load == 0.0 else (SLIDE + WHEEL) * GRAVITY - load
    samples = []
    for step in range(round((LEAD_IN + DURATION) / STEP)):
        time = step * STEP
        rate = 2.0 * math.pi * cause.frequency
        commanded = start + turning * (time + cause.ripple * (1.0 - math.cos(rate * time)) / rate)
        commanded_speed = turning * (1.0 + cause.ripple * math.sin(rate * time))
        state.ctrl[0] = BELT * (speed * time - state.qpos[0]) + belt * (speed - state.qvel[0])
        state.ctrl[1] = GEAR * (commanded - state.qpos[2]) + gear * (commanded_speed - state.qvel[2])
        state.xfrc_applied[slide, 2] = carried
        mujoco.mj_step(wheel, state)
        pull, normal = state.qfrc_constraint[:2]
        # The friction of the guide is a constraint too, the first, and none of the ground's.
        normal -= state.efc_force[state.ne] if state.nf else 0.0
        torque = state.ctrl[1] - ROTOR * state.qacc[2]
        samples.append((state.sensordata[2] - GRAVITY, pull, normal, torque, state.qvel[0], state.qpos[2]))
    return sampled(np.array(samples))


def sampled(values):
    """Low-passed columns after the lead-in, every tenth row."""
    time = (np.arange(TAPS) - 0.5 * (TAPS - 1)) * STEP
    taps = np.sinc(2.0 * 430.0 * time) * np.hamming(TAPS)
    taps /= taps.sum()
    first = round(LEAD_IN / STEP) - (TAPS - 1) // 2
    columns = [np.convolve(column, taps, "valid")[first::STEPS_PER_SAMPLE] for column in values.T]
    return np.stack(columns, axis=1)


def measured(cause, values, rng):
    """What the sensors of the rig make of it."""
    read = values.copy()
    pull, normal = values[:, 1], values[:, 2]
    read[:, 1] = pull * math.cos(cause.tilt) + normal * math.sin(cause.tilt)
    read[:, 2] = normal * math.cos(cause.tilt) - pull * math.sin(cause.tilt)
    read[:, 5] *= 1.0 + cause.encoder
    for column, (_, _, deviation) in enumerate(CHANNELS):
        read[:, column] += rng.normal(0.0, deviation, len(read)) if deviation else 0.0
    return read


def write(path, cause):
    rng = np.random.default_rng([SEED, CAUSES.index(cause)])
    runs = [(*condition, repeat) for repeat in (1, 2) for condition in CONDITIONS + LIFTED[: 2 * (2 - repeat)]]
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "lugwheel-runs"
        file.attrs["format_version"] = 1
        file.attrs["created_by"] = f"tests/python/mujoco_rig.py, MuJoCo {mujoco.__version__}"
        for index, (slip, speed, load, repeat) in enumerate(runs):
            run = file.create_group(f"runs/run_{index + 1:02}")
            run.attrs.update({
                "wheel_radius_m": RADIUS, "wheel_width_m": WIDTH, "wheel_mass_kg": WHEEL, "lug_height_m": HEIGHT,
                "lug_thickness_m": THICKNESS, "lug_count": np.uint32(LUGS), "load_n": load, "speed_m_s": speed,
                "slip_ratio": slip, "terrain": "REF", "class": "", "repeat": np.uint32(repeat), "day": "", "notes": "",
            })
            values = measured(cause, rolled(cause, slip, speed, load, rng.uniform(0.0, 2.0 * math.pi)), rng)
            for (name, unit, _), column in zip(CHANNELS, values.T):
                kind = "f8" if name == "wheel_angle" else "f4"
                data = run.create_dataset(f"channels/{name}", data=column.astype(kind), compression="gzip", shuffle=True)
                data.attrs.update({"unit": unit, "start_s": 0.0, "sample_rate_hz": 1.0 / (STEP * STEPS_PER_SAMPLE)})


def scenario():
    """The ready scenario with the lead-in and the noise of this rig."""
    ready = Path(__file__).parents[2] / "scenarios" / "single_wheel_ref.toml"
    text = ready.read_text().replace("version = 1\n", "version = 1\nlead_in = 2.0\n").replace("2_000", "1_000")
    return text + """
[sensors.accelerometer.acceleration_y]
noise_density = 4.9e-5  # m/s²/√Hz
[sensors.force_torque.normal_force]
noise_density = 2.0e-3  # N/√Hz
[sensors.force_torque.drawbar_pull]
noise_density = 2.0e-3  # N/√Hz
[sensors.force_torque.driving_torque]
noise_density = 1.2e-4  # N·m/√Hz
[sensors.encoder.forward_speed]
noise_density = 1.0e-6  # m/s/√Hz
"""


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "wheel.toml").write_text(scenario())
    for each in CAUSES:
        write(folder / f"{each.name}.h5", each)
