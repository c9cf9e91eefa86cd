#!/usr/bin/env python3
"""Prints a table of beds.csv: per condition the levels' geometric mean and 10 to 90 % over beds, and means and sd over beds."""
import csv
from collections import defaultdict
import numpy as np

groups = defaultdict(list)
for r in csv.DictReader(open("beds.csv")):
    if float(r["penetration_max_mm"]) > 1.0:      # a ball driven through the wheel's edge: the run failed
        print(f"left out: {r['simulator']} {r['shape']} seed {r['seed']} (overlap {float(r['penetration_max_mm']):.1f} mm)")
        continue
    groups[r["simulator"], r["shape"], float(r["width_m"]), float(r["speed_mps"]), float(r["slip"]), float(r["load_n"])].append(r)

def level(rows, key):
    v = np.array([float(r[key]) for r in rows])
    return f"{np.exp(np.log(v).mean()):.3f} [{np.quantile(v, .1):.3f}, {np.quantile(v, .9):.3f}]"

def mean(rows, key, digits=1):
    v = np.array([float(r[key]) for r in rows])
    return f"{v.mean():.{digits}f} ± {v.std(ddof=1) if len(v) > 1 else float('nan'):.{digits}f}"

base = (0.15, 0.014, 0.1, 100.0)
head = f"{'simulator':<16}{'stones':<8}{'width':>6}{'speed':>7}{'slip':>5}{'load':>6}{'n':>4}  {'2-20 Hz':<22}{'20-200 Hz':<22}{'200-800 Hz':<22}{'pull [N]':<14}{'sd in run':<13}{'torque [N m]':<14}{'sinkage [mm]':<14}{'touching':<12}"
print("Rms of vertical acceleration in bands [m/s²]: geometric mean [10 %, 90 %] over beds; others: mean ± sd over beds.")
print(head)
for key, rows in sorted(groups.items(), key=lambda g: (g[0][2:] != base, g[0][2] == 0.15, g[0][2:], g[0][:2])):
    print(f"{key[0]:<16}{key[1]:<8}{key[2] * 1e3:>4.0f}mm{key[3] * 1e3:>7.0f}{key[4]:>5.1f}{key[5]:>6.0f}{len(rows):>4}  "
          f"{level(rows, 'rms_2_20_mps2'):<22}{level(rows, 'rms_20_200_mps2'):<22}{level(rows, 'rms_200_800_mps2'):<22}"
          f"{mean(rows, 'pull_mean_n'):<14}{mean(rows, 'pull_sd_n'):<13}{mean(rows, 'torque_mean_nm', 2):<14}{mean(rows, 'sinkage_mm'):<14}{mean(rows, 'contacts_mean', 2):<12}")
