"""Writes what follows from other files: `python python/api.py`.

These are the types of the parts of a scenario, from the schema of the format, and the pages of the
book on the Python package, from its sources. Signatures and docstrings are read from the files and
the stubs, without importing them.
"""

from __future__ import annotations

import ast
import json
import re
import textwrap
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "python/cohaul"
PAGES = ROOT / "docs/src/reference"
WIDTH = 100

Definition = ast.ClassDef | ast.FunctionDef

INTRODUCTION = """# Python package

All that `import cohaul` has, in the order of its name: each function and class with its signature
and what its source says of it. [Python](../python.md) shows how they are used, and
[Python results](python-results.md) has the types of the answers. `python python/api.py` writes
these pages, and a test compares them with the sources."""

RESULTS = """# Python results

The answers of `cohaul.run`, `cohaul.compare` and other functions are dicts. Type checkers know
which keys they have by these types of the module `cohaul.results`, and tests hold them against real
answers. Keys end in their units."""


SCENARIO = '''"""Types of the parts of a scenario, for type checkers, completion and documentation.

All are dicts in the format of scenarios. `python python/api.py` writes this file from the schema of
the format; the book's page on scenario keys has the rules and the defaults.

>>> from cohaul.scenario import Obstacle
>>> wall: Obstacle = {"name": "wall", "outline": {"polyline": {"points_m": [[0.1, -1.0], [0.1, 1.0]]}}}
"""

from __future__ import annotations

import sys
from typing import Literal, Sequence, Union

if sys.version_info >= (3, 11):
    from typing import NotRequired, TypedDict
else:
    from typing_extensions import NotRequired, TypedDict
'''

# Parts whose keys are keywords of functions, which give some of them themselves.
KEYWORDS = ("Scenario", "Load", "Ground", "Spring", "Obstacle", "Ants")


def main() -> None:
    (PACKAGE / "scenario.py").write_text(scenario_types(), encoding="utf-8")
    for name, text in pages().items():
        (PAGES / name).write_text(text, encoding="utf-8")


def scenario_types() -> str:
    """Text of the module of the parts of a scenario."""
    schema = json.loads((PAGES / "scenario.schema.json").read_text(encoding="utf-8"))
    defined = {name.removesuffix("Entry"): part for name, part in [("Scenario", schema), *schema["$defs"].items()]}
    dicts = {name: part for name, part in defined.items() if "properties" in part}
    # Unions are no annotations: what they name stands before them.
    unions = [f"{name} = {hint(part)}\n{documented(part)}" for name, part in defined.items() if name not in dicts]
    return "\n\n".join([SCENARIO, *(typed_dict(name, part) for name, part in dicts.items())]) + "\n\n" + "\n".join(unions)


def typed_dict(name: str, part: dict[str, Any]) -> str:
    is_keywords = name in KEYWORDS
    head = f"class {name}Keys" if name == "Scenario" else f"class {name}"
    lines = [f"{head}(TypedDict{', total=False' if is_keywords else ''}):\n{documented(part, '    ')}"]
    for key, value in part["properties"].items():
        if key.isidentifier():
            is_given = is_keywords or key in part.get("required", ())
            lines.append(f"    {key}: {hint(value) if is_given else f'NotRequired[{hint(value)}]'}\n{documented(value, '    ')}")
    return "\n".join(lines).replace("\n\n", "\n")


def hint(part: dict[str, Any]) -> str:
    """The type of a value of the schema."""
    if "$ref" in part:
        return str(part["$ref"]).rpartition("/")[2].removesuffix("Entry")
    if "oneOf" in part:
        words = [json.dumps(one["const"]) for one in part["oneOf"] if "const" in one]
        members = [hint(one) for one in part["oneOf"] if "const" not in one]
        return f"Literal[{', '.join(words)}]" if words and not members else f"Union[{', '.join(members)}]"
    if "const" in part:
        return f"Literal[{json.dumps(part['const'])}]"
    if part["type"] == "array":
        return f"Sequence[{hint(part['items'])}]"
    return {"string": "str", "number": "float", "integer": "int", "boolean": "bool"}[part["type"]]


