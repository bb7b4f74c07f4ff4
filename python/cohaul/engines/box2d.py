"""Box2D: supports are friction joints, which clamp what would stop them."""

from __future__ import annotations

from typing import Any

import Box2D as b2

from ._bodies import Bodies
from ._planar import Planar, contact


class Box2D(Bodies):
    """Box2D in units that suit it: the load's radius is ten units of length, its mass one of mass.

    Box2D computes in 32 bits, has a skin of 0.01 units around polygons and lets bodies overlap by
    0.005. It advises bodies of 0.1 to 10 units: the largest have the smallest faults.
    """

    name: str = "Box2D"
    version: str | None = b2.__version__
    sweeps: tuple[int, int] = (50, 20)
    """Iterations for velocities and for positions (1)."""
    sleeps: bool = False
    """Whether bodies at rest are left out."""
    rates: tuple[str, str] = "linearVelocity", "angularVelocity"
    most_corners: int = b2.b2_maxPolygonVertices
    load: Any
    obstacles: list[Any]
    world: Any
    impulses: Any

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        return scene["radius_m"] / 10.0, scene["mass_kg"]

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        self.keep(scene)
        self.impulses = _Impulses()
        self.world = b2.b2World(gravity=(0, 0), doSleep=self.sleeps, contactListener=self.impulses)
        self.load = self.world.CreateDynamicBody()
        self.obstacles = [self.world.CreateKinematicBody(userData=at) for at in range(len(scene["obstacles"]))]
        self.place(scene)
        inertia = scene["inertia_kg_m2"] / self.mass / self.length**2
        self.load.massData = b2.b2MassData(mass=scene["mass_kg"] / self.mass, center=(0, 0), I=inertia)
        self.set_twist(self.load, scene["twist"])
        ground = self.world.CreateStaticBody()
        for support in scene["supports"]:
            limit = support["slip_limit_n"] / self.mass / self.length
            at = self.scaled(support["offset_m"])
            self.world.CreateJoint(b2.b2FrictionJointDef(bodyA=ground, bodyB=self.load, localAnchorB=at, maxForce=limit, maxTorque=0))

    def add_shape(self, body: Any, kind: str, part: Any, has: dict[str, Any]) -> None:
        # Box2D takes the geometric mean of the frictions and the larger restitution.
        pair = {"friction": has.get("friction_coefficient", 1.0) ** 2, "restitution": has.get("restitution", 0.0)}
        if kind == "disc":
            shape = b2.b2CircleShape(pos=part[0], radius=part[1])
        else:
            shape = (b2.b2PolygonShape if kind == "polygon" else b2.b2EdgeShape)(vertices=part)
        body.CreateFixture(shape=shape, density=1.0, **pair)

    def step(self, h: float) -> None:
        fx, fy, torque = self.pull()
        unit = self.mass * self.length
        self.load.ApplyForceToCenter((fx / unit, fy / unit), True)
        self.load.ApplyTorque(torque / unit / self.length, True)
        self.impulses.found = []
        self.world.Step(h, *self.sweeps)

    def contacts(self, h: float) -> list[dict[str, Any]]:
        unit = self.mass * self.length / h
        found = self.impulses.found
        return [contact(at, [[x * self.length for x in point]], [j * unit for j in impulse]) for at, point, impulse in found]


class Box2DDefaults(Box2D):
    """Box2D in SI units, with the iterations that its manual advises."""

    name: str = "Box2D (defaults)"
    sweeps: tuple[int, int] = (8, 3)
    sleeps: bool = True

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        return Planar.units(self, scene)


class _Impulses(b2.b2ContactListener):  # type: ignore[misc]
    """Impulses of obstacles on the load in the last step, with the places where they act."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[int, Any, list[float]]] = []

    def PostSolve(self, touch: Any, impulse: Any) -> None:
        manifold = touch.worldManifold  # Its normal lives as long as it does.
        (x, y), obstacle, sign = manifold.normal, touch.fixtureA.body.userData, 1.0
        if obstacle is None:  # The load comes first, and the normal points away from it.
            obstacle, sign = touch.fixtureB.body.userData, -1.0
        for at, (along, across) in enumerate(zip(impulse.normalImpulses, impulse.tangentImpulses)):
            force = [sign * (along * x + across * y), sign * (along * y - across * x)]
            self.found.append((obstacle, list(manifold.points[at]), force))
