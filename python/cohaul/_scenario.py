"""A scenario: one run as data."""

from __future__ import annotations

import difflib
import json
import os
import sys
from typing import Any, Literal, Mapping, Union

from . import _native
from ._errors import ScenarioError
from ._options import as_json, plain, whole
from .scenario import ScenarioKeys

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

Source = Union["Scenario", Mapping[str, Any], str, "os.PathLike[str]"]


SCENES: tuple[str, ...] = tuple(name for name, _ in _native.shipped())
"""Names of the scenes that come with the package, for :meth:`Scenario.shipped`."""


class Scenario:
    """A scenario that keeps all rules of the format. It does not change.

    ``source`` is a dict in the scenario format, the path of a JSON file, or another scenario.
    Keywords are keys of the format and replace those of the source. See also :func:`load`,
    :func:`ground`, :func:`spring`, :func:`obstacle`, :func:`tips` and :func:`ants`.

    Raises :class:`ScenarioError` with every fault, or ``OSError`` if the file cannot be read.

    >>> scenario = Scenario("scenarios/paper/four-ants-four-springs.json", duration_s=10.0)
    >>> scenario
    <Scenario 'four ants, four springs': 4 springs, ants, 10 s>
    >>> scenario.to_dict()["load"]["mass_kg"]
    0.0016
    >>> scenario.replace({"load.mass_kg": 0.002}).to_dict()["load"]["mass_kg"]
    0.002
    """

    __slots__ = ("_scene", "_written", "_file")

    def __init__(self, source: Source | None = None, /, **keys: Unpack[ScenarioKeys]) -> None:
        if source is not None and not isinstance(source, (Scenario, Mapping, str, os.PathLike)):
            raise TypeError(f"source: must be a dict, a path or a Scenario, found {type(source).__name__}")
        self._file = "scenario"
        self._written: dict[str, Any]
        if isinstance(source, Scenario):
            written, self._file = dict(source._written), source._file
        elif isinstance(source, Mapping):
            written = dict(source)
        elif source is None:
            written = {}
        else:
            self._file = os.fspath(source)
            with open(source, encoding="utf-8-sig") as file:
                try:
                    content = file.read()
                except UnicodeDecodeError as error:
                    raise ScenarioError(f"{self._file}: must be text in UTF-8: {error}") from None
            # The native reader names the place of an error, and keys that are given twice.
            self._scene = _native.Scene.parse(content, self._file)
            self._written = json.loads(content)
            if not keys:
                return
            written = self._written
        self._written = plain({**written, **keys}, self._file)
        self._scene = _native.Scene.parse(as_json(self._written), self._file)

    @classmethod
    def shipped(cls, name: str) -> Scenario:
        """A scene that comes with the package; :data:`SCENES` has the names of all.

        >>> Scenario.shipped("contact/pusher").name
        'disc pushed straight ahead by a post that moves 50 mm'
        """
        texts = dict(_native.shipped())
        if not isinstance(name, str) or name not in texts:
            near = difflib.get_close_matches(str(name), SCENES, 1)
            raise KeyError(f"name: must be one of cohaul.SCENES, found {name!r}" + "".join(f"; {other!r} is near" for other in near))
        return cls(json.loads(texts[name]))

    @property
    def name(self) -> str:
        """Name of the run, in a few words."""
        return self._scene.name

    @property
    def duration_s(self) -> float:
        """Longest simulated time (s)."""
        return self._scene.duration_s

    @property
    def control_period_s(self) -> float:
        """Time between two decisions and two rows of a trace (s)."""
        return self._scene.control_period_s

    @property
    def seed(self) -> int:
        """Seed of all random streams."""
        return self._scene.seed

    @property
    def n_springs(self) -> int:
        """Number of springs (1)."""
        return self._scene.n_springs

    @property
    def drive(self) -> Literal["tips", "ants"]:
        """What moves the tips: ``'tips'`` or ``'ants'``."""
        return self._scene.drive

    @property
    def radius_m(self) -> float:
        """Radius of the load's outline about its origin (m)."""
        return self._scene.radius_m

    @property
    def slip_limit_n(self) -> float:
        """Sum of the slip limits of all supports (N): no smaller pull moves the load straight."""
        return self._scene.slip_limit_n

    @property
    def warnings(self) -> list[str]:
        """Rules that are better kept, each with its place and what was found."""
        return self._scene.warnings()

    @property
    def sha256(self) -> str:
        """Hash of the scenario with all defaults, its seed included, in hexadecimal."""
        return self._scene.hash()

    def to_dict(self, *, expanded: bool = True) -> dict[str, Any]:
        """The scenario as a dict, with all defaults and short forms filled in, or as written."""
        found: dict[str, Any] = json.loads(self._scene.expanded() if expanded else as_json(self._written))
        return found

    def save(self, path: str | os.PathLike[str], *, expanded: bool = False) -> None:
        """Writes the scenario as JSON, as written or with all defaults filled in."""
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.to_dict(expanded=expanded), file, indent=2)
            file.write("\n")

    def replace(self, values: Mapping[str, Any] | None = None, /, **keys: Unpack[ScenarioKeys]) -> Scenario:
        """A scenario with other values at these paths, as ``{"springs[0].damping_ratio": 0.5}``.

        A path that the scenario as written does not have is set in the expanded one. Keywords are
        top-level keys.
        """
        written = json.loads(as_json(self._written))
        for path, value in (values or {}).items():
            if not _set(written, path, value):
                written = self.to_dict() if not values or len(values) == 1 else _expanded(written, self._file)
                if not _set(written, path, value):
                    raise KeyError(f"{path}: must be a place of the scenario as written or as expanded")
        changed = Scenario.__new__(Scenario)
        changed._file = self._file
        changed._written = plain({**written, **keys}, self._file)
        changed._scene = _native.Scene.parse(as_json(changed._written), self._file)
        return changed

    def with_seed(self, seed: int) -> Scenario:
        """The same scenario with another seed."""
        whole("seed", seed)
        return self.replace(seed=seed)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and self.sha256 == other.sha256 and self.name == other.name

    def __hash__(self) -> int:
        return hash((self.sha256, self.name))

    def __reduce__(self) -> tuple[type, tuple[dict[str, Any]]]:
        return Scenario, (self._written,)

    def __repr__(self) -> str:
        springs = "1 spring" if self.n_springs == 1 else f"{self.n_springs} springs"
        return f"<Scenario {self.name!r}: {springs}, {self.drive}, {self.duration_s:g} s>"


def as_scenario(source: Source) -> Scenario:
    """The scenario itself, or a new one from a dict or a file."""
    return source if isinstance(source, Scenario) else Scenario(source)


def _expanded(written: dict[str, Any], file: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(_native.Scene.parse(as_json(plain(written, file)), file).expanded())
    return found


def _set(data: Any, path: str, value: Any) -> bool:
    """Sets the value at a path that exists, and returns whether it does."""
    if not isinstance(path, str):
        raise TypeError(f"path: must be text, found {type(path).__name__}")
    steps: list[str | int] = []
    for part in path.split("."):
        key, *indices = part.replace("]", "").split("[")
        steps.append(key)
        if not all(index.isdecimal() for index in indices):
            raise KeyError(f"{path}: must be keys joined by points, with indices in brackets")
        steps.extend(int(index) for index in indices)
    for step in steps[:-1]:
        data = _at(data, step)
    if _at(data, steps[-1]) is None:
        return False
    data[steps[-1]] = value
    return True


def _at(data: Any, step: str | int) -> Any:
    if isinstance(step, str):
        return data.get(step) if isinstance(data, dict) else None
    return data[step] if isinstance(data, list) and step < len(data) else None
