# %% [markdown]
# # Where inertia matters for my robots
#
# Two robots of mine drag a box of 2 kg. I do not know yet how stiff the couplings and how fast the
# robots will be. For each pair, the quasi-static and the inertial path are computed; the map shows
# their largest difference over the length of the path.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul


def robots(stiffness_n_per_m, speed_m_per_s):
    """The box is towed by 0.6 m along x, and stops."""
    towed_s = 0.6 / speed_m_per_s
    tip = lambda y: [(0.0, 0.35, y), (towed_s, 0.95, y)]  # noqa: E731
    spring = dict(rest_length_m=0.2, radial_stiffness_n_per_m=stiffness_n_per_m, torsional_stiffness_nm_per_rad=1.0)
    return cohaul.Scenario(
        name="two robots and a box",
        duration_s=towed_s + 1.0,
        control_period_s=0.02,
        load=cohaul.load(mass_kg=2.0, outline={"rectangle": {"size_m": [0.3, 0.2]}}),
        ground=cohaul.ground(friction_coefficient=0.3, uniform_n=16),
        springs=[cohaul.spring(root_m=(0.15, y), **spring) for y in (0.08, -0.08)],
        drive=cohaul.tips(cohaul.path(0, tip(0.08)), cohaul.path(1, tip(-0.08))),
    )


stiffnesses, speeds = np.geomspace(20.0, 2000.0, 7), np.geomspace(0.02, 1.0, 7)
effect = np.empty((len(speeds), len(stiffnesses)))
for row, speed in enumerate(speeds):
    for column, stiffness in enumerate(stiffnesses):
        scenario = robots(stiffness, speed)
        quasi_static, inertial = (cohaul.run(scenario, backend).trace["x_m"] for backend in ["quasi-static", "inertial"])
        effect[row, column] = np.abs(inertial - quasi_static).max() / max(quasi_static[-1], 1e-9)

# %%
figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
levels = [1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0]
shown = axes.contourf(stiffnesses, speeds, effect, levels=levels, norm="log", cmap="viridis", extend="both")
axes.contour(stiffnesses, speeds, effect, levels=[1e-2], colors="white")
axes.set(xscale="log", yscale="log", xlabel="stiffness of each spring (N/m)", ylabel="speed of the robots (m/s)")
axes.set_title("Inertia effect over the path length; white: 1 %")
figure.colorbar(shown, ax=axes, format="%g")
plt.show()

# %% [markdown]
# A whole verdict for one of the pairs, with what the engine adds and what would help.

# %%
cohaul.compare(robots(200.0, 0.3))
