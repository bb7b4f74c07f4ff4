"""Page of the report cards, from their numbers."""

from __future__ import annotations

import shlex
import textwrap
from pathlib import Path
from typing import Any, Iterable

from figures import heat_map, work_precision

TITLES = {
    "analytic/slide-spin": "slide and spin",
    "analytic/tripod-slide-spin-pinned": "turn about a support",
    "analytic/ramp-and-hold": "towed",
    "analytic/release-jump": "released",
    "contact/wall-slide": "smooth wall",
    "contact/box-wall-friction": "rough wall",
    "contact/post-arc": "round a post",
    "contact/push-aside": "pushed",
    "contact/oblique-impact": "impact",
    "contact/rebound": "rebound",
}
QUANTITIES = ("path", "heading", "pulls", "contacts", "speed", "energy")


def write_page(folder: Path, cards: dict[str, Any], times: dict[str, Any], manifest: dict[str, Any]) -> None:
    engines = cards["engines"]
    scenes = list(engines[0]["scenes"])
    titles = [TITLES.get(name, name) for name in scenes]
    shares = {engine["name"]: [_share(engine["scenes"][name]) for name in scenes] for engine in engines if _is_compared(engine)}
    (folder / "errors.svg").write_text(heat_map(titles, shares))
    (folder / "work-precision.svg").write_text(work_precision(_curves(cards, times)))
    (folder / "README.md").write_text("\n".join(_page(cards, manifest, scenes, titles)) + "\n")


def _page(cards: dict[str, Any], manifest: dict[str, Any], scenes: list[str], titles: list[str]) -> Iterable[str]:
    engines = cards["engines"]
    compared = [engine for engine in engines if _is_compared(engine)]
    yield "# Report cards of engines"
    yield from ["", "```sh", shlex.join(manifest["command_line"]), "```", ""]
    yield _text(
        "Engines move the same loads through the same scenes, in steps of 1 ms. A load stands on supports with Coulomb friction, seen "
        "from above. The engines were not made for that: the page says what each does with the usual stand-in for the ground. "
        "It judges an adapter of cohaul together with its engine. What is asked, and how, is in [Other engines](../../docs/src/engines.md)."
    )
    yield from ["", "## In a minute", ""]
    head = ["engine", "friction against a slip along 45 deg", "slide of 3.28 mm", "creep below the slip limit", "known answers within 1 %",
            "scenes with a path within 1 %", "and its model within 1 %", "worst path, ground alone", "worst path, contact"]  # fmt: skip
    yield from _table(head, [_glance(engine) for engine in engines])
    yield ""
    yield _text(
        "Errors of the path are the largest edge displacement between engine and reference, over the path length. One step at the first "
        "speed is 4.6 % of the slide. Such time-step errors vanish with the step: steps of a quarter have a quarter of them. The model "
        "is what is left in the limit of small steps, and counts as within 1 % if it is so together with the error of that limit. "
        "Below the slip limit a load should stand."
    )
    yield ""
    yield _text(
        "The direction of friction is that of one support off the centre, at 1 m/s and with friction too weak to turn the slip. That of rapier "
        "and of cohaul is from C4, where the slip turns by some tenths of a degree. The path of "
        "Box2D in `analytic/slide-spin` is within 1 % because the errors of time step and model happen to cancel."
    )
    yield ""
    yield from _table(["scene", "file"], [[title, f"`scenarios/{name}.json`"] for name, title in zip(scenes, titles)])
    yield from ["", "![Path error of each engine on each scene](errors.svg)", "", "## Settings", ""]
    yield from _table(["engine", "version", "settings"], [[engine["name"], engine["version"], engine["settings"]] for engine in engines])
    yield ""
    yield _text(
        "Box2D is the version of its Python package. Box2D 3 has another solver and was not asked. Defaults are those of each library, "
        "with the adapter's model of the supports. The adapters `Box2D`, `Drake` and `DrakeDefaults` compute in units of the load, all others in "
        "SI units. `rapier (defaults)` was not asked for known answers, since `cohaul conformance` has rapier with its recommended settings."
    )
    yield from ["", "## How to do better", ""]
    yield from [line for change in cards["advice"] for line in _advice(change)]
    yield from ["", "## What is refused", ""]
    yield from [line for engine in engines for line in _refusals(engine)]
    yield ""
    yield _text(
        "MuJoCo has no coefficient of restitution; its users get a rebound from an underdamped `solref`, which depends on the masses. "
        "The adapter of Drake takes obstacles since these cards were made."
    )
    yield from ["", "## Path errors", ""]
    yield _text(
        "Error, and behind it its parts: time step, model, and the error of the limit of small steps. Where that exceeds a third of the "
        "model error, time step and model cannot be told apart at this step."
    )
    yield ""
    yield from _table(["scene", "engine", "error", "of the path", "time step", "model", "of the limit", "order"], _errors(compared, scenes, titles))
    yield from ["", "## Quantities within their tolerance", ""]
    yield _text("Number of scenes in which a quantity is within its tolerance, of those in which the engine was asked and the quantity is stated.")
    yield ""
    yield from _table(["engine", *QUANTITIES], [_counts(engine) for engine in compared])
    yield from ["", "## Error against run time", "", "![Path error against CPU time of one run](work-precision.svg)", ""]
    yield _text(
        "Each point is a run of 1 s of simulated time, at steps of 4, 2, 1 and 0.5 ms. The path round the post has a corner every 2 ms, "
        "which cuts the longest steps. The time is CPU time of one thread around the "
        "adapter's step, as Python's `time.thread_time` has it, without that of the springs, which cohaul computes. It holds the "
        "adapter's own Python, which is most of it for the small engines. Engines called from C are faster. rapier and the inertial "
        "backend run inside cohaul, and their time is that of the whole process, with springs and all. The build of cohaul was "
        f"{manifest['build']}, which makes these two slower. Times are the least of three alternating rounds on a noisy machine and are kept apart in "
        "`times.json`: read factors of two at most."
    )
    if cards["others"]:
        yield from ["", "## Two programs that are built on Chipmunk", ""]
        yield from [line for found in cards["others"] for line in _other(found)]
        yield ""
        yield _text(
            "Both scenes are in `scenes/`. The models of both programs were written anew on pymunk from their sources, at their step of "
            "10 ms. The T block of gym-pusht has no friction of the ground but a damping of 0, and its centre of gravity lies 4.3 px from "
            "that of its area. ARGoS holds each load by 1.49 N and 1.49 N m, whatever its mass, so that a robot does not turn a cylinder "
            "of 0.1 m which it pulls at the edge."
        )
    yield from ["", "## Numbers", ""]
    yield _text("`cards.json` has all answers, errors, orders and verdicts. `manifest.json` has versions and the hash of each scenario.")


