# %% [markdown]
# # Pushing along a wall
#
# A disc pushes a box along a wall. Contact forces, sliding and sticking are part of all three
# models: here they are seen, and judged.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul

scenario = cohaul.Scenario(
    name="a box that a disc pushes along a wall",
    duration_s=2.0,
    control_period_s=0.01,
    load=cohaul.load(mass_kg=0.5, outline={"rectangle": {"size_m": [0.1, 0.06]}}, side_friction_coefficient=0.3),
    ground=cohaul.ground(friction_coefficient=0.4, uniform_n=16),
    springs=[],
    obstacles=[
        {"name": "wall", "outline": {"polyline": {"points_m": [[-0.2, 0.0305], [0.5, 0.0305]]}}, "friction_coefficient": 0.3},
        {
            "name": "pusher",
            "outline": {"disc": {"radius_m": 0.01}},
            "path": {"waypoints": [[0.0, -0.061, -0.01, 0.0], [2.0, 0.139, -0.01, 0.0]]},
            "friction_coefficient": 0.3,
        },
    ],
    drive=cohaul.tips(),
)
runs = {backend: cohaul.run(scenario, backend) for backend in cohaul.BACKENDS}

# %% [markdown]
# The pusher is below the centre: it turns the box into the wall. The forces of both on the load,
# and the instants at which the contact changes:

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
for backend, run in runs.items():
    forces = np.linalg.norm(run.trace["contact_forces_n"], axis=2)
    for at, (name, axes) in enumerate([("wall", left), ("pusher", right)]):
        axes.plot(run.trace["time_s"], forces[:, at], label=backend, lw=1.0)
        axes.set(xlabel="time (s)", ylabel="force on the box (N)", title=name)
left.legend(frameon=False)
plt.show()
for transition in runs["inertial"].transitions[:6]:
    print(f"{transition['time']:.4f} s: {transition['transition']} {scenario.to_dict()['obstacles'][transition['obstacle']]['name'] if 'obstacle' in transition else ''}")

# %% [markdown]
# Where does the energy go? The ledger has the ground, the sides of the obstacles and impacts apart.

# %%
for backend, run in runs.items():
    energy = run.energy
    print(f"{backend:13} ground {1e3 * energy['friction_j']:.1f} mJ, sides {1e3 * energy['side_friction_j']:.2f} mJ, impacts {1e6 * energy['impact_j']:.1f} uJ")

# %%
cohaul.compare(scenario)
