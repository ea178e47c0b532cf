# SPDX-License-Identifier: MIT
"""docs/recording.md does what it says: its commands are typed one after the other."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from cli_support import FOLDER, environment

PAGE = Path(__file__).resolve().parents[2] / "docs" / "recording.md"
_TOOLS = ("tshark", "octave")


def _session() -> str:
    """All that a reader types, for a shell: blocks of sh, and those of Python as programs."""
    parts = []
    walk = PAGE.read_text(encoding="utf-8").partition("## A tour")[2].partition("\n## ")[0]
    for language, text in re.findall(
        r"^```(sh|python)\n(.*?)^```$", walk, re.MULTILINE | re.DOTALL
    ):
        lines = [
            line
            for line in text.splitlines()
            if not (line.startswith(_TOOLS) and shutil.which(line.split()[0]) is None)
        ]
        block = "\n".join(lines)
        parts.append(block if language == "sh" else f"python3 - <<'PYTHON'\n{block}\nPYTHON")
    return "\n".join(parts) + "\n"


@pytest.mark.skipif(not PAGE.exists(), reason="an sdist has no pages but python.md")
def test_the_tour_of_the_page_works_as_typed(tmp_path: Path) -> None:
    import roburoc4

    with roburoc4.Simulator(port=0) as taken:  # a port that is free, instead of the usual one
        port = taken.address.rpartition(":")[2]
    text = _session()
    # other tests run beside this one
    text = text.replace("roburoc4 sim &", f"roburoc4 sim --port {port} &")
    text = text.replace("--robot 127.0.0.1 ", f"--robot 127.0.0.1:{port} ")
    # however slow this machine is, there is a drive of some seconds before the kill
    size = "$(stat -c %s runs/*.pcapng 2>/dev/null || echo 0)"
    recorded = f'until [ "{size}" -gt 60000 ]; do sleep 0.1; done'
    assert text.count("sleep 6") == 1
    text = text.replace("sleep 6", recorded)
    # ... and each robot is there before the next line
    text, robots = re.subn(
        r"& sleep 2$",
        ">ready.log 2>&1 & until grep ready ready.log; do sleep 0.1; done",
        text,
        flags=re.MULTILINE,
    )
    assert robots == 2
    with roburoc4.Simulator(port=0) as taken:
        text = text.replace("60001", taken.address.rpartition(":")[2])
    env = environment()
    done = subprocess.run(
        ["bash", "-e", "-m", "-c", text],
        cwd=tmp_path,
        env=env | {"PATH": f"{FOLDER}:{env['PATH']}", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    said = done.stdout + done.stderr
    assert "Traceback" not in said, said
    assert done.returncode == 0, said
    figures = json.loads((tmp_path / "figures.json").read_text(encoding="utf-8"))
    assert figures["path"]["driven_m"] > 0.3
    assert any("begins to drive" in event["text"] for event in figures["events"])
    assert "<svg" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert (tmp_path / "run.mcap").stat().st_size > 10_000
    assert (tmp_path / "run.csv").stat().st_size > 10_000
    assert "commands change nothing" in said
    assert said.count("ready") >= 3
