# SPDX-License-Identifier: MIT
"""The program from outside: options, exit codes, and what it says when something is missing."""

import re
import shutil
import subprocess
from collections.abc import Callable

import pytest
from rig import Bridge, Bus, Program, Programs, until
from rig.bus import drive_command

StartBridge = Callable[..., Bridge]


def said(programs: Programs, *options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [programs("roburoc4-lcm"), *options],
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )


def test_help_names_every_option(programs: Programs) -> None:
    for option in ("-h", "--help"):
        done = said(programs, option)
        assert done.returncode == 0
        for name in (
            "--lcm-url",
            "--robot",
            "--prefix",
            "--period",
            "--enable-drive",
            "--enable-outputs",
            "--enable-relocalize",
            "--command-timeout",
            "--max-age",
            "--pose-channel",
            "--version",
        ):
            assert name in done.stdout, name


def test_version(programs: Programs) -> None:
    done = said(programs, "--version")
    assert done.returncode == 0
    assert re.fullmatch(r"roburoc4-lcm \d+\.\d+\.\d+.*\n", done.stdout)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--no-such-option"], "--no-such-option"),
        (["--robot"], "robot"),
        (["--robot", "host:99999"], "99999"),
        (["--robot", "A=127.0.0.1:1", "--robot", "A=127.0.0.1:2"], "A"),
        (["-r", "127.0.0.1", "--period", "battery"], "battery"),
        (["-r", "127.0.0.1", "--period", "wings=10"], "wings"),
        (["-r", "127.0.0.1", "--period", "battery=-5"], "-5"),
        (["-r", "127.0.0.1", "--command-timeout", "soon"], "soon"),
        (["-r", "127.0.0.1", "--max-age", "-1"], "-1"),
        (["-r", "127.0.0.1", "surplus"], "surplus"),
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


@pytest.mark.parametrize("url", ["nonsense", "udpm://1.2.3:4", "smoke://"])
def test_an_lcm_url_that_cannot_be_used_ends_with_3(programs: Programs, url: str) -> None:
    done = said(programs, "-r", "127.0.0.1", "-l", url)
    assert done.returncode == 3, done.stdout + done.stderr
    assert url in done.stderr


@pytest.mark.parametrize(("option", "lines"), [("-q", 0), ("", 1), ("-v", 3)])
def test_quiet_tells_nothing_and_verbose_tells_each_rejection(
    start_bridge: StartBridge, bus: Bus, option: str, lines: int
) -> None:
    bridge = start_bridge("--enable-drive", *option.split()).connects()
    for _ in range(3):
        bus.publish("ROBUROC4_DRIVE_CMD", drive_command(0.3, utime=0).encode())
    until(lambda: bridge.status.rejected_no_utime == 3, "all are counted")
    bridge.end()
    assert bridge.output.count("utime") == lines
    assert bool(bridge.output) == (option != "-q")
