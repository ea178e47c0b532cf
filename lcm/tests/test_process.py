# SPDX-License-Identifier: MIT
"""The program from outside: options, exit codes, and messages when something is missing."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from rig import Bridge, Bus, Program, Programs, until
from rig.bus import drive_command

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


def test_version(programs: Programs) -> None:
    done = said(programs, "--version")
    assert done.returncode == 0
    assert re.fullmatch(r"roburoc4-lcm \d+\.\d+\.\d+.*\n", done.stdout)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--no-such-option"], "--no-such-option"),
        (["-r", "A=127.0.0.1", "-r", "B=127.0.0.1:60000"], "A already has this address"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_bad_usage_is_named_and_ends_with_2(
    programs: Programs, options: list[str], named: str
) -> None:
    done = said(programs, *options)
    assert done.returncode == 2, done.stderr
    assert named in done.stderr
    assert done.stdout == ""


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


def test_the_remedy_helps(programs: Programs, run: Callable[..., Program]) -> None:
    remedy = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo"
    bridge = run(
        str(shutil.which("unshare")),
        "-rn",
        "sh",
        "-c",
        f"{remedy} && exec {programs('roburoc4-lcm')} -r 127.0.0.1:9",
    )
    bridge.says("127.0.0.1:9")
    with pytest.raises(subprocess.TimeoutExpired):
        bridge.ends(1.0)


@pytest.mark.parametrize("by", ["--lcm-url", "LCM_DEFAULT_URL"])
@pytest.mark.parametrize(
    "url",
    [
        "tcpq://127.0.0.1:7700",
        "udpm://127.0.0.1:7667",
    ],
)
def test_an_lcm_url_that_is_not_multicast_ends_with_2(
    programs: Programs, url: str, by: str
) -> None:
    """LCM's other networks wait within LCM: no zero, and no end on SIGTERM."""
    if by == "--lcm-url":
        done = said(programs, "-r", "127.0.0.1", "-l", url)
    else:
        done = said(programs, "-r", "127.0.0.1", LCM_DEFAULT_URL=url)
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"{by} {url}" in done.stderr
    assert "udpm://ADDRESS:PORT?ttl=N" in done.stderr
    assert "ip route" not in done.stderr, "a route does not help"


def test_a_lost_route_is_logged_once_and_so_is_its_return(
    programs: Programs, run: Callable[..., Program]
) -> None:
    route = "224.0.0.0/4 dev lo"
    bridge = run(
        str(shutil.which("unshare")),
        "-rn",
        "sh",
        "-c",
        f"ip link set lo up multicast on && ip route add {route} || exit 9\n"
        f"{programs('roburoc4-lcm')} -r 127.0.0.1:9 & sleep 1; ip route del {route}\n"
        f"sleep 2; ip route add {route}; sleep 3; kill $!; wait $!",
    )
    assert bridge.ends(20) == 0, bridge.output
    assert bridge.output.count("LCM cannot send") == 1, bridge.output
    assert bridge.output.count("LCM can send again") == 1, bridge.output


@pytest.mark.parametrize(("option", "lines"), [("-q", 0), ("", 1), ("-v", 3)])
def test_quiet_logs_nothing_and_verbose_logs_each_rejection(
    start_bridge: StartBridge, bus: Bus, option: str, lines: int
) -> None:
    bridge = start_bridge("--enable-drive", *option.split()).connects()
    for _ in range(3):
        bus.publish("ROBUROC4_DRIVE_CMD", drive_command(0.3, utime=0).encode())
    until(lambda: bridge.statistics.rejected_no_utime == 3, "all are counted")
    bridge.end()
    assert bridge.output.count("utime") == lines
    assert bool(bridge.output) == (option != "-q")
