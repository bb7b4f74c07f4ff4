# %% [markdown]
# # First verdict
#
# A spring pulls a load over the ground and is released. May inertia be neglected?

# %%
import matplotlib.pyplot as plt

import cohaul

scenario = cohaul.Scenario(
    name="one spring, pulled and released",
    duration_s=2.0,
    control_period_s=0.0025,
    load=cohaul.load(mass_kg=0.0016, radius_m=0.0122),
    ground=cohaul.ground(friction_coefficient=1.4, tripod_radius_m=0.0081333),
    springs=[
        cohaul.spring(
            root_m=(0.0122, 0.0),
            rest_length_m=0.0263,
            radial_stiffness_n_per_m=0.664,
            torsional_stiffness_nm_per_rad=4.52e-4,
        )
    ],
    drive=cohaul.tips(cohaul.path(0, [(0.0, 0.0385, 0.0), (1.0, 0.0985, 0.0028)], release_s=1.5)),
)
comparison = cohaul.compare(scenario)
comparison

# %% [markdown]
# The paths of the three models, and what inertia adds.

# %%
figure, (path, difference) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
traces = {backend: comparison.trace(backend) for backend in cohaul.BACKENDS}
for backend, trace in traces.items():
    path.plot(trace["time_s"], 1e3 * trace["x_m"], label=backend, lw=1.2)
path.set(xlabel="time (s)", ylabel="x (mm)", title="Position of the load")
path.legend(frameon=False)
shift = traces["inertial"]["x_m"] - traces["quasi-static"]["x_m"]
difference.plot(traces["inertial"]["time_s"], 1e3 * shift, color="C1", lw=1.2)
difference.axhline(0.0, color="0.7", lw=0.8)
difference.set(xlabel="time (s)", ylabel="difference of x (mm)", title="Inertial minus quasi-static")
plt.show()
