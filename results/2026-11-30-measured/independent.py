"""Quasi-static pushes by one finger, by the principle of least power. It shares nothing with cohaul.

usage: independent.py FOLDER, that of the measured tables; it prints the median of each.
"""
import csv, sys
import numpy as np

SUPPORTS = {  # mm, from the right-angled corner
    "board-skew": [(10, 10), (90, 30), (10, 130)],
    "board-even": [(30, 30), (90, 30), (30, 90)],
    "wood-wide": [(10, 10), (130, 10), (10, 130)],
    "wood-narrow": [(30, 30), (63.33, 43.33), (43.33, 63.33)],
    "board-patch": None,
}
CORNERS = np.array([[-50, -50], [100, -50], [-50, 100]]) / 1e3
TIP = 0.5e-3
STEP = 4e-5  # of the finger (m)
STEPS = {"board-patch": 1e-4}  # with 400 supports


def supports_of(name, n=20):
    if SUPPORTS[name] is None:
        # Centroids of n^2 equal triangles: the legs in n parts.
        a = 0.15 / n
        up = [((i + 1 / 3) * a, (j + 1 / 3) * a) for i in range(n) for j in range(n - i)]
        down = [((i + 2 / 3) * a, (j + 2 / 3) * a) for i in range(n) for j in range(n - i - 1)]
        at = np.array(up + down) - 0.05
        return at, np.full(len(at), 1.0 / len(at))
    at = np.array(SUPPORTS[name]) / 1e3 - 0.05
    # Loads whose centre is below the centroid.
    return at, np.linalg.solve(np.vstack([at.T, np.ones(3)]), np.array([0.0, 0.0, 1.0]))


def rotated(v, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]], axis=1)


def closest(q):
    """Closest point of the edge, outward normal, and signed distance of points q (load's frame)."""
    best = None
    inside = np.ones(len(q), bool)
    for k in range(3):
        a, b = CORNERS[k], CORNERS[(k + 1) % 3]
        e = (b - a) / np.linalg.norm(b - a)
        n = np.array([e[1], -e[0]])
        t = np.clip((q - a) @ e, 0, np.linalg.norm(b - a))
        p = a + t[:, None] * e
        d = np.linalg.norm(q - p, axis=1)
        inside &= (q - a) @ n < 0
        if best is None:
            best = [p, d, np.tile(n, (len(q), 1))]
        else:
            better = d < best[1]
            for old, new in zip(best, (p, d, np.tile(n, (len(q), 1)))):
                old[better] = new[better]
    p, d, n = best
    out = np.where((d > 1e-9)[:, None], (q - p) / np.maximum(d, 1e-12)[:, None] * np.where(inside, -1, 1)[:, None], n)
    return p, out, np.where(inside, -d, d)


def balance(p, v, at, share):
    """Turn rate of least power for the velocity v of the contact p, and the force (unit slip limit)."""
    arm = at - p[:, None]  # run, support, axis
    spin = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
    size = np.linalg.norm(v, axis=1)
    low, high = -size / 1e-3, size / 1e-3
    eps = 1e-7 * size[:, None]
    for _ in range(30):
        mid = 0.5 * (low + high)
        u = v[:, None] + mid[:, None, None] * spin
        slope = (share * (u * spin).sum(-1) / np.sqrt((u * u).sum(-1) + eps**2)).sum(1)
        low, high = np.where(slope < 0, mid, low), np.where(slope < 0, high, mid)
    omega = 0.5 * (low + high)
    u = v[:, None] + omega[:, None, None] * spin
    f = (share[..., None] * u / np.sqrt((u * u).sum(-1) + eps**2)[..., None]).sum(1)
    return omega, f


