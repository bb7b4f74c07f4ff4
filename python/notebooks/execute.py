"""Executes the notebooks, which are Python files in the percent format of jupytext.

python execute.py FOLDER [BOOK]: with BOOK, each notebook is written there as a page of the book, with
its code, what it printed, and its figures.
"""

from __future__ import annotations

import base64
import os
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jupytext
from nbclient import NotebookClient

ROOT = os.environ.get("COHAUL_ROOT", str(Path(__file__).resolve().parents[2]))


def executed(path: Path) -> Any:
    notebook = jupytext.read(path)
    client = NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": ROOT}})
    client.execute()
    return notebook


def outputs(cell: Any) -> Iterator[tuple[str, str]]:
    """Kind and content of what a cell gave: ``figure``, a PNG in base64, or ``text``."""
    for output in cell.get("outputs", []):
        data = output.get("data", {})
        if "image/png" in data:
            yield "figure", data["image/png"]
        elif output["output_type"] == "stream" or "text/plain" in data:
            yield "text", output.get("text") or data["text/plain"]


def page(notebook: Any, name: str, book: Path) -> str:
    """The notebook as Markdown; its figures are written beside it."""
    parts, n_figures = [], 0
    for cell in notebook.cells:
        parts.append(cell.source if cell.cell_type == "markdown" else f"```python\n{cell.source}\n```")
        for kind, content in outputs(cell):
            if kind == "figure":
                n_figures += 1
                figure = f"{name}-{n_figures}.png"
                (book / figure).write_bytes(base64.b64decode(content))
                parts.append(f"![Figure {n_figures}]({figure})")
            else:
                lines = [textwrap.fill(line, 80) for line in content.rstrip().splitlines()]
                parts.append("```text\n" + "\n".join(lines) + "\n```")
    return "\n\n".join(parts) + "\n"


def main(folder: str, book: str | None = None) -> None:
    for path in sorted(Path(folder).glob("[0-9]*.py")):
        notebook = executed(path)
        n_figures = sum(kind == "figure" for cell in notebook.cells for kind, _ in outputs(cell))
        print(f"{path.name}: {n_figures} figures")
        if book is not None:
            Path(book).mkdir(parents=True, exist_ok=True)
            (Path(book) / f"{path.stem}.md").write_text(page(notebook, path.stem, Path(book)))


if __name__ == "__main__":
    main(*sys.argv[1:])
