"""The live page of a scenario, from Python and notebooks."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import webbrowser
from typing import Callable

from ._scenario import Scenario, Source


def program() -> str:
    """The program ``cohaul``: that of the variable ``COHAUL``, or the one on the path."""
    found = os.environ.get("COHAUL") or shutil.which("cohaul")
    if found is None:
        raise FileNotFoundError("cohaul: the live page needs the program on the path, or COHAUL set to it; `cargo install --path crates/app` installs it")
    return found


def view(scenario: Source, *, open: Callable[[str], object] | None = webbrowser.open) -> Scenario | None:
    """Opens the live page of a scenario, and waits until its *Hand back* is pressed.

    Returns the scenario with all that was edited and dragged, or ``None`` if the page's server ended
    without it. Ctrl-C, or the stop button of a notebook, ends the server.

    :param scenario: as for :func:`run`
    :param open: what opens the link; ``None`` prints it alone

    Raises :class:`ScenarioError` for a wrong scenario, and ``FileNotFoundError`` without the program.

    >>> edited = cohaul.view("scenarios/robots/two-fingers.json")  # doctest: +SKIP
    """
    checked = Scenario(scenario)
    command = [program(), "view", "--hand-back", "-"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, encoding="utf-8") as server:
        assert server.stdin is not None and server.stdout is not None
        try:
            server.stdin.write(json.dumps(checked.to_dict()))
            server.stdin.close()
            link = server.stdout.readline().strip()
            if link:
                print(link)
                if open is not None:
                    open(link)
            handed = server.stdout.readline()
        finally:
            server.terminate()
    return Scenario(json.loads(handed)) if handed else None
