"""The fixture ``engine_verdict``: engines that pass, and what is said of those that fail."""

from __future__ import annotations

import importlib.metadata
import textwrap

import pytest
from conftest import ROOT

# An installed package names the plugin itself, and pytest takes it once.
IS_KNOWN = any(point.value == "cohaul.pytest_plugin" for point in importlib.metadata.entry_points(group="pytest11"))
PLUGIN = [] if IS_KNOWN else ["-p", "cohaul.pytest_plugin"]
ENGINES = f"""
    import math, sys
    import pytest
    from cohaul.engines import Engine

    sys.path.append({str(ROOT / "crates/engines/examples")!r})
    from pins import Pins

    SCENE = {str(ROOT / "scenarios/analytic/ramp-and-hold.json")!r}

    class Still(Engine):
        name = "still"
        def start(self, scene, longest_step_s):
            self.pose = scene["pose"]
        def advance(self, tips_m, obstacles, duration_s, n_steps):
            return {{"pose": self.pose}}
"""


def run(pytester: pytest.Pytester, test: str) -> pytest.RunResult:
    pytester.makepyfile(textwrap.dedent(ENGINES) + textwrap.dedent(test))
    # numpy is loaded once in a process.
    return pytester.runpytest_subprocess(*PLUGIN, "-p", "no:cacheprovider")


def test_an_engine_within_its_tolerances_passes(pytester: pytest.Pytester) -> None:
    # Pins errs by 54 % of the path: its friction points along K^-1 v.
    result = run(
        pytester,
        """
        def test_rapier(engine_verdict):
            found = engine_verdict(SCENE, speed=0.05)
            assert found.verdicts["path"]["tolerance"] > 0.0

        def test_pins(engine_verdict):
            assert engine_verdict(SCENE, Pins, path=0.7, step_s=1e-3).verdicts["path"]["engine"] == "within"

        def test_energy_that_an_engine_knows(engine_verdict):
            engine_verdict(SCENE, Pins, energy=0.5, pulls=0.1, step_s=1e-3)
        """,
    )
    result.assert_outcomes(passed=3)


def test_an_engine_beyond_a_tolerance_fails_with_answer_and_numbers(pytester: pytest.Pytester) -> None:
    result = run(
        pytester,
        """
        def test_default(engine_verdict):
            engine_verdict(SCENE, Pins, step_s=1e-3)

        def test_two(engine_verdict):
            engine_verdict(SCENE, Pins, path=0.02, heading=0.2, step_s=1e-3)

        def test_what_is_not_computed(engine_verdict):
            engine_verdict(SCENE, Still, path=2.0, energy=0.5, step_s=1e-3)

        def test_what_is_not_there(engine_verdict):
            engine_verdict(SCENE, Pins, contacts=0.5, step_s=1e-3)
        """,
    )
    result.assert_outcomes(failed=4)
    text = result.stdout.str()
    assert "The engine error of pins exceeds the tolerance" in text
    # 1 % and 2 % of the path of 12.96 mm, and the error of 7.06 mm of pivots on this scene.
    assert "path: engine error 0.00706" in text and "tolerance 0.0001296 m" in text and "tolerance 0.0002591 m" in text
    assert "heading: engine error 0.47" in text and "tolerance 0.2 rad" in text and "engine model 0.47" in text
    assert "energy: not compared" in text and "contacts: not compared" in text
    assert "pytest_plugin.py" not in text  # The reader's own line is shown, not one of the fixture.


def test_misuses_are_raised(pytester: pytest.Pytester) -> None:
    result = run(
        pytester,
        """
        def test_negative(engine_verdict):
            with pytest.raises(ValueError, match="tolerance"):
                engine_verdict(SCENE, Pins, path=-1.0)

        def test_two_tolerances_of_one_option(engine_verdict):
            with pytest.raises(ValueError, match="contacts: must have the tolerance of tolerance_pull_share"):
                engine_verdict(SCENE, Pins, pulls=0.1, contacts=0.2)

        def test_unknown_option(engine_verdict):
            with pytest.raises(TypeError, match="hedding"):
                engine_verdict(SCENE, Pins, hedding=0.1)

        def test_an_engine_that_raises(engine_verdict):
            with pytest.raises(NotImplementedError):
                engine_verdict(SCENE, Engine)
        """,
    )
    result.assert_outcomes(passed=4)
