# SPDX-License-Identifier: MIT
"""`roburoc4 dissector`."""

import os
from pathlib import Path

import pytest
from cli_support import run


def test_the_path_of_the_file_is_printed() -> None:
    path = Path(run("dissector").stdout.strip())
    assert path.read_text(encoding="utf-8").count('Proto("roburoc4"') == 1


def test_install_copies_it_for_this_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    done = run("dissector", "--install")
    installed = tmp_path / ".local" / "lib" / "wireshark" / "plugins" / "roburoc4.lua"
    assert done.stdout.strip() == str(installed)
    assert installed.exists()
    assert run("dissector", "--install").returncode == os.EX_OK
