# %% [markdown]
# # Own controller on three backends
#
# A controller is a function. It is called once in each control period, sees the load, and returns
# where the tips shall be at the end of the period. This one pulls the load to a goal with two
# springs, and lets go of it at full speed: the load with inertia coasts on.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul

spring = dict(rest_length_m=0.0263, radial_stiffness_n_per_m=0.664, torsional_stiffness_nm_per_rad=4.52e-4)
scenario = cohaul.Scenario(
    name="two springs and a goal",
    duration_s=3.0,
    control_period_s=0.01,
    load=cohaul.load(mass_kg=0.0016, radius_m=0.0122),
    ground=cohaul.ground(friction_coefficient=0.05, tripod_radius_m=0.0081333),
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
        if np.linalg.norm(GOAL - place) < 0.005:
            for spring in range(2):
                if view.attached[spring]:
                    view.release(spring)
        direction = (GOAL - place) / max(np.linalg.norm(GOAL - place), 1e-9)
        return view.tips + view.control_period_s * 0.05 * direction

    return control


# %% [markdown]
# The paths lie nearly on one another, so what differs is drawn: the distance to the goal, and the
# distances of the other two from the inertial load.

# %%
runs = {backend: cohaul.run(scenario, backend, controller=pull_to_goal(1)).trace for backend in cohaul.BACKENDS}
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
place = {backend: np.column_stack([trace["x_m"], trace["y_m"]]) for backend, trace in runs.items()}
for backend, trace in runs.items():
    left.plot(trace["time_s"], 1e3 * np.linalg.norm(place[backend] - GOAL, axis=1), label=backend, lw=1.2)
    if backend != "inertial":
        apart = np.linalg.norm(place[backend] - place["inertial"], axis=1)
        right.semilogy(trace["time_s"][1:], 1e3 * apart[1:], label=f"{backend} from inertial", lw=1.2)
left.set(xlabel="time (s)", ylabel="distance to the goal (mm)")
right.set(xlabel="time (s)", ylabel="distance of the loads (mm)")
left.legend(frameon=False)
right.legend(frameon=False)
plt.show()

# %% [markdown]
# The tier `controlled` asks how far the controller still does its work where it answers to what it
# sees on each backend. A measure of your own is judged beside the paths.

# %%
missed = cohaul.Measure("distance to the goal", "m", lambda trace: np.hypot(*(GOAL - [trace["x_m"][-1], trace["y_m"][-1]])), tolerance=0.001)
cohaul.compare_controller(scenario, pull_to_goal, tiers="controlled", measure=missed)