def documented(part: dict[str, Any], indent: str = "") -> str:
    text = part.get("description", "").replace("`", "``")
    return textwrap.fill(f'"""{text}"""', WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False) + "\n"


def pages() -> dict[str, str]:
    """Text of each page by the name of its file."""
    parsed = {path.stem: ast.parse(path.read_text(encoding="utf-8")) for path in [*PACKAGE.glob("*.py"), PACKAGE / "_native.pyi"]}
    stubs = definitions(parsed["_native"])
    places = {name: module for module, name in exported(parsed["__init__"])}
    parts = [INTRODUCTION]
    for name in sorted(places, key=str.lower):
        node = definitions(parsed[places[name]]).get(name)
        if node is not None:
            parts.append(described(name, node, stubs))
    parts += ["## cohaul.gym", prose(ast.get_docstring(parsed["gym"]) or "")]
    parts.append(described("TransportEnv", definitions(parsed["gym"])["TransportEnv"], stubs))
    engines = ast.parse((PACKAGE / "engines/__init__.py").read_text(encoding="utf-8"))
    parts += ["## cohaul.engines", prose(ast.get_docstring(engines) or "")]
    parts += [described(name, definitions(engines)[name], stubs) for name in ("Engine", "serve")]
    plugin = definitions(parsed["pytest_plugin"])
    parts += ["## Fixture of pytest", described("engine_verdict", plugin["engine_verdict"], stubs)]
    return {"python.md": "\n\n".join(parts) + "\n", "python-results.md": "\n\n".join([RESULTS, *types(parsed["results"])]) + "\n"}


def definitions(tree: ast.Module) -> dict[str, Definition]:
    return {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def exported(tree: ast.Module) -> list[tuple[str, str]]:
    """Module and name of all that the package hands on."""
    return [(node.module or "", name.name) for node in tree.body if isinstance(node, ast.ImportFrom) for name in node.names]


def described(name: str, node: Definition, stubs: dict[str, Definition]) -> str:
    """A function or a class with its members."""
    if isinstance(node, ast.FunctionDef):
        return f"## {name}\n\n{code(signature(name, node))}\n\n{prose(ast.get_docstring(node) or '')}"
    made = next((part for part in node.body if isinstance(part, ast.FunctionDef) and part.name in ("__init__", "__new__")), None)
    parts = [f"## {name}"]
    if made is not None and not any("_native" in ast.unparse(argument) for argument in made.args.args):
        parts.append(code(signature(name, made)))
    parts.append(prose(ast.get_docstring(node) or ""))
    parts += members(node, stubs)
    return "\n\n".join(parts)


def members(node: ast.ClassDef, stubs: dict[str, Definition]) -> list[str]:
    """Public attributes, properties and methods, also those of the native part."""
    found: dict[str, str] = {}
    for base in node.bases:
        stub = stubs.get(ast.unparse(base).removeprefix("_native."))
        if isinstance(stub, ast.ClassDef):
            found |= own_members(stub)
    found |= own_members(node)
    return list(found.values())


def own_members(node: ast.ClassDef) -> dict[str, str]:
    found: dict[str, str] = {}
    for part, after in zip(node.body, [*node.body[1:], None]):
        documented = after.value.value if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) else None
        if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name) and isinstance(documented, str):
            found[part.target.id] = member(f"{part.target.id}: {ast.unparse(part.annotation)}", documented)
        if not isinstance(part, ast.FunctionDef) or part.name.startswith("_"):
            continue
        decorators = [ast.unparse(decorator) for decorator in part.decorator_list]
        text = ast.get_docstring(part)
        if text is None or any(decorator.endswith(".setter") for decorator in decorators):
            continue
        is_property = any(decorator in ("property", "cached_property") for decorator in decorators)
        head = f"{part.name}: {ast.unparse(part.returns) if part.returns else 'Any'}" if is_property else signature(part.name, part)
        found[part.name] = member(head, text)
    return found


def member(head: str, text: str) -> str:
    return f"{code(head)}\n\n{prose(text)}"


