"""Engines and scenes of the report cards, and the changes of settings that are measured."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass, field
from typing import Any, Callable, Mapping

from cohaul import engines

Make = Callable[[], Any]


@dataclass(frozen=True)
class Card:
    """An engine with its settings."""

    name: str
    library: str
    """Module that must be there."""
    engine: Make | str
    """Class of an adapter, or the name of a backend of cohaul."""
    settings: str
    """Settings, in a sentence for people."""
    rapier: Mapping[str, str] = field(default_factory=dict)
    """Options of the rapier backend."""


def _adapter(name: str) -> Make | None:
    """An adapter, or ``None`` where its engine is not installed."""
    library = {"box2d": "Box2D", "drake": "pydrake", "mujoco": "mujoco", "pymunk": "pymunk"}[engines.ADAPTERS[name]]
    return getattr(engines, name) if importlib.util.find_spec(library) else None


SETTINGS = {
    "PymunkDefaults": "Clamped pivot joints at the supports. 10 iterations, collision slop 0.1 m, collision bias 0.0018.",
    "Pymunk": "The same joints. 50 iterations, collision slop 0.01 % of the load's radius, collision bias 1e-100.",
    "PymunkAlongSlip": "As pymunk, with a pin joint along the slip at each support.",
    "Box2DDefaults": "Clamped friction joints, SI units, 8 velocity and 3 position iterations.",
    "Box2D": "The same joints. The load has a radius of 10 units and a mass of 1; 50 and 20 iterations.",
    "MuJoCoDefaults": "Pressed feet, pyramidal cones, impratio 1, `solref` of 20 ms.",
    "MuJoCo": "Pressed feet, elliptic cones, impratio 1e6, `solref` of two steps for feet and five for obstacles, 200 iterations.",
    "DrakeDefaults": "Pressed feet, the lagged approximation, Drake's own contact stiffness. Corners touch as solids of their own.",
    "Drake": "Pressed feet, the SAP approximation, contact stiffness 1e8, relaxation time 0, near-rigid threshold 0. "
    "Beside obstacles the lagged approximation, feet of 1e6 and friction 1, sides of four times the mass over the step squared.",
}


def cards() -> list[Card]:
    """The engines that are installed, those of cohaul last."""
    found = []
    for name, settings in SETTINGS.items():
        make = _adapter(name)
        if make is not None:
            found.append(Card(make.name, engines.ADAPTERS[name], make, settings))  # type: ignore[attr-defined]
    return [
        *found,
        Card("rapier (defaults)", "", "rapier", "Friction joints with a box of friction, four substeps, soft contacts of 60 Hz.", {"settings": "engine-defaults"}),
        Card("rapier", "", "rapier", "Friction joints along the slip, one substep with 24 or 48 sweeps, rigid contacts: what cohaul recommends."),
        Card("cohaul inertial", "", "inertial", "The reference model itself, at the same fixed steps."),
    ]


SCENES = (
    "analytic/slide-spin",
    "analytic/tripod-slide-spin-pinned",
    "analytic/ramp-and-hold",
    "analytic/release-jump",
    "contact/wall-slide",
    "contact/box-wall-friction",
    "contact/post-arc",
    "contact/push-aside",
    "contact/oblique-impact",
    "contact/rebound",
)
"""Scenes at one step: four on the ground alone, four along obstacles, and two impacts."""

PRECISION = ("contact/box-wall-friction", "contact/post-arc", "contact/push-aside")
"""Scenes at several steps."""

STEPS_S = (4e-3, 2e-3, 1e-3, 5e-4)


@dataclass(frozen=True)
class Advice:
    """A change of one setting, and the number that it changes."""

    engine: str
    """Name of the engine."""
    change: str
    """What to change, as its users would say it."""
    before: Make | str
    after: Make | str
    measured: tuple[str, str]
    """Key of a conformance test and name of its quantity, or ``path`` and name of a scene."""
    rapier_before: Mapping[str, str] = field(default_factory=dict)


def advice() -> list[Advice]:
    """Changes for the engines that are installed."""
    found = [Advice("rapier", "one substep with 24 sweeps, rigid contacts and friction along the slip",
                    "rapier", "rapier", ("path", "contact/post-arc"), {"settings": "engine-defaults"})]  # fmt: skip
    if pymunk := _adapter("Pymunk"):
        defaults, along = _adapter("PymunkDefaults"), _adapter("PymunkAlongSlip")
        assert defaults is not None and along is not None
        found += [
            Advice("pymunk", "set `collision_slop` to 0.01 % of the size of a body, `collision_bias` to 1e-100 and `iterations` to 50",
                   defaults, pymunk, ("C11b", "across the wall")),
            Advice("pymunk", "set forces that depend on the place in the `velocity_func`, not before `step`",
                   _forced_before(pymunk), pymunk, ("C6", "amplitude")),
            Advice("pymunk", "hold supports by a `PinJoint` along the slip, in place of a `PivotJoint`",
                   pymunk, along, ("path", "analytic/ramp-and-hold")),
        ]  # fmt: skip
    if box2d := _adapter("Box2D"):
        defaults = _adapter("Box2DDefaults")
        assert defaults is not None
        found += [
            Advice("Box2D", "choose units in which the load has a radius of 10, for the skin of polygons",
                   defaults, _varied(defaults, "Box2D", units=box2d.units), ("C11b", "across the wall")),  # type: ignore[attr-defined]
            Advice("Box2D", "take 50 velocity and 20 position iterations in place of 8 and 3: no gain for one load",
                   _varied(box2d, "Box2D", sweeps=(8, 3)), box2d, ("path", "contact/push-aside")),
        ]  # fmt: skip
    if mujoco := _adapter("MuJoCo"):
        defaults = _adapter("MuJoCoDefaults")
        assert defaults is not None
        cones = _varied(defaults, "MuJoCo", set_up=_elliptic)
        found += [
            Advice("MuJoCo", 'set `cone="elliptic"`', defaults, cones, ("C14", "spread")),
            Advice("MuJoCo", 'with `cone="elliptic"`, set `impratio` to 1e6',
                   cones, _varied(defaults, "MuJoCo", set_up=_hard_friction), ("C3", "creep")),
            Advice("MuJoCo", "set `solref` to two steps and `solimp` to 0.9999 too, and press feet of small friction by large forces",
                   _varied(defaults, "MuJoCo", set_up=_hard_friction), mujoco, ("C5", "displacement")),
        ]  # fmt: skip
    if drake := _adapter("Drake"):
        defaults = _adapter("DrakeDefaults")
        assert defaults is not None
        found.append(Advice("Drake", "take the SAP approximation with stiff feet, a relaxation time and a near-rigid threshold of 0",
                            defaults, drake, ("C15a", "displacement")))  # fmt: skip
    return found


def _varied(make: Any, name: str, **changed: Any) -> Make:
    """An adapter with other members."""
    found: Make = type(f"{make.__name__}Varied", (make,), {"name": f"{name} (varied)", **changed})
    return found


def _elliptic(self: Any, option: Any, h: float) -> None:
    option.cone, self.soles, self.sides = 1, {}, {}


def _hard_friction(self: Any, option: Any, h: float) -> None:
    option.cone, option.impratio, self.soles, self.sides = 1, 1e6, {}, {}


def _forced_before(make: Any) -> Make:
    """pymunk with forces that are set before the step."""

    def step(self: Any, h: float) -> None:
        fx, fy, torque = self.pull()
        self.load.velocity_func = type(self.load).update_velocity
        self.load.force, self.load.torque = (fx, fy), torque
        self.space.step(h)

    return _varied(make, "pymunk", step=step)
