# %% [markdown]
# # Own controller on three backends
#
# A controller is a function. It is called once in each control period, sees the load, and returns
# where the tips shall be at the end of the period. This one pulls the load to a goal with two
# springs, and slows down when the pull comes near the slip limit.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul

spring = dict(rest_length_m=0.0263, radial_stiffness_n_per_m=0.664, torsional_stiffness_nm_per_rad=4.52e-4)
scenario = cohaul.Scenario(
    name="two springs and a goal",
    duration_s=12.0,
    control_period_s=0.01,
    load=cohaul.load(mass_kg=0.0016, radius_m=0.0122),
    ground=cohaul.ground(friction_coefficient=1.4, tripod_radius_m=0.0081333),
    springs=[
        cohaul.spring(root_m=(0.0, 0.0122), bearing_rad=np.pi / 2, **spring),
        cohaul.spring(root_m=(0.0122, 0.0), bearing_rad=0.0, **spring),
    ],
    drive=cohaul.tips(),
)
GOAL = np.array([0.06, 0.04])


def pull_to_goal(seed):
    def control(view):
        place = np.array(view.pose[:2])
        if view.time_s == 0.0:
            view.attach(0, (0.0, 0.0385))
            view.attach(1, (0.0385, 0.0))
        if np.linalg.norm(GOAL - place) < 0.002:
            view.finish()
        direction = (GOAL - place) / max(np.linalg.norm(GOAL - place), 1e-9)
        share = np.linalg.norm(view.pulls.sum(axis=0)) / scenario.slip_limit_n
        speed = 0.03 * max(0.2, 1.0 - 0.6 * share)
        return view.tips + view.control_period_s * speed * direction

    return control


# %%
figure, axes = plt.subplots(figsize=(5, 3.6), layout="constrained")
for backend in cohaul.BACKENDS:
    run = cohaul.run(scenario, backend, controller=pull_to_goal(1))
    axes.plot(1e3 * run.trace["x_m"], 1e3 * run.trace["y_m"], label=f"{backend}: {run['final']['time_s']:.2f} s")
axes.plot(*(1e3 * GOAL), "k+", ms=10)
axes.set(xlabel="x (mm)", ylabel="y (mm)", title="Paths to the goal, and their times", aspect="equal")
axes.legend(frameon=False)
plt.show()

# %% [markdown]
# The comparison records the controller on one backend and replays its motions on all three.

# %%
cohaul.compare_controller(scenario, pull_to_goal, tiers="replayed")