def signature(name: str, node: ast.FunctionDef) -> str:
    """The call as Python has it, without self and private arguments."""
    arguments = node.args
    kept = [argument for argument in arguments.args if argument.arg not in ("self", "cls")]
    defaults = [None] * (len(kept) - len(arguments.defaults)) + list(arguments.defaults)
    first = [ast.arg(argument.arg, argument.annotation) for argument in arguments.posonlyargs if argument.arg not in ("self", "cls")]
    shown = [one(argument, default) for argument, default in zip([*first, *kept], [None] * len(first) + defaults[-len(kept) or len(defaults) :])]
    if arguments.vararg:
        shown.append("*" + one(arguments.vararg, None))
    elif arguments.kwonlyargs:
        shown.append("*")
    shown += [one(argument, default) for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    if arguments.kwarg:
        shown.append("**" + one(arguments.kwarg, None))
    returned = f" -> {ast.unparse(node.returns)}" if node.returns and name == node.name else ""
    line = f"{name}({', '.join(shown)}){returned}"
    return line if len(line) <= WIDTH else f"{name}(\n" + "".join(f"    {argument},\n" for argument in shown) + f"){returned}"


def one(argument: ast.arg, default: ast.expr | None) -> str:
    text = argument.arg + (f": {ast.unparse(argument.annotation)}" if argument.annotation else "")
    return text if default is None else f"{text} = {ast.unparse(default)}"


def types(tree: ast.Module) -> list[str]:
    """Words and dicts of the answers."""
    parts: list[str] = []
    for node, after in zip(tree.body, [*tree.body[1:], None]):
        text = after.value.value if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) else ""
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and isinstance(text, str):
            parts.append(f"## {node.targets[0].id}\n\n{code(ast.unparse(node.value))}\n\n{prose(text)}")
        elif isinstance(node, ast.ClassDef):
            base = ast.unparse(node.bases[0])
            keys = [f"# and all of {base}"] if base != "TypedDict" else []
            for field, doc in zip(node.body, [*node.body[1:], None]):
                if isinstance(field, ast.AnnAssign):
                    if isinstance(doc, ast.Expr) and isinstance(doc.value, ast.Constant):
                        keys += [f"# {line}" for line in textwrap.wrap(" ".join(str(doc.value.value).split()), WIDTH - 2)]
                    keys.append(ast.unparse(field))
            parts.append(f"## {node.name}\n\n{prose(ast.get_docstring(node) or '')}\n\n{code(chr(10).join(keys))}")
    return parts


def code(text: str) -> str:
    return f"```python\n{text}\n```"


def prose(text: str) -> str:
    """A docstring as Markdown: roles, parameters and examples."""
    text = re.sub(r":(?:func|class|meth|mod|attr):`([^`]*)`", r"`\1`", text).replace("``", "`")
    parts, lines, example = [], [], False
    for line in [*text.splitlines(), ""]:
        starts = line.startswith((">>> ", "... ")) or (example and line.strip() != "")
        if starts != example and lines:
            parts.append(code("\n".join(lines)) if example else paragraphs("\n".join(lines)))
            lines = []
        example = starts
        lines.append(line)
    parts.append(code("\n".join(lines)) if example else paragraphs("\n".join(lines)))
    return "\n\n".join(part for part in parts if part)


def paragraphs(text: str) -> str:
    found = []
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        if paragraph.startswith(":param "):
            entries = re.split(r"\n(?=:param )", paragraph)
            found.append("\n".join(entry(one) for one in entries))
        elif "::" in paragraph and paragraph.endswith("::"):
            found.append(filled(paragraph[:-1]))
        elif paragraph.startswith("    "):
            found.append(code(textwrap.dedent(paragraph)))
        elif paragraph:
            found.append(filled(paragraph))
    return "\n\n".join(found)


def entry(text: str) -> str:
    name, meaning = re.fullmatch(r":param (\w+):\s*(.*)", text, re.S).groups()  # type: ignore[union-attr]
    return textwrap.fill(f"- `{name}`: {' '.join(meaning.split())}", WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def filled(text: str) -> str:
    return textwrap.fill(" ".join(text.split()), WIDTH, break_long_words=False, break_on_hyphens=False)


if __name__ == "__main__":
    main()
