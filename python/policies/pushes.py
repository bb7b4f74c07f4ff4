"""A rule for ``cohaul/PushT-v0``: choose a push by the quasi-static model, go to it, and push.

The rule chooses anew in each control period and keeps nothing, so that one policy serves any number
of episodes. It does not turn the pusher, a disc, and does not use where the posts are. All places
are those of the centre of the pusher, seen from the block in the axes of the block (m).
"""

from __future__ import annotations

import math

import numpy as np

import cohaul
from cohaul.gym import TransportEnv
from cohaul.results import FloatArray
from policy import Policy

Box = tuple[FloatArray, FloatArray]
"""Lowest and highest corner of a part of the block (m)."""

N_SPOTS, N_RING = 120, 360
"""Number of spots, where the pusher touches the block, and of places on the ring round it (1)."""
MARGIN_M = 0.006
"""Clearance between the pusher and the block on the ring (m)."""
NEAR_M = 0.007
"""Distance from a spot within which the pusher goes straight to it (m)."""
BEARINGS_RAD = (-0.5, -0.25, 0.0, 0.25, 0.5)
"""Directions of a push from the normal of the block's side (rad)."""
LENGTHS = (1, 2, 3, 5, 8, 12, 18)
"""Lengths of a push (control periods)."""
PERIODS_PER_MISS = 15.0
"""Control periods that count as much as a pose that misses the goal by one tolerance (1)."""


def planned_pushes(env: TransportEnv) -> Policy:
    """The pusher takes the push with the least sum of approach, length and miss, each as a time.

    The miss is that of the pose after the push. The motion of the block is simulated once, for short
    pushes, and taken to be steady: errors by slip are corrected in the next control periods.
    """
    data = env.scenario.to_dict()
    radius = data["obstacles"][0]["outline"]["disc"]["radius_m"]
    corners = [np.array(part["outline"]["polygon"]["points_m"]) for part in data["load"]["outline"]["compound"]["parts"]]
    boxes = [(points.min(axis=0), points.max(axis=0)) for points in corners]
    spots, ring = around(boxes, radius, N_SPOTS), around(boxes, radius + MARGIN_M, N_RING)
    # Normals point into the block. The entry of a spot is the place of the ring in front of it.
    normals = np.array([direction_to(boxes, spot) for spot in spots])
    entries = np.array([nearest(ring, spot - MARGIN_M * normal) for spot, normal in zip(spots, normals)])
    sides = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    along, round_m = np.cumsum(sides) - sides, float(sides.sum())
    pushes = np.stack([turned(normals, bearing) for bearing in BEARINGS_RAD], axis=1)
    advance = env.max_speed_m_per_s * env.scenario.control_period_s
    shifts, turns = after(advance * motions(env, spots, normals, pushes), np.array(LENGTHS))
    goal_unit, place_unit, _ = env._units

    def act(seen: FloatArray) -> FloatArray:
        axes = np.array([[seen[2], -seen[3]], [seen[3], seen[2]]])
        goal, turn, at = goal_unit * seen[:2] @ axes, math.atan2(seen[-1], seen[-2]), place_unit * seen[7:9] @ axes
        # How far is each spot, the shorter direction round the block?
        here = nearest(ring, at)
        from_ring, from_spots = np.linalg.norm(at - ring[here]), np.linalg.norm(at - spots, axis=1)
        ahead = (along[entries] - along[here] + 0.5 * round_m) % round_m - 0.5 * round_m
        is_near = (entries == here) | (from_spots < NEAR_M)
        approaches = np.where(is_near, from_spots, from_ring + np.abs(ahead) + MARGIN_M)
        # Which push is best, and which pose does it leave?
        misses = np.hypot(np.linalg.norm(goal - shifts, axis=-1) / env.goal_radius_m, (turn - turns) / env.goal_angle_rad)
        times = approaches[:, None, None] / advance + np.array(LENGTHS) + PERIODS_PER_MISS * misses
        spot, push, _ = np.unravel_index(np.argmin(times), times.shape)
        # Go to the ring, along it to the entry, straight to the spot, and on into the push.
        if is_near[spot]:
            step = spots[spot] + advance * pushes[spot, push] - at
        elif from_ring > 0.5 * MARGIN_M:
            step = ring[here] - at
        else:
            place = along[here] + np.clip(ahead[spot], -advance, advance)
            step = ring[np.argmin(np.abs(along - place % round_m))] - at
        step /= max(float(np.linalg.norm(step)), advance)
        return np.append(axes @ step, 0.0)

    return act


def motions(env: TransportEnv, spots: FloatArray, normals: FloatArray, pushes: FloatArray) -> FloatArray:
    """Motion of the block for each metre of a push, on the quasi-static backend (1, 1, rad/m)."""
    sim, step, n = cohaul.Simulation(env.scenario), 1e-3, pushes.shape[1]
    states = np.tile(sim.state, (len(spots) * n, 1))
    # The block is at the origin. The pusher, obstacle 0, closes a gap and then makes two steps.
    states[:, 1:4] = 0.0
    states[:, 7:11] = np.repeat(np.column_stack([np.ones(len(spots)), spots - step * normals, np.zeros(len(spots))]), n, axis=0)
    paths = np.zeros((len(states), 3, 3))
    paths[:, :, :2] = np.repeat(spots, n, axis=0)[:, None] + step * np.arange(3)[:, None] * pushes.reshape(-1, 1, 2)
    poses = cohaul.rollouts(env.scenario, states=states, pushers={0: paths}).poses
    return ((poses[:, -1] - poses[:, -2]) / step).reshape(len(spots), n, 3)


def after(moved: FloatArray, lengths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shift and turn of the block after a steady motion over some periods, seen from its start."""
    turns = moved[..., 2:] * lengths
    cos, sin, chord = np.cos(0.5 * turns), np.sin(0.5 * turns), lengths * np.sinc(0.5 * turns / math.pi)
    x, y = moved[..., :1], moved[..., 1:2]
    return np.stack([chord * (cos * x - sin * y), chord * (sin * x + cos * y)], axis=-1), turns


def around(boxes: list[Box], distance: float, n: int) -> FloatArray:
    """Places at a distance from the block, in all directions from the middle of its first part."""
    bearings = np.linspace(0.0, 2.0 * math.pi, n, endpoint=False)
    lines = 0.5 * sum(boxes[0]) + np.linspace(0.0, 0.3, 3001)[:, None, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    far = np.min([np.linalg.norm(lines - np.clip(lines, low, high), axis=-1) for low, high in boxes], axis=0)
    places: FloatArray = lines[len(lines) - np.argmax(far[::-1] < distance, axis=0), np.arange(n)]
    return places


def direction_to(boxes: list[Box], place: FloatArray) -> FloatArray:
    """Unit vector from a place to the closest point of the block."""
    offsets = [np.clip(place, low, high) - place for low, high in boxes]
    shortest = min(offsets, key=lambda offset: float(np.linalg.norm(offset)))
    return shortest / np.linalg.norm(shortest)


def nearest(places: FloatArray, to: FloatArray) -> int:
    """Index of the place that is nearest to another place."""
    return int(np.argmin(np.sum((places - to) ** 2, axis=1)))


def turned(vectors: FloatArray, angle: float) -> FloatArray:
    """Vectors that are turned counter-clockwise by an angle (rad)."""
    cos, sin = math.cos(angle), math.sin(angle)
    found: FloatArray = vectors @ np.array([[cos, sin], [-sin, cos]])
    return found
