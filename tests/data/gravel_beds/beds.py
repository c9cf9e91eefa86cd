#!/usr/bin/env python3
"""A lugged wheel rolling over a bed of free stones, in MuJoCo.

    gcc -O3 -march=native -ffast-math -o soft_clump soft_clump.c -lm
    python3 beds.py --out beds.csv --beds 20                 # the base condition, non-spherical stones
    python3 beds.py --out beds.csv --beds 8 --width 0.3
    python3 beds.py --out beds.csv --beds 20 --shape sphere
    python3 beds.py --out beds.csv --beds 20 --simulator soft    # the same beds by soft_clump.c

One row per bed is appended to the file; rows that it already has are skipped, so an interrupted run
goes on where it stopped. `characterise.py` measures the stones, `summarise.py` prints the table.

Model: stones are rigid bodies, single spheres or clumps of four overlapping spheres (random templates,
scaled so that the clump's volume is that of a sphere of the stone's nominal diameter; inertia of the
union). The wheel is a cylinder with one box per lug; its forward motion and turn are prescribed, its
vertical motion is free under a constant load. Stones far from the wheel cannot move: every
`SEGMENT` metres the model is set up anew with free stones only between `BACK` and `AHEAD` of the axle,
fixed ones for 80 mm beyond, none elsewhere. MuJoCo's contacts have no memory, so this changes no force.
"""
import argparse
import csv
import os
import pickle
import subprocess
import tempfile
import time
from dataclasses import dataclass, field

import mujoco
import numpy as np

GRAVITY = 9.81            # m/s²
DENSITY = 2650.0          # kg/m³
DIAMETERS = (0.020, 0.050)  # m, log-uniform
DEPTH = 0.12              # m
FRICTION = 0.6            # stone on stone, wheel and floor
WALL_FRICTION = 0.3       # stone on the trough's side walls, assumed
OFFSET, BALL = 0.30, 0.265  # of a clump's spheres before scaling
POUR_FRICTION = 0.2       # while the bed is poured and raked: stands for tamping, assumed
SIDE_GAP = 0.10           # m, trough width less wheel width
RIM, LUG_HEIGHT, LUG_THICKNESS, LUGS = 0.14, 0.015, 0.003, 28  # m
MOVING_MASS = 12.0        # kg, moves vertically with the axle
RAMP, WINDOW, STAND = 0.5, 15.0, 1.0  # s
BACK, AHEAD, MARGIN = 0.11, 0.15, 0.08  # m
SEGMENT = 0.014           # m
RATE = 2000.0             # Hz, output
FIELDS = ("simulator shape seed width_m speed_mps slip load_n rms_2_20_mps2 rms_20_200_mps2 "
          "rms_200_800_mps2 pull_mean_n pull_sd_n torque_mean_nm sinkage_mm contacts_mean "
          "contacts_rim_mean contacts_lugs_mean rms_2_800_mps2 load_mean_n penetration_max_mm stones wall_clock_s").split()


@dataclass
class Contact:
    """MuJoCo's contact law: acceleration-space spring and damper of natural frequency `omega` and
    damping ratio `zeta`, regularised by 1 - `impedance`; `impratio` stiffens friction against creep."""
    step: float = 0.0005
    omega: float = 1000.0     # rad/s
    zeta: float = 1.0         # measured restitution 0.17
    impedance: float = 0.95
    impratio: float = 20.0
    iterations: int = 200
    tolerance: float = 1e-8   # at 1e-5 the solver's residual shakes the wheel
    solver: str = "CG"
    noslip: int = 0

    def solref(self):
        return f"{1.0 / (self.zeta * self.omega):.6g} {self.zeta:.6g}"


@dataclass
class Stones:
    shape: str
    templates: list
    template: np.ndarray
    diameter: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray
    velocity: np.ndarray = field(default=None)

    def keep(self, mask):
        return Stones(self.shape, self.templates, self.template[mask], self.diameter[mask],
                      self.position[mask], self.quaternion[mask],
                      None if self.velocity is None else self.velocity[mask])

    def volume(self):
        return np.pi / 6 * self.diameter**3

    def tops(self):
        """Height of each stone's highest point."""
        z = np.empty(len(self.diameter))
        for i, (t, d, p, q) in enumerate(zip(self.template, self.diameter, self.position, self.quaternion)):
            c, r, _ = self.templates[t]
            w, x, y, s = q
            row = np.array([2 * (x * s - w * y), 2 * (y * s + w * x), 1 - 2 * (x * x + y * y)])
            z[i] = p[2] + (d * (c @ row + r)).max()
        return z


