"""Box2D: supports are friction joints, which clamp what would stop them."""

from __future__ import annotations

from typing import Any

import Box2D as b2

from ._outline import convex_parts
from ._planar import Planar


class Box2D(Planar):
    """Box2D in units that suit it: the load's radius is ten units of length, its mass one of mass.

    Box2D computes in 32 bits, has a skin of 0.01 units around polygons and lets bodies overlap by
    0.005. It advises bodies of 0.1 to 10 units: the largest have the smallest faults.
    """

    name, version = "Box2D", b2.__version__
    sweeps, sleeps = (50, 20), False

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        """Units of length and mass (m, kg)."""
        return scene["radius_m"] / 10.0, scene["mass_kg"]

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        self.keep(scene)
        self.length, self.mass = self.units(scene)
        self.impulses = _Impulses()
        self.world = b2.b2World(gravity=(0, 0), doSleep=self.sleeps, contactListener=self.impulses)
        self.load = self.world.CreateDynamicBody()
        self.obstacles = [self.world.CreateKinematicBody(userData=at) for at in range(len(scene["obstacles"]))]
        for body, has in zip([self.load, *self.obstacles], [scene, *scene["obstacles"]]):
            body.position, body.angle = self.scaled(has["pose"]), has["pose"][2]
            # Box2D takes the geometric mean of the frictions and the larger restitution.
            pair = has.get("friction_coefficient", 1.0) ** 2, has.get("restitution", 0.0)
            for kind, part in convex_parts(has["outline"], b2.b2_maxPolygonVertices):
                body.CreateFixture(shape=self.shape(kind, part), density=1.0, friction=pair[0], restitution=pair[1])
        inertia = scene["inertia_kg_m2"] / self.mass / self.length**2
        self.load.massData = b2.b2MassData(mass=scene["mass_kg"] / self.mass, center=(0, 0), I=inertia)
        self.load.linearVelocity, self.load.angularVelocity = self.scaled(scene["twist"]), scene["twist"][2]
        ground = self.world.CreateStaticBody()
        for support in scene["supports"]:
            limit = support["slip_limit_n"] / self.mass / self.length
            at = self.scaled(support["offset_m"])
            self.world.CreateJoint(b2.b2FrictionJointDef(bodyA=ground, bodyB=self.load, localAnchorB=at, maxForce=limit, maxTorque=0))

    def step(self, h: float, share: float) -> None:
        fx, fy, torque = self.wrench(self.load_pose(), self.load_twist(), share)
        unit = self.mass * self.length
        self.load.ApplyForceToCenter((fx / unit, fy / unit), True)
        self.load.ApplyTorque(torque / unit / self.length, True)
        self.impulses.found = []
        self.world.Step(h, *self.sweeps)

    def load_pose(self) -> list[float]:
        return self.pose_of(self.load)

    def load_twist(self) -> list[float]:
        u, v = self.load.linearVelocity
        return [u * self.length, v * self.length, self.load.angularVelocity]

    def obstacle_poses(self) -> list[list[float]]:
        return [self.pose_of(body) for body in self.obstacles]

    def move_obstacle(self, at: int, twist: list[float]) -> None:
        self.obstacles[at].linearVelocity, self.obstacles[at].angularVelocity = self.scaled(twist), twist[2]

    def contacts(self, h: float) -> list[dict[str, Any]]:
        unit = self.mass * self.length / h
        return [
            {"obstacle": at, "point_m": [x * self.length for x in point], "force_n": [j * unit for j in impulse]}
            for at, point, impulse in self.impulses.found
        ]

    def pose_of(self, body: Any) -> list[float]:
        return [body.position[0] * self.length, body.position[1] * self.length, body.angle]

    def scaled(self, vector: Any) -> tuple[float, float]:
        return vector[0] / self.length, vector[1] / self.length

    def shape(self, kind: str, part: Any) -> Any:
        if kind == "disc":
            return b2.b2CircleShape(pos=self.scaled(part[0]), radius=part[1] / self.length)
        corners = [self.scaled(corner) for corner in part]
        return b2.b2PolygonShape(vertices=corners) if kind == "polygon" else b2.b2EdgeShape(vertices=corners)


class Box2DDefaults(Box2D):
    """Box2D in SI units, with the iterations that its manual advises."""

    name = "Box2D (defaults)"
    sweeps, sleeps = (8, 3), True

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        return 1.0, 1.0


class _Impulses(b2.b2ContactListener):  # type: ignore[misc]
    """Impulses of obstacles on the load in the last step, with the places where they act."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[int, Any, list[float]]] = []

    def PostSolve(self, contact: Any, impulse: Any) -> None:
        manifold = contact.worldManifold  # Its normal lives as long as it does.
        (x, y), obstacle, sign = manifold.normal, contact.fixtureA.body.userData, 1.0
        if obstacle is None:  # The load comes first, and the normal points away from it.
            obstacle, sign = contact.fixtureB.body.userData, -1.0
        for at, (along, across) in enumerate(zip(impulse.normalImpulses, impulse.tangentImpulses)):
            force = [sign * (along * x + across * y), sign * (along * y - across * x)]
            self.found.append((obstacle, list(manifold.points[at]), force))
