"""Executes the notebooks, which are Python files in the percent format of jupytext.

python execute.py FOLDER [OUT]: with OUT, the executed notebooks and their figures are written there.
"""

from __future__ import annotations

import base64
import os
import sys
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient

ROOT = os.environ.get("COHAUL_ROOT", str(Path(__file__).resolve().parents[2]))


def main(folder: str, out: str | None = None) -> None:
    for path in sorted(Path(folder).glob("[0-9]*.py")):
        notebook = jupytext.read(path)
        client = NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": ROOT}})
        client.execute()
        figures = [
            output["data"]["image/png"]
            for cell in notebook.cells
            for output in cell.get("outputs", [])
            if "image/png" in output.get("data", {})
        ]
        print(f"{path.name}: {len(figures)} figures")
        if out is not None:
            Path(out).mkdir(parents=True, exist_ok=True)
            nbformat.write(notebook, Path(out) / f"{path.stem}.ipynb")
            for at, figure in enumerate(figures):
                (Path(out) / f"{path.stem}-{at + 1}.png").write_bytes(base64.b64decode(figure))


if __name__ == "__main__":
    main(*sys.argv[1:])