def template(rng, shape):
    """Centres, radii and principal moments (per mass and diameter²) of one shape of unit nominal diameter."""
    if shape == "sphere":
        return np.zeros((1, 3)), np.array([0.5]), np.full(3, 0.1)
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    axes = np.array([1.3, 1.0, 0.75])
    c = corners * axes * OFFSET * rng.uniform(0.85, 1.15, (4, 1))
    r = rng.uniform(0.88, 1.12, 4) * BALL
    p = rng.uniform(-1, 1, (200_000, 3))
    inside = np.zeros(len(p), bool)
    for ci, ri in zip(c, r):
        inside |= ((p - ci) ** 2).sum(1) < ri * ri
    scale = (np.pi / 6 / (8 * inside.mean())) ** (1 / 3)
    q = p[inside] * scale
    centre = q.mean(0)
    q -= centre
    cov = q.T @ q / len(q)
    moments, axes = np.linalg.eigh(np.trace(cov) * np.eye(3) - cov)
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    return (c * scale - centre) @ axes, r * scale, moments


def stone_xml(stones, i, free):
    c, r, moments = stones.templates[stones.template[i]]
    d = stones.diameter[i]
    m = DENSITY * np.pi / 6 * d**3
    geoms = "".join(f'<geom class="stone" size="{ri * d:.7g}" pos="{ci[0] * d:.7g} {ci[1] * d:.7g} {ci[2] * d:.7g}"/>'
                    for ci, ri in zip(c, r))
    joint = ""
    if free:
        j = moments * m * d * d
        joint = f'<freejoint/><inertial pos="0 0 0" mass="{m:.7g}" diaginertia="{j[0]:.7g} {j[1]:.7g} {j[2]:.7g}"/>'
    p, q = stones.position[i], stones.quaternion[i]
    return (f'<body pos="{p[0]:.12g} {p[1]:.12g} {p[2]:.12g}" quat="{q[0]:.12g} {q[1]:.12g} {q[2]:.12g} {q[3]:.12g}">'
            f'{joint}{geoms}</body>')


def wheel_xml(width, mass=MOVING_MASS):
    """Joints in order: forward, vertical, turn. Huge armatures make forward motion and turn prescribed."""
    inner = RIM - 0.01
    half = 0.5 * (RIM + LUG_HEIGHT - inner)
    lugs = "".join(
        f'<geom class="lug" size="{LUG_THICKNESS / 2} {width / 2} {half}" '
        f'pos="{(inner + half) * np.sin(a):.8g} 0 {-(inner + half) * np.cos(a):.8g}" euler="0 {-a:.8g} 0"/>'
        for a in 2 * np.pi * np.arange(LUGS) / LUGS)
    return (f'<body name="wheel" pos="0 0 0" gravcomp="1"><joint type="slide" axis="1 0 0" armature="1e6"/>'
            f'<joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0" armature="1e5"/>'
            f'<inertial pos="0 0 0" mass="{mass}" diaginertia="0.05 0.05 0.05"/>'
            f'<geom class="rim" size="{RIM} {width / 2}" euler="{np.pi / 2} 0 0"/>{lugs}</body>')


