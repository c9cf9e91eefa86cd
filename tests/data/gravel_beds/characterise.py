#!/usr/bin/env python3
"""Measures the stones themselves in both simulators, into characterisation.csv:
restitution of a drop, stiffness of a contact, angle of repose, packing, creep of a standing wheel.

    python3 characterise.py [--quick]        # --quick leaves out the standing wheel in MuJoCo
"""
import csv
import glob
import pickle
import subprocess
import sys
import tempfile
import time

import mujoco
import numpy as np

import beds
from beds import DEPTH, FRICTION, POUR, Contact, Stones, bed, draw, model, packing, pour, roll, settle, wheel_xml, write_bed

LAW = Contact()
rows = []


def put(quantity, simulator, shape, values, unit):
    v = np.atleast_1d(np.asarray(values, float))
    rows.append([quantity, simulator, shape, f"{v.mean():.4g}", unit, len(v)])
    if len(v) > 1:
        rows.append([quantity + ", sd", simulator, shape, f"{v.std(ddof=1):.3g}", unit, len(v)])
    print(*rows[-1], np.round(v, 4), flush=True)
    with open("characterisation.csv", "w") as f:
        csv.writer(f).writerows([["quantity", "simulator", "shape", "value", "unit", "n"], *rows])


def soft(stones, *options, folder=None):
    with tempfile.TemporaryDirectory() as folder:
        write_bed(stones, folder + "/bed")
        subprocess.run(["./soft_clump", folder + "/bed", folder + "/out", *options], check=True)
        return np.loadtxt(folder + "/out")


def slope(x, top, length):
    """Angle [deg] of a surface by its three highest stones every 30 mm, flat top and foot left out."""
    xs, zs = [], []
    for a in np.arange(0, length, 0.03):
        k = (x >= a) & (x < a + 0.03)
        if k.any():
            xs.append(a + 0.015)
            zs.append(np.sort(top[k])[-3:].mean() + DEPTH)
    xs, zs = np.array(xs), np.array(zs)
    k = (zs < 0.85 * zs.max()) & (xs < length - 0.03) & (xs > 0.02)
    return np.degrees(np.arctan(-np.polyfit(xs[k], zs[k], 1)[0]))


def heap(seed, shape, simulator, length=0.36, width=0.15, seconds=2.5):
    """Slope left on a floor once the wall at one end is taken away; side walls without friction."""
    rng = np.random.default_rng(500 + seed)
    s = settle(draw(rng, shape, (0.0, length, width), 0.55 * length * width * 0.26), (0.0, length, width), 0.7, POUR)
    if simulator == "soft":
        d = soft(s, "x0=0", "x1=5", f"edge={length}", f"width={width}", "wall_mu=0", "free=1", f"seconds={seconds}",
                 "rate=20000", "E=3e8", "relax=0.3", "check=2")
        k = (d[:, 0] < length + 0.03) & (d[:, 2] > -DEPTH - 0.03)
        return slope(d[k, 0], d[k, 3], length)
    floor = f'<geom type="box" size="{length / 2} {width} 0.02" pos="{length / 2} 0 {-DEPTH - 0.02}"/>'
    law = Contact(step=0.001, omega=500.0, zeta=1.0, impedance=0.95, impratio=20.0, iterations=100, tolerance=1e-7)
    for _ in range(int(seconds / 0.25)):
        m, data = model(s, range(len(s.diameter)), [], law, (0.0, 5.0, width), floor=floor)
        m.geom_friction[1:3, 0] = 0.0
        data.qvel[:] = s.velocity.ravel()
        mujoco.mj_step(m, data, 250)
        q = data.qpos.reshape(-1, 7)
        s = Stones(s.shape, s.templates, s.template, s.diameter, q[:, :3].copy(), q[:, 3:].copy(), data.qvel.reshape(-1, 6).copy())
        s = s.keep((s.position[:, 2] > -DEPTH - 0.03) & (s.position[:, 0] < length + 0.03))
    return slope(s.position[:, 0], s.tops(), length)


def one(d=0.035, z=0.0):
    t = [beds.template(np.random.default_rng(0), "sphere")]
    return Stones("sphere", t, np.zeros(1, int), np.array([d]), np.array([[0.0, 0.0, z]]), np.array([[1.0, 0, 0, 0]]))