def _is_compared(engine: dict[str, Any]) -> bool:
    return any(found["outcome"] != "reference" for found in engine["scenes"].values())


def _share(found: dict[str, Any]) -> float | None:
    return found["error_m"] / found["path_length_m"] if found["outcome"] == "measured" else None


def _answer(engine: dict[str, Any], key: str) -> dict[str, Any] | None:
    tests = engine["conformance"]["tests"] if engine["conformance"] else []
    measures = [test.get("measures") or [] for test in tests if test["key"] == key]
    found: dict[str, Any] | None = measures[0][0] if measures and measures[0] else None
    return found


def _glance(engine: dict[str, Any]) -> list[str]:
    slide, creep, direction = (_answer(engine, key) for key in ("C1", "C3", "C4"))
    degrees = engine["friction_direction_deg"]
    if degrees is None and direction:
        degrees = 45.0 + (direction["found"] - direction["known"]) * 57.29577951
    tests = engine["conformance"]["tests"] if engine["conformance"] else []
    good = sum(test["grade"] in ("exact", "to 1 %") for test in tests if test.get("grade"))
    scenes = engine["scenes"]
    shares = {name: share for name, found in scenes.items() if (share := _share(found)) is not None}
    within = sum(found["verdicts"]["path"] == "within" for found in scenes.values() if found["outcome"] == "measured")
    models = sum(found["model_error_m"] + found["limit_error_m"] <= 0.01 * found["path_length_m"] for found in scenes.values() if _share(found))
    worst = [max((share for name, share in shares.items() if name.startswith(kind)), default=None) for kind in ("analytic", "contact")]
    return [
        engine["name"],
        f"{degrees:.1f} deg" if degrees is not None else "",
        f"{100.0 * slide['relative_error']:+.1f} %" if slide else "",
        _length(creep["found"], "/s") if creep else "",
        f"{good} of {len(tests)}" if tests else "",
        f"{within} of {len(shares)}" if shares else "reference",
        f"{models} of {len(shares)}" if shares else "",
        *(_percent(share) for share in worst),
    ]


