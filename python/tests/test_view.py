"""The live page, opened from Python: it hands its scene back."""

from __future__ import annotations

import json
import os
import socket
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

import cohaul

from conftest import PROGRAM


def page(*asked: dict[str, Any]) -> Any:
    """What opens a link as a page does, and asks these things of the server."""

    def open_link(link: str) -> None:
        parts = urlsplit(link)
        stream = socket.create_connection((parts.hostname, parts.port), timeout=60)
        stream.sendall(
            f"GET /socket?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nOrigin: http://{parts.netloc}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
        )
        assert stream.recv(12) == b"HTTP/1.1 101"
        for ask in asked:
            text = json.dumps(ask).encode()
            assert len(text) < 126
            # One frame of text, masked by zeros.
            stream.sendall(bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text)
        pages.append(stream)

    pages: list[socket.socket] = []
    return open_link


def test_the_page_hands_its_scene_back(pulled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COHAUL", str(PROGRAM))
    before = cohaul.Scenario(pulled).to_dict()["load"]["mass_kg"]
    edited = cohaul.view(pulled, open=page({"do": "set", "what": "mass", "value": 2 * before}, {"do": "hand-back"}))
    assert edited is not None
    assert edited.to_dict()["load"]["mass_kg"] == pytest.approx(2 * before, rel=1e-12)
    assert cohaul.run(edited)["final"]["time_s"] > 0


def test_a_server_that_ends_hands_nothing_back(pulled: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    ends = tmp_path / "ends"
    ends.write_text("#!/bin/sh\ncat > /dev/null\necho http://127.0.0.1:1/\n")
    ends.chmod(0o755)
    monkeypatch.setenv("COHAUL", os.fspath(ends))
    assert cohaul.view(pulled, open=None) is None


def test_wrong_scenes_and_missing_programs_are_errors(pulled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(cohaul.ScenarioError):
        cohaul.view({"name": "nothing"})
    monkeypatch.delenv("COHAUL", raising=False)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(FileNotFoundError, match="cohaul: the live page needs the program"):
        cohaul.view(pulled)
