# %% [markdown]
# # Fitting a force sensor
#
# The springs of the load are a force sensor: their tips are filmed, and the forces follow from the
# stiffnesses. Here a calibration is simulated. A known force pulls each tip, the camera adds noise,
# and both stiffnesses are fitted with Eq. (10): F_r = k_r (l - l_0), F_t = k_t swing / l.

# %%
import matplotlib.pyplot as plt
import numpy as np

import cohaul

K_R, K_T, L_0, ROOT = 0.664, 4.52e-4, 0.0263, 0.0122
scenario = cohaul.Scenario(
    name="a sensor on a bench",
    duration_s=1.0,
    control_period_s=0.01,
    load=cohaul.load(mass_kg=1.0, radius_m=ROOT),
    ground=cohaul.ground(friction_coefficient=1.4, tripod_radius_m=0.008),
    springs=[
        cohaul.spring(root_m=(ROOT, 0.0), rest_length_m=L_0, radial_stiffness_n_per_m=K_R, torsional_stiffness_nm_per_rad=K_T)
    ],
    drive=cohaul.tips(),
)

# %% [markdown]
# The load is so heavy that it stays. The tip visits a grid of places; the pull is what a reference
# sensor would show.

# %%
sim = cohaul.Simulation(scenario)
sim.attach(0, (ROOT + L_0, 0.0))
tips, pulls = [], []
for length in np.linspace(0.020, 0.034, 8):
    for swing in np.linspace(-0.5, 0.5, 9):
        tip = (ROOT + length * np.cos(swing), length * np.sin(swing))
        sim.advance([tip], 0.01)
        tips.append(tip)
        pulls.append(sim.pulls[0])
noise = np.random.default_rng(1)
filmed = np.array(tips) + noise.normal(0.0, 2e-4, (len(tips), 2))
pulls = np.array(pulls) + noise.normal(0.0, 5e-5, (len(tips), 2))

# %%
arm = filmed - [ROOT, 0.0]
length, swing = np.hypot(*arm.T), np.arctan2(arm[:, 1], arm[:, 0])
radial = arm / length[:, None]
across = np.column_stack([-radial[:, 1], radial[:, 0]])
pull_r, pull_t = (pulls * radial).sum(axis=1), (pulls * across).sum(axis=1)
k_r, force_0 = np.polyfit(length, pull_r, 1)
k_t = (swing / length) @ pull_t / ((swing / length) @ (swing / length))
print(f"radial: {k_r:.3f} N/m (true {K_R}), rest length {-1e3 * force_0 / k_r:.2f} mm (true {1e3 * L_0})")
print(f"torsional: {k_t:.3e} N m/rad (true {K_T})")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
left.plot(1e3 * length, 1e3 * pull_r, ".", ms=4)
left.plot(1e3 * np.sort(length), 1e3 * (k_r * np.sort(length) + force_0), lw=1.0)
left.set(xlabel="length (mm)", ylabel="radial pull (mN)")
right.plot(swing / length, 1e3 * pull_t, ".", ms=4)
right.plot(np.sort(swing / length), 1e3 * k_t * np.sort(swing / length), lw=1.0)
right.set(xlabel="swing / length (rad/m)", ylabel="tangential pull (mN)")
plt.show()
