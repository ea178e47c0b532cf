# SPDX-License-Identifier: MIT
"""The Python package of the types, as the wheel installs it."""

import filecmp
import importlib.metadata
import subprocess
import sys
from pathlib import Path

from rig import Programs

COMMITTED = Programs.checkout() / "lcm" / "python" / "roburoc4_lcm"


def installed() -> Path:
    return Path(
        subprocess.run(
            [sys.executable, "-I", "-c", "import roburoc4_lcm; print(roburoc4_lcm.__file__)"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
    ).parent


def equal(one: Path, other: Path) -> bool:
    names = sorted(path.name for path in other.glob("*.py"))
    assert sorted(path.name for path in one.glob("*.py")) == names
    return filecmp.cmpfiles(one, other, names, shallow=False)[0] == names


def test_the_committed_package_is_what_lcm_gen_generates(tmp_path: Path) -> None:
    types = sorted((Programs.checkout() / "lcm" / "types").glob("*.lcm"))
    lcm_gen = Path(sys.executable).with_name("lcm-gen")
    subprocess.run([lcm_gen, "-p", "--ppath", tmp_path, *types], check=True)
    assert equal(COMMITTED, tmp_path / "roburoc4_lcm"), (
        f"generate it again: {lcm_gen} -p --ppath lcm/python lcm/types/*.lcm"
    )


def test_the_wheel_brings_the_committed_package() -> None:
    assert installed() != COMMITTED
    assert equal(installed(), COMMITTED)


def test_the_wheel_needs_lcm_for_its_extra_only() -> None:
    needs = importlib.metadata.requires("roburoc4") or []
    assert all("extra ==" in need for need in needs), needs
    assert any(need.startswith("lcm") and 'extra == "lcm"' in need for need in needs), needs


def test_both_packages_live_in_one_program_without_lcm() -> None:
    program = (
        "import sys; sys.modules['lcm'] = None\n"
        "import roburoc4, roburoc4_lcm\n"
        "with roburoc4.Simulator() as sim, sim.connect() as robot:\n"
        "    message = roburoc4_lcm.localization_status_t()\n"
        "    message.x_m = robot.localization.x_m\n"
        "    roburoc4_lcm.localization_status_t.decode(message.encode())\n"
    )
    subprocess.run([sys.executable, "-I", "-c", program], check=True)