def simulate(load, finger, mu, at, share, step):
    """Last poses of loads (x, y, heading) that fingers push from the first to the second place."""
    pose = load.copy()
    start, end = finger
    # Out along the normal where they overlap.
    q = rotated(start - pose[:, :2], -pose[:, 2])
    _, n, d = closest(q)
    shift = np.maximum(TIP - d, 0)[:, None] * rotated(n, pose[:, 2])
    start, end = start + shift, end + shift
    way = end - start
    steps = int(np.ceil(np.linalg.norm(way, axis=1).max() / step))
    for k in range(steps):
        dv = way / steps
        q = rotated(start + (k + 1) * dv - pose[:, :2], -pose[:, 2])
        _, _, d = closest(q)
        touches = d < TIP
        if not touches.any():
            continue
        w = np.where(touches)[0]
        # Midpoint: the motion by half of the step gives the contact of the whole step.
        for part in (0.5, 1.0):
            here = pose[w] if part == 0.5 else half
            q = rotated(start[w] + (k + (0.0 if part == 0.5 else 0.5)) * dv[w] - here[:, :2], -here[:, 2])
            p, n, d = closest(q)
            vf = rotated(dv[w], -here[:, 2])
            t = np.stack([-n[:, 1], n[:, 0]], axis=1)
            omega, f = balance(p, vf, at[w], share[w])
            normal, along = -(f * n).sum(1), (f * t).sum(1)  # the force pushes inward
            slides = (np.abs(along) > mu * normal) | (normal <= 0)
            v = vf.copy()
            if slides.any():
                s = np.where(slides)[0]
                ps, ns, ts, vs = p[s], n[s], t[s], vf[s]
                # The load's point slips along the tangent by x: its velocity's tangent, between none and
                # what brings the force into the cone.
                vn = (vs * ns).sum(1)
                sign = np.sign(along[s])
                tangent = (vs * ts).sum(1)
                reach = 60 * np.abs(vn) + 2 * np.abs(tangent)
                low, high = np.zeros(len(s)), reach
                for _ in range(26):
                    x = 0.5 * (low + high)
                    trial = vn[:, None] * ns + (tangent - sign * x)[:, None] * ts
                    _, g = balance(ps, trial, at[w][s], share[w][s])
                    out = sign * (g * ts).sum(1) > mu * -(g * ns).sum(1)
                    low, high = np.where(out, x, low), np.where(out, high, x)
                x = 0.5 * (low + high)
                v[s] = vn[:, None] * ns + (tangent - sign * x)[:, None] * ts
                omega_s, _ = balance(ps, v[s], at[w][s], share[w][s])
                omega[s] = omega_s
            # Velocity of the origin from that of the contact.
            origin = v - omega[:, None] * np.stack([-p[:, 1], p[:, 0]], axis=1)
            move = np.column_stack([rotated(origin, here[:, 2]), omega])
            if part == 0.5:
                half = pose[w] + 0.5 * move
        new = pose[w] + move
        # What is left of the gap at the end of the step.
        q = rotated(start[w] + (k + 1) * dv[w] - new[:, :2], -new[:, 2])
        _, n, d = closest(q)
        fix = np.minimum(np.maximum(TIP - d, -1e-6), 1e-5)
        new[:, :2] -= rotated(n, new[:, 2]) * fix[:, None]
        pose[w] = new
    return pose


def ends(t, p):
    """First and last place of a finger that rests and then moves straight at constant speed: least
    squares on all places, which are rounded to 0.1 mm."""
    best = None
    for start in np.linspace(t[0], 0.5 * t[-1], 200):
        moved = np.clip(t - start, 0.0, None)
        columns = np.stack([np.ones_like(t), moved], axis=1)
        fit = columns @ np.linalg.lstsq(columns, p, rcond=None)[0]
        if best is None or ((fit - p) ** 2).sum() < best[0]:
            best = ((fit - p) ** 2).sum(), fit
    return best[1][[0, -1]]


def table(path):
    runs = {}
    for row in csv.DictReader(open(path)):
        runs.setdefault(int(row["run"]), []).append(row)
    loads, fingers = [], []
    of = lambda row, keys: [float(row[key]) for key in keys]
    for rows in runs.values():
        seen = [r for r in rows if r["load_x_m"]]
        loads.append([of(r, ("load_x_m", "load_y_m", "load_heading_rad")) for r in (seen[0], seen[-1])])
        places = np.array([of(r, ("finger_x_m", "finger_y_m")) for r in rows])
        fingers.append(ends(np.array([float(r["time_s"]) for r in rows]), places))
    loads, fingers = np.array(loads), np.array(fingers)
    return list(runs), loads, [fingers[:, 0], fingers[:, 1]]


def errors(folder, name, mu):
    """Last measured minus simulated positions (m) and headings (rad) of the runs of a table."""
    _, load, finger = table(f"{folder}/{name}.csv")
    at, share = (np.repeat(each[None], len(load), axis=0) for each in supports_of(name))
    d = load[:, 1] - simulate(load[:, 0], finger, mu, at, share, STEPS.get(name, STEP))
    d[:, 2] = (d[:, 2] + np.pi) % (2 * np.pi) - np.pi
    return d


def medians(folder, mu=0.4):
    """Median edge displacement between measured and simulated block at the end, by table (m)."""
    found = {name: errors(folder, name, mu) for name in SUPPORTS}
    radius = np.linalg.norm(CORNERS, axis=1).max()
    return {name: float(np.median(np.hypot(d[:, 0], d[:, 1]) + radius * abs(d[:, 2]))) for name, d in found.items()}


if __name__ == "__main__":
    import json

    print(json.dumps(medians(sys.argv[1]), indent=1))
