# %% [markdown]
# # An engine of your own under the verdict
#
# An engine is a class with two methods. This one treats the load as a point that slides without
# turning, as many simple simulators do. Does it do for my scene?

# %%
import math

import matplotlib.pyplot as plt
import numpy as np

import cohaul
from cohaul.engines import Engine


class Slider(Engine):
    name = "slider"

    def start(self, scene, longest_step_s):
        if scene["obstacles"]:
            raise NotImplementedError("obstacles: the slider knows none")
        self.mass = scene["mass_kg"]
        self.grip = sum(support["slip_limit_n"] for support in scene["supports"])
        self.pose, self.twist = scene["pose"], scene["twist"]

    def advance(self, tips_m, obstacles, duration_s, n_steps):
        h = duration_s / n_steps
        for step in range(n_steps):
            fx, fy, _ = self.wrench(self.pose, self.twist, (step + 1) / n_steps)
            u, v = self.twist[0] + h * fx / self.mass, self.twist[1] + h * fy / self.mass
            speed = math.hypot(u, v)
            left = max(0.0, 1.0 - h * self.grip / self.mass / speed) if speed > 0.0 else 0.0
            self.twist = [left * u, left * v, 0.0]
            self.pose = [self.pose[0] + h * self.twist[0], self.pose[1] + h * self.twist[1], self.pose[2]]
        return {"pose": self.pose, "twist": self.twist}


# %% [markdown]
# On a straight pull it is right:

# %%
straight = cohaul.compare("scenarios/analytic/ramp-and-hold.json", engine=Slider, step_s=1e-3)
print(straight.answer)

# %% [markdown]
# A pull off the centre turns the load, but not with the slider. The verdict says how much that
# changes, and that no smaller step helps: the part `engine_model` is all of it.

# %%
aside = cohaul.Scenario(
    name="a load that is towed off its centre",
    duration_s=2.0,
    control_period_s=0.01,
    load=cohaul.load(mass_kg=0.0016, radius_m=0.0122),
    ground=cohaul.ground(friction_coefficient=1.4, tripod_radius_m=0.0081333),
    springs=[cohaul.spring(root_m=(0.0, 0.0122), radial_stiffness_n_per_m=0.664)],
    drive=cohaul.tips(cohaul.path(0, [(0.0, 0.0, 0.0122), (2.0, 0.1, 0.0122)])),
)
turning = cohaul.compare(aside, engine=["rapier", Slider], step_s=1e-3)
print(turning.answer)
for path in (turning.paths, *turning.other_engines):
    parts = path["verdicts"]["path"]["parts"]
    print(f"{path['engine']['name']}: time step {1e3 * parts['time_step']:.3g} mm, model {1e3 * parts['engine_model']:.3g} mm")

# %%
figure, axes = plt.subplots(figsize=(5.4, 3.4), layout="constrained")
for name in ("inertial", "rapier", "slider"):
    trace = turning.trace(name)
    axes.plot(1e3 * trace["x_m"], 1e3 * trace["y_m"], label=name, lw=1.2)
axes.set(xlabel="x (mm)", ylabel="y (mm)", title="Path of a load that is towed off its centre")
axes.legend(frameon=False)
plt.show()

# %% [markdown]
# Questions with closed answers show what an engine knows, and what it refuses.

# %%
table = cohaul.conformance(Slider)
print(table.line)
grades = list(table.grades.values())
print({grade: grades.count(grade) for grade in sorted(set(grades))})
