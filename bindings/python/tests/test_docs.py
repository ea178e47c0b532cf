# SPDX-License-Identifier: MIT
"""The tutorial does what it says: its blocks are run, one after the other, as a reader would."""

import re
import sys
from pathlib import Path

import pytest

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
def test_the_blocks_of_a_page_run(page: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = blocks(page)
    assert code
    reader: dict[str, object] = {"__name__": "reader"}
    with Simulator(port=0) as simulator:
        for block in code:
            text = re.sub(r"127\.0\.0\.1|192\.168\.0\.2", simulator.address, block)
            exec(compile(text, page.name, "exec"), reader)
            assert simulator.state.last_linear_m_s == 0
        assert simulator.state.nonzero_speed_commands > 0
    assert "Traceback" not in capsys.readouterr().out
    assert "roburoc4" in sys.modules


def test_there_are_pages() -> None:
    assert PAGES
