"""MuJoCo: supports are feet that are pressed on the ground, and slide there."""

from __future__ import annotations

from typing import Any

import mujoco as mj
import numpy as np

from ._outline import convex_parts
from ._planar import Planar


class MuJoCo(Planar):
    """MuJoCo with elliptic cones, and constraints as stiff as its steps allow.

    The load moves in the plane. A foot slides up and down in it at each support, and is pressed on
    the ground. MuJoCo lifts what slides, in proportion to the coefficient of friction: that of a
    foot is small, its force large, and their product the slip limit.
    """

    name, version = "MuJoCo", mj.__version__
    foot_friction = 0.01
    lifted = 1e-3
    """Mass that moves up and down with the feet, over that of the load (1)."""
    heavy = 1e9
    """Mass of an obstacle over that of the load: it keeps its speed in a contact (1)."""

    def set_up(self, option: Any, h: float) -> None:
        option.cone, option.impratio = mj.mjtCone.mjCONE_ELLIPTIC, 1e6
        option.iterations, option.tolerance, option.ls_tolerance, option.ccd_tolerance = 200, 1e-14, 1e-6, 1e-10
        # The shortest time constant that MuJoCo takes, and 0.01 % of softness.
        self.feet = {"solref": [2.0 * h, 1.0], "solimp": [0.9999, 0.9999, 1.0, 0.5, 2.0]}
        # Softer obstacles: what slides on them stays in touch, in place of leaping off.
        self.sides = {"solref": [5.0 * h, 1.0], "solimp": [0.9, 0.9, 1.0, 0.5, 2.0]}

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        if any(obstacle["restitution"] > 0.0 for obstacle in scene["obstacles"]):
            raise NotImplementedError("restitution: MuJoCo has no coefficient of restitution")
        self.keep(scene)
        spec, height, mass, inertia = mj.MjSpec(), scene["radius_m"], scene["mass_kg"], scene["inertia_kg_m2"]
        spec.option.gravity, spec.option.timestep, self.height = [0, 0, 0], longest_step_s, height
        self.set_up(spec.option, longest_step_s)
        supports = [support for support in scene["supports"] if support["slip_limit_n"] > 0.0]
        load = self.body(spec, scene, mass, inertia, {"contype": 2, "conaffinity": 0})
        for obstacle in scene["obstacles"]:
            mu = obstacle["friction_coefficient"]
            # That of higher priority states the friction of a pair.
            pair = {"contype": 0, "conaffinity": 2, "priority": 1, "condim": 3 if mu > 0.0 else 1, "friction": [mu, 0, 0]}
            self.body(spec, obstacle, self.heavy * mass, self.heavy * inertia, pair)
        plane = spec.worldbody.add_geom(type=mj.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=1, conaffinity=0)
        plane.pos = [0, 0, -2.0 * height]
        for support in supports:
            # A foot has next to no mass in the plane; what is lifted with it is inertia of its joint.
            # MuJoCo refuses moments of inertia below 1e-15.
            foot = {"mass": 1e-6 * mass, "inertia": [max(1e-6 * inertia, 2e-15)] * 3, "explicitinertial": True}
            body = load.add_body(pos=[*support["offset_m"], -height], **foot)
            body.add_joint(type=mj.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1], armature=self.lifted * mass / len(supports))
            sole = {"contype": 0, "conaffinity": 1, "priority": 1, "friction": [self.foot_friction, 0, 0], **self.feet}
            body.add_geom(type=mj.mjtGeom.mjGEOM_SPHERE, size=[height, 0, 0], **sole)
        self.model = spec.compile()
        self.data = mj.MjData(self.model)
        # Joints are sorted by their bodies: those of the load, of its feet, and of the obstacles.
        firsts = [0, *(3 + len(supports) + 3 * at for at in range(len(scene["obstacles"])))]
        self.joints = [slice(first, first + 3) for first in firsts]
        self.press = -np.array([support["slip_limit_n"] for support in supports]) / self.foot_friction
        self.data.qfrc_applied[3 : 3 + len(supports)] = self.press
        mj.mj_step(self.model, self.data, 200)  # The feet settle.
        self.data.qvel[:] = 0.0
        for joints, has in zip(self.joints, [scene, *scene["obstacles"]]):
            self.data.qpos[joints] = has["pose"]
        self.data.qvel[:3] = scene["twist"]
        self.twists = np.zeros((len(scene["obstacles"]), 3))

    def body(self, spec: Any, has: dict[str, Any], mass: float, inertia: float, pair: dict[str, Any]) -> Any:
        body = spec.worldbody.add_body(mass=mass, inertia=[inertia] * 3, explicitinertial=True)
        for axis in ([1, 0, 0], [0, 1, 0]):
            body.add_joint(type=mj.mjtJoint.mjJNT_SLIDE, axis=axis)
        body.add_joint(type=mj.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        for kind, part in convex_parts(has["outline"], 64):
            body.add_geom(**self.shape(spec, kind, part), **pair, **self.sides)
        return body

    def step(self, h: float, share: float) -> None:
        self.model.opt.timestep = h
        for joints, twist in zip(self.joints[1:], self.twists):
            self.data.qvel[joints] = twist
        mj.mj_step1(self.model, self.data)
        self.data.qfrc_applied[:3] = self.wrench(self.load_pose(), self.load_twist(), share)
        self.data.qfrc_applied[3 : 3 + len(self.press)] = self.press
        mj.mj_step2(self.model, self.data)

    def load_pose(self) -> list[float]:
        return self.data.qpos[:3].tolist()

    def load_twist(self) -> list[float]:
        return self.data.qvel[:3].tolist()

    def obstacle_poses(self) -> list[list[float]]:
        return [self.data.qpos[joints].tolist() for joints in self.joints[1:]]

    def move_obstacle(self, at: int, twist: list[float]) -> None:
        self.twists[at] = twist

    def contacts(self, h: float) -> list[dict[str, Any]]:
        found, force = [], np.zeros(6)
        for at, contact in enumerate(self.data.contact):
            first, second = self.model.geom_bodyid[contact.geom]
            if min(first, second) != 1:
                continue  # The load is body 1, and no foot is.
            mj.mj_contactForce(self.model, self.data, at, force)
            on_second = force[:3] @ contact.frame.reshape(3, 3)
            on_load = on_second if second == 1 else -on_second
            obstacle = int(max(first, second)) - 2 - len(self.press)
            found.append({"obstacle": obstacle, "point_m": contact.pos[:2].tolist(), "force_n": on_load[:2].tolist()})
        return found

    def shape(self, spec: Any, kind: str, part: Any) -> dict[str, Any]:
        if kind == "disc":
            return {"type": mj.mjtGeom.mjGEOM_SPHERE, "pos": [*part[0], 0], "size": [part[1], 0, 0]}
        if kind == "segment":
            ends = [value for point in part for value in (*point, 0.0)]
            return {"type": mj.mjtGeom.mjGEOM_CAPSULE, "fromto": ends, "size": [1e-4 * self.height, 0, 0]}
        name = f"prism {len(spec.meshes)}"
        spec.add_mesh(name=name, uservert=[value for z in (-1, 1) for point in part for value in (*point, z * self.height)])
        return {"type": mj.mjtGeom.mjGEOM_MESH, "meshname": name}


class MuJoCoDefaults(MuJoCo):
    """MuJoCo with its own settings: pyramids in place of cones, and soft constraints.

    The feet have its default coefficient of friction, and lift the whole mass as those of a block.
    """

    name = "MuJoCo (defaults)"
    foot_friction, lifted = 1.0, 1.0

    def set_up(self, option: Any, h: float) -> None:
        self.feet, self.sides = {}, {}
