# SPDX-License-Identifier: MIT
"""Pictures of the main states; run by scripts/screenshots."""

import io
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright
from state_table import STATES, merged
from station import CHROMIUM, FAKE_PAD, SHOWS, Station, arm, hold_pad, open_tab, ready, until

LAPTOP: dict[str, Any] = {"viewport": {"width": 1440, "height": 900}}
TABLET: dict[str, Any] = {"viewport": {"width": 1024, "height": 600}}
PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 844},
    "device_scale_factor": 2,
    "has_touch": True,
}

LYING = PHONE | {"viewport": {"width": 844, "height": 390}}


@contextmanager
def scene(
    browser: Browser, theme: str, size: dict[str, Any], init: str = "", **settings: Any
) -> Iterator[Any]:
    """A dashboard and a page that shows it."""
    here = Station(battery_percent=68.0, lease_s=1.0, **settings)  # pictures take their time
    context = browser.new_context(color_scheme=theme, **size)
    context.add_init_script(FAKE_PAD + init)
    page = context.new_page()
    try:
        page.goto(here.url)
        yield here, page
    finally:
        context.close()
        here.close()


def drive_about(here: Station, page: Page, seconds: float) -> None:
    """Leave a path: ahead, then a bend."""
    arm(page)
    page.locator("#scale").fill("70")
    hold_pad(page, rt=1.0)
    time.sleep(seconds / 2)
    hold_pad(page, rt=0.8, lj=0.5)
    time.sleep(seconds / 2)


def save(page: Page, folder: Path, name: str) -> None:
    """Take a picture with few colours: a third of the size, and it looks the same."""
    path = folder / f"dashboard-{name}.png"
    taken = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    few = taken.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
    print(f"{path}: {path.stat().st_size // 1000} kB")  # noqa: T201  (a program's output)


def driving(browser: Browser, folder: Path) -> None:
    for size, name in (
        (LAPTOP, "driving-light"),
        (PHONE, "phone-driving"),
        (LYING, "phone-lying"),
    ):
        with scene(browser, "light", size, panel=True) as (here, page):
            drive_about(here, page, 7.0)
            save(page, folder, name)


def panel(browser: Browser, folder: Path) -> None:
    with scene(browser, "light", LAPTOP, panel=True) as (here, page):
        drive_about(here, page, 6.0)
        here.sim.set("front_bumper", True)
        time.sleep(0.6)
        open_tab(page, "sim")
        time.sleep(0.3)
        save(page, folder, "panel")


def override(browser: Browser, folder: Path) -> None:
    with scene(browser, "dark", LAPTOP, enable_drive=False) as (here, page):
        ready(page)
        here.sim.set("pad_a", True)
        here.sim.set("pad_rt", -0.2)
        until(lambda: here.sim.state.true_x_m > 1.0)
        save(page, folder, "override")


def lost(browser: Browser, folder: Path) -> None:
    with scene(browser, "light", TABLET) as (here, page):
        drive_about(here, page, 4.0)
        here.sim.set("power", False)
        page.get_by_text("ROBOT LOST").first.wait_for()
        time.sleep(1.0)
        save(page, folder, "lost")


def inhibited(browser: Browser, folder: Path) -> None:
    with scene(browser, "dark", PHONE) as (here, page):
        here.sim.set("estop_remote", True)
        arm(page)
        hold_pad(page, rt=1.0)
        page.get_by_text("The robot did not follow its commands").first.wait_for()
        save(page, folder, "phone-inhibited")


# A laptop, and at 200 % (720 by 450; 683 by 384 of a smaller one); a phone lying; less; a phone.
GALLERY_SIZES = ((1440, 900), (720, 450), (683, 384), (667, 375), (512, 384), (320, 568))
HEIGHT = 220


def press_place(page: Page) -> None:
    page.locator("#map-relocalize").click()


def press_past(page: Page) -> None:
    page.locator("#map-past").click()
    page.locator("#past-at").fill("-3")


def press_go(page: Page) -> None:
    page.locator("#map-go").click()


def gallery(browser: Browser, folder: Path) -> None:
    """Draw all states in all sizes and both themes as one page."""
    folder = folder / "gallery"
    folder.mkdir(exist_ok=True)
    opens = {"place": press_place, "go to": press_go, "past": press_past} | {
        f"tab {name}": partial(open_tab, name=name)
        for name in ("plots", "events", "io", "link", "sim")
    }
    scenes = [(title, frame, None) for title, frame in STATES]
    nobody = {"driver": None, "driver_name": None, "facts": {"armed": False}}
    other = {"driver": 99, "driver_name": "phone of the laboratory", "relievable": True}
    asks = {"asker": 99, "asker_name": "phone of the laboratory"}
    goes = {"going": [3.0, 1.0], "going_m_s": 0.3, "facts": {"armed": True, "driving": True}}
    scenes += [("DISARMED, nobody has control", nobody, None)]
    scenes += [("ARMED by another page", other | {"facts": {"armed": True}}, None)]
    scenes += [("ARMED, another page asks", asks | {"facts": {"armed": True}}, None)]
    scenes += [("DRIVING by itself", goes, None)]
    scenes += [("Several alarms", merged(STATES[3][1], merged(STATES[5][1], STATES[2][1])), None)]
    scenes += [("ARMED", {"facts": {"armed": True}}, name) for name in opens]
    scenes += [("NO CONNECTION", {}, "gone")]
    rows = []
    with scene(
        browser,
        "light",
        {"viewport": {"width": 1440, "height": 900}},
        init=SHOWS,
        panel=True,
        robots=("RED", "BLUE"),
    ) as (here, page):
        drive_about(here, page, 3.0)
        page.evaluate("hold(0, 0)")
        for number, (title, frame, special) in enumerate(scenes):
            calm = {"why": "", "must_let_go": False}
            page.evaluate("(frame) => { window.wanted = frame; }", calm | frame)
            if special == "gone":
                here.stop_serving()
                page.get_by_text("NO CONNECTION").first.wait_for()
            pictures = []
            for theme in ("light", "dark"):
                page.emulate_media(color_scheme=theme)
                for width, height in GALLERY_SIZES:
                    page.set_viewport_size({"width": width, "height": height})
                    page.wait_for_timeout(150)
                    if special in opens:
                        opens[special](page)
                    page.wait_for_timeout(150)
                    name = f"{number:02}-{theme}-{width}x{height}.jpg"
                    page.screenshot(path=folder / name, type="jpeg", quality=70)
                    if special in opens:
                        page.keyboard.press("Escape")
                    pictures.append(
                        f'<a href="{name}"><img src="{name}" height="{HEIGHT}" '
                        f'alt="{title}, {theme}, {width} by {height}"></a>'
                    )
            rows.append(f"<h2>{title} {special or ''}</h2>" + "".join(pictures))
    text = "<!doctype html><meta charset='utf-8'><title>The dashboard</title>" + "\n".join(rows)
    (folder / "index.html").write_text(text, encoding="utf-8")
    print(folder / "index.html")  # noqa: T201


SCENES = (driving, panel, override, lost, inhibited)


def main() -> None:
    folder, wanted = Path(sys.argv[1]), sys.argv[2:]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        for take in (*SCENES, gallery):
            if take.__name__ in wanted or (not wanted and take is not gallery):
                take(browser, folder)
        browser.close()


if __name__ == "__main__":
    main()
