"""Types of results are those of real answers, and type checkers find mistakes by them."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
import typing
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, SCENES
from typed import Seen, members_of, misfits, spoilt

import cohaul
import cohaul.engines
from cohaul import results

JUMP, PULL, ROLL = SCENES / "analytic/release-jump.json", SCENES / "analytic/centre-pull.json", SCENES / "contact/disc-roll.json"
PUSHES, BLOCK = str(ROOT / "data/measured/pushes.csv"), ROOT / "data/measured/block.json"

# Promises of the types that these small scenes do not show. Sources must have them.
RARE = set("""
BaselineDivergence.agreed_until_s BaselineDivergence.expected BaselineDivergence.found BaselineDivergence.last_event
BaselineEvent.ant BaselineOptions.adapts_step BaselineOptions.rate_independent BaselineOptions.second_order
BaselineOptions.skips BaselineOptions.step_s BaselineOptions.tolerance CheckedBaseline.arrival_change
CheckedBaseline.status_change ClosedLoop.doubts ClosedLoop.n_seeds_needed ContactCounts.n_impacts_by_poisson
ContactCounts.n_impacts_without_law ContactCounts.n_not_unique DifferentDecision.expected
DifferentDecision.found Divergence.trigger FirstDifferentDecision.engine_s FirstDifferentDecision.quasi_static_s
Fit.on_check_m ImportPlace.time_s InertiaEstimate.is_negligible InertiaEstimate.largest MapCell.compared MapCell.failure
MeasuredFound.end_gap_m MeasuredQuestion.bound_m MeasuredQuestion.longest_gap_s MeasuredResults.bias
MeasuredResults.over_runs MeasuredResults.own_limit MeasuredRun.found MeasuredRun.left_out ModelError.mean_force_n
OverRuns.model_error_force_n Pathwise.doubts Pathwise.largest_pull_over_slip_limit Predicted.coasting_m
Predicted.estimated_m QuantityVerdict.open RunResults.time_to_nest_s RunSteps.doubts RunSteps.lost_share RunSteps.residual
RunSteps.unresolved_rad StepTotals.doubts StepTotals.gained_share StepTotals.lost_share StepTotals.swing_rad
StepTotals.unresolved_rad SuggestedChange.halvings SuggestedChange.tolerance_m ThresholdPoint.doubt ThresholdPoint.failure
Transition.is_uncertain TransitionCounts.n_uncertain_jumps Trigger.obstacle Trigger.support
""".split())


@pytest.fixture(scope="module")
def ants() -> cohaul.Scenario:
    return cohaul.Scenario(SCENES / "paper/four-ants-four-springs.json", duration_s=4.0)


def answers(ants: cohaul.Scenario) -> typing.Iterator[tuple[Any, Any]]:
    """Answers of all kinds, with their types."""
    for backend in cohaul.BACKENDS:
        for scene in (JUMP, ROLL, ants, SCENES / "contact/rebound.json"):
            run = cohaul.run(scene, backend)
            yield run.results, results.RunResults
            yield run.transitions, list[results.Transition]
        sim = cohaul.Simulation(ROLL, backend)
        sim.attach(0, sim.pose[:2])
        sim.advance([(0.01, 0.0)] * sim.n_springs, 0.1)
        yield sim.energy, results.SimulationEnergy
        yield sim.steps, results.StepTotals
    yield cohaul.run(JUMP, "inertial", tolerance_m=1e-6).results, results.RunResults
    yield cohaul.run(JUMP, rate_independent=True).results, results.RunResults
    yield cohaul.run(ROOT / "tests/common/tip-past-root.json").results, results.RunResults
    yield cohaul.run(ROOT / "tests/common/stiff-spring.json", "inertial", step_s=0.005).results, results.RunResults
    for found in comparisons(ants):
        yield found.results, results.ComparisonResults
    for options in ({"fit": ["side-friction", "ground-friction"]}, {"engine": None, "start": "recorded"}, {"uncertainty": (1e-4, 1e-3)}):
        yield cohaul.measured(PUSHES, BLOCK, **options).results, results.MeasuredResults
    yield from studies()
    yield cohaul.conformance("quasi-static").results, results.ConformanceResults
    yield cohaul.conformance("rapier", step_s=0.01).results, results.ConformanceResults
    recording, like = ROOT / "examples/recordings/table.csv", ROOT / "examples/recordings/ants.json"
    yield cohaul.import_scenario(recording, like, fps=50, bridge_s=0.001).account, results.ImportAccount


def studies() -> typing.Iterator[tuple[Any, Any]]:
    """Maps, thresholds and checks."""
    yield cohaul.compare_map(JUMP, {"load.mass_kg": "log:1e-4:1:3"}).results, results.MapResults
    yield cohaul.compare_map(JUMP, {"speed": [0.5, 1, 2]}, everywhere=True).results, results.MapResults
    yield cohaul.threshold(JUMP, "speed", (0.5, 2.0, 3)).results, results.ThresholdResults
    yield cohaul.threshold(SCENES / "contact/pusher.json", "inertia", (0.5, 2.0, 3), tolerance_m=1e-6).results, results.ThresholdResults
    with tempfile.TemporaryDirectory() as folder:
        for backend in ("quasi-static", "rapier"):
            cohaul.store_baseline(JUMP, folder, backend, name=backend)
        yield cohaul.check(folder).results, results.CheckResults
        yield cohaul.check(folder, "rapier", scenario=SCENES / "analytic/slide.json").results, results.CheckResults


def comparisons(ants: cohaul.Scenario) -> typing.Iterator[cohaul.Comparison]:
    damped = cohaul.Scenario(JUMP).to_dict()
    for spring in damped["springs"]:
        spring["damping_ratio"] = 0.5
    yield from (cohaul.compare(scene) for scene in (JUMP, ROLL, damped))
    yield cohaul.compare(damped, rate_independent=True, tolerance_heading_rad=0.1, tolerance_m=1e-6, step_s=1e-3)
    yield cohaul.compare(ants, seeds=2)
    still = {"step_s": 0.01, "engine": ["rapier", Still, Refusing], "beside": cohaul.run(PULL, "inertial").trace}
    yield cohaul.compare(cohaul.Scenario(PULL, duration_s=0.5), **still)
    measure = cohaul.Measure("final x", "m", lambda trace: trace["x_m"][-1])
    yield cohaul.compare_controller(SCENES / "analytic/centre-pull.json", tow, tiers="controlled", measure=measure)


class Still(cohaul.engines.Engine):
    """A load that nothing moves."""

    name = "still"

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        self.pose = scene["pose"]

    def advance(self, tips_m: Any, obstacles: Any, duration_s: float, n_steps: int) -> dict[str, Any]:
        return {"pose": self.pose}


class Refusing(Still):
    name = "refusing"

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        raise NotImplementedError("springs: not here")


def tow(seed: int) -> cohaul.Controller:
    def control(view: cohaul.View) -> cohaul.Tips:
        if view.time_s == 0.0:
            view.attach(0, (0.0, 0.0))
        return [(0.005 * (view.time_s + view.control_period_s), 0.0)]

    return control


@pytest.fixture(scope="module")
def looked_at(ants: cohaul.Scenario) -> tuple[list[tuple[Any, Any]], list[str], Seen]:
    seen, faults, all_answers = Seen(), [], list(answers(ants))
    for answer, kind in all_answers:
        faults += misfits(answer, kind, getattr(kind, "__name__", "list"), seen)
    return all_answers, faults, seen


def test_answers_have_the_keys_and_types_that_are_promised(looked_at: tuple[list[tuple[Any, Any]], list[str], Seen]) -> None:
    _, faults, seen = looked_at
    assert not faults, "\n".join(sorted(set(faults)))
    unconfirmed = {line.split(" ")[0]: line for line in seen.unconfirmed()}
    new = [line for name, line in unconfirmed.items() if name not in RARE]
    assert not new, "\n".join(sorted(new))
    assert not RARE - unconfirmed.keys(), "these answers show what was rare"


def test_rare_keys_stand_in_the_sources() -> None:
    folders = [ROOT / "src", *(ROOT / "crates").glob("*/src")]
    sources = "\n".join(path.read_text() for folder in folders for path in folder.rglob("*.rs"))
    for name in RARE:
        kind, key = name.split(".")
        may_be_none = type(None) in members_of(typing.get_type_hints(getattr(results, kind))[key])
        field, fact = (rf"\b{key}: Option<" if may_be_none else rf"\b{key}: "), rf'"(\w+\.)*{key}"'
        assert re.search(f"{field}|{fact}", sources), name


def test_each_fault_in_an_answer_is_found(looked_at: tuple[list[tuple[Any, Any]], list[str], Seen]) -> None:
    tried = set()
    optional = {key for other in looked_at[2].answers for key in other.__optional_keys__}
    for answer, kind in looked_at[0]:
        for what, wrong in spoilt(answer):
            if (str(kind), what) in tried:
                continue
            # A key that may be missing is no fault, nor one of the data.
            if re.search(rf"(\b({'|'.join(optional)})|closed_loop\.verdicts\.\w+|build\.\w+) missing$", what):
                continue
            # Values of a scenario may be anything.
            if re.search(r"scenario_changes\.\[0\]\.(stored|now)\.", what):
                continue
            assert any(misfits(wrong, kind)), what
            tried.add((str(kind), what))
    assert len(tried) > 3_000


KEYED = {
    cohaul.Run: results.RunResults, cohaul.Comparison: results.ComparisonResults, cohaul.Measured: results.MeasuredResults,
    cohaul.Conformance: results.ConformanceResults, cohaul.Map: results.MapResults, cohaul.Threshold: results.ThresholdResults,
    cohaul.Check: results.CheckResults,
}  # fmt: skip


@pytest.mark.skipif(sys.version_info < (3, 11), reason="overloads are not kept")
@pytest.mark.parametrize("kind", KEYED, ids=lambda kind: kind.__name__)
def test_keys_of_results_have_the_types_of_their_dicts(kind: type) -> None:
    names = {**vars(results), **vars(sys.modules[kind.__module__])}
    promised = {}
    for overload in typing.get_overloads(kind.__getitem__):
        hints = typing.get_type_hints(overload, names)
        promised |= dict.fromkeys(typing.get_args(hints["name"]), hints["return"])
    assert promised == typing.get_type_hints(KEYED[kind])


def test_keys_are_completed_in_notebooks() -> None:
    run = cohaul.run(JUMP)
    assert run._ipython_key_completions_() == list(run) and "final" in run._ipython_key_completions_()
    assert run.trace._ipython_key_completions_() == list(typing.get_args(results.TraceColumn)) == list(run.trace)
    assert "status" in cohaul.sweep(JUMP, {"load.mass_kg": [1e-3]})._ipython_key_completions_()


# Each line has one mistake, but for those that end with `ok`.
PLANTED = '''
import cohaul
from cohaul.results import QuantityVerdict

run = cohaul.run("scene.json", backend="inertial")  # ok
found = cohaul.compare("scene.json", tiers="replayed")  # ok
cohaul.run("scene.json", backend="inertal")
cohaul.run("scene.json", integrator="rk4")
cohaul.run("scene.json", rapier={"friktion": "box"})
cohaul.compare("scene.json", tiers="replay")
cohaul.compare("scene.json", tiers=["replayed", "closed"])
cohaul.compare("scene.json", tolerance_m="small")
cohaul.rollouts("scene.json", "rapier3d")
cohaul.Simulation("scene.json", "fast")
cohaul.conformance("havok")
x: float = run["final"]["position_m"][0]  # ok
run["finale"]
run["final"]["position"]
run["final"]["position_m"].real
run.energy["friction"]
run.final["heading_rad"].upper()
run.trace["x"]
run.trace["x_m"].upper()
cohaul.Scenario("scene.json", duration_s=2.0, load=cohaul.load(mass_kg=1.0, radius_m=0.1))  # ok
cohaul.Scenario("scene.json", duration=2.0)
cohaul.Scenario("scene.json", springs=[cohaul.spring(root_m=(0.0, 0.0), stiffness=2.0)])
cohaul.load(mass_kg="heavy", radius_m=0.1)
cohaul.ants(4, preset="papers")
cohaul.ants(4, nest_position_m=(0.2, -0.17))  # ok
post = cohaul.obstacle(name="post", outline={"disc": {"radius_m": 0.01}})  # ok
cohaul.Scenario("scene.json", obstacles=[post, cohaul.obstacle(name="wall", outline={"disk": {"radius_m": 0.01}})])
cohaul.ground(friction_coefficient=0.3, supports=[{"offset": (0.0, 0.0)}])
found["answers"]
found["answer"]["text"]
found.verdicts["path"]["verdict"] == "agree"  # ok
found.verdicts["paths"]
found.verdicts["path"]["effect"]
found.tiers["prescribed"]["engine"]["nom"]
verdict: QuantityVerdict = found.verdict
number: int = found.verdicts["path"]["tolerance"]
found.trace("rapier", tier="prescribd")
cohaul.compare_map("scene.json", {"load.mass_kg": [1e-3]}).shares("paths")
cohaul.compare_map("scene.json", {"load.mass_kg": 3})
cohaul.threshold("scene.json", "speed").bands("velocity")
cohaul.check("baselines")["n_agreed"]
'''
LINES = PLANTED.splitlines()
WRONG = [at for at, line in enumerate(LINES, 1) if at > 4 and not line.endswith("# ok")]


@pytest.fixture
def planted(tmp_path: Path) -> Path:
    (tmp_path / "planted.py").write_text(PLANTED)
    return tmp_path


def test_mypy_finds_the_planted_mistakes(planted: Path) -> None:
    pytest.importorskip("mypy")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(planted / "cache"), "planted.py"], cwd=planted, capture_output=True, text=True
    )
    found = sorted({int(line) for line in re.findall(r"^planted\.py:(\d+): error", done.stdout, re.M)})
    assert found == WRONG, done.stdout + done.stderr


@pytest.fixture
def pyright() -> list[str]:
    pytest.importorskip("pyright")
    command = [sys.executable, "-m", "pyright"]
    if shutil.which("node") is None or subprocess.run([*command, "--version"], capture_output=True).returncode:
        pytest.skip("pyright does not start here")
    return [*command, "--pythonpath", sys.executable]


def test_pyright_finds_the_planted_mistakes(planted: Path, pyright: list[str]) -> None:
    done = subprocess.run([*pyright, "--outputjson", "planted.py"], cwd=planted, capture_output=True, text=True)
    errors = [found for found in json.loads(done.stdout)["generalDiagnostics"] if found["severity"] == "error"]
    assert sorted({found["range"]["start"]["line"] + 1 for found in errors}) == WRONG, done.stdout


def test_types_of_the_package_are_known(tmp_path: Path, pyright: list[str]) -> None:
    done = subprocess.run([*pyright, "--verifytypes", "cohaul", "--ignoreexternal", "--outputjson"], cwd=tmp_path, capture_output=True, text=True)
    found = json.loads(done.stdout)["typeCompleteness"]
    unknown = [symbol["name"] for symbol in found["symbols"] if symbol["isExported"] and not symbol["isTypeKnown"]]
    assert found["completenessScore"] >= 0.99, unknown
