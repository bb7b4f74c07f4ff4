"""Drake: supports are feet that are pressed on the ground, in its discrete contact."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, Iterator

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation
from pydrake.systems.framework import DiagramBuilder

from ._feet import Feet
from ._plant import add_feet, add_sides, planar_body

MOST_PRESSED = 4e5
"""Force on a foot of usual inertia, in units of the load's mass and radius and of seconds (1)."""
FAR = 1e4
"""Where obstacles are while the feet settle, in radii of the load (1)."""


class Drake(Feet):
    """Drake with the SAP solver and stiff contacts.

    SAP's own approximation of friction lifts what slides, by its friction and its step: a load would
    leap along an obstacle. Beside obstacles friction follows the normal force of the step before,
    and feet are softer and pressed less, without which the solver misses the forces of obstacles.
    """

    name: str = "Drake"
    version: str | None = version("drake")
    approximation: Any = DiscreteContactApproximation.kSap
    stiffness: float | None = 1e8
    beside_obstacles: tuple[Any, float | None, float] = DiscreteContactApproximation.kLagged, 1e6, 1.0
    foot_friction: float = 1e-3
    heavy: float = 1e5
    """The solver ends by the largest momentum: that of heavier obstacles hides the load's."""
    bodies: list[dict[str, Any]]
    """Load and obstacles of the scene."""
    inertia: float
    """Moment of inertia of the load in the units of the plant."""
    firmness: float
    """Inertia and stiffness of the feet over the usual ones (1)."""
    q: Any
    v: Any
    plants: dict[float, Any]
    """A plant for each step (s)."""
    found: Any
    """Contacts in the last step."""

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        return scene["radius_m"], scene["mass_kg"]  # Drake's solver fails at grams and millimetres.

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        if scene["obstacles"]:
            self.approximation, self.stiffness, self.foot_friction = self.beside_obstacles
        super().start(scene, longest_step_s)

    def build(self, scene: dict[str, Any], longest_step_s: float) -> None:
        self.bodies, self.inertia = [scene, *scene["obstacles"]], scene["inertia_kg_m2"] / self.mass / self.length**2
        # Feet that are pressed more have more inertia and stiffness: they would fall through the ground.
        self.firmness = max([1.0, *(-self.press / MOST_PRESSED).tolist()])
        self.q, self.v = np.zeros((2, len(self.press) + 3 * len(self.bodies)))
        self.q[self.others] = FAR
        self.plants = {}
        # The feet settle: lagged friction is that of a foot that was pressed before.
        for _ in range(100):
            self.moved(longest_step_s, np.zeros(3))

    def built(self, h: float) -> Any:
        """Diagram, plant and contexts. A plant has the same step at all times: there is one for each step."""
        builder = DiagramBuilder()
        plant, graph = AddMultibodyPlantSceneGraph(builder, h)
        plant.SetUseSampledOutputPorts(False)
        plant.set_discrete_contact_approximation(self.approximation)
        # Drake softens stiff contacts by the mass in the plane, so that light loads would sink in.
        plant.set_sap_near_rigid_threshold(0.0)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, 0])
        load = planar_body(plant, "load", 1.0, self.inertia)
        add_feet(plant, load, self.supports, self.length, self.foot_friction, self.stiffness, self.firmness)
        obstacles = [planar_body(plant, f"obstacle {at}", self.heavy, self.heavy * self.inertia) for at in range(len(self.bodies) - 1)]
        # What hits an obstacle is in it by a step at its speed. Sides stiffer than this rub more there than they push.
        add_sides(plant, graph, [load, *obstacles], self.bodies, self.length, self.stiffness and 4.0 / h**2)
        plant.Finalize()
        diagram = builder.Build()
        context = diagram.CreateDefaultContext()
        return diagram, plant, context, plant.GetMyMutableContextFromRoot(context)

    def step(self, h: float) -> None:
        self.moved(h, np.array(self.pull()) / self.mass / self.length / [1.0, 1.0, self.length])

    def moved(self, h: float, wrench: Any) -> None:
        """One step under a wrench in the units of the plant."""
        if h not in self.plants:
            self.plants[h] = self.built(h)
        diagram, plant, root, context = self.plants[h]
        plant.SetPositions(context, self.q)
        plant.SetVelocities(context, self.v)
        force = np.array([*wrench, *self.press, *np.zeros(3 * len(self.bodies) - 3)])
        plant.get_applied_generalized_force_input_port().FixValue(context, force)
        plant.get_actuation_input_port().FixValue(context, np.zeros(len(self.press)))
        after = diagram.EvalUniquePeriodicDiscreteUpdate(root)
        # Contacts of this step: those of the next one stand there once it is done.
        self.found = plant.get_contact_results_output_port().Eval(context)
        root.SetDiscreteState(after)
        self.q, self.v = plant.GetPositions(context), plant.GetVelocities(context)

    def touches(self) -> Iterator[tuple[int, int, Any, Any]]:
        for touch in (self.found.point_pair_contact_info(at) for at in range(self.found.num_point_pair_contacts())):
            yield int(touch.bodyA_index()), int(touch.bodyB_index()), touch.contact_point(), touch.contact_force()


class DrakeDefaults(Drake):
    """Drake with its own settings: friction by the normal force of the step before."""

    name: str = "Drake (defaults)"
    approximation: Any = DiscreteContactApproximation.kLagged
    stiffness: float | None = None
    foot_friction: float = 1.0
    beside_obstacles: tuple[Any, float | None, float] = approximation, None, 1.0
