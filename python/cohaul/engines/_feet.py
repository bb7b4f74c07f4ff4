"""What adapters share whose engine has bodies of three dimensions: feet that are pressed on the ground."""

from __future__ import annotations

from typing import Any, Iterator

import numpy as np

from ..results import FloatArray
from ._planar import Planar, contact


class Feet(Planar):
    """An engine in which the load moves in the plane, and a foot slides up and down at each support.

    A foot is pressed on the ground. Engines lift what slides, in proportion to the coefficient of
    friction: that of a foot is small, its force large, and their product the slip limit.

    ``q`` are the coordinates in the units of the engine, and ``v`` their rates: three of the load,
    the height of each foot, and three of each obstacle. Bodies have that order too; the load is 1.
    """

    foot_friction: float
    heavy: float = 1e9
    """Mass of an obstacle over that of the load: it keeps its speed in a contact (1)."""
    q: Any
    v: Any
    scale: FloatArray
    """Units of the load's coordinates (m, m, rad)."""
    supports: list[dict[str, Any]]
    """Supports with a slip limit."""
    press: FloatArray
    """Force on each foot in the units of the engine."""
    feet: slice
    """Coordinates of the feet."""
    others: slice
    """Coordinates of the obstacles."""

    def build(self, scene: dict[str, Any], longest_step_s: float) -> None:
        """Makes the model and its ``q`` and ``v``, and lets the feet settle."""
        raise NotImplementedError

    def touches(self) -> Iterator[tuple[int, int, Any, Any]]:
        """Two bodies, the place and the force on the second, of each contact in the last step."""
        raise NotImplementedError

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        if any(obstacle["restitution"] > 0.0 for obstacle in scene["obstacles"]):
            raise NotImplementedError(f"restitution: {self.name.split()[0]} has no coefficient of restitution")
        self.keep(scene)
        self.scale = np.array([self.length, self.length, 1.0])
        self.supports = [support for support in scene["supports"] if support["slip_limit_n"] > 0.0]
        limits = np.array([support["slip_limit_n"] for support in self.supports])
        self.press = -limits / self.foot_friction / self.mass / self.length
        self.feet, self.others = slice(3, 3 + len(limits)), slice(3 + len(limits), None)
        self.build(scene, longest_step_s)
        self.v[:] = 0.0
        self.q[:3], self.v[:3] = scene["pose"] / self.scale, scene["twist"] / self.scale
        self.q[self.others] = [value for obstacle in scene["obstacles"] for value in obstacle["pose"] / self.scale]

    def load_pose(self) -> list[float]:
        pose: list[float] = (self.q[:3] * self.scale).tolist()
        return pose

    def load_twist(self) -> list[float]:
        twist: list[float] = (self.v[:3] * self.scale).tolist()
        return twist

    def obstacle_poses(self) -> list[list[float]]:
        poses: list[list[float]] = (self.q[self.others].reshape(-1, 3) * self.scale).tolist()
        return poses

    def move_obstacle(self, at: int, twist: list[float]) -> None:
        self.v[self.others][3 * at : 3 * at + 3] = twist / self.scale

    def contacts(self, h: float) -> list[dict[str, Any]]:
        found = []
        for first, second, point, force in self.touches():
            obstacle = max(first, second) - 2 - len(self.press)
            if min(first, second) == 1 and obstacle >= 0:
                on_load = (force if second == 1 else -force) * self.mass * self.length
                found.append(contact(obstacle, [(point * self.length).tolist()], on_load[:2].tolist()))
        return found
