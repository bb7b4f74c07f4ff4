"""A robot pushes a disc to a goal. Does the pushing work without inertia, with it, and in rapier?

It is the controller of ``push_to_goal.rs``, and its numbers are the same to the bit.
"""

import math
import os
from pathlib import Path

import cohaul

ROOT = Path(os.environ.get("COHAUL_ROOT", Path(__file__).resolve().parents[1]))
SCENE = cohaul.Scenario(ROOT / "scenarios/contact/pusher.json")
GOAL = (0.03, 0.01)
REACH = 0.0172
"""Distance of the centres of pusher and disc where they touch (m)."""


def push(seed):
    """The pusher goes behind the disc as seen from the goal, and on from there."""
    period = SCENE.control_period_s

    def control(view):
        (x, y, _), (pusher_x, pusher_y, _) = view.pose, view.obstacles[0].tolist()
        left_x, left_y = GOAL[0] - x, GOAL[1] - y
        left = math.sqrt(left_x * left_x + left_y * left_y)
        if left < 0.001:
            return
        back = (REACH - 0.04 * period) / left
        step_x, step_y = x - back * left_x - pusher_x, y - back * left_y - pusher_y
        share = min(0.08 * period / math.sqrt(step_x * step_x + step_y * step_y), 1.0)
        view.steer(0, (pusher_x + share * step_x, pusher_y + share * step_y, 0.0))

    return control


def missed(trace):
    """Distance of the disc from the goal at the end (m)."""
    return math.hypot(GOAL[0] - trace["x_m"][-1], GOAL[1] - trace["y_m"][-1])


if __name__ == "__main__":
    measure = cohaul.Measure("distance to the goal", "m", missed, tolerance=0.001)
    print(cohaul.compare_controller(SCENE, push, tiers="controlled", measure=measure).answer)