def restitution(simulator, drop=0.02):
    s = one(z=-DEPTH + 0.0175 + drop)
    if simulator == "soft":
        z = soft(s, "x0=-1", "x1=1", "width=2", "free=1", "show=1", "relax=0", "seconds=0.3")
    else:
        m, data = model(s, [0], [], LAW, (-1.0, 1.0, 2.0))
        z = []
        for _ in range(600):
            mujoco.mj_step(m, data)
            z.append(data.qpos[2])
        z = np.array(z)
    z = z + DEPTH - 0.0175
    hit = np.argmax(z < 1e-4)
    return np.sqrt(max(z[hit + 8:].max(), 0) / drop)


def stiffness():
    """MuJoCo: overlap of a lug on a fixed, and on a free stone on the floor, under 80 and 120 N."""
    out = []
    for free in (False, True):
        gaps = []
        for load in (80.0, 120.0):
            s = one(z=-DEPTH + 0.0175)
            m, data = model(s, [0] if free else [], [] if free else [0], LAW, (-1.0, 1.0, 2.0), wheel_xml(0.15))
            data.qpos[1] = -DEPTH + 0.035 + 0.155
            for _ in range(2000):
                data.qvel[0] = data.qvel[2] = 0
                data.qfrc_applied[1] = -load - 300 * data.qvel[1]
                mujoco.mj_step(m, data)
            gaps.append(data.qpos[1])
        out.append(40.0 / (gaps[0] - gaps[1]))
    return out


if __name__ == "__main__":
    put("restitution, 35 mm sphere, 20 mm drop", "mujoco", "sphere", restitution("mujoco"), "-")
    put("restitution, 35 mm sphere, 20 mm drop", "soft", "sphere", restitution("soft"), "-")
    fixed, loose = stiffness()
    put("stiffness at 100 N, lug on fixed 35 mm sphere", "mujoco", "sphere", fixed, "N/m")
    put("stiffness at 100 N, lug on 35 mm sphere on floor (two contacts)", "mujoco", "sphere", loose, "N/m")
    for name, r in (("17.5 mm (35 mm sphere)", 0.0175), ("9 mm (ball of a 35 mm clump)", 0.009)):
        d = (100 / (4 / 3 * 1e9 * r**0.5)) ** (2 / 3)
        put(f"stiffness at 100 N, lug on radius {name}, by its law", "soft", "any", 2e9 * (r * d) ** 0.5, "N/m")
    for shape in ("clump", "sphere"):
        names = sorted(glob.glob(f"beds/{shape}_*_0.417_0.250.pkl"))[:20]
        if names:
            put("packing, floor to 20 mm below the level, trough 250 mm", "both", shape,
                [packing(pickle.load(open(n, "rb")), -0.1, 0.35, 0.25) for n in names], "-")
        put("angle of repose", "soft", shape, [heap(s, shape, "soft") for s in range(1, 7)], "deg")
        put("angle of repose", "mujoco", shape, [heap(s, shape, "mujoco") for s in range(1, 3)], "deg")
        creep, level = [], []
        for seed in (1, 2, 3):
            s = bed(seed, shape, (-0.16, 0.417, 0.25))
            d = soft(s, "x1=0.417", "stand=11", "show=1", "seconds=0.01")[2000:22000]
            creep.append(1e3 * (d[0, 4] - d[-1, 4]))
            level.append(d[:, 0].std())
        put("creep of the standing wheel in 10 s", "soft", shape, creep, "mm")
        put("acceleration rms of the standing wheel, 10 s", "soft", shape, level, "m/s2")
    if "--quick" not in sys.argv:
        for shape, seeds in (("clump", (1,)), ("sphere", (1,))):
            t = [roll(bed(seed, shape, (-0.16, 0.417, 0.25)), 0.15, 0.014, 0.1, 100.0, LAW, 0.01, 11.0, (-0.16, 0.417, 0.25)) for seed in seeds]
            put("creep of the standing wheel in 10 s", "mujoco", shape, [1e3 * x.creep for x in t], "mm")
            put("acceleration rms of the standing wheel, 10 s", "mujoco", shape, [x.standing_rms for x in t], "m/s2")
