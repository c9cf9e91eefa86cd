"""Lugged rover wheels on hard, gravel and granular ground: simulated, measured, recognised, diagnosed.

    import lugwheel as lw

    sand = lw.scenario("single_wheel_st", slip=0.3, duration=15.0)
    run = sand.run(seed=1)
    run["drawbar_pull"]            # samples [N], as a NumPy array
    run.to_pandas()                # channels over time [s]

All numbers are in SI units. A computation releases the interpreter's lock, and Ctrl-C stops it.
"""

from ._native import VERSION as __version__
from .campaign import MeasuredRun, Wheel, campaign
from .catalogue import effects
from .data_set import CLASSES, DataSet, Sweep, WindowDataset, sweep
from .diagnosis import Diagnosis, diagnose
from .errors import Error, Failed, Interrupted, InvalidInput
from .identification import Identification
from .inspection import Inspection
from .page import Page
from .recognition import Recognition
from .run import Channel, Run
from .run_file import RunFile, import_campaign, read
from .scenarios import Scenario, keys, scenario, scenarios

__all__ = [
    "CLASSES",
    "Channel",
    "DataSet",
    "Diagnosis",
    "Error",
    "Failed",
    "Identification",
    "Inspection",
    "Interrupted",
    "InvalidInput",
    "MeasuredRun",
    "Page",
    "Recognition",
    "Run",
    "RunFile",
    "Scenario",
    "Sweep",
    "Wheel",
    "WindowDataset",
    "__version__",
    "campaign",
    "diagnose",
    "effects",
    "import_campaign",
    "keys",
    "read",
    "scenario",
    "scenarios",
    "sweep",
]
