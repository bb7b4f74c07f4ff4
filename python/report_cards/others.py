"""Two loads of other programs: the T block of gym-pusht, and a cylinder of ARGoS."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import cohaul

STEP_S = 1e-2
"""Step of both programs (s)."""


def others(folder: Path) -> list[dict[str, Any]]:
    """Errors of both programs on their scenes in a folder, where pymunk is installed."""
    if importlib.util.find_spec("pymunk") is None:
        return []
    return [_found(folder / f"{name}.json", make()) for name, make in (("pusht-bar-end", gym_pusht), ("argos-edge", argos))]


def _found(path: Path, make: Any) -> dict[str, Any]:
    found = cohaul.compare(str(path), engine=make, step_s=STEP_S, tiers="prescribed")
    heading = [float(found.trace(backend)["heading_rad"][-1]) for backend in (make.name, "inertial")]
    tier, error = found.tiers["prescribed"], found.verdicts["path"]["engine_error"]
    return {"scene": path.stem, "engine": make.name, "path_length_m": tier["path_length_m"], "error_m": error,
            "heading_rad": heading[0], "reference_heading_rad": heading[1], "step_s": STEP_S}  # fmt: skip


def argos() -> Any:
    """A load of ARGoS's dynamics2d: a pivot joint of 1.49 N and a gear joint of 1.49 N m."""
    import pymunk

    from cohaul.engines.pymunk import Pymunk

    class Argos(Pymunk):
        name = "ARGoS's load"

        def set_up(self, slop: float) -> None:
            self.space.iterations = 10

        def grip(self, supports: Any) -> None:
            ground = self.space.static_body
            pivot, gear = pymunk.PivotJoint(ground, self.load, (0, 0), (0, 0)), pymunk.GearJoint(ground, self.load, 0.0, 1.0)
            for joint in (pivot, gear):
                joint.max_bias, joint.max_force = 0.0, 1.49
            self.space.add(pivot, gear)

    return Argos


def gym_pusht() -> Any:
    """The T block of gym-pusht: no friction of the ground, but a damping of 0, and pixels of 1 mm."""
    import pymunk

    from cohaul.engines.pymunk import Pymunk

    pixels = 1e3
    scale = [pixels, pixels, 1.0]

    def scaled(body: dict[str, Any]) -> dict[str, Any]:
        parts = [{key: value if key == "kind" else _times(value, pixels) for key, value in part.items()} for part in body["outline"]]
        return {**body, "outline": parts, "pose": [a * b for a, b in zip(body["pose"], scale)]}

    class GymPushT(Pymunk):
        name = "gym-pusht"

        def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
            alike = {"mass_kg": 1.0, "inertia_kg_m2": 1.0, "radius_m": pixels * scene["radius_m"], "supports": [], "springs": []}
            obstacles = [{**scaled(obstacle), "restitution": 0.0} for obstacle in scene["obstacles"]]
            super().start({**scaled(scene), **alike, "obstacles": obstacles}, longest_step_s)
            self.space.damping = 0.0
            self.load.velocity_func = pymunk.Body.update_velocity
            for shape in self.load.shapes:
                shape.elasticity = shape.friction = 0.0
            # Both shapes have the moment of the bar, and the centre is the mean of both centres,
            # which lies 45 px from the edge of the bar in place of 40.7.
            self.load.moment = 2.0 * pymunk.moment_for_poly(1.0, [(-60, 30), (60, 30), (60, 0), (-60, 0)])
            self.load.center_of_gravity = (0.0, 45.0 - (3600 * 15 + 2700 * 75) / 6300)

        def set_up(self, slop: float) -> None:
            pass

        def load_pose(self) -> list[float]:
            return [a / b for a, b in zip(super().load_pose(), scale)]

        def advance(self, tips_m: Any, obstacles: Any, duration_s: float, n_steps: int) -> Any:
            targets = [[a * b for a, b in zip(pose, scale)] for pose in obstacles]
            return {"pose": super().advance(tips_m, targets, duration_s, n_steps)["pose"]}

    return GymPushT


def _times(value: Any, factor: float) -> Any:
    return [_times(each, factor) for each in value] if isinstance(value, (list, tuple)) else value * factor
