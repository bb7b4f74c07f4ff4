"""Examples in docstrings, README and book run, and stubs name what there is."""

from __future__ import annotations

import ast
import doctest
import importlib
import re
import runpy
import types
from pathlib import Path

import pytest
from conftest import ROOT

import cohaul

MODULES = ["cohaul", *(f"cohaul.{name}" for name in ["_errors", "_parts", "_scenario", "_run", "_rollouts", "_compare", "_sweep", "_simulation", "_import", "_maps", "_check", "_measured", "engines", "gym", "results", "scenario"])]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    module = importlib.import_module(name)
    found = doctest.testmod(module, extraglobs={"cohaul": cohaul})
    assert found.failed == 0 and found.attempted > 0


@pytest.mark.parametrize("name", ["README.md", "docs/src/environments.md", *(f"docs/src/environments/{name}.md" for name in ("transport", "doorway", "push-t")), "docs/src/engines.md", "docs/src/friction-joints.md", "docs/src/python.md", "docs/src/recordings.md"])
def test_python_code_of_readme_and_book(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    text = (ROOT / name).read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks
    for folder in ("scenarios", "examples"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    for file, content in re.findall(r"```json (\S+)\n(.*?)```", text, re.S):
        (tmp_path / file).write_text(content)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in blocks:
        exec(compile(block, name, "exec"), names)


def test_pages_of_notebooks_have_their_code() -> None:
    notebooks = sorted((ROOT / "python/notebooks").glob("[0-9]*.py"))
    assert len(notebooks) == 8
    for notebook in notebooks:
        page = (ROOT / "docs/src/notebooks" / f"{notebook.stem}.md").read_text()
        cells = re.split(r"^# %%(.*)$", notebook.read_text(), flags=re.M)[1:]
        code = [source.strip() for kind, source in zip(cells[::2], cells[1::2]) if "markdown" not in kind]
        assert code and all(f"```python\n{source}\n```" in page for source in code), f"{notebook.name}: see python/notebooks/execute.py"


def test_pages_of_the_package_follow_from_its_sources() -> None:
    script = runpy.run_path(str(ROOT / "python/api.py"))
    assert (ROOT / "python/cohaul/scenario.py").read_text() == script["scenario_types"](), "python python/api.py writes it"
    for name, text in script["pages"]().items():
        assert (ROOT / "docs/src/reference" / name).read_text() == text, f"{name}: python python/api.py writes it"


def test_pages_of_the_package_have_all_that_is_public() -> None:
    page = (ROOT / "docs/src/reference/python.md").read_text()
    names = [name for name in cohaul.__all__ if isinstance(getattr(cohaul, name), (type, types.FunctionType))]
    assert len(names) > 30
    for name in names:
        thing = getattr(cohaul, name)
        assert f"\n## {name}\n" in page, name
        # Fields of a data class stand among its arguments.
        fields = getattr(thing, "__dataclass_fields__", {})
        members = [member for member in vars(thing) if isinstance(thing, type) and not member.startswith("_") and getattr(thing, member).__doc__]
        members = [member for member in members if member not in fields]
        assert all(f"`{field}`" in page for field in fields), (name, fields)
        missing = [member for member in members if not re.search(rf"^{member}\b", page, re.M)]
        assert not missing, (name, missing)


def test_stubs_name_what_the_native_part_has() -> None:
    from cohaul import _native

    tree = ast.parse((Path(cohaul.__file__).parent / "_native.pyi").read_text())
    stubs = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(stubs) == {name for name in dir(_native) if not name.startswith("_")}
    for name, node in stubs.items():
        if isinstance(node, ast.ClassDef):
            members = [part.name if isinstance(part, ast.FunctionDef) else part.target.id for part in node.body if isinstance(part, (ast.FunctionDef, ast.AnnAssign))]
            missing = {member for member in vars(getattr(_native, name)) if not member.startswith("_")} - set(members)
            assert not missing and all(hasattr(getattr(_native, name), member) for member in members), (name, missing)


def test_every_public_thing_has_a_docstring() -> None:
    for name in cohaul.__all__:
        thing = getattr(cohaul, name)
        if isinstance(thing, (type, types.FunctionType)):
            assert thing.__doc__, name
            for member in [member for member in vars(thing) if isinstance(thing, type) and not member.startswith("_")]:
                assert getattr(thing, member).__doc__, f"{name}.{member}"
