# SPDX-License-Identifier: MIT
"""The Python package of the types, as the wheel installs it."""

import importlib.metadata
import subprocess
import sys

import roburoc4_lcm
from rig import Programs

TYPES = Programs.checkout() / "lcm" / "types"


def test_the_wheel_brings_every_type() -> None:
    names = sorted(path.stem for path in TYPES.glob("*.lcm"))
    assert names
    for name in names:
        message = getattr(roburoc4_lcm, name)()
        assert message.encode()[:8] == getattr(roburoc4_lcm, name)._get_packed_fingerprint()


def test_the_wheel_needs_lcm_for_its_extra_only() -> None:
    needs = [n for n in importlib.metadata.requires("roburoc4-tools") or [] if n.startswith("lcm")]
    assert needs
    assert all('extra == "lcm"' in need for need in needs), needs


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
