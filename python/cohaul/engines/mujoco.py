"""MuJoCo: supports are feet that are pressed on the ground, and slide there."""

from __future__ import annotations

from typing import Any, Iterator

import mujoco as mj
import numpy as np
from mujoco import mjtGeom, mjtJoint

from ._feet import Feet
from ._outline import solids

# What may touch: the load and obstacles, feet and the ground. Of a pair, that of higher priority states
# the friction.
LOAD, OBSTACLE = {"contype": 2, "conaffinity": 0}, {"contype": 0, "conaffinity": 2, "priority": 1}
GROUND, SOLE = {"contype": 1, "conaffinity": 0}, {"contype": 0, "conaffinity": 1, "priority": 1}


class MuJoCo(Feet):
    """MuJoCo with elliptic cones, and constraints as stiff as its steps allow."""

    name: str = "MuJoCo"
    version: str | None = mj.__version__
    foot_friction: float = 0.01
    """Coefficient of friction of the feet (1)."""
    lifted: float = 1e-3
    """Mass that is lifted with the feet over that of the load (1)."""
    soles: dict[str, list[float]]
    """How firm the feet are."""
    sides: dict[str, list[float]]
    """How firm load and obstacles are."""
    height: float
    """Height of the load above the ground (m)."""
    model: Any
    data: Any
    q: Any
    v: Any

    def set_up(self, option: Any, h: float) -> None:
        option.cone, option.impratio = mj.mjtCone.mjCONE_ELLIPTIC, 1e6
        option.iterations, option.tolerance, option.ls_tolerance, option.ccd_tolerance = 200, 1e-14, 1e-6, 1e-10
        # The shortest time constant that MuJoCo takes, and 0.01 % of softness.
        self.soles = {"solref": [2.0 * h, 1.0], "solimp": [0.9999, 0.9999, 1.0, 0.5, 2.0]}
        # Softer obstacles: what slides on them stays in touch, in place of leaping off.
        self.sides = {"solref": [5.0 * h, 1.0], "solimp": [0.9, 0.9, 1.0, 0.5, 2.0]}

    def build(self, scene: dict[str, Any], longest_step_s: float) -> None:
        spec, height = mj.MjSpec(), scene["radius_m"]
        spec.option.gravity, spec.option.timestep, self.height = [0, 0, 0], longest_step_s, height
        self.set_up(spec.option, longest_step_s)
        load = self.body(spec, scene, 1.0, LOAD)
        for obstacle in scene["obstacles"]:
            mu = obstacle["friction_coefficient"]
            self.body(spec, obstacle, self.heavy, {"condim": 3 if mu > 0.0 else 1, "friction": [mu, 0, 0], **OBSTACLE})
        spec.worldbody.add_geom(type=mjtGeom.mjGEOM_PLANE, pos=[0, 0, -2.0 * height], size=[0, 0, 1], **GROUND)
        for support in self.supports:
            # A foot has next to no mass in the plane; what is lifted with it is inertia of its joint.
            # MuJoCo refuses moments of inertia below 1e-15.
            foot = load.add_body(pos=[*support["offset_m"], -height], mass=1e-6 * scene["mass_kg"], explicitinertial=True)
            foot.inertia = [max(1e-6 * scene["inertia_kg_m2"], 2e-15)] * 3
            foot.add_joint(type=mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1], armature=self.lifted * scene["mass_kg"] / len(self.supports))
            foot.add_geom(type=mjtGeom.mjGEOM_SPHERE, size=[height, 0, 0], friction=[self.foot_friction, 0, 0], **SOLE, **self.soles)
        self.model = spec.compile()
        self.data = mj.MjData(self.model)
        self.q, self.v = self.data.qpos, self.data.qvel
        self.data.qfrc_applied[self.feet] = self.press
        mj.mj_step(self.model, self.data, 200)  # The feet settle.

    def body(self, spec: Any, has: dict[str, Any], weight: float, pair: dict[str, Any]) -> Any:
        body = spec.worldbody.add_body(mass=weight * self.masses[0], inertia=[weight * self.masses[2]] * 3, explicitinertial=True)
        for joint, axis in ((mjtJoint.mjJNT_SLIDE, [1, 0, 0]), (mjtJoint.mjJNT_SLIDE, [0, 1, 0]), (mjtJoint.mjJNT_HINGE, [0, 0, 1])):
            body.add_joint(type=joint, axis=axis)
        for solid in solids(has["outline"], self.height, 1e-4 * self.height):
            body.add_geom(**self.shape(spec, *solid), **pair, **self.sides)
        return body

    def shape(self, spec: Any, kind: str, points: Any, radius: float) -> dict[str, Any]:
        if kind == "sphere":
            return {"type": mjtGeom.mjGEOM_SPHERE, "pos": points, "size": [radius, 0, 0]}
        if kind == "capsule":
            return {"type": mjtGeom.mjGEOM_CAPSULE, "fromto": np.ravel(points), "size": [radius, 0, 0]}
        mesh = spec.add_mesh(name=f"prism {len(spec.meshes)}", uservert=np.ravel(points).tolist())
        return {"type": mjtGeom.mjGEOM_MESH, "meshname": mesh.name}

    def step(self, h: float) -> None:
        self.model.opt.timestep = h
        mj.mj_step1(self.model, self.data)
        self.data.qfrc_applied[:3] = self.pull()
        mj.mj_step2(self.model, self.data)

    def touches(self) -> Iterator[tuple[int, int, Any, Any]]:
        force = np.zeros(6)
        for at, touch in enumerate(self.data.contact):
            mj.mj_contactForce(self.model, self.data, at, force)
            first, second = self.model.geom_bodyid[touch.geom].tolist()
            yield first, second, touch.pos, force[:3] @ touch.frame.reshape(3, 3)


class MuJoCoDefaults(MuJoCo):
    """MuJoCo with its own settings: pyramids in place of cones, and soft constraints.

    The feet have its default coefficient of friction, and lift the whole mass as those of a block.
    """

    name: str = "MuJoCo (defaults)"
    foot_friction: float = 1.0
    lifted: float = 1.0
    soles: dict[str, list[float]]
    sides: dict[str, list[float]]

    def set_up(self, option: Any, h: float) -> None:
        self.soles, self.sides = {}, {}
