"""Outlines as convex parts, for adapters of engines."""

from __future__ import annotations

import math
from typing import Any, Iterator, Sequence

Point = Sequence[float]
HAS_NO_LENGTH = 1e-12
"""Twice the area of a triangle that is none, over the square of the outline's size (1)."""


def convex_parts(outline: Sequence[dict[str, Any]], most_corners: int = 8, unit_m: float = 1.0) -> Iterator[tuple[str, Any]]:
    """``("disc", (centre, radius))``, ``("polygon", corners)`` and ``("segment", (from, to))``.

    Polygons are convex and have at most ``most_corners``, counter-clockwise. Points are pairs, and
    all lengths in units of ``unit_m`` (m).
    """

    def scaled(point: Point) -> tuple[float, float]:
        return point[0] / unit_m, point[1] / unit_m

    for part in outline:
        if part["kind"] == "disc":
            yield "disc", (scaled(part["centre_m"]), part["radius_m"] / unit_m)
        elif part["kind"] == "polygon":
            for corners in _merged(part["corners_m"], _triangles(part["corners_m"]), most_corners):
                yield "polygon", [scaled(part["corners_m"][at]) for at in corners]
        else:
            for start, end in zip(part["points_m"], part["points_m"][1:]):
                yield "segment", (scaled(start), scaled(end))


def solids(outline: Sequence[dict[str, Any]], height: float, thin: float, unit_m: float = 1.0) -> Iterator[tuple[str, Any, float]]:
    """Convex parts as solids about the plane: what they are, points (x, y, z) and a radius.

    A disc is a ``sphere`` about its centre, a segment a ``capsule`` between its ends, as ``thin`` as
    a radius may be, and a polygon a ``prism`` with corners at a height above and below. All lengths
    are in units of ``unit_m`` (m).
    """
    for kind, part in convex_parts(outline, 64, unit_m):
        if kind == "disc":
            yield "sphere", [*part[0], 0.0], part[1]
        elif kind == "segment":
            yield "capsule", [[*point, 0.0] for point in part], thin
        else:
            yield "prism", [[*point, z] for z in (-height, height) for point in part], 0.0


def corners(outline: Sequence[dict[str, Any]], height: float, thin: float, unit_m: float = 1.0) -> Iterator[tuple[str, Any, float]]:
    """Corners and ends of an outline alone, as ``solids`` has them: spikes within polygons, and spheres."""
    for kind, points, radius in solids(outline, height, thin, unit_m):
        if kind == "capsule":
            yield from (("sphere", end, radius) for end in points)
        elif kind == "prism":
            base = [[x, y] for x, y, _ in points[: len(points) // 2]]
            middle = [sum(values) / len(base) for values in zip(*base)]
            for at, corner in enumerate(base):
                # Nearly at the middle, a tenth of the way to the corners on both sides.
                sides = [[0.9 * m + 0.1 * value for m, value in zip(middle, base[beside % len(base)])] for beside in (at + 1, at - 1)]
                yield "prism", [[*point, z] for z in (-height, height) for point in (corner, *sides)], 0.0


def _turn(a: Point, b: Point, c: Point) -> float:
    """Twice the area of a triangle, positive counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _triangles(corners: Sequence[Point]) -> list[list[int]]:
    """Triangles of a polygon without holes, by cutting off one ear after another."""
    left, found = list(range(len(corners))), []
    size = max(math.dist(corners[0], corner) for corner in corners)
    while len(left) > 2:
        ears = []
        for at in range(len(left)):
            ear = [left[at - 1], left[at], left[(at + 1) % len(left)]]
            a, b, c = (corners[corner] for corner in ear)
            others = (corners[corner] for corner in left if corner not in ear)
            area = _turn(a, b, c)
            if area >= 0.0 and not any(min(_turn(a, b, p), _turn(b, c, p), _turn(c, a, p)) >= 0.0 for p in others):
                ears.append((area, ear))
        # An ear without area is a corner between two edges in line: it goes first.
        area, ear = min(ears) if ears and min(ears)[0] <= HAS_NO_LENGTH * size**2 else max(ears)
        if area > HAS_NO_LENGTH * size**2:
            found.append(ear)
        left.remove(ear[1])
    return found


def _merged(corners: Sequence[Point], parts: list[list[int]], most: int) -> list[list[int]]:
    """Parts that are merged across a common edge, as long as they stay convex and small."""
    for one in parts:
        for other in parts:
            if one is other:
                continue
            joined = _joined(one, other)
            if joined and len(joined) <= most and _is_convex([corners[corner] for corner in joined]):
                return _merged(corners, [part for part in parts if part is not one and part is not other] + [joined], most)
    return parts


def _joined(one: list[int], other: list[int]) -> list[int] | None:
    for at in range(len(one)):
        a, b = one[at], one[(at + 1) % len(one)]
        if b in other and other[(other.index(b) + 1) % len(other)] == a:
            start = other.index(a)
            return one[at + 1 :] + one[: at + 1] + (other[start + 1 :] + other[:start])[: len(other) - 2]
    return None


def _is_convex(corners: Sequence[Point]) -> bool:
    n = len(corners)
    return all(_turn(corners[at], corners[(at + 1) % n], corners[(at + 2) % n]) > 0.0 for at in range(n))
