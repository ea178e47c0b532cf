# SPDX-License-Identifier: MIT
"""The package as it is installed."""

import importlib.metadata
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

import roburoc4
import roburoc4.iocard
import roburoc4.records
from roburoc4 import Simulator

FOLDER = Path(roburoc4.__file__).parent
Start = Callable[..., "subprocess.Popen[str]"]


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


def test_importing_is_quick() -> None:
    code = "import time; t = time.process_time(); import roburoc4; print(time.process_time() - t)"
    assert min(float(run(sys.executable, "-c", code).stdout) for _ in range(5)) < 0.04


PUBLIC = (roburoc4, roburoc4.protocol, roburoc4.records, roburoc4.iocard)


@pytest.mark.parametrize("module", PUBLIC)
def test_every_public_name_is_there(module: ModuleType) -> None:
    assert len(set(module.__all__)) == len(module.__all__)
    for name in module.__all__:
        assert getattr(module, name) is not None


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


@pytest.mark.parametrize("isolated", [False, True])
def test_a_subinterpreter_alone_connects_and_ends(served: Simulator, isolated: bool) -> None:
    """As in a web server; from Python 3.12 on, an isolated one refuses the import itself."""
    inside = f"""
import roburoc4
with roburoc4.connect({served.address!r}) as robot:
    print(robot.battery.remaining_percent, flush=True)
"""
    code = f"""
try:
    import _xxsubinterpreters as interpreters  # until Python 3.12
except ImportError:
    import _interpreters as interpreters
import sys
if sys.version_info < (3, 12):
    interpreter = interpreters.create(isolated={isolated})
else:
    interpreter = interpreters.create("isolated" if {isolated} else "legacy")
try:
    ended = interpreters.run_string(interpreter, {inside!r})
except Exception as error:
    ended = error
interpreters.destroy(interpreter)
assert ended is None or "subinterpreters" in str(ended), ended
print("ended")
"""
    # without the sitecustomize of these tests, which imports roburoc4
    lines = run(sys.executable, "-I", "-c", code).stdout.split()
    assert lines[-1] == "ended"
    assert lines == ["100", "ended"] or sys.version_info >= (3, 12)


def test_every_public_thing_is_described() -> None:
    bare = []
    for thing in [getattr(module, name) for module in PUBLIC for name in module.__all__]:
        if isinstance(thing, type) and not issubclass(thing, dict):
            methods = [v for k, v in vars(thing).items() if not k.startswith("_") and callable(v)]
            bare += [m for m in [thing, *methods] if not (m.__doc__ or "").strip()]
    assert bare == []


def test_roburoc4_sim_is_a_program() -> None:
    version = run(program("roburoc4-sim"), "--version").stdout
    assert version == f"roburoc4-sim {roburoc4.__version__}\n"
    assert "Usage" in run(program("roburoc4-sim"), "--help").stdout
    wrong = run(program("roburoc4-sim"), "--coffee")
    assert wrong.returncode == 2
    assert wrong.stderr.count("\n") == 1


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
        "ManualRobot",
        "BatteryStatus",
        "TelemeterStatus",
    ]
    assert set(re.findall(r"user.py:(\d+): error", output)) == {"11", "12"}