def model(stones, free, fixed, contact, walls, wheel="", floor=None):
    bodies = "".join(stone_xml(stones, i, True) for i in free) + "".join(stone_xml(stones, i, False) for i in fixed)
    x0, x1, width = walls
    side = f'size="0 0 1" friction="{WALL_FRICTION} 0 0" priority="1"'
    floor = floor or f'<geom type="plane" size="0 0 1" pos="0 0 {-DEPTH}"/>'
    text = f'''<mujoco><compiler angle="radian"/><size memory="400M"/>
<option timestep="{contact.step}" gravity="0 0 {-GRAVITY}" cone="elliptic" impratio="{contact.impratio}" solver="{contact.solver}"
 iterations="{contact.iterations}" tolerance="{contact.tolerance}" noslip_iterations="{contact.noslip}"/>
<default><geom condim="3" friction="{FRICTION} 0 0" solref="{contact.solref()}" solimp="{contact.impedance} {contact.impedance} 0.001 0.5 2"/>
<default class="stone"><geom type="sphere"/></default><default class="rim"><geom type="cylinder" group="1"/></default>
<default class="lug"><geom type="box" group="2"/></default></default>
<worldbody>{floor}
<geom type="plane" pos="0 {width / 2} 0" zaxis="0 -1 0" {side}/><geom type="plane" pos="0 {-width / 2} 0" zaxis="0 1 0" {side}/>
<geom type="plane" size="0 0 1" pos="{x0} 0 0" zaxis="1 0 0"/><geom type="plane" size="0 0 1" pos="{x1} 0 0" zaxis="-1 0 0"/>
{wheel}{bodies}</worldbody></mujoco>'''
    m = mujoco.MjModel.from_xml_string(text)
    return m, mujoco.MjData(m)


