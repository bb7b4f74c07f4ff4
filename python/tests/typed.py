"""Answers against their types: which keys are there, and what their values are."""

from __future__ import annotations

import types
import typing
from typing import Any, Iterator, Union, is_typeddict

NONE = type(None)


class Seen:
    """What the answers showed of each type: keys that were there or not, and members of unions."""

    def __init__(self) -> None:
        self.answers: dict[type, int] = {}
        self.keys: dict[tuple[type, str], int] = {}
        self.members: dict[tuple[type, str], set[str]] = {}

    def unconfirmed(self) -> Iterator[str]:
        """Promises of the types that no answer has shown to be needed."""
        for kind, n in self.answers.items():
            for key, hint in typing.get_type_hints(kind).items():
                n_there = self.keys.get((kind, key), 0)
                if n_there == 0:
                    yield f"{kind.__name__}.{key} is in no answer"
                elif key in kind.__optional_keys__ and n_there == n:
                    yield f"{kind.__name__}.{key} is in every answer"
                else:
                    unseen = {name_of(member) for member in members_of(hint)} - self.members[kind, key]
                    yield from (f"{kind.__name__}.{key} is never {member}" for member in sorted(unseen))


def members_of(hint: Any) -> tuple[Any, ...]:
    """The members of a union, or the type itself."""
    return typing.get_args(hint) if typing.get_origin(hint) in (Union, types.UnionType) else (hint,)


def name_of(member: Any) -> str:
    return "None" if member is NONE else "a value"


def misfits(value: Any, hint: Any, path: str = "", seen: Seen | None = None) -> Iterator[str]:
    """Places where a value is not what its type promises."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        fits = [member for member in arguments if not list(misfits(value, member, path))]
        if fits:
            yield from misfits(value, fits[0], path, seen)
        else:
            member = next((member for member in arguments if member is not NONE), NONE)
            yield from misfits(value, member, path) if value is not None else iter([f"{path}: is None"])
    elif is_typeddict(hint):
        yield from _of_keys(value, hint, path, seen)
    elif origin is typing.Literal:
        if value not in arguments or not isinstance(value, str):
            yield f"{path}: is {value!r}, not one of {arguments}"
    elif origin is list:
        if type(value) is not list:
            yield f"{path}: is a {type(value).__name__}, not a list"
            return
        for at, entry in enumerate(value):
            yield from misfits(entry, arguments[0], f"{path}[{at}]", seen)
    elif origin is dict:
        if type(value) is not dict:
            yield f"{path}: is a {type(value).__name__}, not a dict"
            return
        for key, entry in value.items():
            yield from misfits(entry, arguments[1], f"{path}.{key}", seen)
    elif hint is Any:
        return
    elif hint in (float, int, str, bool, NONE):
        if type(value) is not hint:
            yield f"{path}: is a {type(value).__name__}, not a {hint.__name__}"
    else:
        raise TypeError(f"{path}: no rule for {hint}")


def _of_keys(value: Any, kind: Any, path: str, seen: Seen | None) -> Iterator[str]:
    if type(value) is not dict:
        yield f"{path}: is a {type(value).__name__}, not a dict"
        return
    hints = typing.get_type_hints(kind)
    yield from (f"{path}.{key}: is missing" for key in kind.__required_keys__ - value.keys())
    yield from (f"{path}.{key}: is unknown" for key in value.keys() - hints.keys())
    if seen is not None:
        seen.answers[kind] = seen.answers.get(kind, 0) + 1
    for key in value.keys() & hints.keys():
        if seen is not None:
            seen.keys[kind, key] = seen.keys.get((kind, key), 0) + 1
            seen.members.setdefault((kind, key), set()).add("None" if value[key] is None else "a value")
        yield from misfits(value[key], hints[key], f"{path}.{key}", seen)


def spoilt(value: Any) -> Iterator[tuple[str, Any]]:
    """Copies of an answer with one fault each: a key missing, added, or a value of another type."""
    if isinstance(value, dict):
        yield "added", {**value, "no_such_key": 1.0}
        for key, entry in value.items():
            yield f"{key} missing", {other: kept for other, kept in value.items() if other != key}
            for what, changed in spoilt(entry):
                yield f"{key}.{what}", {**value, key: changed}
    elif isinstance(value, list):
        yield "a dict", {}
        for what, changed in spoilt(value[0]) if value else ():
            yield f"[0].{what}", [changed, *value[1:]]
    else:
        yield "another type", ()
        if value is not None:
            yield "a truth", 1 if isinstance(value, bool) else True
