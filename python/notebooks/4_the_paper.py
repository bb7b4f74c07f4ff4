# %% [markdown]
# # The paper in ten minutes
#
# Berman et al. (2010) let ants pull a load on springs to their nest, and neglect inertia. Here are
# one such transport, and the same ensemble with inertia. More seeds make the intervals narrower.

# %%
import matplotlib.pyplot as plt

import cohaul

four = cohaul.Scenario("scenarios/paper/four-ants-four-springs.json")
run = cohaul.run(four)
print(run.answer)

# %%
figure, (path, pulls) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
path.plot(1e3 * run.trace["x_m"], 1e3 * run.trace["y_m"], lw=1.0)
path.plot(200.0, -170.0, "k+", ms=10)
path.set(xlabel="x (mm)", ylabel="y (mm)", title="Path to the nest", aspect="equal")
pulls.plot(run.trace["time_s"], 1e3 * run.trace["interaction_n"], lw=0.5)
pulls.set(xlabel="time (s)", ylabel="interaction force (mN)", title="Ants against each other, Eq. (4)")
plt.show()

# %% [markdown]
# The ensemble, on both exact backends and on all threads.

# %%
table = cohaul.sweep(four, {"drive.n_ants": [1, 2, 4]}, seeds=6, backend=["quasi-static", "inertial"]).to_pandas()
table.groupby(["drive.n_ants", "backend"])[["time_to_nest_s", "mean_speed_m_per_s", "pull_mean_n"]].mean().round(4)

# %%
figure, axes = plt.subplots(figsize=(5, 3.4), layout="constrained")
for at, (backend, rows) in enumerate(table.groupby("backend")):
    axes.plot(rows["drive.n_ants"] + 0.12 * (at - 0.5), rows["time_to_nest_s"], "o", ms=4, alpha=0.7, label=backend)
axes.set(xlabel="number of ants", ylabel="time to the nest (s)", xticks=[1, 2, 4], title="Each dot is a seed")
axes.legend(frameon=False)
plt.show()
