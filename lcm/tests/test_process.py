# SPDX-License-Identifier: MIT
"""The program from outside: options, exit codes, and messages when something is missing."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

from rig import Bridge, Programs

StartBridge = Callable[..., Bridge]


def said(programs: Programs, *options: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [programs("roburoc4-lcm"), *options],
        capture_output=True,
        text=True,
        timeout=10,
        check=False,
        env={**os.environ, **environment},
    )


def test_the_file_of_the_page_is_accepted(programs: Programs, tmp_path: Path) -> None:
    page = (Programs.checkout() / "docs" / "lcm.md").read_text()
    (text,) = re.findall(r"^```ini\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    file = tmp_path / "fleet.ini"
    file.write_text(text)
    done = said(programs, "--config", str(file), "--check")
    assert done.returncode == 0, done.stderr
    assert "BLUE" in done.stdout


def test_without_multicast_it_prints_the_remedy_and_ends_with_3(programs: Programs) -> None:
    unshare = shutil.which("unshare")
    assert unshare, "unshare is missing: install util-linux"
    done = subprocess.run(
        [unshare, "-rn", programs("roburoc4-lcm"), "-r", "127.0.0.1"],
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == 3, done.stdout + done.stderr
    assert "ip route add 224.0.0.0/4" in done.stderr


def test_an_lcm_url_that_is_not_multicast_ends_with_2(programs: Programs) -> None:
    """LCM's other networks wait within LCM: no zero, and no end on SIGTERM."""
    done = said(programs, "-r", "127.0.0.1", LCM_DEFAULT_URL="tcpq://127.0.0.1:7700")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "LCM_DEFAULT_URL tcpq://127.0.0.1:7700" in done.stderr
    assert "udpm://ADDRESS:PORT?ttl=N" in done.stderr
    assert "ip route" not in done.stderr, "a route does not help"
