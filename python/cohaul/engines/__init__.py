"""Engines of your own, which ``cohaul.compare`` puts in the place of rapier.

An engine is a class that moves the load. It gets the scene once and is asked to advance it, in SI
units and world axes; the origin of the load is its centre of mass, and headings turn
counter-clockwise and are not wrapped. This one is a load that slides without turning:

>>> import math
>>> class Slider(Engine):
...     name = "slider"
...     def start(self, scene, longest_step_s):
...         self.mass = scene["mass_kg"]
...         self.grip = sum(support["slip_limit_n"] for support in scene["supports"])
...         self.pose, self.twist = scene["pose"], scene["twist"]
...     def advance(self, tips_m, obstacles, duration_s, n_steps):
...         h = duration_s / n_steps
...         for step in range(n_steps):
...             fx, fy, _ = self.wrench(self.pose, self.twist, (step + 1) / n_steps)
...             u, v = self.twist[0] + h * fx / self.mass, self.twist[1] + h * fy / self.mass
...             speed = math.hypot(u, v)
...             left = max(0.0, 1.0 - h * self.grip / self.mass / speed) if speed > 0.0 else 0.0
...             self.twist = [left * u, left * v, 0.0]
...             self.pose = [self.pose[0] + h * self.twist[0], self.pose[1] + h * self.twist[1], self.pose[2]]
...         return {"pose": self.pose, "twist": self.twist}
>>> import cohaul
>>> found = cohaul.compare("scenarios/analytic/ramp-and-hold.json", engine=Slider, step_s=1e-3)
>>> found.verdicts["path"]["engine"], found.tiers["prescribed"]["engine"]["name"]
('within', 'slider')

The same class is a program for ``cohaul compare SCENE --engine CMD``, if its file ends with
``cohaul.engines.serve(Slider)``. This file needs nothing but Python.

Adapters for engines of others have a file each. They are imported when they are asked for, and need
the engine's own library, ``pip install cohaul[pymunk]``:

>>> sorted(ADAPTERS)
['Box2D', 'Box2DDefaults', 'Drake', 'DrakeDefaults', 'MuJoCo', 'MuJoCoDefaults', 'Pymunk', 'PymunkAlongSlip', 'PymunkDefaults']
"""

from __future__ import annotations

import collections.abc
import ctypes
import functools
import importlib
import json
import sys
import threading
import time
from typing import Any, Callable, Mapping, Sequence, Type

PATIENCE_S = 60.0
"""Longest time that an engine in the interpreter may take to answer (s). One that computes outside of
Python ends after its call only: as a command it is ended at once."""

Wrench = Callable[[Sequence[float], Sequence[float], float], Sequence[float]]

ADAPTERS = {
    "Box2D": "box2d",
    "Box2DDefaults": "box2d",
    "Drake": "drake",
    "DrakeDefaults": "drake",
    "MuJoCo": "mujoco",
    "MuJoCoDefaults": "mujoco",
    "Pymunk": "pymunk",
    "PymunkAlongSlip": "pymunk",
    "PymunkDefaults": "pymunk",
}
"""Adapters, and the file and extra of each."""


def __getattr__(name: str) -> Any:
    """An adapter, when it is asked for."""
    if name not in ADAPTERS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{ADAPTERS[name]}"), name)


class Engine:
    """Base of an engine: one object moves the load in one run."""

    name = "engine"
    """Name in every answer, figure and file."""
    version: str | None = None
    """Version of the engine, if it has one."""

    _ask: Wrench

    def start(self, scene: dict[str, Any], longest_step_s: float) -> None:
        """Begins a run of ``scene``, in steps of at most ``longest_step_s`` (s).

        An engine that lacks something that the scene has refuses it by ``NotImplementedError``.

        The scene has ``mass_kg``, ``inertia_kg_m2``, ``radius_m``, ``pose`` (m, m, rad) and ``twist``
        (m/s, m/s, rad/s) at the start, ``outline``, ``supports``, ``springs`` and ``obstacles``.
        """
        raise NotImplementedError

    def attach(self, spring: int, tip_m: Sequence[float]) -> None:
        """The tip of a free spring is attached at a place (m). Nothing by default."""

    def release(self, spring: int) -> None:
        """An attached spring is released. Nothing by default."""

    def advance(
        self,
        tips_m: Sequence[Sequence[float] | None],
        obstacles: Sequence[Sequence[float]],
        duration_s: float,
        n_steps: int,
    ) -> Mapping[str, Any]:
        """Moves the load, while tips and obstacles move straight to their targets.

        Returns the state at the end: ``pose`` (m, m, rad), and as far as the engine knows it
        ``twist`` (m/s, m/s, rad/s), ``pulls_n``, ``dissipated_j``, ``contacts`` and ``converged``.
        What is left out is not judged, but for the pulls, which follow from the spring law.
        """
        raise NotImplementedError

    def wrench(self, pose: Sequence[float], twist: Sequence[float], share: float) -> Sequence[float]:
        """Force (N, N) and torque (N m) of all attached springs on the load at a pose and a twist.

        The tips are where they are after this ``share`` (1) of the advance.
        """
        return self._ask(pose, twist, share)


