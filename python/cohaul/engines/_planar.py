"""What adapters share: units, the loop of steps, obstacles that move, and the energy that is lost."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from . import Engine


class Planar(Engine):
    """An engine that is stepped, and states where its load is."""

    length: float
    """Unit of length in which the engine computes (m)."""
    mass: float
    """Unit of mass in which it does (kg)."""
    masses: list[float]
    """Mass (kg), twice, and moment of inertia (kg m^2) of the load."""
    lost: float | None
    """Energy lost so far (J); ``None`` where it is not known."""
    places: list[list[float]]
    """Poses of the obstacles at the start (m, m, rad)."""
    share: float
    """Share of the advance after which the tips have their places (1)."""

    def units(self, scene: dict[str, Any]) -> tuple[float, float]:
        """Units of length and mass in which the engine computes (m, kg)."""
        return 1.0, 1.0

    def step(self, h: float) -> None:
        """One step of ``h`` (s), at whose end the springs have the wrench ``pull()`` of where the load is."""
        raise NotImplementedError

    def load_pose(self) -> list[float]:
        raise NotImplementedError

    def load_twist(self) -> list[float]:
        raise NotImplementedError

    def obstacle_poses(self) -> list[list[float]]:
        """Where the engine has the obstacles (m, m, rad)."""
        return []

    def move_obstacle(self, at: int, twist: list[float]) -> None:
        """Lets an obstacle move at a constant twist from here on."""

    def contacts(self, h: float) -> list[dict[str, Any]] | None:
        """Forces of obstacles on the load in the last step of ``h`` (s), if the engine knows them."""
        return None

    def pull(self) -> Sequence[float]:
        """Force (N, N) and torque (N m) of the springs where the load is, with the tips at the end of the step."""
        return self.wrench(self.load_pose(), self.load_twist(), self.share)

    def keep(self, scene: dict[str, Any]) -> None:
        """Begins to keep the energy, and the units."""
        self.length, self.mass = self.units(scene)
        self.masses = [scene["mass_kg"], scene["mass_kg"], scene["inertia_kg_m2"]]
        self.lost = 0.0
        self.places = [list(obstacle["pose"]) for obstacle in scene["obstacles"]]
        if any(spring["radial_damping_ns_per_m"] or spring["torsional_damping_nms_per_rad"] for spring in scene["springs"]):
            self.lost = None  # What dashpots take is not known here.

    def advance(self, tips_m: Any, obstacles: Sequence[Sequence[float]], duration_s: float, n_steps: int) -> Mapping[str, Any]:
        h = duration_s / n_steps
        twists = [[(there - here) / duration_s for here, there in zip(*ends)] for ends in zip(self.obstacle_poses(), obstacles)]
        if [list(target) for target in obstacles] != self.places:
            self.lost = None  # What pushers give is not known here.
        before = self.load_pose(), self._kinetic_energy()
        self.share = 0.0
        pushed = self.pull()
        for step in range(n_steps):
            for at, twist in enumerate(twists):
                self.move_obstacle(at, twist)
            self.share = (step + 1) / n_steps
            self.step(h)
            after = self.load_pose(), self._kinetic_energy()
            if self.lost is not None:
                # The springs' work on the load that did not become kinetic energy.
                pulled, pushed = pushed, self.pull()
                work = sum(0.5 * (f + g) * (there - here) for f, g, here, there in zip(pulled, pushed, before[0], after[0]))
                self.lost += work - (after[1] - before[1])
            before = after
        found = {"pose": self.load_pose(), "twist": self.load_twist(), "dissipated_j": self.lost, "contacts": self.contacts(h)}
        return {key: value for key, value in found.items() if value is not None}

    def _kinetic_energy(self) -> float:
        return sum(0.5 * mass * rate * rate for mass, rate in zip(self.masses, self.load_twist()))


def contact(obstacle: int, points_m: Sequence[Sequence[float]], force_n: Sequence[float]) -> dict[str, Any]:
    """Force of an obstacle on the load, which acts in the middle of some points."""
    middle = [sum(point[axis] for point in points_m) / len(points_m) for axis in (0, 1)]
    return {"obstacle": obstacle, "point_m": middle, "force_n": list(force_n)}
