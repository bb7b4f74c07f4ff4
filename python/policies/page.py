"""The page of the trained policies, from the stored numbers alone."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

BACKENDS = ("quasi-static", "inertial", "rapier")
TITLES = {"Transport": "the paper's load to a place", "Doorway": "a crate through a doorway", "PushT": "a T block to a pose among posts"}


def write_page(out: Path, training: dict[str, Any], judgement: dict[str, Any], manifest: dict[str, Any]) -> None:
    parts = [HEAD, trained(training), JUDGED, arrivals(judgement), EPISODES, episodes(judgement), made_by(manifest)]
    (out / "README.md").write_text("\n\n".join(parts) + "\n")


def trained(training: dict[str, Any]) -> str:
    rows = []
    for name, found in training.items():
        curve = found["curve"]
        first = next((point["n_steps"] for point in curve if point["success"] >= 0.9), None)
        last = f"{100 * curve[-1]['success']:.0f} %"
        rows.append([f"`cohaul/{name}-v0`: {TITLES[name]}", f"{found['n_steps']:,}", last, "not reached" if first is None else f"{first:,}"])
    return table(["environment", "steps of training", "success at the end", "steps to 90 %"], rows)


def arrivals(judgement: dict[str, Any]) -> str:
    rows = []
    for name, policies in judgement.items():
        for policy, found in policies.items():
            cells = [arrived(found["backends"][backend]) for backend in BACKENDS]
            rows.append([name, policy, *cells])
    return table(["environment", "policy", *BACKENDS], rows)


def arrived(of: dict[str, Any]) -> str:
    low, high = (100 * one for one in of["interval_95"])
    time = "" if of["mean_time_s"] is None else f", {of['mean_time_s']:.3g} s"
    return f"{of['n_arrived']} of {of['n']} ({low:.0f} to {high:.0f} %){time}"


def episodes(judgement: dict[str, Any]) -> str:
    rows = []
    for name, policies in judgement.items():
        for policy, found in policies.items():
            for one in found["episodes"]:
                path, far = one["path"], one["distances_m"]
                numbers = [f"{1e3 * path[key]:.3g} mm" for key in ("inertia_effect", "engine_error", "tolerance")]
                ends = ", ".join(f"{1e3 * far[key]:.3g}" for key in ("quasi_static", "inertial", "engine"))
                rows.append([name, policy, str(one["seed"]), *numbers, path["verdict"], f"{ends} mm", one["goal"]])
    head = ["environment", "policy", "seed", "inertia effect", "engine error", "tolerance", "path", "distances to the goal", "goal"]
    return table(head, rows)


def made_by(manifest: dict[str, Any]) -> str:
    libraries = ", ".join(f"{name} {of}" for name, of in manifest["libraries"].items() if of)
    return wrapped(f"Made with {libraries}. Weights are in `NAME.npz`, numbers in `training.json` and `judgement.json`.")


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


HEAD = """# Trained policies

```sh
python python/policies train --only Transport
python python/policies judge
python python/policies page
```

Does a policy that was trained without inertia hold with inertia, or on an engine? PPO of
stable-baselines3 with its default settings trains a policy on the quasi-static backend. Its success
is that of the mean action over 100 episodes, every 10,000 steps."""

JUDGED = """## On each backend

The same policies move the load on each backend, over 200 starts and goals that were no part of the
training. The table has the episodes that arrive, the confidence interval of their share at 95 %
after Wilson, and the mean time of those that arrive. The policy `towards the goal` is one line: all
tips move towards the goal at full speed. The policy `planned pushes` is a rule of about 100 lines.
It simulates short pushes all round the block on the quasi-static backend, once. In each control
period it then takes the push for which approach, length and miss of the pose are least, and goes to
it round the block. Its constants were chosen on episodes with other seeds, 20,000 to 20,499."""

EPISODES = """## As comparisons of paths

The first episodes are compared by `cohaul.compare_controller` in the tier `controlled`: the policy
answers to what it sees on each backend. The path has a tolerance of 1 % of its length, the distance
to the goal that of the goal's radius. Distances are those of the quasi-static, the inertial and the
engine's load, at the time at which the first of them has arrived."""


