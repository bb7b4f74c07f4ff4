"""Licences of the crates in a wheel: `python python/third_parties.py` writes `THIRD-PARTY.txt`.

The list follows from `cargo metadata` and Cargo.lock; texts are those of the files that the crates
carry. `--check` says whether the file has the crates of the present lock file.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / "python/licences/THIRD-PARTY.txt"
PLATFORMS = ("x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu", "x86_64-pc-windows-msvc", "x86_64-apple-darwin", "aarch64-apple-darwin")
"""Platforms of wheels: a crate that one of them needs is listed."""
OF_PROC_MACROS = "proc-macro"


def main() -> None:
    crates = linked_crates()
    if "--check" in sys.argv[1:]:
        missing = sorted(heading(crate) for crate in crates if heading(crate) not in listed())
        more = sorted(listed() - {heading(crate) for crate in crates})
        if missing or more:
            sys.exit(f"{FILE.name}: must have the crates of Cargo.lock, found {missing} missing and {more} more; python python/third_parties.py writes it")
        return
    FILE.write_text(text(crates), encoding="utf-8")


def linked_crates() -> list[dict[str, Any]]:
    """Crates of others whose code is part of the library, on any platform, by name and version."""
    found: dict[str, dict[str, Any]] = {}
    for platform in PLATFORMS:
        data = metadata(platform)
        packages = {package["id"]: package for package in data["packages"]}
        nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
        root = next(package["id"] for package in data["packages"] if package["name"] == "cohaul-python")
        left, seen = [root], {root}
        while left:
            for dependency in nodes[left.pop()]["deps"]:
                package = packages[dependency["pkg"]]
                # Macros and build scripts run when the library is built, and are no part of it.
                is_linked = any(kind["kind"] is None for kind in dependency["dep_kinds"])
                is_macro = any(OF_PROC_MACROS in target["kind"] for target in package["targets"])
                if is_linked and not is_macro and package["id"] not in seen:
                    seen.add(package["id"])
                    left.append(package["id"])
        found |= {key: packages[key] for key in seen if packages[key]["source"] is not None}
    return sorted(found.values(), key=lambda package: (package["name"], package["version"]))


def metadata(platform: str) -> dict[str, Any]:
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", platform]
    found: dict[str, Any] = json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
    return found


def heading(crate: dict[str, Any]) -> str:
    return f"{crate['name']} {crate['version']}: {crate['license'] or 'see its file'}"


def listed() -> set[str]:
    """Headings of the crates in the file."""
    whole = FILE.read_text(encoding="utf-8") if FILE.exists() else ""
    return set(re.findall(r"^- (.*)$", whole.partition("=" * 80)[0], re.M))


def text(crates: list[dict[str, Any]]) -> str:
    """A list of all crates, then each text once with the crates that carry it."""
    carriers: dict[str, list[str]] = {}
    bodies: dict[str, str] = {}
    for crate in crates:
        folder = Path(crate["manifest_path"]).parent
        for path in sorted(folder.iterdir()):
            if re.match(r"(licen[sc]e|copying|notice|unlicense|copyright)", path.name, re.I) and path.is_file():
                body = path.read_text(encoding="utf-8", errors="replace").replace("\r\n", "\n").strip()
                # Texts that differ in spaces alone are one.
                key = "".join(re.findall(r"\w+", body)).lower()
                carriers.setdefault(bodies.setdefault(key, body), []).append(f"{crate['name']} {crate['version']} ({path.name})")
    lines = [
        "The library of this wheel contains code of these crates, each under its licence as an SPDX",
        "expression. Texts that the crates carry follow. A crate without a text of its own is under the",
        "standard text of its licence.",
        "",
        *(f"- {heading(crate)}" for crate in crates),
    ]
    for body, names in sorted(carriers.items(), key=lambda item: item[1]):
        lines += ["", "=" * 80, *names, "", body]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
