#!/usr/bin/env python3
"""An engine of 50 lines without dependencies: semi-implicit Euler, and friction by impulses that
are clamped at each support, one after another, as engines for games do it.

    cohaul compare SCENE --engine crates/engines/examples/pins.py
"""

import math
import sys
from pathlib import Path

try:
    from cohaul.engines import Engine, serve
except ImportError:  # The file engines.py of the package needs nothing else.
    sys.path.append(str(Path(__file__).resolve().parents[3] / "python/cohaul"))
    from engines import Engine, serve

SWEEPS = 20


class Pins(Engine):
    name, version = "pins", "1"

    def start(self, scene, longest_step_s):
        if scene["obstacles"]:
            raise NotImplementedError("obstacles: must be none, which pins do not know")
        self.mass, self.inertia = scene["mass_kg"], scene["inertia_kg_m2"]
        self.supports = [(support["offset_m"], support["slip_limit_n"]) for support in scene["supports"]]
        self.pose, self.twist, self.lost = scene["pose"], scene["twist"], 0.0

    def advance(self, tips_m, obstacles, duration_s, n_steps):
        h = duration_s / n_steps
        for step in range(n_steps):
            self.step(h, self.wrench(self.pose, self.twist, (step + 1) / n_steps))
        return {"pose": self.pose, "twist": self.twist, "dissipated_j": self.lost}

    def step(self, h, wrench):
        (x, y, heading), (u, v, w) = self.pose, self.twist
        u, v, w = u + h * wrench[0] / self.mass, v + h * wrench[1] / self.mass, w + h * wrench[2] / self.inertia
        c, s = math.cos(heading), math.sin(heading)
        arms = [(c * a - s * b, s * a + c * b, h * limit) for (a, b), limit in self.supports]
        held = [(0.0, 0.0)] * len(arms)
        for _ in range(SWEEPS):
            for at, (rx, ry, most) in enumerate(arms):
                # The impulse that stops the support, added to that of before and clamped.
                ix, iy = self.carried(rx, ry, u - w * ry, v + w * rx)
                jx, jy = held[at][0] - ix, held[at][1] - iy
                size = math.hypot(jx, jy)
                if size > most:
                    jx, jy = jx * most / size, jy * most / size
                dx, dy, held[at] = jx - held[at][0], jy - held[at][1], (jx, jy)
                u, v, w = u + dx / self.mass, v + dy / self.mass, w + (rx * dy - ry * dx) / self.inertia
        self.lost -= sum(jx * (u - w * ry) + jy * (v + w * rx) for (jx, jy), (rx, ry, _) in zip(held, arms))
        self.pose, self.twist = [x + h * u, y + h * v, heading + h * w], [u, v, w]

    def carried(self, rx, ry, px, py):
        """Impulse K^-1 p of a support that moves at p."""
        kxx, kyy = 1 / self.mass + ry * ry / self.inertia, 1 / self.mass + rx * rx / self.inertia
        kxy = -rx * ry / self.inertia
        det = kxx * kyy - kxy * kxy
        return (kyy * px - kxy * py) / det, (kxx * py - kxy * px) / det


class AlongSlip(Pins):
    """The cure: the largest eigenvalue of K in place of K. Friction then opposes the slip."""

    name = "pins (along the slip)"

    def carried(self, rx, ry, px, py):
        k = 1 / self.mass + (rx * rx + ry * ry) / self.inertia
        return px / k, py / k


if __name__ == "__main__":
    serve(AlongSlip if "--along-slip" in sys.argv else Pins)
