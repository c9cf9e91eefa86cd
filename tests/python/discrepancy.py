"""Root mean square difference of two programs with the same wheel, in margins of equivalence.

discrepancy.py DIAGNOSIS.json    prints it for every statistic and third octave of the loaded conditions

The factors of src/diagnosis/discrepancy.rs are from one campaign, `nothing.h5` of mujoco_rig.py, diagnosed with its wheel.toml.
"""

import collections
import json
import re
import sys

if len(sys.argv) != 2:
    sys.exit(__doc__)
with open(sys.argv[1]) as file:
    entries = json.load(file)["map"]
ratios = collections.defaultdict(list)
for entry in entries:
    if "lifted" in entry["condition"] or not entry["margin"]:
        continue
    name = entry["cell"].split("/", 1)[1]
    third = re.search(r"_([\d.]+)hz$", name)
    kinds = [name] if third is None else [name[: third.start()], f"third of {third[1]} Hz"]
    for kind in kinds:
        ratios[kind].append(entry["difference"] / entry["margin"])
for kind, values in sorted(ratios.items()):
    rms = (sum(value * value for value in values) / len(values)) ** 0.5
    print(f"{kind:<28} n = {len(values):<4} {rms:6.1f}")
