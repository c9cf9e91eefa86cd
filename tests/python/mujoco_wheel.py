"""A lugged wheel that MuJoCo rolls over flat hard ground, as a run file.

mujoco_wheel.py FILE.h5    writes the runs; needs `pip install mujoco h5py`

The wheel is that of scenarios/single_wheel_ref.toml: rim 140 mm, 28 lugs of 15 mm height and 3 mm
thickness, 100 N on the ground; carriage and wheel speed are driven as a single-wheel test bed does.
Contact: MuJoCo's soft constraints with the parameters in `CONTACT`; time step 0.1 ms, integrator
implicitfast, Newton solver. Nothing is random: the same version writes the same numbers.
"""

import math
import sys

try:
    import h5py
    import mujoco
    import numpy as np
except ImportError as missing:
    sys.exit(f"a module is missing ({missing}): run `pip install mujoco h5py`")

RADIUS, WIDTH, LUGS, HEIGHT, THICKNESS = 0.14, 0.15, 28, 0.015, 0.003  # m
LOAD = 100.0  # N
MASS = {"wheel": 4.0, "slide": 6.19}  # kg; together they weigh LOAD
# Time constant 2 ms and damping ratio 1 of a contact; impedance 0.95 to 0.99 over 0.1 mm.
CONTACT = 'solref="0.002 1" solimp="0.95 0.99 0.0001" friction="0.6 0.005 0.0001" condim="3"'
STEP = 1.0e-4  # s
STEPS_PER_SAMPLE = 10  # block means: 1 kHz
LEAD_IN, DURATION = 2.0, 15.0  # s
RUNS = [(0.010, 0.0), (0.014, 0.2), (0.020, 0.4)]  # forward speed [m/s], slip [-]


def lug(index, offset=0.0):
    """A lug as a box from inside the rim to its tip; the first points straight down, where the rim is `offset` [m] off."""
    angle = 2.0 * math.pi * index / LUGS
    middle = RADIUS + 0.5 * HEIGHT - 0.005
    place = f"{-middle * math.sin(angle)} 0 {-offset - middle * math.cos(angle)}"
    half = f"{0.5 * THICKNESS} {0.5 * WIDTH} {0.5 * HEIGHT + 0.005}"
    return f'<geom type="box" size="{half}" pos="{place}" euler="0 {angle} 0" mass="0" {CONTACT}/>'


def model():
    lugs = "\n".join(lug(index) for index in range(LUGS))
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{STEP}" integrator="implicitfast" solver="Newton" gravity="0 0 -9.81"/>
  <worldbody>
    <geom type="plane" size="5 5 0.1" {CONTACT}/>
    <body name="slide" pos="0 0 {RADIUS + HEIGHT}">
      <joint name="forward" type="slide" axis="1 0 0"/>
      <joint name="upward" type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.01" mass="{MASS['slide']}" contype="0" conaffinity="0"/>
      <site name="axle"/>
      <body name="wheel">
        <joint name="turn" type="hinge" axis="0 1 0"/>
        <geom type="cylinder" size="{RADIUS} {0.5 * WIDTH}" euler="{0.5 * math.pi} 0 0"
              mass="{MASS['wheel']}" {CONTACT}/>
        {lugs}
      </body>
    </body>
  </worldbody>
  <actuator>
    <velocity name="speed" joint="forward" kv="1e5"/>
    <velocity name="motor" joint="turn" kv="1e3"/>
  </actuator>
  <sensor><accelerometer site="axle"/></sensor>
</mujoco>""")


def rolled(speed, slip):
    """Vertical acceleration without gravity [m/s²], wheel angle [rad] and normal force [N]."""
    wheel = model()
    state = mujoco.MjData(wheel)
    turning = speed / (RADIUS * (1.0 - slip))
    state.ctrl[:] = [speed, turning]
    state.qvel[wheel.jnt_dofadr[0]], state.qvel[wheel.jnt_dofadr[2]] = speed, turning
    upward = wheel.jnt_dofadr[1]
    samples = []
    for _ in range(round((LEAD_IN + DURATION) / STEP)):
        mujoco.mj_step(wheel, state)
        samples.append((state.sensordata[2] - 9.81, state.qpos[2], state.qfrc_constraint[upward]))
    block = np.array(samples).reshape(-1, STEPS_PER_SAMPLE, 3).mean(axis=1)
    return block[round(LEAD_IN / (STEP * STEPS_PER_SAMPLE)):].T


def write(path):
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "lugwheel-runs"
        file.attrs["format_version"] = 1
        file.attrs["created_by"] = f"tests/python/mujoco_wheel.py, MuJoCo {mujoco.__version__}"
        for index, (speed, slip) in enumerate(RUNS):
            run = file.create_group(f"runs/mujoco_{index}")
            run.attrs.update({
                "wheel_radius_m": RADIUS, "wheel_width_m": WIDTH, "lug_height_m": HEIGHT,
                "lug_count": np.uint32(LUGS), "load_n": LOAD, "speed_m_s": speed,
                "slip_ratio": slip, "terrain": "REF", "class": "ALCT", "repeat": np.uint32(0),
                "day": "", "notes": f"MuJoCo {mujoco.__version__}, {CONTACT}",
            })
            channels = zip(("acceleration_y", "wheel_angle", "normal_force"), ("m/s^2", "rad", "N"), rolled(speed, slip))
            for name, unit, values in channels:
                data = run.create_dataset(f"channels/{name}", data=values.astype("f4"), compression="gzip", shuffle=True)
                data.attrs.update({"unit": unit, "start_s": 0.0, "sample_rate_hz": 1.0 / (STEP * STEPS_PER_SAMPLE)})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    write(sys.argv[1])
