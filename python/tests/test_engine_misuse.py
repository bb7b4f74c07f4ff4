"""Engines that misbehave at random, in the interpreter and behind a pipe.

Each ends in an exception of a named type, or in code 1 with a message and without files; none in a
panic, and none without end. ``--misuses 500`` runs more of them.
"""

from __future__ import annotations

import itertools
import json
import math
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import PROGRAM

import cohaul
from cohaul.engines import Engine

SCENE = {
    "name": "short",
    "duration_s": 0.01,
    "control_period_s": 0.001,
    "seed": 1,
    "load": {"mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.1, 0.0]},
    "ground": {"friction_coefficient": 1.4, "gravity_m_per_s2": 9.81, "supports": {"tripod": {"radius_m": 0.008}}},
    "springs": [{"root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.01, "radial_stiffness_n_per_m": 0.664, "torsional_stiffness_nm_per_rad": 1e-6}] * 2,
    "obstacles": [{"name": "wall", "outline": {"polyline": {"points_m": [[-0.2, -0.1], [0.5, -0.1]]}}}],
    "drive": {
        "kind": "tips",
        "paths": [
            {"spring": 0, "waypoints": [[0.0, 0.01, 0.0], [0.01, 0.02, 0.0]]},
            {"spring": 1, "waypoints": [[0.002, 0.01, 0.0], [0.01, 0.01, 0.001]], "release_s": 0.006},
        ],
    },
}
CALLS = ["start", "attach", "release", "advance"]


class OfTheEngine(Exception):
    """An exception that only the engine knows."""


class Deep:
    def tolist(self):
        return [Deep()]


class Unprintable:
    def __str__(self):
        raise OfTheEngine("has no text")


def raising(error):
    def act(engine, answer):
        raise error

    return act


def endless(engine, answer):
    return endless(engine, answer)


def nested(depth):
    found = []
    for _ in range(depth):
        found = [found]
    return found


def with_key(key, value):
    return lambda engine, answer: {**answer, key: value}


def asking(*arguments):
    def act(engine, answer):
        engine.wrench(*arguments)
        raise OfTheEngine("asked")

    return act


NUMBERS = [math.nan, math.inf, -math.inf, 1e300, 10**400, -(10**5000), "1", None, True, [], {}, 1j, b"1", object(), np.nan, np.float32("inf"), "\udcff", "\x00"]
SEVEN = [0.0] * 7
STATES = [None, [], 0.0, "far", [0.0, 0.0], SEVEN, [[0.0, 0.0, 0.0]], {"x": 0.0}, np.zeros((3, 3)), np.zeros(2), np.array(["a"] * 3), np.array([object()] * 3), nested(10**5), nested(50), Deep(), Unprintable(), range(10**6), itertools.count(), (x for x in "abc"), {0.0, 1.0, 2.0}, np.array([1j] * 3), b"\xff\xfe\xfd"]
ERRORS = [ZeroDivisionError("by zero"), RuntimeError("\x00\udcff"), KeyError(), OSError(5, "no"), MemoryError(), StopIteration(3), SystemExit(3), OfTheEngine(), UnicodeDecodeError("utf-8", b"x", 0, 1, "no"), AssertionError, NotImplementedError("x" * 10**6), GeneratorExit("late")]


def misuse(rng: random.Random):
    """A method, when it misbehaves, how, and what that raises."""
    named = (ValueError, TypeError)
    kind = rng.choice(["raise", "raise", "endless", "answer", "pose", "pose", "number", "number", "key", "contact", "pulls", "wrap", "ask", "name"])
    after = rng.randrange(5)
    if kind == "raise":
        error = rng.choice(ERRORS)
        # An engine does not end the interpreter; every other exception reaches the caller.
        call = rng.choice(CALLS)
        kind_of = type(error) if isinstance(error, BaseException) else error
        return call, after if call == "advance" else 0, raising(error), RuntimeError if kind_of is SystemExit else kind_of
    if kind == "endless":
        return "advance", after, endless, RecursionError
    if kind == "answer":
        answer = rng.choice([None, 3, "pose", [1, 2], object(), b"x", np.zeros(3), [("pose",)], {"pose"}, {}, Ellipsis, type, lambda: 0])
        return "advance", after, lambda engine, _: answer, named
    if kind == "pose":
        key, state = rng.choice(["pose", "twist"]), rng.choice(STATES)
        if key == "twist" and state is None:
            state = 0.0
        return "advance", after, with_key(key, state), (*named, RecursionError)
    if kind == "number":
        key, number = rng.choice(["pose", "twist", "dissipated_j", "converged"]), rng.choice(NUMBERS)
        if key in ("dissipated_j", "converged"):
            number = "1" if number is None or number is True else number
            return "advance", after, with_key(key, number), named
        state = [0.0, 0.0, 0.0]
        state[rng.randrange(3)] = number
        return "advance", after, with_key(key, state), named
    if kind == "key":
        key = rng.choice(["Pose", "", "poses", "\x00", "\U0001f41c", (1, 2), 7, None, "forces", "x" * 500])
        return "advance", after, with_key(key, 0), named
    if kind == "contact":
        force = {"obstacle": 0, "point_m": [0.0, 0.0], "force_n": [0.0, 0.0]}
        wrong = rng.choice([{"obstacle": 1}, {"obstacle": -1}, {"obstacle": 0.5}, {"obstacle": 10**30}, {"point_m": [0.0]}, {"force_n": [math.nan, 0.0]}, {"force_n": None}, {"torque": 0}, {"force_n": [1e200, 0.0]}])
        contacts = rng.choice([[{**force, **wrong}], [force, {**force, **wrong}], [wrong], wrong, 3, [None]])
        return "advance", after, with_key("contacts", contacts), named
    if kind == "pulls":
        pulls = rng.choice([[], [None], [None] * 3, [[0.0, 0.0, 0.0]] * 2, [[math.inf, 0.0]] * 2, [0.0, 0.0], "ab", {"0": None}, [[1e300, 0.0]] * 2])
        return "advance", after, with_key("pulls_n", pulls), named
    if kind == "wrap":
        return "advance", 1 + after, with_key("pose", [0.0, 0.0, rng.choice([-1, 1]) * (2 * math.pi + rng.uniform(-0.1, 0.1))]), named
    if kind == "ask":
        arguments = rng.choice([(), ([0, 0, 0],), ([0.0], [0.0], 0.5), ("abc", "abc", 0.5), ([0, 0, 0], [0, 0, 0], None), (None, None, None), ([0, 0, 0], [0, 0, 0], "x"), ([1j] * 3, [0] * 3, 0.0), ([0, 0, 10**400], [0] * 3, 0.0), ([math.nan] * 3, [math.inf] * 3, math.nan), ([1e308] * 3, [1e308] * 3, 1e308), ([0, 0, 1e300], [0, 0, 0], -1e300), (np.zeros(3), np.zeros(3), np.float64(0.5)), (np.zeros((3, 1)), np.zeros(3), 0)])
        return "advance", after, asking(*arguments), (TypeError, ValueError, OverflowError, OfTheEngine)
    key = rng.choice(["name", "version"])
    word = rng.choice(["", " ", "x" * 41, "\n", "\x1b[2J", "quasi-static", "inertial", "\udcff", "\U0001f41c" * 11, "\u2028" * 20, b"pins", 5, ["a"], {}, Unprintable(), Deep()])
    if key == "version" and not isinstance(word, (str, Unprintable)):
        word = "\r"
    if key == "name" and isinstance(word, (list, dict)) and not word:
        word = "\x07"  # Without a name, the class names itself.
    if key == "name" and word == "":
        word = "\t"
    return key, 0, word, (*named, OfTheEngine, RecursionError)


def wild(seed: int):
    """A class that misbehaves once, and what that raises."""
    call, after, act, error = misuse(random.Random(seed))

    class Wild(Engine):
        name, version = "wild", "1"

        def start(self, scene, longest_step_s):
            self.pose, self.calls = scene["pose"], 0
            return self.turn("start", None)

        def attach(self, spring, tip_m):
            return self.turn("attach", None)

        def release(self, spring):
            return self.turn("release", None)

        def advance(self, tips_m, obstacles, duration_s, n_steps):
            self.calls += 1
            return self.turn("advance", {"pose": self.pose, "twist": [0.0, 0.0, 0.0]})

        def turn(self, now, answer):
            return act(self, answer) if now == call and (now != "advance" or self.calls > after) else answer

    if call in ("name", "version"):
        setattr(Wild, call, act)
    return Wild, error


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("misuse") / "short.json"
    path.write_text(json.dumps(SCENE))
    return path


def pytest_generate_tests(metafunc):
    if "seed" in metafunc.fixturenames:
        default = 100 if "interpreter" in metafunc.function.__name__ else 30
        metafunc.parametrize("seed", range(metafunc.config.getoption("--misuses") or default))


def test_the_scene_runs_with_an_engine_that_behaves(scene):
    class Tame(Engine):
        def start(self, scene, longest_step_s):
            self.pose = scene["pose"]

        def advance(self, tips_m, obstacles, duration_s, n_steps):
            return {"pose": np.array(self.pose), "twist": (0, 0, np.float32(0)), "contacts": [], "pulls_n": [None, None], "converged": np.True_}

    assert cohaul.compare(scene, engine=Tame).tiers["prescribed"]["engine"] == {"name": "engine"}


def test_misuse_in_the_interpreter(seed, scene):
    make, error = wild(seed)
    started = time.process_time()
    with pytest.raises(BaseException) as raised:
        cohaul.compare(scene, engine=make)
    assert issubclass(raised.type, error), (raised.type, str(raised.value)[:500], error)
    assert "panic" not in raised.type.__name__.lower()
    # A run takes a hundredth of this work; a message has no megabytes of the engine's own answer.
    assert time.process_time() - started < 5.0
    assert raised.type is NotImplementedError or len(str(raised.value)) < 1000, str(raised.value)[:2000]


SCRIPT = '''
import json, os, random, signal, sys, time
rng = random.Random(int(sys.argv[1]))
kind = rng.choice(["garbage", "utf8", "half", "huge", "closed", "code", "signal", "sleep", "twice", "early", "print", "deep", "kind", "nan", "ask", "newline", "empty", "surrogate", "crlf", "bom", "asks", "deaf"])
when = rng.choice(["start", "attach", "release", "advance"])
if len(sys.argv) > 2:
    kind, when = sys.argv[2:]
out = sys.stdout.buffer
GOOD = {"start": {"name": "wild"}, "advance": {"pose": [0.0, 0.0, 0.0]}}

def say(data):
    out.write(data if isinstance(data, bytes) else data.encode())
    out.flush()

def misbehave(line):
    good = json.dumps(GOOD.get(when, {}))
    if kind == "garbage":
        say(bytes(rng.randrange(1, 256) for _ in range(rng.randrange(1, 300))).replace(b"{", b"[") + b"\\n")
    elif kind == "utf8":
        say(b'{"name": "\\xff\\xfe"}\\n')
    elif kind == "half":
        say(good[: len(good) // 2])
        time.sleep(rng.choice([0, 0, 60]))
        sys.exit(0)
    elif kind == "huge":
        say(b"[" + b" " * (1 << 25))
        time.sleep(60)
    elif kind == "closed":
        out.close()
        os.close(1)
        time.sleep(rng.choice([0, 60]))
        os._exit(0)
    elif kind == "code":
        os._exit(rng.choice([0, 1, 2, 77, 255]))
    elif kind == "signal":
        os.kill(os.getpid(), rng.choice([signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT, signal.SIGTERM]))
    elif kind == "sleep":
        time.sleep(60)
    elif kind == "twice":
        say((good + "\\n") * 2)
    elif kind == "early":
        say('{"name": "wild"}\\n')
    elif kind == "print":
        say("step 1 of 10\\n" + good + "\\n")
    elif kind == "deep":
        say(rng.choice(["[", '{"pose":']) * rng.choice([200, 100000]) + "\\n")
    elif kind == "kind":
        say(rng.choice(["null", "3", "[]", '"pose"', '{"pose": null}', '{"pose": [0, 0]}', '{"pose": {"x": 0}}', '{"pose": [0,0,0], "pose": [1,1,1]}', '{"name": 3}', '{"name": "wild", "nom": 1}']) + "\\n")
    elif kind == "nan":
        say(rng.choice(['{"pose": [NaN, 0, 0]}', '{"pose": [1e999, 0, 0]}', '{"pose": [1e80, 0, 0]}', '{"pose": [0, 0, Infinity]}']) + "\\n")
    elif kind == "ask":
        say(rng.choice(['{"ask": "torque"}', '{"ask": "wrench"}', '{"ask": "wrench", "pose": [0, 0], "share": 0}', '{"ask": "wrench", "pose": [0, 0, 0], "share": 0, "x": 1}']) + "\\n")
    elif kind == "newline":
        say(good.replace(" ", "\\n") + "x\\n")
    elif kind == "empty":
        say("\\n" * rng.choice([1, 1000]))
    elif kind == "surrogate":
        say('{"name": "\\\\ud800"}\\n')
    elif kind == "crlf":
        say("\\r\\n")
    elif kind == "bom":
        say("\\ufeff" + good + "\\n")
    elif kind == "asks":
        while True:
            say('{"ask": "wrench", "pose": [0, 0, 0], "share": 0.5}\\n')
            sys.stdin.readline()
    elif kind == "deaf":
        while True:
            say('{"ask": "wrench", "pose": [0, 0, 0], "share": 0.5}\\n')

print(kind, when, file=sys.stderr, flush=True)
if kind == "early":
    misbehave("")
for line in iter(sys.stdin.readline, ""):
    call = json.loads(line)["call"]
    if call == when and kind != "early":
        misbehave(line)
    elif call == "end":
        sys.exit(0)
    else:
        say(json.dumps(GOOD.get(call, {})) + "\\n")
'''
# Waits for an answer end after this time (s).
PATIENCE = 1


def test_misuse_through_the_pipe(seed, scene, tmp_path):
    script = tmp_path / "wild.py"
    script.write_text(SCRIPT)
    ends_in_an_error(f"{sys.executable} -S {script} {seed}", scene, tmp_path)


def ends_in_an_error(engine, scene, tmp_path):
    """A comparison with this command ends in time, in code 1 with a message, and leaves nothing."""
    out = tmp_path / "out"
    command = [str(PROGRAM), "compare", str(scene), "--engine", engine, "--engine-timeout-s", str(PATIENCE), "--out", str(out), "--no-check-suggestions"]
    try:
        # Four runs wait for their answers, and each may take half a second to end.
        ran = subprocess.run(command, capture_output=True, timeout=15 * PATIENCE, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired as late:
        pytest.fail(f"no end: {late.stderr!r}")
    said = ran.stderr.decode(errors="replace")
    assert ran.returncode == 1, (ran.returncode, said)
    assert "panicked" not in said and "engine" in said, said
    assert not out.exists() and not list(tmp_path.glob("out*")), list(tmp_path.iterdir())


@pytest.mark.parametrize("kind, when", [("asks", "advance"), ("deaf", "advance"), ("kind", "attach"), ("ask", "attach")])
def test_misuse_of_a_kind(kind, when, scene, tmp_path):
    script = tmp_path / "wild.py"
    script.write_text(SCRIPT)
    ends_in_an_error(f"{sys.executable} -S {script} 0 {kind} {when}", scene, tmp_path)


def test_an_engine_that_answers_twice(tmp_path):
    """Without a grasp or release in between, each advance gets the state of the one before."""
    tips = {"kind": "tips", "paths": []}
    (tmp_path / "free.json").write_text(json.dumps({**SCENE, "springs": [], "obstacles": [], "drive": tips}))
    (tmp_path / "wild.py").write_text(SCRIPT)
    ends_in_an_error(f"{sys.executable} -S {tmp_path / 'wild.py'} 0 twice advance", tmp_path / "free.json", tmp_path)


def test_an_engine_that_closes_its_output(scene, tmp_path):
    (tmp_path / "wild.py").write_text("import os, sys, time; sys.stdin.readline(); os.close(1); time.sleep(60)")
    ends_in_an_error(f"exec {sys.executable} -S {tmp_path / 'wild.py'}", scene, tmp_path)


def test_what_an_engine_has_started_ends_with_it(scene, tmp_path):
    (tmp_path / "wild.py").write_text(SCRIPT)
    ends_in_an_error(f"sleep 71.25 & {sys.executable} -S {tmp_path / 'wild.py'} 0 code advance", scene, tmp_path)
    left = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout
    assert "sleep 71.25" not in left


def test_a_long_message_is_shortened(scene, tmp_path):
    (tmp_path / "wild.py").write_text("import json; input(); print(json.dumps({'name': 'wild', 'x' * 10**6: 1}), flush=True); input()")
    ran = subprocess.run([str(PROGRAM), "compare", str(scene), "--engine", f"{sys.executable} {tmp_path / 'wild.py'}"], capture_output=True)
    assert ran.returncode == 1 and len(ran.stderr) < 2000, ran.stderr[:300]


def test_engines_end_with_a_comparison_that_is_interrupted(scene, tmp_path):
    """An engine that does not come back to its input does not see that nobody asks."""
    (tmp_path / "wild.py").write_text("import time; input(); print('{\"name\": \"wild\"}', flush=True); input(); time.sleep(73.5)")
    command = [str(PROGRAM), "compare", str(scene), "--engine", f"{sys.executable} {tmp_path / 'wild.py'}"]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as running:
        time.sleep(2.0)
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=30) == 130
    left = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout
    assert str(tmp_path / "wild.py") not in left
