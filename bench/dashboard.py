# SPDX-License-Identifier: MIT
"""What `roburoc4 dashboard` costs, with real pages in Debian's Chromium.

    dashboard.py cpu        the program's share of a core: 5 services at 50 Hz, three pages
    dashboard.py memory     what an hour of driving leaves in program and page

Run by scripts/test-dashboard and scripts/check-dashboard-memory, which make the environment that
it needs: the package with its extra, and Playwright. Exit status: 0 kept, 1 broken, 2 the run was
too short to tell.
"""

import argparse
import contextlib
import math
import os
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from playwright.sync_api import CDPSession, Page, sync_playwright

PAGES = 3
CPU_SHARE = 0.10
DRIVEN_SHARE = 0.8
SERVER_MB_PER_HOUR = 4.0
PAGE_MB_PER_HOUR = 10.0
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
PYTHON = [sys.executable, "-c"]
COMMAND = [*PYTHON, "from roburoc4_tools.cli import main; main()"]
SIMULATOR = [os.path.join(os.path.dirname(sys.executable), "roburoc4-sim")]

FAKE_PAD = """
window.pad = { id: "bench", index: 0, connected: true, mapping: "standard", axes: [-0.6, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ pressed: false, value: 0 })) };
navigator.getGamepads = () => [window.pad];
"""


@contextlib.contextmanager
def program(*command: str, ready: str) -> Iterator[tuple[int, str]]:
    """Run a program; return its process and the match of its ready line."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        for line in running.stdout:
            if found := re.search(ready, line):
                break
        else:
            sys.exit(f"{command[-1]} ended before it was ready")
        try:
            yield running.pid, found[1]
        finally:
            running.terminate()


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident_mb(pid: int) -> float:
    """Return the memory that a process holds."""
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@contextlib.contextmanager
def pages(link: str) -> Iterator[list[Page]]:
    """Open pages, each in a window of its own."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        opened = [browser.new_context().new_page() for _ in range(PAGES)]
        for page in opened:
            page.set_default_timeout(60_000)
            page.add_init_script(FAKE_PAD)
            page.goto(link)
            page.get_by_text("Link good").first.wait_for()
        yield opened
        browser.close()


def drive(page: Page) -> None:
    """Drive in circles."""
    page.get_by_role("button", name="Take control").click()
    page.get_by_role("button", name="Arm", exact=True).click()
    page.get_by_text("Ready: hold").wait_for()
    page.evaluate("pad.buttons[0] = { pressed: true, value: 1 }")
    page.evaluate("pad.buttons[7] = { pressed: true, value: 0.8 }")


def drives_on(page: Page) -> bool:
    """Return whether it drives; where a stall ended that, switch inputs off and on."""
    if page.locator("#banner-title").text_content() == "DRIVING":
        return True
    page.evaluate("pad.buttons[0] = { pressed: false, value: 0 }")
    if page.locator("#arm").is_visible():
        page.locator("#arm").click()
    page.wait_for_timeout(500)
    page.evaluate("pad.buttons[0] = { pressed: true, value: 1 }")
    return False


def share_of_core(pid: int, seconds: float) -> float:
    """Return how much of one core a process uses."""
    begun_s, begun_cpu_s = time.monotonic(), cpu_s(pid)
    time.sleep(seconds)
    return (cpu_s(pid) - begun_cpu_s) / (time.monotonic() - begun_s)


def share_while_driving(page: Page, pid: int, seconds: float) -> float:
    """Measure until it has driven all the time."""
    for _ in range(3):
        share = share_of_core(pid, seconds)
        if drives_on(page):
            return share
    sys.exit("it did not keep driving: leave the machine idle, and start again")


def write_results(folder: str, shares: dict[str, float]) -> None:
    """Write the figures for bench/report.py."""
    import figures

    about = (
        "Share of one core: five services at 50 Hz, three pages open in Chromium. Driven with a "
        "lease of 1 s (default 250 ms), so that a stall of the machine does not end it."
    )
    part = figures.Part("dashboard", "Dashboard", about, [])
    for name, share in shares.items():
        value, aim = round(100 * share, 2), 100 * CPU_SHARE
        part.add(f"processor time, {name}", "roburoc4", "% of a core", value, aim=aim)
    part.write(folder)


def bench_cpu(seconds: float, path: str | None) -> bool:
    """Measure while watched, and while driven."""
    with program(*SIMULATOR, "--port", "0", ready=r"ready on (\S+)") as (_, robot):
        options = ("--robot", robot, "--period-ms", "20", "--enable-drive")
        options += ("--lease-ms", "1000", "--port", "0", "--no-open")
        with (
            program(*COMMAND, "dashboard", *options, ready=r"(http\S+)") as (pid, link),
            pages(link) as opened,
        ):
            time.sleep(2.0)
            watched = share_of_core(pid, seconds)
            drive(opened[0])
            driven = share_while_driving(opened[0], pid, seconds)
            drawn = opened[0].locator("#pages").text_content()
    print(
        f"dashboard, 5 services at 50 Hz, {drawn}: {watched:.1%} of a core watched, "
        f"{driven:.1%} driven (at most {CPU_SHARE:.0%})"
    )
    if path is not None:
        write_results(path, {"watched": watched, "driven": driven})
    return max(watched, driven) < CPU_SHARE


