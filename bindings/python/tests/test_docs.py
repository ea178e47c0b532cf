# SPDX-License-Identifier: MIT
"""The tutorial does what it says: its blocks are run, one after the other, as a reader would."""

import re
import sys
from pathlib import Path

import pytest

import roburoc4
from roburoc4 import Simulator

HERE = Path(__file__).resolve().parent
PAGES = [
    path
    for path in (
        HERE.parent / "core" / "docs" / "python.md",
        HERE.parents[2] / "docs" / "python.md",
        HERE.parent / "README.md",
    )
    if path.exists()
]


def blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_blocks_of_a_page_run(
    page: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Moves, which take a minute, in virtual time; the rest behind a port."""
    code = blocks(page)
    assert code
    reader: dict[str, object] = {"__name__": "reader"}
    with Simulator(port=0) as served:
        for block in code:
            text = re.sub(r"127\.0\.0\.1|192\.168\.0\.2", served.address, block)
            with Simulator() as stepped, monkeypatch.context() as patched:
                if re.search(r"robot\.(move|goto)\(", block):
                    patched.setattr(roburoc4, "connect", lambda _, sim=stepped: sim.connect())
                exec(compile(text, page.name, "exec"), reader)
                assert served.state.last_linear_m_s == stepped.state.last_linear_m_s == 0
        assert served.state.nonzero_speed_commands > 0
    assert "Traceback" not in capsys.readouterr().out
    assert "roburoc4" in sys.modules


def test_there_are_pages() -> None:
    assert PAGES


def test_the_patrol_waits_for_an_obstacle_and_continues(monkeypatch: pytest.MonkeyPatch) -> None:
    (block,) = [block for block in blocks(PAGES[0]) if "OBSTACLE" in block]
    assert len(block.splitlines()) < 20
    said: list[str] = []
    with Simulator(slip=0.0) as simulator:
        box = simulator.add_box(1.2, 0.0, 0.2, 0.2)
        assert box >= 0

        def show(error: roburoc4.MoveError) -> None:
            said.append(str(error))
            assert len(said) < 10
            simulator.clear_obstacles()

        monkeypatch.setattr(roburoc4, "connect", lambda _: simulator.connect())
        exec(block, {"roburoc4": roburoc4, "print": show})
        pose = simulator.true_pose
    assert len(said) == 1
    assert "telemeter" in said[0]
    assert (pose.x_m, pose.y_m) == pytest.approx((0.0, 0.0), abs=0.05)


def test_the_tutorial_passes_strict_type_checks(tmp_path: Path) -> None:
    api = pytest.importorskip("mypy.api")
    imports: list[str] = []
    files = []
    for number, block in enumerate(blocks(PAGES[0])):
        imports += re.findall(r"^import \w+$", block, re.M)
        if block.startswith("def test_"):
            continue  # of pytest, where nobody writes types
        file = tmp_path / f"block_{number}.py"
        file.write_text("\n".join([*dict.fromkeys(imports), block]), encoding="utf-8")
        files.append(str(file))
    out, err, code = api.run(["--strict", "--cache-dir", str(tmp_path / "cache"), *files])
    assert (code, err) == (0, ""), out
    typed = tmp_path / "typed.py"
    typed.write_text(
        "import roburoc4\n"
        "robot = roburoc4.connect()\n"
        "reveal_type(next(robot.statuses('localization')))\n"
    )
    assert "LocalizationStatus" in api.run(["--cache-dir", str(tmp_path / "cache"), str(typed)])[0]
