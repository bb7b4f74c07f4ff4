"""pymunk, which is Chipmunk: supports are pivot joints that the ground holds with a clamped force."""

from __future__ import annotations

from typing import Any, Sequence

import pymunk

from ._bodies import Bodies
from ._planar import contact


class Pymunk(Bodies):
    """pymunk with settings for millimetres and small steps."""

    name: str = "pymunk"
    version: str | None = pymunk.version
    joint: Any = pymunk.PivotJoint
    turn: Any = None
    """What is done to a joint before each step, if anything."""
    space: pymunk.Space
    load: Any
    obstacles: list[Any]

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        self.keep(scene)
        self.space = pymunk.Space()
        self.set_up(1e-4 * scene["radius_m"])
        self.load = pymunk.Body(scene["mass_kg"], scene["inertia_kg_m2"])
        self.obstacles = [pymunk.Body(body_type=pymunk.Body.KINEMATIC) for _ in scene["obstacles"]]
        self.space.add(self.load, *self.obstacles)
        self.place(scene)
        self.set_twist(self.load, scene["twist"])
        self.load.velocity_func = self.push
        self.grip(scene["supports"])

    def grip(self, supports: Sequence[dict[str, Any]]) -> None:
        for support in supports:
            joint = self.joint(self.space.static_body, self.load, (0.0, 0.0), tuple(support["offset_m"]))
            joint.max_bias, joint.max_force = 0.0, support["slip_limit_n"]
            joint.pre_solve = self.turn
            self.space.add(joint)

    def set_up(self, slop: float) -> None:
        # By default overlaps up to 0.1 m are left, and 94 % of the rest after 10 ms.
        self.space.iterations, self.space.collision_slop, self.space.collision_bias = 50, slop, 1e-100

    def add_shape(self, body: pymunk.Body, kind: str, part: Any, has: dict[str, Any]) -> None:
        shape: pymunk.Shape
        if kind == "disc":
            shape = pymunk.Circle(body, part[1], part[0])
        else:
            shape = pymunk.Poly(body, part) if kind == "polygon" else pymunk.Segment(body, part[0], part[1], 0.0)
        # Chipmunk multiplies the coefficients of both sides: those of the load are 1.
        shape.friction, shape.elasticity = has.get("friction_coefficient", 1.0), has.get("restitution", 1.0)
        self.space.add(shape)

    def push(self, load: pymunk.Body, gravity: Any, damping: float, h: float) -> None:
        # Chipmunk moves bodies before it changes velocities. A force that is set before the step
        # belongs to the place that the load leaves, and adds energy: it is set here instead.
        load.velocity, load.angular_velocity = self.pushed(h)

    def pushed(self, h: float) -> tuple[pymunk.Vec2d, float]:
        """Velocity and turn rate under the springs alone."""
        fx, fy, torque = self.pull()
        velocity = self.load.velocity + (h * fx / self.load.mass, h * fy / self.load.mass)
        return velocity, self.load.angular_velocity + h * torque / self.load.moment

    def step(self, h: float) -> None:
        self.space.step(h)

    def contacts(self, h: float) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        self.load.each_arbiter(lambda arbiter: found.append(self.touch(arbiter, h)))
        return found

    def touch(self, arbiter: pymunk.Arbiter, h: float) -> dict[str, Any]:
        obstacle = next(at for at, body in enumerate(self.obstacles) if body in [shape.body for shape in arbiter.shapes])
        # Chipmunk states one impulse for up to two points.
        points = [point.point_a for point in arbiter.contact_point_set.points]
        return contact(obstacle, points, [impulse / h for impulse in arbiter.total_impulse])


class PymunkDefaults(Pymunk):
    """pymunk with its own settings."""

    name: str = "pymunk (defaults)"

    def set_up(self, slop: float) -> None:
        pass


class PymunkAlongSlip(Pymunk):
    """pymunk with friction along the slip: a joint of one axis at each support.

    A pivot joint whose force is clamped pushes along K^-1 v, with the matrix K that maps an impulse
    at the support to its change of velocity. A joint of one axis pushes along that axis, which is
    laid along the slip of the step without friction.
    """

    name: str = "pymunk (friction along the slip)"
    joint: Any = pymunk.PinJoint

    def turn(self, joint: Any, space: pymunk.Space) -> None:
        arm = joint.anchor_b.rotated(self.load.angle)
        velocity, turn_rate = self.pushed(space.current_time_step)
        slip = velocity + turn_rate * arm.perpendicular()
        joint.anchor_a = self.load.position + arm + (slip.normalized() if slip else pymunk.Vec2d(1.0, 0.0))
