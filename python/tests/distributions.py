"""What stands in a wheel and in a source distribution: `python distributions.py FILE...`."""

from __future__ import annotations

import posixpath
import re
import sys
import tarfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LARGEST_SOURCE = 2_000_000
"""Largest source distribution (bytes)."""
NOT_IN_SOURCE = r"^(tests|results|benches|python/(tests|notebooks|report_cards|policies))/"


def check_wheel(path: Path) -> list[str]:
    """Faults of a wheel."""
    with zipfile.ZipFile(path) as wheel:
        names = set(wheel.namelist())
        metadata = wheel.read(next(name for name in names if name.endswith("/METADATA"))).decode()
        licences = {name.rsplit("/", 1)[-1] for name in names if ".dist-info/licenses/" in name}
    modules = {f"cohaul/{file.relative_to(ROOT / 'python/cohaul').as_posix()}" for file in (ROOT / "python/cohaul").rglob("*.py*") if "__pycache__" not in str(file)}
    faults = [f"{name} is missing" for name in sorted(modules - names)]
    faults += [f"{name} is unknown" for name in sorted(names - modules) if not re.match(r"cohaul/_native\.|cohaul/py\.typed|cohaul-.*\.dist-info/", name)]
    faults += [f"the licence {name} is missing" for name in {"LICENSE-APACHE", "LICENSE-MIT", "THIRD-PARTY.txt"} - licences]
    faults += [f"METADATA lacks {line!r}" for line in ("License-Expression: MIT OR Apache-2.0", "Requires-Python: >=3.10") if line not in metadata]
    return faults


def included(name: str, text: str) -> set[str]:
    """Files that a source includes, without which it does not build. Tests include results."""
    found = re.findall(r'include(?:_str|_bytes)?!\(\s*"([^"]+)"\s*\)', text)
    paths = {posixpath.normpath(posixpath.join(posixpath.dirname(name), one)) for one in found}
    return {path for path in paths if not path.startswith("results/")}


def check_source(path: Path) -> list[str]:
    """Faults of a source distribution."""
    needed = {"Cargo.lock", "pyproject.toml", "python/Cargo.toml", "licences/THIRD-PARTY.txt", "cohaul/py.typed"}
    with tarfile.open(path) as source:
        names = {name.partition("/")[2] for name in source.getnames()}
        for member in source.getmembers():
            if member.name.endswith(".rs"):
                needed |= included(member.name.partition("/")[2], source.extractfile(member).read().decode())  # type: ignore[union-attr]
    faults = [f"{name} is missing" for name in sorted(needed - names)]
    faults += [f"{name} is of no use" for name in sorted(names) if re.match(NOT_IN_SOURCE, name)]
    if path.stat().st_size > LARGEST_SOURCE:
        faults.append(f"must have at most {LARGEST_SOURCE} bytes, found {path.stat().st_size}")
    return faults


def main() -> None:
    faults = []
    for path in map(Path, sys.argv[1:]):
        faults += [f"{path.name}: {fault}" for fault in (check_wheel(path) if path.suffix == ".whl" else check_source(path))]
    if faults:
        sys.exit("\n".join(faults))


main()