class Session:
    """Answers requests, one JSON object a line, with engines from ``make``."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make
        self._engine: Any = None
        _watch()

    def asked(self, line: str, wrench: Wrench) -> str:
        """The answer to a request in the interpreter, which has to come in time."""
        thread = threading.get_ident()
        _asked[thread] = time.monotonic()
        try:
            return self.exchange(line, wrench)
        except Late:
            raise TimeoutError(f"{self._name()}: must answer within {PATIENCE_S} s") from None
        except SystemExit as error:
            raise RuntimeError(f"{self._name()}: must not end the interpreter, found SystemExit: {error}") from error
        finally:
            _asked.pop(thread, None)

    def _name(self) -> str:
        return getattr(self._engine, "name", None) or type(self._engine).__name__

    def exchange(self, line: str, wrench: Wrench) -> str:
        """The answer to a request, for which ``wrench`` gives that of the springs."""
        request = json.loads(line)
        call = request.pop("call")
        answer: Any = {}
        if call == "start":
            self._engine = self._make()
            self._engine._ask = wrench
            version = getattr(self._engine, "version", None)
            answer = {"name": self._name()}
            if version is not None:
                answer["version"] = str(version)
            try:
                self._engine.start(request["scene"], request["longest_step_s"])
            except NotImplementedError as error:
                answer["refused"] = str(error) or "start is not implemented"
        elif call == "end":
            self._engine = None
        else:
            found = getattr(self._engine, call)(**request)
            answer = dict(found) if call == "advance" else {}
        return json.dumps(answer, allow_nan=False, default=_plain)


class Late(BaseException):
    """An engine in the interpreter has not answered in time, which nothing of it may catch."""


_asked: dict[int, float] = {}
"""Threads in which an engine is asked, and since when (s)."""


@functools.cache
def _watch() -> threading.Thread:
    """The thread that ends engines which do not answer, as soon as they execute Python again."""

    def watch() -> None:
        while True:
            time.sleep(PATIENCE_S / 60.0)
            for thread, since in list(_asked.items()):
                # An engine may catch everything: it is told again until it ends.
                if time.monotonic() - since > PATIENCE_S and thread in _asked:
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(Late))

    watcher = threading.Thread(target=watch, name="cohaul.engines", daemon=True)
    watcher.start()
    return watcher


def _plain(value: Any) -> Any:
    """Numbers and arrays of numpy, and other sequences, as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, collections.abc.Sequence) and not isinstance(value, (bytes, bytearray, memoryview)):
        return list(value)
    # What is read once may have no end.
    raise TypeError(f"answer: must consist of numbers, texts, lists and arrays, found {type(value).__name__}")


def serve(make: Type[Engine] | Callable[[], Any]) -> None:
    """Answers the requests of ``cohaul compare SCENE --engine CMD`` on standard input and output.

    What the engine prints goes to standard error.
    """
    lines, answers = sys.stdin, sys.stdout
    sys.stdout = sys.stderr
    session = Session(make)

    def say(text: str) -> None:
        answers.write(text + "\n")
        answers.flush()

    def wrench(pose: Sequence[float], twist: Sequence[float], share: float) -> Sequence[float]:
        say(json.dumps({"ask": "wrench", "pose": list(pose), "twist": list(twist), "share": share}, default=_plain))
        found: Sequence[float] = json.loads(lines.readline())["wrench"]
        return found

    for line in iter(lines.readline, ""):
        say(session.exchange(line, wrench))
        if '"call":"end"' in line:
            return