ABOUT = {
    "Transport": (
        "Transport",
        "Four springs drag the paper's load, a disc of 1.6 g on three feet, to a place 100 mm away in a random direction. "
        "All tips are attached, and an action moves them at up to 50 mm/s for a control period of 50 ms. "
        "An episode ends within 10 mm of the goal, or after 30 s.",
        [("goal seen from the load", 2), ("cosine and sine of the heading", 2), ("velocity and turn rate", 3), ("tips seen from the load", 8), ("pulls on the tips", 8)],
        [("velocities of the four tips", 8)],
    ),
    "Doorway": (
        "Doorway",
        "Two robots tow a crate of 2 kg and 0.4 by 0.3 m on springs through a doorway between two posts, 1.4 m ahead. "
        "The crate starts up to 50 mm aside and turned by up to 0.3 rad. An action moves the tips at up to 0.1 m/s for 0.1 s. "
        "An episode ends within 0.1 m of the goal, or after 40 s.",
        [("goal seen from the load", 2), ("cosine and sine of the heading", 2), ("velocity and turn rate", 3), ("tips seen from the load", 4), ("pulls on the tips", 4)],
        [("velocities of both tips", 4)],
    ),
    "PushT": (
        "Push-T",
        "A disc pushes a T block of 0.3 kg to a pose among two posts. The block starts up to 30 mm aside and turned by up to 0.5 rad. "
        "An action moves the disc at up to 0.1 m/s, and turns it, for 0.1 s. "
        "An episode ends within 10 mm and 0.1 rad of the goal, or after 40 s.",
        [("goal seen from the load", 2), ("cosine and sine of the heading", 2), ("velocity and turn rate", 3), ("pusher seen from the load", 2),
         ("cosine and sine of its heading", 2), ("its force on the load", 2), ("cosine and sine of the turn that is left", 2)],
        [("velocity and turn rate of the pusher", 3)],
    ),
}  # fmt: skip
RULES = {
    "towards the goal": "all tips move towards the goal at full speed.",
    "planned pushes": (
        "the pusher takes in each control period the push with the least sum of approach, length and miss of the pose. "
        "How the block moves under a push is simulated on the quasi-static backend, once."
    ),
}
FILES = {"Transport": "transport", "Doorway": "doorway", "PushT": "push-t"}


def write_book(book: Path, training: dict[str, Any], judgement: dict[str, Any]) -> None:
    """A page of the book for each environment."""
    for name, (title, about, seen, acted) in ABOUT.items():
        policies = judgement[name]
        rows = [[policy, *(arrived(of["backends"][backend]) for backend in BACKENDS)] for policy, of in policies.items()]
        parts = [
            f"# {title}",
            f"`cohaul/{name}-v0`. " + about,
            "```python\nimport gymnasium\nimport cohaul.gym\n\n"
            f'env = gymnasium.make("cohaul/{name}-v0", backend="inertial")\nobservation, info = env.reset(seed=1)\n'
            f"assert observation.shape == ({sum(n for _, n in seen)},) and env.action_space.shape == ({sum(n for _, n in acted)},)\n```",
            table(["observation", "numbers"], [[what, str(n)] for what, n in seen]),
            table(["action, from -1 to 1", "numbers"], [[what, str(n)] for what, n in acted]),
            "Numbers are near 1: `cohaul.gym.TransportEnv` has the units, and other rewards, goals and scenes.",
            "## Policies",
            learned(training.get(name)),
            *judged_in_words(policies, rows),
            repeated(name, name in training),
            "All numbers are from [Trained policies](../results/2026-11-30-policies/README.md)." if policies else "",
        ]
        (book / f"{FILES[name]}.md").write_text("\n\n".join(wrapped(part) for part in parts if part) + "\n")


def learned(found: dict[str, Any] | None) -> str:
    """What training has reached."""
    if found is None:
        return ""
    first = next((point["n_steps"] for point in found["curve"] if point["success"] >= 0.9), None)
    reached = f"Its mean action arrives in 90 % of 100 episodes after {first:,} steps." if first else "It stays below 90 % of 100 episodes."
    return f"PPO with its default settings was trained on the quasi-static backend for {found['n_steps']:,} steps. {reached}"


def repeated(name: str, is_trained: bool) -> str:
    """The command that makes the numbers of a page."""
    if is_trained:
        return f"`python python/policies all --only {name}` trains and judges a policy."
    return f"`python python/policies judge --only {name}` repeats these numbers. The results have no trained policy of this environment."


def judged_in_words(policies: dict[str, Any], rows: list[list[str]]) -> list[str]:
    if not policies:
        return ["The results have no policy of this environment."]
    about = (
        "The table has the episodes that arrive on each backend, the confidence interval of their share at 95 %, and the mean time of those "
        "that arrive. "
    )
    about += " ".join(f"Under `{policy}` {RULES[policy]}" for policy in policies if policy in RULES)
    return [about, table(["policy", *BACKENDS], rows), verdicts_in_words(policies)]


def verdicts_in_words(policies: dict[str, Any]) -> str:
    """What the comparisons of episodes say, for each policy."""
    sentences = []
    for policy, found in policies.items():
        effects = [1e3 * one["path"]["inertia_effect"] for one in found["episodes"]]
        errors = [1e3 * one["path"]["engine_error"] for one in found["episodes"]]
        n = sum(one["goal"] == "agree" for one in found["episodes"])
        sentences.append(
            f"Under `{policy}`, inertia moves the path by {min(effects):.3g} to {max(effects):.3g} mm in {len(effects)} episodes, the engine by "
            f"{min(errors):.3g} to {max(errors):.3g} mm; the distance to the goal agrees in {n} of them."
        )
    return " ".join(sentences)


def wrapped(text: str) -> str:
    """A paragraph in lines of the book."""
    return text if text.startswith(("|", "`" * 3, "#")) else textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False)