def draw(rng, shape, walls, volume, z0=-DEPTH, cell=1.12 * DIAMETERS[1]):
    """Stones of total `volume` on a loose grid, ready to fall."""
    x0, x1, width = walls
    templates = [template(np.random.default_rng(77), "sphere")] if shape == "sphere" else \
        [template(r, shape) for r in np.random.default_rng(77).spawn(16)]
    d, total = [], 0.0
    while total < volume:
        d.append(DIAMETERS[0] * (DIAMETERS[1] / DIAMETERS[0]) ** rng.random())
        total += np.pi / 6 * d[-1] ** 3
    d = np.array(d)
    nx, ny = max(1, int((x1 - x0) / cell)), max(1, int(width / cell))
    k = np.arange(len(d))
    sx, sy = (x1 - x0) / nx, width / ny
    grid = np.stack([x0 + sx * (0.5 + k // ny % nx), -width / 2 + sy * (0.5 + k % ny), z0 + cell * (0.5 + k // (nx * ny))], 1)
    grid[:, :2] += (rng.random((len(d), 2)) - 0.5) * np.maximum(0.0, 0.5 * (cell - 1.25 * d))[:, None]
    q = rng.normal(size=(len(d), 4))
    q /= np.linalg.norm(q, axis=1)[:, None]
    return Stones(shape, templates, rng.integers(len(templates), size=len(d)), d, grid, q)


def settle(stones, walls, seconds, contact, floor=None, drag=2.0, friction=FRICTION):
    """Lets all stones fall and come to rest, with a light drag [1/s]."""
    m, data = model(stones, range(len(stones.diameter)), [], contact, walls, floor=floor)
    m.geom_friction[:, 0] = np.minimum(m.geom_friction[:, 0], friction)
    if stones.velocity is not None:
        data.qvel[:] = stones.velocity.ravel()
    for _ in range(int(seconds / contact.step)):
        mujoco.mj_step(m, data)
        data.qvel *= 1 - drag * contact.step
    q = data.qpos.reshape(-1, 7)
    return Stones(stones.shape, stones.templates, stones.template, stones.diameter, q[:, :3].copy(), q[:, 3:].copy(),
                  data.qvel.reshape(-1, 6).copy())


POUR = Contact(step=0.001, omega=500.0, zeta=0.5, impedance=0.97, impratio=1.0, iterations=40, tolerance=1e-5)


def pour(seed, shape, walls, fill=0.66):
    """A bed of DEPTH, raked: stones that stick out more than 12 mm above the level are taken away."""
    rng = np.random.default_rng(1000 + seed)
    x0, x1, width = walls
    stones = settle(draw(rng, shape, walls, fill * (x1 - x0) * width * DEPTH), walls, 0.9, POUR, friction=POUR_FRICTION)
    for seconds, friction in ((0.2, POUR_FRICTION), (0.3, FRICTION)):
        stones = settle(stones.keep(stones.tops() < 0.012), walls, seconds, POUR, friction=friction)
    stones.velocity[:] = 0
    return stones


def packing(stones, x0, x1, width, top=-0.02):
    """Solid fraction between floor and `top`, by points inside the stones' spheres."""
    rng = np.random.default_rng(5)
    p = rng.uniform([x0, -width / 2, -DEPTH], [x1, width / 2, top], (40_000, 3))
    inside = np.zeros(len(p), bool)
    for t, d, x, q in zip(stones.template, stones.diameter, stones.position, stones.quaternion):
        near = np.flatnonzero(((p - x) ** 2).sum(1) < d * d)
        if near.size:
            rot = np.empty(9)
            mujoco.mju_quat2Mat(rot, q)
            for c, r in zip(*stones.templates[t][:2]):
                inside[near] |= ((p[near] - x - rot.reshape(3, 3) @ (c * d)) ** 2).sum(1) < (r * d) ** 2
    return inside.mean()


@dataclass
class Trace:
    acceleration: np.ndarray
    pull: np.ndarray
    torque: np.ndarray
    load: np.ndarray
    height: np.ndarray
    contacts: np.ndarray      # stones touching wheel, rim, lugs
    penetration: float
    standing_height: float
    creep: float
    standing_rms: float


def roll(stones, width, speed, slip, load, contact, seconds=WINDOW, stand=STAND, track=None, reach=(BACK, AHEAD)):
    """Lowers the wheel, lets it stand, drives it; traces at RATE, those of the start-up left out."""
    walls = track
    omega = speed / (RIM * (1 - slip))
    dt, block = contact.step, max(1, round(1 / (RATE * contact.step)))
    near = (np.abs(stones.position[:, 0]) < 0.12) & (np.abs(stones.position[:, 1]) < width / 2)
    # lowest height at which the tip circle clears every stone
    tops = stones.tops()
    x = stones.position[near, 0]
    z = (tops[near] + np.sqrt(np.maximum((RIM + LUG_HEIGHT) ** 2 - x**2, 0))).max()
    state = np.array([0.0, z, 0.0])   # forward, vertical, turn
    vz, steps_done = 0.0, 0
    total = stand + RAMP + seconds
    n = round(total / dt)
    out, touch = np.zeros((n, 5)), []
    penetration, warm = 0.0, None
    height0, q = z, stones.position
    free = None
    k = 0
    while k < n:
        xw = state[0]
        p = stones.position[:, 0] - xw
        free = np.flatnonzero((p > -reach[0]) & (p < reach[1]))
        fixed = np.flatnonzero(((p > -reach[0] - MARGIN) & (p <= -reach[0])) | ((p >= reach[1]) & (p < reach[1] + MARGIN)))
        m, data = model(stones, free, fixed, contact, walls, wheel_xml(width))
        data.qpos[:3] = state
        data.qvel[1] = vz
        if stones.velocity is not None:
            data.qvel[3:] = stones.velocity[free].ravel()
        if warm is not None:
            acc = np.zeros((len(stones.diameter), 6))
            acc[warm[0]] = warm[2]
            data.qacc_warmstart[:3], data.qacc_warmstart[3:] = warm[1], acc[free].ravel()
        wheel = m.body("wheel").id
        group = m.geom_group
        while k < n and data.qpos[0] < xw + SEGMENT:
            t = k * dt
            if t <= stand:
                v = 0.0
            else:
                tr = t - stand
                v = 0.5 - 0.5 * np.cos(np.pi * tr / RAMP) if tr < RAMP else 1.0
            data.qvel[0], data.qvel[2] = speed * v, omega * v
            damper = 1800.0 * data.qvel[1] if t < min(stand, 1.0) else 0.0
            data.qfrc_applied[1] = -load - damper
            mujoco.mj_step(m, data)
            out[k] = data.qacc[1], data.qfrc_constraint[0], -data.qfrc_constraint[2], data.qfrc_constraint[1], data.qpos[1]
            if k % 20 == 0:
                g = data.contact.geom
                dist = data.contact.dist
                body = m.geom_bodyid[g]
                hit = (body == wheel).any(1) & (dist < 0)
                other = np.where(body[:, 0] == wheel, body[:, 1], body[:, 0])[hit]
                mine = np.where(body[:, 0] == wheel, g[:, 0], g[:, 1])[hit]
                touch.append((k, len(set(other)), len(set(other[group[mine] == 1])), len(set(other[group[mine] == 2]))))
                if t > stand:
                    penetration = max(penetration, -dist.min())
            k += 1
            if t <= stand and k * dt > stand:
                break
        state, vz = data.qpos[:3].copy(), data.qvel[1]
        s = data.qpos[3:].reshape(-1, 7)
        stones.position[free], stones.quaternion[free] = s[:, :3], s[:, 3:]
        if stones.velocity is None:
            stones.velocity = np.zeros((len(stones.diameter), 6))
        stones.velocity[:] = 0
        stones.velocity[free] = data.qvel[3:].reshape(-1, 6)
        warm = (free, data.qacc_warmstart[:3].copy(), data.qacc_warmstart[3:].reshape(-1, 6).copy())
    first = round((stand + RAMP) / dt)
    standing = round(stand / dt) - 1
    touch = np.array(touch)
    rows = (n - first) // block
    mean = out[first:first + rows * block].reshape(rows, block, 5).mean(1)
    released = round(min(stand, 1.0) / dt)
    return Trace(mean[:, 0], mean[:, 1], mean[:, 2], mean[:, 3], mean[:, 4], touch[touch[:, 0] >= first][:, 1:], penetration,
                 out[standing, 4], out[min(released, standing), 4] - out[standing, 4],
                 out[released:standing + 1, 0].std() if standing > released else np.nan)


def band(a, low, high, rate=RATE):
    """Rms of `a` between two frequencies."""
    s = np.fft.rfft(a - a.mean())
    f = np.fft.rfftfreq(len(a), 1 / rate)
    s[(f < low) | (f >= high)] = 0
    return np.fft.irfft(s, len(a)).std()


def low_pass(x, cut, rate=RATE):
    s = np.fft.rfft(x)
    s[np.fft.rfftfreq(len(x), 1 / rate) > cut] = 0
    return np.fft.irfft(s, len(x))


def measures(trace):
    keep = int(RATE * (WINDOW - 1))
    a = trace.acceleration[-keep:]
    pull = trace.pull[-keep:]
    return dict(rms_2_20_mps2=band(a, 2, 20), rms_20_200_mps2=band(a, 20, 200), rms_200_800_mps2=band(a, 200, 800),
                rms_2_800_mps2=band(a, 2, 800), pull_mean_n=pull.mean(), pull_sd_n=low_pass(pull, 20).std(),
                torque_mean_nm=trace.torque[-keep:].mean(), load_mean_n=trace.load[-keep:].mean(),
                sinkage_mm=1e3 * (trace.standing_height - trace.height[-1]),
                contacts_mean=trace.contacts[:, 0].mean(), contacts_rim_mean=trace.contacts[:, 1].mean(),
                contacts_lugs_mean=trace.contacts[:, 2].mean(), penetration_max_mm=1e3 * trace.penetration)


def write_bed(stones, path):
    """The bed in the format of soft_clump.c."""
    with open(path, "w") as f:
        print(len(stones.diameter), file=f)
        for t, d, p, q in zip(stones.template, stones.diameter, stones.position, stones.quaternion):
            c, r, moments = stones.templates[t]
            m = DENSITY * np.pi / 6 * d**3
            print(m, *(moments * m * d * d), *p, *q, len(r), file=f)
            for ci, ri in zip(c, r):
                print(*(ci * d), ri * d, file=f)


def bed(seed, shape, walls):
    """The poured bed, kept in beds/ as it is wanted for several conditions."""
    name = f"beds/{shape}_{seed}_{walls[1]:.3f}_{walls[2]:.3f}.pkl"
    if os.path.exists(name):
        with open(name, "rb") as f:
            return pickle.load(f)
    stones = pour(seed, shape, walls)
    os.makedirs("beds", exist_ok=True)
    with open(name, "wb") as f:
        pickle.dump(stones, f)
    return stones


def run_soft(seed, shape, width, speed, slip, load, seconds=WINDOW, options=()):
    """The same bed and condition by soft_clump.c (soft spheres, explicit integration)."""
    started = time.time()
    walls = (-0.16, speed * (seconds + RAMP) + 0.2, width + SIDE_GAP)
    stones = bed(seed, shape, walls)
    with tempfile.TemporaryDirectory() as folder:
        write_bed(stones, folder + "/bed")
        subprocess.run(["./soft_clump", folder + "/bed", folder + "/out", f"x0={walls[0]}", f"x1={walls[1]}", f"width={walls[2]}",
                        f"wheel={width}", f"speed={speed}", f"slip={slip}", f"load={load}", f"seconds={seconds}", *options], check=True)
        d = np.loadtxt(folder + "/out")
    trace = Trace(d[:, 0], d[:, 1], d[:, 2], d[:, 3], d[:, 4], d[:, 5:8], d[-1, 8], 0.0, 0.0, 0.0)
    row = dict(simulator="soft", shape=shape, seed=seed, width_m=width, speed_mps=speed, slip=slip, load_n=load,
               stones=len(stones.diameter), wall_clock_s=time.time() - started)
    row.update(measures(trace))
    return row, trace, 0.0


def run(seed, shape, width, speed, slip, load, contact, seconds=WINDOW, reach=(BACK, AHEAD)):
    started = time.time()
    walls = (-0.16, speed * (seconds + RAMP) + 0.2, width + SIDE_GAP)
    stones = bed(seed, shape, walls)
    poured = time.time() - started
    trace = roll(stones, width, speed, slip, load, contact, seconds, track=walls, reach=reach)
    row = dict(simulator="mujoco", shape=shape, seed=seed, width_m=width, speed_mps=speed, slip=slip, load_n=load,
               stones=len(stones.diameter), wall_clock_s=time.time() - started)
    row.update(measures(trace))
    return row, trace, poured


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", default="beds.csv")
    p.add_argument("--beds", type=int, default=20, help="seeds 1 to this")
    p.add_argument("--first", type=int, default=1, help="first seed")
    p.add_argument("--shape", choices=("clump", "sphere"), default="clump")
    p.add_argument("--width", type=float, default=0.15)
    p.add_argument("--speed", type=float, default=0.014)
    p.add_argument("--slip", type=float, default=0.1)
    p.add_argument("--load", type=float, default=100.0)
    p.add_argument("--simulator", choices=("mujoco", "soft"), default="mujoco")
    p.add_argument("--label", help="name of the simulator in the table, its own by default")
    p.add_argument("--option", action="append", default=[], help="key=value passed to soft_clump")
    p.add_argument("--traces", help="folder to keep the traces in")
    for key, value in vars(Contact()).items():
        p.add_argument(f"--{key}", type=type(value), default=value)
    a = p.parse_args()
    contact = Contact(**{k: getattr(a, k) for k in vars(Contact())})
    label = a.label or a.simulator
    done = set()
    if os.path.exists(a.out):
        with open(a.out) as f:
            done = {tuple(r[k] for k in FIELDS[:7]) for r in csv.DictReader(f)}
    else:
        with open(a.out, "w") as f:
            csv.writer(f).writerow(FIELDS)
    for seed in range(a.first, a.beds + 1):
        key = tuple(str(v) for v in (label, a.shape, seed, a.width, a.speed, a.slip, a.load))
        if key in done:
            continue
        if a.simulator == "soft":
            row, trace, _ = run_soft(seed, a.shape, a.width, a.speed, a.slip, a.load, options=a.option)
        else:
            row, trace, _ = run(seed, a.shape, a.width, a.speed, a.slip, a.load, contact)
        row["simulator"] = label
        if a.traces:
            os.makedirs(a.traces, exist_ok=True)
            np.savez_compressed(f"{a.traces}/" + "_".join(map(str, key)), **{k: np.float32(v) for k, v in vars(trace).items()})
        with open(a.out, "a") as f:
            csv.writer(f).writerow([f"{row[k]:.5g}" if k in FIELDS[7:] else row[k] for k in FIELDS])


if __name__ == "__main__":
    main()
