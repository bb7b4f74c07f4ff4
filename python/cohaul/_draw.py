"""Pictures of a load, its springs and obstacles, drawn by pygame."""

from __future__ import annotations

import math
from typing import Any, Iterator

import numpy as np
import numpy.typing as npt

from ._run import library
from .results import FloatArray

WIDTH, HEIGHT = 640, 480
"""Size of a picture (pixels)."""
PAPER, LOAD, OBSTACLE, SPRING, GOAL = (255, 255, 255), (0, 114, 178), (120, 128, 138), (213, 94, 0), (0, 158, 115)


class Painter:
    """Draws a simulation with a goal, into an array or into a window."""

    def __init__(self, scenario: dict[str, Any], is_window: bool, frames_per_s: float) -> None:
        self.pygame: Any = library("pygame", "render")
        self.load = list(_parts(_outline(scenario["load"])))
        self.obstacles = [list(_parts(obstacle["outline"])) for obstacle in scenario.get("obstacles", [])]
        self.roots = np.array([spring["root_m"] for spring in scenario["springs"]]).reshape(-1, 2)
        self.frames_per_s = frames_per_s
        if is_window:
            self.pygame.display.init()
            self.surface = self.pygame.display.set_mode((WIDTH, HEIGHT))
            self.clock = self.pygame.time.Clock()
        else:
            self.surface = self.pygame.Surface((WIDTH, HEIGHT))
        self.is_window = is_window

    def see(self, places: FloatArray) -> None:
        """Fits the view to these places (m, world), a row each."""
        low, high = places.min(axis=0), places.max(axis=0)
        self.middle = 0.5 * (low + high)
        span = np.maximum(high - low, 1e-9) / (np.array([WIDTH, HEIGHT]) - 80.0)
        self.metres_per_pixel = float(span.max())

    def draw(self, sim: Any, goal: FloatArray, goal_radius: float) -> npt.NDArray[np.uint8] | None:
        """Draws what is there; returns rows of pixels (height, width, 3) unless it is a window."""
        self.surface.fill(PAPER)
        self.pygame.draw.circle(self.surface, GOAL, self._pixel(goal[:2]), max(2.0, goal_radius / self.metres_per_pixel), 3)
        if goal.size == 3:
            self._shapes(self.load, goal, GOAL, 2)
        for pose, parts in zip(sim.obstacles, self.obstacles):
            self._shapes(parts, pose, OBSTACLE, 0)
        self._shapes(self.load, np.array(sim.pose), LOAD, 0)
        for root, tip, is_attached in zip(_placed(self.roots, sim.pose), sim.tips, sim.attached):
            if is_attached:
                self.pygame.draw.line(self.surface, SPRING, self._pixel(root), self._pixel(tip), 3)
                self.pygame.draw.circle(self.surface, SPRING, self._pixel(tip), 6)
        if not self.is_window:
            return np.ascontiguousarray(self.pygame.surfarray.array3d(self.surface).transpose(1, 0, 2))
        self.pygame.event.pump()
        self.pygame.display.flip()
        self.clock.tick(self.frames_per_s)
        return None

    def close(self) -> None:
        if self.is_window:
            self.pygame.display.quit()

    def _pixel(self, place: np.ndarray) -> tuple[float, float]:
        x, y = (np.asarray(place) - self.middle) / self.metres_per_pixel
        return 0.5 * WIDTH + float(x), 0.5 * HEIGHT - float(y)

    def _shapes(self, parts: list[Any], pose: FloatArray, colour: tuple[int, int, int], width: int) -> None:
        for kind, shape, places in parts:
            points = [self._pixel(place) for place in _placed(places, pose)]
            if kind == "disc":
                self.pygame.draw.circle(self.surface, colour, points[0], max(1.0, shape / self.metres_per_pixel), width)
                # A mark that shows how far it has turned.
                self.pygame.draw.line(self.surface, PAPER if width == 0 else colour, points[0], points[1], 2)
            elif kind == "polygon":
                self.pygame.draw.polygon(self.surface, colour, points, width)
            else:
                self.pygame.draw.lines(self.surface, colour, False, points, 3)


def reach(scenario: dict[str, Any]) -> float:
    """Largest distance of the load's outline and of its springs' tips from the origin (m)."""
    far = [radius + float(np.hypot(*places[0])) if kind == "disc" else np.hypot(*places.T).max() for kind, radius, places in _parts(_outline(scenario["load"]))]
    springs = [float(np.hypot(*spring["root_m"])) + spring["rest_length_m"] for spring in scenario["springs"]]
    return float(max([*far, *springs]))


def _outline(load: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = load.get("outline") or {"disc": {"radius_m": load["radius_m"]}}
    return found


def _parts(outline: dict[str, Any], place: Any = (0.0, 0.0), heading: float = 0.0) -> Iterator[tuple[str, float, FloatArray]]:
    """Kind, radius (m) and points (m) of each part in the frame of the body."""
    (kind, shape), pose = next(iter(outline.items())), (*place, heading)
    if kind == "compound":
        for part in shape["parts"]:
            x, y = _placed(np.array([part.get("position_m", (0.0, 0.0))], dtype=float), pose)[0]
            yield from _parts(part["outline"], (x, y), heading + part.get("heading_rad", 0.0))
    elif kind == "disc":
        radius = float(shape["radius_m"])
        yield kind, radius, _placed(np.array([[0.0, 0.0], [radius, 0.0]]), pose)
    elif kind == "rectangle":
        a, b = 0.5 * np.array(shape["size_m"])
        yield "polygon", 0.0, _placed(np.array([[-a, -b], [a, -b], [a, b], [-a, b]]), pose)
    else:
        yield kind, 0.0, _placed(np.array(shape["points_m"], dtype=float), pose)


def _placed(places: FloatArray, pose: Any) -> FloatArray:
    """Places of a body's frame in that in which its pose is given."""
    x, y, heading = (float(one) for one in pose)
    cos, sin = math.cos(heading), math.sin(heading)
    placed: FloatArray = places @ np.array([[cos, sin], [-sin, cos]]) + np.array([x, y])
    return placed
