"""Drag one load with ants or robots on springs, and measure where inertia matters.

The same grasps, releases and tip motions move three models of the load: ``quasi-static`` (no
inertia), ``inertial`` (the same springs and exact friction, with the mass) and ``rapier`` (the
rigid-body engine rapier2d). Units are SI; angles are in radians, counter-clockwise.

>>> import cohaul
>>> scenario = cohaul.Scenario(
...     name="one spring, pulled and released", duration_s=2.0, control_period_s=0.0025,
...     load=cohaul.load(mass_kg=0.0016, radius_m=0.0122),
...     ground=cohaul.ground(friction_coefficient=1.4, tripod_radius_m=0.0081333),
...     springs=[cohaul.spring(root_m=(0.0122, 0.0), rest_length_m=0.0263,
...         radial_stiffness_n_per_m=0.664, torsional_stiffness_nm_per_rad=4.52e-4)],
...     drive=cohaul.tips(cohaul.path(0, [(0.0, 0.0385, 0.0), (1.0, 0.0985, 0.0028)], release_s=1.5)))
>>> run = cohaul.run(scenario)
>>> round(run["final"]["position_m"][0], 4)
0.0269
>>> comparison = cohaul.compare(scenario)
>>> comparison.verdicts["path"]["verdict"]
'inertia'
"""

from ._check import Check, check, store_baseline
from ._compare import BACKENDS, Comparison, Measure, compare, compare_controller
from ._conformance import Conformance, conformance
from ._errors import Fault, InternalError, ScenarioError
from ._hand import Hand
from ._import import Import, import_scenario
from ._maps import Map, Threshold, compare_map, threshold
from ._measured import Measured, measured
from ._native import View, __version__
from ._parts import ants, ground, load, obstacle, path, spring, tips
from ._rollouts import Rollouts, rollouts
from ._run import Controller, Event, Run, Tips, Trace, run
from ._scenario import SCENES, Scenario, Source
from ._simulation import Simulation
from ._sweep import Sweep, sweep
from ._view import view

__all__ = [
    "BACKENDS",
    "SCENES",
    "Check",
    "Comparison",
    "Conformance",
    "Controller",
    "Event",
    "Fault",
    "Hand",
    "Import",
    "InternalError",
    "Map",
    "Measure",
    "Measured",
    "Rollouts",
    "Run",
    "Scenario",
    "ScenarioError",
    "Simulation",
    "Source",
    "Sweep",
    "Threshold",
    "Tips",
    "Trace",
    "View",
    "__version__",
    "ants",
    "check",
    "compare",
    "compare_controller",
    "compare_map",
    "conformance",
    "ground",
    "import_scenario",
    "load",
    "measured",
    "obstacle",
    "path",
    "rollouts",
    "run",
    "spring",
    "store_baseline",
    "sweep",
    "threshold",
    "tips",
    "view",
]
