"""Drake: supports are feet that are pressed on the ground, in its discrete contact."""

# mypy: disable-error-code="arg-type, call-overload"
# Drake's stubs name types of arrays that those of numpy do not match.

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, DiscreteContactApproximation
from pydrake.multibody.tree import FixedOffsetFrame, PlanarJoint, PrismaticJoint, SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder

from ._planar import Planar

SETTLING_STEPS = 100
MOST_PRESSED = 4e5
"""Force on a foot of usual inertia, in units of the load's mass and radius and of seconds (1)."""


class Drake(Planar):
    """Drake with the SAP solver and stiff feet, without obstacles.

    A foot slides up and down in the load at each support, and is pressed on the ground. SAP lifts
    what slides, in proportion to the coefficient of friction: that of a foot is small, its force
    large, and their product the slip limit.
    """

    name, version = "Drake", version("drake")
    approximation: Any = DiscreteContactApproximation.kSap
    stiffness: float | None = 1e8
    foot_friction = 1e-3

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        if scene["obstacles"]:
            raise NotImplementedError("obstacles: the adapter for Drake has none")
        self.keep(scene)
        # The units are the load's mass and radius: Drake's solver fails at grams and millimetres.
        self.mass, self.length = scene["mass_kg"], scene["radius_m"]
        self.inertia = scene["inertia_kg_m2"] / self.mass / self.length**2
        supports = [support for support in scene["supports"] if support["slip_limit_n"] > 0.0]
        self.supports = [np.array([*support["offset_m"], 0.0]) / self.length for support in supports]
        limits = np.array([support["slip_limit_n"] for support in supports])
        self.press = -limits / self.foot_friction / self.mass / self.length
        # Feet that are pressed more have more inertia and stiffness: they would fall through the ground.
        self.firmness = max([1.0, *(-self.press / MOST_PRESSED)])
        self.units = np.array([self.length, self.length, 1.0])
        # The feet settle: lagged friction is that of a foot that was pressed before.
        self.q, self.v = np.zeros(3 + len(limits)), np.zeros(3 + len(limits))
        self.plants: dict[float, Any] = {}
        for _ in range(SETTLING_STEPS):
            self.moved(longest_step_s, np.zeros(3))
        self.q[:3], self.v[:] = scene["pose"] / self.units, 0.0
        self.v[:3] = scene["twist"] / self.units

    def built(self, h: float) -> Any:
        """A plant has the same step at all times: there is one for each step."""
        if h not in self.plants:
            builder = DiagramBuilder()
            plant, _ = AddMultibodyPlantSceneGraph(builder, h)
            plant.SetUseSampledOutputPorts(False)
            plant.set_discrete_contact_approximation(self.approximation)
            # Drake softens stiff contacts by the mass in the plane, so that light loads would sink in.
            plant.set_sap_near_rigid_threshold(0.0)
            plant.mutable_gravity_field().set_gravity_vector([0, 0, 0])
            load = plant.AddRigidBody("load", _inertia(1.0, self.inertia))
            plant.AddJoint(PlanarJoint("plane", plant.world_frame(), load.body_frame(), np.zeros(3)))
            # A box: Drake logs a warning about half spaces, and its log may wait for Python's lock
            # without end while another run holds it.
            ground = RigidTransform([0, 0, -2])
            plant.RegisterCollisionGeometry(plant.world_body(), ground, Box(1e5, 1e5, 2), "ground", self.surface())
            for at, offset in enumerate(self.supports):
                # A foot has next to no mass in the plane, and lifts as much as the load has.
                body = plant.AddRigidBody(f"foot {at}", _inertia(1e-6, 1e-6))
                root = plant.AddFrame(FixedOffsetFrame(f"root {at}", load.body_frame(), RigidTransform(offset)))
                leg = plant.AddJoint(PrismaticJoint(f"leg {at}", root, body.body_frame(), [0, 0, 1]))
                plant.AddJointActuator(f"motor {at}", leg).set_default_rotor_inertia(self.firmness)
                plant.RegisterCollisionGeometry(body, RigidTransform(), Sphere(1.0), f"foot {at}", self.surface())
            plant.Finalize()
            diagram = builder.Build()
            context = diagram.CreateDefaultContext()
            self.plants[h] = diagram, plant, context, plant.GetMyMutableContextFromRoot(context)
        return self.plants[h]

    def surface(self) -> Any:
        properties = ProximityProperties()
        friction = CoulombFriction(self.foot_friction, self.foot_friction)
        AddContactMaterial(point_stiffness=self.stiffness and self.firmness * self.stiffness, friction=friction, properties=properties)
        # With Drake's own relaxation time, 0.1 s, the feet would sink in deeply.
        properties.AddProperty("material", "relaxation_time", 0.0)
        return properties

    def step(self, h: float, share: float) -> None:
        wrench = np.array(self.wrench(self.load_pose(), self.load_twist(), share))
        self.moved(h, wrench / self.mass / self.length / [1.0, 1.0, self.length])

    def moved(self, h: float, wrench: Any) -> None:
        """One step under a wrench in the units of the plant."""
        diagram, plant, root, context = self.built(h)
        plant.SetPositions(context, self.q)
        plant.SetVelocities(context, self.v)
        force = np.array([*wrench, *self.press])
        plant.get_applied_generalized_force_input_port().FixValue(context, force)
        plant.get_actuation_input_port().FixValue(context, np.zeros(len(self.press)))
        root.SetDiscreteState(diagram.EvalUniquePeriodicDiscreteUpdate(root))
        self.q, self.v = plant.GetPositions(context), plant.GetVelocities(context)

    def load_pose(self) -> list[float]:
        return (self.q[:3] * self.units).tolist()

    def load_twist(self) -> list[float]:
        return (self.v[:3] * self.units).tolist()


class DrakeDefaults(Drake):
    """Drake with its own settings: friction by the normal force of the step before."""

    name = "Drake (defaults)"
    approximation, stiffness, foot_friction = DiscreteContactApproximation.kLagged, None, 1.0


def _inertia(mass: float, inertia: float) -> Any:
    gyration = inertia / mass
    return SpatialInertia(mass, np.zeros(3), UnitInertia(gyration, gyration, gyration))