def heap_mb(session: CDPSession) -> float:
    """Return what a page's scripts hold after a collection."""
    session.send("HeapProfiler.collectGarbage")
    return float(session.send("Runtime.getHeapUsage")["usedSize"]) / 1e6


@dataclass(frozen=True)
class Trend:
    """A straight line through memory over time, and how well it is known."""

    name: str
    mb: float
    mb_per_hour: float
    error_mb_per_hour: float
    """Twice the slope's standard error."""
    most_mb_per_hour: float

    @property
    def grows(self) -> bool:
        """Whether it grows by more than it may, beyond doubt."""
        return self.mb_per_hour - self.error_mb_per_hour > self.most_mb_per_hour

    @property
    def kept(self) -> bool:
        """Whether it stays below what it may, beyond doubt."""
        return self.mb_per_hour + self.error_mb_per_hour <= self.most_mb_per_hour

    def __str__(self) -> str:
        word = "grows" if self.grows else "kept" if self.kept else "too short a run to tell"
        return (
            f"{self.name} {self.mb:.1f} MB, {self.mb_per_hour:+.2f} ± {self.error_mb_per_hour:.2f} "
            f"MB/h (at most {self.most_mb_per_hour:g}): {word}"
        )


def trend(
    name: str, times_s: list[float], values_mb: list[float], most_mb_per_hour: float
) -> Trend:
    """Judge the second half of a run, when everything that fills up is full."""
    times_h = [time_s / 3600.0 for time_s in times_s[len(times_s) // 2 :]]
    values = values_mb[len(times_s) // 2 :]
    slope, start = statistics.linear_regression(times_h, values)
    middle = statistics.fmean(times_h)
    spread = sum((time_h - middle) ** 2 for time_h in times_h)
    pairs = zip(times_h, values, strict=True)
    left = sum((value - start - slope * time_h) ** 2 for time_h, value in pairs)
    error = math.sqrt(left / max(len(values) - 2, 1) / spread)
    return Trend(name, values[-1], slope, 2.0 * error, most_mb_per_hour)


def bench_memory(minutes: float, every_s: float) -> int:
    """Drive in circles, and sample repeatedly; return the exit status."""
    options = ("--sim", "--enable-drive", "--lease-ms", "1000", "--port", "0", "--no-open")
    with (
        program(*COMMAND, "dashboard", *options, ready=r"(http\S+)") as (pid, link),
        pages(link) as opened,
    ):
        drive(opened[0])
        driven: list[bool] = []
        session = opened[0].context.new_cdp_session(opened[0])
        times_s: list[float] = []
        server_mb: list[float] = []
        page_mb: list[float] = []
        end_s = time.monotonic() + 60.0 * minutes
        while time.monotonic() < end_s:
            time.sleep(every_s)
            times_s.append(time.monotonic())
            server_mb.append(resident_mb(pid))
            page_mb.append(heap_mb(session))
            driven.append(drives_on(opened[0]))
            minute = minutes - (end_s - times_s[-1]) / 60.0
            print(f"{minute:5.1f} min  {server_mb[-1]:6.1f} MB  {page_mb[-1]:6.1f} MB", flush=True)
    share = sum(driven) / len(driven)
    trends = (
        trend("program", times_s, server_mb, SERVER_MB_PER_HOUR),
        trend("page", times_s, page_mb, PAGE_MB_PER_HOUR),
    )
    print(f"dashboard, {minutes:g} min, {share:.0%} of them driven: {trends[0]}; {trends[1]}")
    if share < DRIVEN_SHARE or any(one.grows for one in trends):
        return 1
    return 0 if all(one.kept for one in trends) else 2


def main() -> int:
    """Run one of the two."""
    parser = argparse.ArgumentParser(description="What roburoc4 dashboard costs.")
    parser.add_argument("what", choices=("cpu", "memory"))
    parser.add_argument("--seconds", type=float, default=15.0, help="of each measurement of cpu")
    parser.add_argument("--minutes", type=float, default=60.0, help="of the run of memory")
    parser.add_argument("--every", type=float, default=15.0, metavar="S", help="sample this often")
    parser.add_argument("--out", metavar="FOLDER", help="write the figures of cpu there")
    options = parser.parse_args()
    if options.minutes * 60.0 < 8 * options.every:
        parser.error(f"--minutes {options.minutes:g}: give time for 8 samples, or less to --every")
    if options.what == "memory":
        return bench_memory(options.minutes, options.every)
    return 0 if bench_cpu(options.seconds, options.out) else 1


if __name__ == "__main__":
    sys.exit(main())
