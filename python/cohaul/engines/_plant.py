"""Parts of a plant of Drake: bodies that move in the plane, feet, and the sides that touch."""

# mypy: disable-error-code="arg-type, call-overload"
# Drake's stubs name types of arrays that those of numpy do not match.

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, CollisionFilterDeclaration, Convex, GeometrySet, ProximityProperties, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import FixedOffsetFrame, PlanarJoint, PrismaticJoint, SpatialInertia, UnitInertia

from ._outline import corners, solids

ABOVE_THE_FEET = 10.0
"""Height at which load and obstacles touch, in radii of a foot (1)."""
THIN = 1e-6
"""Radius of a segment, in that of a foot: what lies on it is in it by as much (1)."""
MOST_FRICTION = 1e3
"""Coefficient of the load's sides: that of an obstacle follows, which makes up its pair's (1)."""


def planar_body(plant: Any, name: str, mass: float, inertia: float) -> Any:
    """A body that moves in the plane."""
    body = plant.AddRigidBody(name, _inertia(mass, inertia))
    plant.AddJoint(PlanarJoint(name, plant.world_frame(), body.body_frame(), np.zeros(3)))
    return body


def surface(friction: float, stiffness: float | None) -> Any:
    """A surface with this coefficient of friction and this stiffness, or that of Drake."""
    properties = ProximityProperties()
    AddContactMaterial(point_stiffness=stiffness, friction=CoulombFriction(friction, friction), properties=properties)
    # With Drake's own relaxation time, 0.1 s, feet would sink in deeply.
    properties.AddProperty("material", "relaxation_time", 0.0)
    return properties


def add_feet(
    plant: Any, load: Any, supports: Sequence[dict[str, Any]], length: float, friction: float, stiffness: float | None, firmness: float
) -> None:
    """The ground, and feet that move up and down in the load, with an inertia of ``firmness``.

    Their surfaces are as many times stiffer.
    """
    sole = surface(friction, stiffness and firmness * stiffness)
    # A box: Drake logs a warning about half spaces, and its log may wait for Python's lock
    # without end while another run holds it.
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform([0, 0, -2]), Box(1e5, 1e5, 2), "ground", sole)
    for at, support in enumerate(supports):
        # A foot has next to no mass in the plane.
        offset = np.array([*support["offset_m"], 0.0]) / length
        foot = plant.AddRigidBody(f"foot {at}", _inertia(1e-6, 1e-6))
        root = plant.AddFrame(FixedOffsetFrame(f"root {at}", load.body_frame(), RigidTransform(offset)))
        leg = plant.AddJoint(PrismaticJoint(f"leg {at}", root, foot.body_frame(), [0, 0, 1]))
        plant.AddJointActuator(f"motor {at}", leg).set_default_rotor_inertia(firmness)
        plant.RegisterCollisionGeometry(foot, RigidTransform(), Sphere(1.0), f"foot {at}", sole)


def add_sides(
    plant: Any, graph: Any, bodies: Sequence[Any], scenes: Sequence[dict[str, Any]], length: float, stiffness: float | None
) -> None:
    """Gives the load, which is the first of ``bodies``, and obstacles the outlines of ``scenes``.

    Drake finds one point where two solids touch, which leaps between the corners of a side that lies
    on another. Corners are solids of their own, and sides do not touch sides.
    """
    faces: list[Any] = []
    for body, has in zip(bodies, scenes):
        mu = has.get("friction_coefficient")
        # Drake takes the harmonic mean of two coefficients.
        side = surface(MOST_FRICTION if mu is None else MOST_FRICTION * mu / (2.0 * MOST_FRICTION - mu), stiffness)
        added = [_add_solid(plant, body, side, *solid) for solid in solids(has["outline"], 1.0, THIN, length)]
        faces.append([geometry for kind, geometry in added if kind != "sphere"])
        for solid in corners(has["outline"], 1.0, THIN, length):
            _add_solid(plant, body, side, *solid)
    filters = CollisionFilterDeclaration().ExcludeWithin(plant.CollectRegisteredGeometries(bodies[1:]))
    filters.ExcludeBetween(GeometrySet(faces[0]), GeometrySet(sum(faces[1:], [])))
    graph.collision_filter_manager().Apply(filters)


def _add_solid(plant: Any, body: Any, side: Any, kind: str, points: Any, radius: float) -> tuple[str, Any]:
    points, frame = np.array(points) + [0.0, 0.0, ABOVE_THE_FEET], RigidTransform()
    shape: Any
    if kind == "sphere":
        shape, frame = Sphere(radius), RigidTransform(points)
    elif kind == "capsule":  # A box: Drake finds exactly how deep something is in it.
        along = points[1] - points[0]
        shape = Box(np.linalg.norm(along), 2.0 * radius, 2.0)
        frame = RigidTransform(RotationMatrix.MakeZRotation(np.arctan2(along[1], along[0])), points.mean(axis=0))
    else:
        shape = Convex(points.T, "prism")
    name = f"{body.name()} {len(plant.GetCollisionGeometriesForBody(body))}"
    return kind, plant.RegisterCollisionGeometry(body, frame, shape, name, side)


def _inertia(mass: float, inertia: float) -> Any:
    gyration = inertia / mass
    return SpatialInertia(mass, np.zeros(3), UnitInertia(gyration, gyration, gyration))
