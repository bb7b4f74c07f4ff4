"""Options as JSON for the native part, and the checks of plain numbers."""

from __future__ import annotations

import json
import math
import numbers
import os
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Mapping, Sequence, Union

from ._errors import Fault, ScenarioError
from .results import BackendName, Integrator, RapierOptions, SkipName

Progress = Union[bool, Callable[[float], object], None]
"""Whether a bar is shown, or a function of the fraction done (1)."""
NoSkip = Union[SkipName, Sequence[SkipName], None]
"""Work that is not skipped, although its outcome is known."""

DEEPEST = 64
"""Deepest level of a scenario (1): deeper data is a mistake, as a list in itself."""


def number(path: str, value: Any, *, positive: bool = True) -> float | None:
    """The value as a float, or ``None`` as it is."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{path}: must be a number, found {type(value).__name__}")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found) or (positive and found <= 0.0):
        rule = "must be a positive finite number" if positive else "must be a finite number"
        raise ValueError(f"{path}: {rule}, found {found}")
    return found


def whole(path: str, value: Any, least: int = 0, most: int = 2**64 - 1) -> int | None:
    """The value as an integer, or ``None`` as it is."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{path}: must be a whole number, found {type(value).__name__}")
    if not least <= int(value) <= most:
        raise ValueError(f"{path}: must be from {least} to {most}, found {int(value)}")
    return int(value)


def text(path: str, value: Any) -> str | None:
    """The value if it is text, or ``None`` as it is."""
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{path}: must be text, found {type(value).__name__}")
    return value


def texts(path: str, value: str | Sequence[str] | None) -> list[str]:
    """A list of words from one word, a list of them, or ``None``."""
    if value is None:
        return []
    words = [value] if isinstance(value, str) else list(value)
    for word in words:
        text(path, word)
    return words


def rapier_options(options: RapierOptions | None) -> dict[str, str]:
    """Options of rapier: ``friction``, ``springs``, ``precision`` and ``settings``."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise TypeError(f"rapier: must be a dict, found {type(options).__name__}")
    return {str(name): str(value) for name, value in options.items()}


def backend_options(
    backend: BackendName,
    step_s: float | None = None,
    tolerance_m: float | None = None,
    tolerance_rad: float | None = None,
    integrator: Integrator | None = None,
    second_order: bool = False,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    rapier: RapierOptions | None = None,
) -> dict[str, Any]:
    """Options of a run, without those that are not given."""
    found = {
        "backend": text("backend", backend),
        "step_s": number("step_s", step_s),
        "tolerance_m": number("tolerance_m", tolerance_m),
        "tolerance_rad": number("tolerance_rad", tolerance_rad),
        "integrator": text("integrator", integrator),
        "second_order": bool(second_order),
        "rate_independent": bool(rate_independent),
        "no_skip": texts("no_skip", no_skip),
        "rapier": rapier_options(rapier),
    }
    return {name: value for name, value in found.items() if value is not None}


def plain(value: Any, file: str) -> Any:
    """The value as JSON can hold it: numpy's numbers and arrays become numbers and lists."""
    faults: list[Fault] = []
    found = _plain(value, "", faults, 0)
    if faults:
        lines = (f"{file}: {fault.path}: {fault.rule}, found {fault.value}" for fault in faults)
        raise ScenarioError("\n".join(lines), faults)
    return found


def _plain(value: Any, path: str, faults: list[Fault], depth: int) -> Any:
    if hasattr(value, "tolist") and not isinstance(value, type):
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        faults.append(Fault(path, "must be a finite number", str(value)))
        return None
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if depth >= DEEPEST:
        faults.append(Fault(path, f"must be at most {DEEPEST} levels deep", "more"))
        return None
    if isinstance(value, Mapping):
        found = {}
        for key, entry in value.items():
            if not isinstance(key, str):
                faults.append(Fault(path, "must have text as keys", repr(key)[:100]))
                continue
            found[key] = _plain(entry, f"{path}.{key}" if path else key, faults, depth + 1)
        return found
    if isinstance(value, (list, tuple)):
        return [_plain(entry, f"{path}[{at}]", faults, depth + 1) for at, entry in enumerate(value)]
    faults.append(Fault(path, "must be a number, text, a list or a dict", type(value).__name__))
    return None


def as_json(value: Any) -> str:
    """The value as JSON; its numbers are finite."""
    return json.dumps(value, allow_nan=False)


@contextmanager
def progress_of(progress: Progress, label: str) -> Iterator[Callable[[float], object] | None]:
    """What is called with the fraction done (1), which never falls and ends with 1 if the work does.

    ``True`` shows a bar of tqdm if it is installed, ``None`` does so if ``COHAUL_PROGRESS`` is set,
    and a function is called with the fraction done.
    """
    show, end = _shown_by(progress, label)
    if show is None:
        yield None
        return
    last = 0.0

    def rising(share: float) -> object:
        nonlocal last
        last = max(last, min(share, 1.0))
        return show(last)

    try:
        yield rising
        show(1.0)
    finally:
        end()


def _shown_by(progress: Progress, label: str) -> tuple[Callable[[float], object] | None, Callable[[], object]]:
    """What shows the fraction done, and what ends that."""
    if progress is not None and not isinstance(progress, bool):
        if not callable(progress):
            raise TypeError(f"progress: must be True, False or a function, found {type(progress).__name__}")
        return progress, lambda: None
    if not (progress or (progress is None and os.environ.get("COHAUL_PROGRESS"))):
        return None, lambda: None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None, lambda: None
    bar = tqdm(total=1.0, desc=label, bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed} < {remaining}")

    def show(share: float) -> None:
        bar.n = share
        bar.refresh()

    return show, bar.close
