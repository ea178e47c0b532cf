# SPDX-License-Identifier: MIT
"""roburoc4 doctor --lcm: each fault of an LCM network has its own verdict."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rig import Bridge, Bus, Program, Robot
from roburoc4_tools.cli.connecting.lcm_doctor import LcmFindings, Network, judge

Run = Callable[..., Program]
FAKE = Path(__file__).parent / "rig" / "fake_bridge.py"
DOCTOR = [str(Path(sys.executable).with_name("roburoc4")), "doctor", "--json", "--lcm"]
LOOPBACK = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo || exit 9"


def document(done: Program, code: int) -> Any:
    assert done.ends(60) == code, done.output
    found = json.loads(done.output[done.output.index("{") :])
    assert found["verdict"]["code"] == code
    return found


def in_a_namespace(run: Run, *lines: str, url: str = "") -> Program:
    """Run doctor after these lines of a shell, on a network of its own."""
    script = "\n".join(
        [*lines, f"{' '.join(DOCTOR)} {url}", "code=$?; kill %1 2>/dev/null; exit $code"]
    )
    return run("setsid", "unshare", "-rn", "bash", "-c", script)


def fake(run: Run, *options: str, url: str = "") -> Program:
    """Run doctor beside a bridge with these options."""
    line = " ".join([sys.executable, str(FAKE), *options, "&", "sleep 1"])
    return in_a_namespace(run, LOOPBACK, "set -m", line, url=url)


def test_a_bridge_that_hears_us_is_healthy(robot: Robot, bus: Bus, armed: Bridge, run: Run) -> None:
    commands = len([data for _, data in list(robot.tap.to_robot) if data[:1] == b"\xff"])
    found = document(run(*DOCTOR, bus.url), 0)
    assert found["verdict"]["name"] == "healthy"
    (heard,) = found["bridges"]
    assert (heard["channel"], heard["robot"]) == ("ROBUROC4_BRIDGE_STATE", robot.address)
    assert heard["hears_us"]
    assert heard["drive_enabled"]
    after = [data for _, data in list(robot.tap.to_robot) if data[:1] == b"\xff"]
    assert len(after) == commands, "nothing is commanded"
    assert armed.state.can_drive, "it keeps nobody from driving"
    assert armed.state.control_owner == ""


def test_no_bridge(bus: Bus, run: Run) -> None:
    assert document(run(*DOCTOR, bus.url), 3)["verdict"]["name"] == "no bridge"


def test_no_route(run: Run) -> None:
    found = document(in_a_namespace(run), 3)
    assert found["verdict"]["name"] == "lcm route"
    assert "ip route add 224.0.0.0/4" in found["verdict"]["remedy"]


def test_an_interface_without_multicast(run: Run) -> None:
    line = "ip link set lo up multicast off && ip route add 224.0.0.0/4 dev lo || exit 9"
    found = document(in_a_namespace(run, line), 3)
    assert (found["verdict"]["name"], found["interface"]) == ("lcm interface", "lo")


def test_a_firewall_that_drops_multicast() -> None:
    """Judged without a firewall, which needs rights outside of a test."""
    found = LcmFindings(Network.read("udpm://239.255.76.67:7667?ttl=1"), interface="eth0")
    assert judge(found).name == "lcm multicast"
    assert "239.255.76.67:7667" in judge(found).remedy


def test_a_ttl_that_is_too_small_here(run: Run) -> None:
    found = document(fake(run, "--least-ttl=1", url="udpm://239.255.76.67:7667?ttl=0"), 1)
    assert (found["verdict"]["name"], found["ttl_needed"]) == ("one way", 1)
    assert "?ttl=1" in found["verdict"]["remedy"]


def test_a_bridge_that_hears_nothing(run: Run) -> None:
    found = document(fake(run, "--least-ttl=9"), 1)
    assert (found["verdict"]["name"], found["ttl_needed"]) == ("one way", None)
    assert "ROBUROC4_BRIDGE_STATE" in found["verdict"]["sentence"]


def test_lost_packets(run: Run) -> None:
    found = document(fake(run, "--lose=1"), 1)
    assert found["verdict"]["name"] == "lcm loss"
    assert found["loss"] > 0.2


def test_clocks_that_differ(run: Run) -> None:
    found = document(fake(run, "--ahead-s=5"), 1)
    assert found["verdict"]["name"] == "clock"
    assert "5.0 s ahead" in found["verdict"]["sentence"]


@pytest.mark.parametrize("url", ["tcpq://", "udpm://?ttl=x"])
def test_a_url_that_cannot_be_used(run: Run, url: str) -> None:
    done = run(*DOCTOR, url)
    assert done.ends(60) == 2
    assert "give udpm://" in done.output
