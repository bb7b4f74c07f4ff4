"""What adapters share whose engine has bodies of two dimensions."""

from __future__ import annotations

from typing import Any, Sequence

from ._outline import convex_parts
from ._planar import Planar


class Bodies(Planar):
    """An engine whose load and obstacles are bodies with a ``position`` and an ``angle``."""

    most_corners: int = 8
    """Corners of a polygon that the engine takes (1)."""
    rates: tuple[str, str] = "velocity", "angular_velocity"
    """What the engine calls the velocity and the turn rate of a body."""
    load: Any
    obstacles: list[Any]

    def add_shape(self, body: Any, kind: str, part: Any, has: dict[str, Any]) -> None:
        """Gives a body a convex part of its outline in the engine's units, and the friction that it has."""
        raise NotImplementedError

    def set_twist(self, body: Any, twist: Sequence[float]) -> None:
        setattr(body, self.rates[0], self.scaled(twist))
        setattr(body, self.rates[1], twist[2])

    def place(self, scene: dict[str, Any]) -> None:
        """Puts load and obstacles at their first poses, with their outlines."""
        for body, has in zip([self.load, *self.obstacles], [scene, *scene["obstacles"]]):
            body.position, body.angle = self.scaled(has["pose"]), has["pose"][2]
            for kind, part in convex_parts(has["outline"], self.most_corners, self.length):
                self.add_shape(body, kind, part, has)

    def scaled(self, vector: Sequence[float]) -> tuple[float, float]:
        return vector[0] / self.length, vector[1] / self.length

    def pose_of(self, body: Any) -> list[float]:
        return [body.position[0] * self.length, body.position[1] * self.length, body.angle]

    def load_pose(self) -> list[float]:
        return self.pose_of(self.load)

    def load_twist(self) -> list[float]:
        u, v = getattr(self.load, self.rates[0])
        return [u * self.length, v * self.length, getattr(self.load, self.rates[1])]

    def obstacle_poses(self) -> list[list[float]]:
        return [self.pose_of(body) for body in self.obstacles]

    def move_obstacle(self, at: int, twist: list[float]) -> None:
        self.set_twist(self.obstacles[at], twist)
