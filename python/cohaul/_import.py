"""Scenarios from recordings and drawings."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any, Callable, Literal, Mapping, Sequence, get_args

from . import _native
from ._options import as_json, number, plain, text, whole
from ._scenario import Scenario, Source
from .results import ImportAccount

TrackFormat = Literal["table", "deeplabcut", "sleap", "idtracker", "trex", "tracktor", "swistrack"]
"""Program that writes tracks."""
FORMATS: tuple[TrackFormat, ...] = get_args(TrackFormat)
"""Programs that write tracks."""


class Import:
    """A scenario that was imported, and an account of what was done."""

    def __init__(self, found: _native.Import) -> None:
        self.scenario: Scenario = Scenario(json.loads(found.scenario))
        """The scenario."""
        self.account: ImportAccount = json.loads(found.json())
        """What ``cohaul scenario import --json`` prints: each kind of change with its number, its
        largest size and its bound."""
        self.tracks_csv: str | None = found.tracks
        """All tracks in SI units as CSV, which can be imported again; ``None`` for a drawing."""
        self.tips_csv: str | None = found.tips
        """Tips and load as CSV, which ``cohaul calibrate`` reads; ``None`` for a drawing."""
        self._text = found.text()

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Import of {', '.join(self.account['files'])}: {self.scenario!r}>"


def import_scenario(
    files: Any,
    like: Source | None = None,
    *,
    format: TrackFormat | None = None,
    name: str | None = None,
    duration_s: float | None = None,
    fps: float | None = None,
    scale_m: float | None = None,
    y: Literal["up", "down"] | None = None,
    headings: Literal["radians", "degrees"] | None = None,
    min_confidence: float | None = None,
    start_s: float | None = None,
    origin_m: Sequence[float] | None = None,
    bridge_s: float | None = None,
    max_jump_m: float | None = None,
    smooth_m: float | None = None,
    spring: Mapping[str, int] | None = None,
    load: str | Sequence[str] | None = None,
    obstacle: Mapping[str, str] | None = None,
    tolerance_m: float | None = None,
    body: str | None = None,
    y_up: bool = False,
    onto: str | None = None,
) -> Import:
    """Makes a scenario of tracks or of a drawing, as ``cohaul scenario import`` does.

    :param files: a file of tracks or a drawing, a list of files of tracks, or a data frame with
        ``to_csv``; or a scenario file whose outlines break a rule, without ``like``
    :param like: scenario with the load, the ground, the springs and the obstacles
    :param format: program that has written the tracks, as ``'deeplabcut'``; the default follows
        from their first lines
    :param fps: frames per second, where the files count frames
    :param scale_m: length of a pixel, or of a unit without a name (m)
    :param y: direction of the y axis, ``'up'`` or ``'down'``
    :param headings: unit of headings, ``'radians'`` or ``'degrees'``
    :param min_confidence: smallest confidence of a place that counts, from 0 to 1
    :param start_s: time of the files that becomes 0 (s)
    :param origin_m: place of the recording that becomes the origin (m, y up)
    :param bridge_s: longest gap in which a tip stays attached (s)
    :param max_jump_m: longest step from frame to frame (m)
    :param smooth_m: largest distance by which a tip is moved by smoothing (m)
    :param spring: index of the spring on whose tip a track is, by the name of the track
    :param load: the track of the load, or two marks, rear and front
    :param obstacle: name of the obstacle that a track moves, by the name of the track
    :param tolerance_m: largest distance of straight lines from a curve of a drawing (m)
    :param body: body of an MJCF model
    :param y_up: take the y axis of an OBJ mesh for up, not z
    :param onto: obstacle that gets the outline of a drawing, in place of the load

    Raises :class:`ScenarioError` with every fault, or ``OSError`` if a file cannot be read.

    >>> found = import_scenario("examples/recordings/table.csv", "examples/recordings/ants.json", fps=50)
    >>> found.scenario.drive, found.account["source"]
    ('tips', 'table')
    """
    units = {
        "fps": number("fps", fps),
        "scale": number("scale_m", scale_m),
        "y_down": _choice("y", y, ("up", "down")),
        "degrees": _choice("headings", headings, ("radians", "degrees")),
        "min_confidence": number("min_confidence", min_confidence, positive=False),
        "start": number("start_s", start_s, positive=False),
        "origin": _origin(origin_m),
    }
    roles = {
        "springs": _pairs("spring", spring, lambda path, index: whole(path, index, 0, 10**9)),
        "load": _marks(load),
        "obstacles": _pairs("obstacle", obstacle, _word),
    }
    if format is not None and format not in FORMATS:
        raise ValueError(f"format: must be one of {', '.join(FORMATS)}, found {format!r}")
    if not isinstance(y_up, bool):
        raise TypeError(f"y_up: must be True or False, found {type(y_up).__name__}")
    asked = {
        "format": format,
        "name": _word("name", name),
        "duration_s": number("duration_s", duration_s),
        "units": units,
        "bounds": {
            "bridge": 0.0 if bridge_s == 0 else number("bridge_s", bridge_s),
            "jump": number("max_jump_m", max_jump_m),
            "smooth": number("smooth_m", smooth_m),
        },
        "roles": roles,
        "tolerance_m": number("tolerance_m", tolerance_m),
        "body": _word("body", body),
        "y_up": y_up,
        "onto": _word("onto", onto),
    }
    return Import(_native.import_scenario(_contents(files), None if like is None else _scene("like", like), as_json(asked)))


def _choice(path: str, value: str | None, words: tuple[str, str]) -> bool | None:
    """Whether the value is the second word."""
    if value is not None and value not in words:
        raise ValueError(f"{path}: must be {words[0]!r} or {words[1]!r}, found {value!r}")
    return None if value is None else value == words[1]


def _word(path: str, value: Any) -> str | None:
    """Text that can be written, or ``None`` as it is."""
    found = text(path, value)
    if found is not None and any("\ud800" <= letter <= "\udfff" for letter in found):
        raise ValueError(f"{path}: must be text in Unicode, found {found!r}")
    return found


def _pairs(path: str, given: Any, of: Callable[[str, Any], Any]) -> list[tuple[str, Any]]:
    """Names of tracks with what each is."""
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise TypeError(f"{path}: must be a dict by the names of tracks, found {type(given).__name__}")
    found = []
    for track, value in given.items():
        if _word(f"{path}: name of a track", track) is None or value is None:
            raise TypeError(f"{path}: must have a name and a value for each track, found {track!r}: {value!r}")
        found.append((track, of(f"{path}[{track!r}]", value)))
    return found


def _marks(load: Any) -> list[str]:
    marks = [] if load is None else [load] if isinstance(load, (str, bytes)) else load
    if not isinstance(marks, (list, tuple)) or not all(isinstance(mark, str) for mark in marks):
        raise TypeError(f"load: must be the name of a track, or two of them, found {load!r}")
    return [_word("load", mark) or "" for mark in marks]


def _origin(origin: Any) -> list[float] | None:
    if origin is None:
        return None
    try:
        found = [float(one) for one in origin]
    except (TypeError, ValueError, OverflowError):
        found = []
    if len(found) != 2 or not all(math.isfinite(one) for one in found):
        raise ValueError(f"origin_m: must be two finite numbers (x, y), found {origin!r}")
    return found


def _contents(files: Any) -> list[tuple[str, bytes]]:
    """Name and content of each file."""
    if hasattr(files, "to_csv"):
        return [("data frame", files.to_csv(index=False).encode())]
    if hasattr(files, "write_csv"):
        return [("data frame", files.write_csv().encode())]
    if isinstance(files, (Scenario, Mapping)):
        return [_scene("files", files)]
    if not isinstance(files, (str, os.PathLike, list, tuple)):
        raise TypeError(f"files: must be a path, a list of paths or a data frame, found {type(files).__name__}")
    paths = [files] if isinstance(files, (str, os.PathLike)) else files
    if not paths:
        raise ValueError("files: must be at least one file, found none")
    return [_file("files", path) for path in paths]


def _file(argument: str, path: Any) -> tuple[str, bytes]:
    if not isinstance(path, (str, os.PathLike)) or os.fspath(path) in ("", b""):
        raise TypeError(f"{argument}: must be a path, found {path!r}")
    return os.fspath(path), Path(path).read_bytes()


def _scene(argument: str, source: Any) -> tuple[str, bytes]:
    """A scenario as text, which may break rules where a drawing replaces an outline."""
    if isinstance(source, Mapping):
        return argument, as_json(plain(dict(source), argument)).encode()
    if isinstance(source, Scenario):
        return source.name, as_json(source.to_dict()).encode()
    return _file(argument, source)
