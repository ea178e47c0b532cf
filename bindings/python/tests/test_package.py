# SPDX-License-Identifier: MIT
"""The package as it is installed."""

import importlib.metadata
import re
import subprocess
import sys
from pathlib import Path

import pytest

import roburoc4

FOLDER = Path(roburoc4.__file__).parent


def run(*arguments: str, text: str | None = None) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        arguments, input=text, capture_output=True, text=True, timeout=60, check=False
    )


def program(name: str) -> str:
    return str(Path(sys.executable).with_name(name))


def test_these_tests_run_against_the_installed_package() -> None:
    assert "site-packages" in FOLDER.parts


def test_the_version_is_the_librarys() -> None:
    assert importlib.metadata.version("roburoc4") == roburoc4.__version__


def test_nothing_else_is_required() -> None:
    required = importlib.metadata.requires("roburoc4") or []
    assert [line for line in required if "extra ==" not in line] == []
    assert {"numpy", "pandas"} == set(
        importlib.metadata.metadata("roburoc4").get_all("Provides-Extra")
    )


def test_the_wheel_has_what_it_needs_and_no_sources() -> None:
    files = {str(path) for path in importlib.metadata.files("roburoc4") or []}
    assert "roburoc4/py.typed" in files
    assert "roburoc4/_native.pyi" in files
    assert any("LICENSE" in name for name in files)
    assert len([name for name in files if name.endswith((".so", ".pyd"))]) == 1
    assert not [name for name in files if name.endswith((".c", ".h", ".i"))]
    paths = importlib.metadata.files("roburoc4") or []
    size = sum(path.locate().stat().st_size for path in paths if path.suffix != ".pyc")
    assert size < 2_000_000


def test_importing_is_quiet_and_loads_no_numpy_or_asyncio() -> None:
    code = (
        "import sys, roburoc4; "
        "print([m for m in ('numpy', 'asyncio', 'typer', 'rich', 'pytest') if m in sys.modules])"
    )
    done = run(sys.executable, "-W", "error", "-c", code)
    assert (done.stdout, done.stderr) == ("[]\n", "")


def test_the_package_shows_its_names_and_nothing_else() -> None:
    assert dir(roburoc4) == sorted(roburoc4.__all__)
    assert len(roburoc4.__all__) < 50


def test_a_second_interpreter_is_refused_and_harms_nothing() -> None:
    code = """
try:
    import _xxsubinterpreters as interpreters  # until Python 3.12
except ImportError:
    import _interpreters as interpreters
import roburoc4
try:
    ended = interpreters.run_string(interpreters.create(), "import roburoc4")
except Exception as error:
    ended = error
assert "roburoc4 is used by another" in str(ended) or "subinterpreters" in str(ended), ended
with roburoc4.Simulator() as sim, sim.connect() as robot:
    robot.battery
    try:
        robot.drive(0.1, 0.0)
    except roburoc4.NotArmedError:
        print("unharmed")
"""
    assert run(sys.executable, "-c", code).stdout == "unharmed\n"


def test_roburoc4_sim_serves_a_robot_and_ends_on_request() -> None:
    process = subprocess.Popen(
        [program("roburoc4-sim"), "--port", "0", "--panel"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    line = process.stdout.readline()
    address = line.split("ready on ")[1].split()[0]
    with roburoc4.connect(address) as robot:
        assert robot.battery.remaining_percent == 100
    process.communicate("quit\n", timeout=10)
    assert process.returncode == 0


def test_a_user_program_is_typed(tmp_path: Path) -> None:
    api = pytest.importorskip("mypy.api")
    user = tmp_path / "user.py"
    user.write_text(
        "import roburoc4\n"
        "with roburoc4.Simulator() as sim, sim.connect() as robot:\n"
        "    reveal_type(robot)\n"
        "    reveal_type(robot.battery.remaining_percent)\n"
        "    reveal_type(robot.wait_for(roburoc4.Event.READY))\n"
        "    reveal_type(robot.wait_for(lambda r: r.battery))\n"
        "    reveal_type(roburoc4.connect('x', threaded=False))\n"
        "    reveal_type(robot.wait_for('battery'))\n"
        "    async def wait(robot: roburoc4.aio.Robot) -> None:\n"
        "        reveal_type(await robot.wait_for('telemeter'))\n"
        "    robot.drive('fast', 0.0)\n"
        "    roburoc4.connect('x', coffee=1)\n",
        encoding="utf-8",
    )
    output, _, _ = api.run(["--strict", "--cache-dir", str(tmp_path), str(user)])
    revealed = re.findall(r'Revealed type is "([^"]*)"', output)
    assert [kind.rpartition(".")[2].strip("]") for kind in revealed] == [
        "Robot",
        "int",
        "Event",
        "BatteryStatus",
        "UnthreadedRobot",
        "BatteryStatus",
        "TelemeterStatus",
    ]
    assert set(re.findall(r"user.py:(\d+): error", output)) == {"11", "12"}
