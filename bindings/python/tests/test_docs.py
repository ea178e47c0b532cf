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