def _errors(compared: list[dict[str, Any]], scenes: list[str], titles: list[str]) -> Iterable[list[str]]:
    for name, title in zip(scenes, titles):
        for engine in compared:
            found = engine["scenes"][name]
            if found["outcome"] != "measured":
                yield [title, engine["name"], found["outcome"], "", "", "", "", ""]
                continue
            lengths = [_length(found[key]) for key in ("time_step_error_m", "model_error_m", "limit_error_m")]
            order = "" if found["time_step_order"] is None else f"{found['time_step_order']:.2f}"
            yield [title, engine["name"], _length(found["error_m"]), _percent(_share(found)), *lengths, order]


def _counts(engine: dict[str, Any]) -> list[str]:
    verdicts = [found["verdicts"] for found in engine["scenes"].values() if found["outcome"] == "measured"]
    stated = [[each[quantity] for each in verdicts if quantity in each] for quantity in QUANTITIES]
    return [engine["name"], *(f"{each.count('within')} of {len(each)}" for each in stated)]


def _advice(change: dict[str, Any]) -> list[str]:
    what, name = change["measured"]
    where = f"Path error on `{name}`" if what == "path" else f"{what}, {name}"
    before, after = (_value(change[side]) for side in ("before", "after"))
    known = change["after"].get("known")
    answer = "" if known is None else f"; the known answer is {_value({**change['after'], 'value': known})}"
    return _item(f"{change['engine']}: {change['change']}. {where}: {before} before, {after} after{answer}.")


def _value(found: dict[str, Any]) -> str:
    value, unit = found["value"], found["unit"]
    return _length(value, unit[1:], 4) if unit.startswith("m") else f"{value:.4g} {unit}".strip()


def _refusals(engine: dict[str, Any]) -> list[str]:
    tests = engine["conformance"]["tests"] if engine["conformance"] else []
    refused: dict[str, list[str]] = {}
    for name, found in [*((test["key"], test) for test in tests), *((f"`{name}`", found) for name, found in engine["scenes"].items())]:
        if found["outcome"] in ("refused", "failed"):
            why = found["why"].split("NotImplementedError: ")[-1]
            refused.setdefault(f"{found['outcome']} ({why})", []).append(name)
    return [line for why, names in refused.items() for line in _item(f"{engine['name']}: {why}: {', '.join(names)}.")]


def _other(found: dict[str, Any]) -> list[str]:
    return _item(
        f"`{found['scene']}`, {found['engine']}: the load's edge errs by {_length(found['error_m'])} on a path of {_length(found['path_length_m'])}. It "
        f"turns by {abs(found['heading_rad']):.3f} rad, the reference by {abs(found['reference_heading_rad']):.3f} rad."
    )


def _curves(cards: dict[str, Any], times: dict[str, Any]) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """CPU time (s) and path error (1) of each engine on each scene."""
    found: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for scene, of_engines in times.items():
        rows = {engine["name"]: {row["step_s"]: row for row in engine["steps"][scene]} for engine in cards["engines"]}
        length = next(row["path_length_m"] for steps in rows.values() for row in steps.values() if "path_length_m" in row)
        for name, points in of_engines.items():
            errors = [(point["cpu_s"], rows[name][point["step_s"]].get("error_m")) for point in points]
            found.setdefault(TITLES.get(scene, scene), {})[name] = [(cpu, error / length) for cpu, error in errors if error]
    return found


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.2g} %" if share < 0.1 else f"{100.0 * share:.0f} %"


def _length(value: float, per: str = "", digits: int = 3) -> str:
    for unit, scale in (("m", 1.0), ("mm", 1e3), ("µm", 1e6), ("nm", 1e9)):
        if abs(value) * scale >= 1.0 or unit == "nm":
            return f"{value * scale:.{digits}g} {unit}{per}" if abs(value) >= 5e-13 else f"0 {unit}{per}".replace("nm", "m")
    raise AssertionError("nm takes all")


def _text(text: str) -> str:
    return textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False)


def _item(text: str) -> list[str]:
    return textwrap.wrap(text, 100, initial_indent="- ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _table(head: list[str], rows: Iterable[list[str]]) -> list[str]:
    return [f"| {' | '.join(cells)} |" for cells in [head, ["---"] * len(head), *rows]]
