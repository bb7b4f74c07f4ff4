# %% [markdown]
# # Where inertia matters for my robots
#
# Two robots of mine tow a box of 2 kg. I do not know yet how stiff the couplings will be, nor how
# fast the robots. The map compares the models at each pair. Where the estimate beside a quasi-static
# run is clear, that decides; elsewhere all three models run.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul

spring = dict(rest_length_m=0.2, radial_stiffness_n_per_m=200.0, torsional_stiffness_nm_per_rad=1.0, damping_ratio=0.1)
tip = lambda y: [(0.0, 0.35, y), (2.0, 0.95, y)]  # noqa: E731
scenario = cohaul.Scenario(
    name="two robots and a box",
    duration_s=3.0,
    control_period_s=0.02,
    load=cohaul.load(mass_kg=2.0, outline={"rectangle": {"size_m": [0.3, 0.2]}}),
    ground=cohaul.ground(friction_coefficient=0.3, uniform_n=16),
    springs=[cohaul.spring(root_m=(0.15, y), **spring) for y in (0.08, -0.08)],
    drive=cohaul.tips(cohaul.path(0, tip(0.08)), cohaul.path(1, tip(-0.08))),
)
found = cohaul.compare_map(scenario, {"springs[*].radial_stiffness_n_per_m": "log:20:2000:6", "speed": "log:0.1:4:6"})
print(found.answer)

# %%
stiffnesses, speeds = found.axes
figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
levels = np.geomspace(1e-2, 1e2, 9)
shown = axes.contourf(stiffnesses, 0.3 * speeds, found.shares("path").T, levels=levels, norm="log", cmap="viridis", extend="both")
axes.contour(stiffnesses, 0.3 * speeds, found.shares("path").T, levels=[1.0], colors="white")
axes.set(xscale="log", yscale="log", xlabel="stiffness of each spring (N/m)", ylabel="speed of the robots (m/s)")
axes.set_title("Inertia effect on the path over its tolerance; white: 1")
figure.colorbar(shown, ax=axes, format="%g")
plt.show()

# %% [markdown]
# How fast may the robots be with these springs? A search finds the boundary to a percent, quantity by
# quantity.

# %%
limit = cohaul.threshold(scenario, "speed", (0.1, 4.0, 12))
print(limit.answer)
for quantity in ("path", "pulls"):
    for band in limit.bands(quantity):
        print(f"{quantity}: {band['class']} from {0.3 * band['from']['value']:.3f} to {0.3 * band['to']['value']:.3f} m/s")
