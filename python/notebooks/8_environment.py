# %% [markdown]
# # A policy, and the models it is tried on
#
# `cohaul.gym` has Gymnasium environments on each backend. A rule of one line tows a crate through a
# doorway: all tips move towards the goal. Does it also hold with inertia, and on an engine?

# %%
import gymnasium
import matplotlib.pyplot as plt
import numpy as np

import cohaul
import cohaul.gym


def towards_the_goal(observation):
    far = observation[:2] / max(np.hypot(*observation[:2]), 1e-12)
    return np.tile(far, 2)


def episode(backend, seed):
    env = gymnasium.make("cohaul/Doorway-v0", backend=backend)
    observation, info = env.reset(seed=seed)
    places, is_over = [env.unwrapped.simulation.pose], False
    while not is_over:
        observation, reward, arrived, late, info = env.step(towards_the_goal(observation))
        places.append(env.unwrapped.simulation.pose)
        is_over = arrived or late
    return arrived, info["time_s"], np.array(places)


# %%
figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
for colour, backend in zip(("C0", "C1", "C2"), cohaul.BACKENDS):
    found = [episode(backend, seed) for seed in range(8)]
    print(f"{backend}: {sum(arrived for arrived, _, _ in found)} of {len(found)} arrive")
    for at, (_, _, places) in enumerate(found):
        axes.plot(*places[:, :2].T, color=colour, lw=0.8, label=backend if at == 0 else None)
for post in cohaul.gym.TOW["scenario"]["obstacles"]:
    axes.add_patch(plt.Circle(post["position_m"], post["outline"]["disc"]["radius_m"], color="0.6"))
axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", title="The crate's centre in eight episodes on each backend")
axes.legend(frameon=False)
plt.show()

# %% [markdown]
# An episode is a scenario and a controller, so that the comparison can say why the motions differ.

# %%
env = gymnasium.make("cohaul/Doorway-v0").unwrapped
scenario, controller = env.episode(towards_the_goal, seed=0)
cohaul.compare_controller(scenario, controller, tiers="controlled")
