# SPDX-License-Identifier: MIT
"""scikit-build-core's backend, which in a checkout first writes the LCM types' Python package.

lcm-gen writes it from lcm/types into the folder `generated`, which a source archive brings along.
"""

import shutil
import subprocess
from pathlib import Path

from scikit_build_core import build as _build
from scikit_build_core.build import *  # noqa: F403  (all hooks that this file does not change)

_HERE = Path(__file__).parent
_TYPES = sorted((_HERE.parent / "lcm" / "types").glob("*.lcm"))
_OUT = _HERE / "generated"
_NEEDED = ["lcm>=1.5.1"] if _TYPES else []


_LEFT_OUT = """raise ImportError(
    "roburoc4-tools was built without LCM's types, as lcm-gen did not run: install libglib2.0-0 "
    "(its name in Debian), and then roburoc4-tools again"
)
"""


def _write_types(*, required: bool) -> None:
    """Write them. Whoever does not use LCM need not have what lcm-gen needs (GLib)."""
    if not _TYPES:
        return
    shutil.rmtree(_OUT, ignore_errors=True)  # lcm-gen keeps what an __init__.py has
    command = ["lcm-gen", "--python", "--ppath", _OUT, *_TYPES]
    if subprocess.run(command, check=required).returncode != 0:
        package = _OUT / "roburoc4_lcm"
        package.mkdir(parents=True, exist_ok=True)
        (package / "__init__.py").write_text(_LEFT_OUT, encoding="utf-8")


def get_requires_for_build_wheel(*arguments, **named):
    """Return what to install first: LCM's generator, in a checkout."""
    return [*_build.get_requires_for_build_wheel(*arguments, **named), *_NEEDED]


def get_requires_for_build_sdist(*arguments, **named):
    """Return the same for a source archive."""
    return [*_build.get_requires_for_build_sdist(*arguments, **named), *_NEEDED]


def build_wheel(*arguments, **named):
    """Build the wheel."""
    _write_types(required=False)
    return _build.build_wheel(*arguments, **named)


def build_sdist(*arguments, **named):
    """Build the source archive."""
    _write_types(required=True)
    return _build.build_sdist(*arguments, **named)
