"""Results that travel to other processes and files: what their native part answers, as plain data.

A result that was pickled or copied has all numbers, texts, pages and files of the one that was
computed, to the bit. It holds them in place of the native part.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Callable

import numpy as np

VERSION = 1
"""Version of the form in which results travel."""


class Kept:
    """Answers of a native part by call and arguments."""

    __slots__ = ("answers",)

    def __init__(self, answers: dict[tuple[Any, ...], Any]) -> None:
        self.answers: dict[tuple[Any, ...], Any] = answers
        for answer in answers.values():
            if isinstance(answer, np.ndarray):
                answer.setflags(write=False)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("__") or all(call[0] != name for call in self.answers):
            raise AttributeError(name)
        return lambda *arguments: self._answer(name, *arguments)

    def _answer(self, *call: Any) -> Any:
        try:
            return self.answers[call]
        except KeyError:
            known = [", ".join(map(str, other[1:])) for other in self.answers if other[0] == call[0]]
            raise ValueError(f"{call[0]}: must be of {' or of '.join(known)}, found {', '.join(map(str, call[1:]))}") from None

    def write(self, folder: str, command: str) -> None:
        """Writes the files that were kept. Nothing is written if the folder has other ones."""
        files, place = self.answers[("write",)], Path(folder)
        others = sorted({path.name for path in place.iterdir()} - set(files)) if place.exists() else []
        if others:
            raise OSError(f"{folder}: must have no files but those of an earlier output, found {', '.join(others[:5])}")
        place.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (place / name).write_bytes(content)

    def __len__(self) -> int:
        return int(self.answers[("__len__",)])

    def __getstate__(self) -> dict[str, Any]:
        return {"version": VERSION, "answers": self.answers}

    def __setstate__(self, state: dict[str, Any]) -> None:
        if state.get("version") != VERSION:
            raise ValueError(f"version: must be {VERSION}, that of this package, found {state.get('version')}")
        Kept.__init__(self, state["answers"])


def kept(data: Any, *calls: tuple[Any, ...], command: str | None = None) -> Kept:
    """The answers to these calls; with the files that ``command`` writes unless that is ``None``."""
    if isinstance(data, Kept):
        return data
    answers = {call: getattr(data, call[0])(*call[1:]) for call in calls}
    if command is not None:
        answers[("write",)] = _files(data, command)
    return Kept(answers)


def kept_trace(data: Any) -> Kept:
    """The answers of a native trace."""
    if isinstance(data, Kept):
        return data
    found = kept(data, ("names",), ("events",), ("transitions",), ("__len__",))
    columns = {("column", name): np.array(data.column(name)) for name in data.names()}
    return Kept({**found.answers, **columns})


def _files(data: Any, command: str) -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as room:
        folder = os.path.join(room, "out")
        data.write(folder, command)
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}
