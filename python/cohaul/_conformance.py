"""Questions with closed answers, put to an engine."""

from __future__ import annotations

import html
import os
from typing import Any, Callable, Literal, Union, cast, overload

from . import _native
from ._kept import Kept, kept
from ._options import Progress, number, progress_of, whole
from ._run import Results
from .results import BackendName, ConformanceCounts, ConformanceResults, ConformanceTest, EngineName, Format, Grade


class Conformance(Results):
    """A finished conformance table. As a mapping it has what ``cohaul conformance --json`` prints, a
    :class:`ConformanceResults`."""

    _command = "cohaul.conformance"
    _data: Any

    def _kept(self) -> Kept:
        return kept(self._data, ("json",), ("text", False), ("markdown",), ("page", self._command), command=self._command)

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "line"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["engine"]) -> EngineName: ...
    @overload
    def __getitem__(self, name: Literal["step_s"]) -> float: ...
    @overload
    def __getitem__(self, name: Literal["counts"]) -> ConformanceCounts: ...
    @overload
    def __getitem__(self, name: Literal["tests"]) -> list[ConformanceTest]: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> ConformanceResults:
        """All results, as ``cohaul conformance --json`` prints them."""
        return cast(ConformanceResults, self._results)

    @property
    def text(self) -> str:
        """The table as text, as the program prints it."""
        text: str = self._data.text(False)
        return text

    @property
    def markdown(self) -> str:
        """The table as Markdown, to be kept beside an engine."""
        text: str = self._data.markdown()
        return text

    @property
    def html(self) -> str:
        """The page that ``cohaul conformance --out`` writes."""
        return self.report()

    @property
    def line(self) -> str:
        """The answer in one line, for the README of an engine."""
        return self["line"]

    @property
    def grades(self) -> dict[str, Union[Grade, Literal["answered", "refused", "failed"]]]:
        """Worst grade of each test by its key, or ``refused`` or ``failed``."""
        return {test["key"]: test["grade"] or test["outcome"] for test in self["tests"]}

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``cohaul conformance --out`` to a folder."""
        self._data.write(os.fspath(folder), self._command)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Conformance: {self.answer}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in ["test", "quantity", "known", "found", "error", "grade"])
        rows = "".join(_rows(test) for test in self["tests"])
        return f"<p>{html.escape(self.answer)}</p><table><tr>{head}</tr>{rows}</table>"


def _rows(test: ConformanceTest) -> str:
    title = f"{test['key']} {test['name']}"
    if not test["measures"]:
        return _row([title, "", "", "", "", f"{test['outcome']}: {test['why']}"])
    return "".join(
        _row([
            title,
            found["name"],
            f"{found['known']:.4g} {found['unit']}",
            f"{found['found']:.4g} {found['unit']}",
            f"{100.0 * found['relative_error']:.3g} %",
            found["grade"],
        ])
        for found in test["measures"]
    )


def _row(cells: list[str]) -> str:
    return "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"


def conformance(
    engine: BackendName | Callable[[], Any] = "rapier",
    *,
    step_s: float = 1e-3,
    threads: int | None = None,
    progress: Progress = None,
) -> Conformance:
    """Puts questions with closed answers to an engine, in steps of at most ``step_s`` (s).

    :param engine: ``'rapier'``, ``'inertial'``, ``'quasi-static'``, or the class of an engine of
        your own, as :mod:`cohaul.engines` describes it
    :param threads: number of threads; the default is one for each processor

    A scene that the engine refuses when it starts, and an exception later, is a row of the table.

    >>> conformance("inertial").grades["C1"]
    'exact'
    """
    is_own = not isinstance(engine, str)
    if is_own and not callable(engine):
        raise TypeError(f"engine: must be a name, or a class that makes an engine, found {type(engine).__name__}")
    step = number("step_s", step_s)
    n_threads = whole("threads", threads, 1, 1024)
    name, make = ("", engine) if callable(engine) else (engine, None)
    with progress_of(progress, "conformance") as show:
        return Conformance(_native.conformance(name, make, 1e-3 if step is None else step, n_threads, show))
