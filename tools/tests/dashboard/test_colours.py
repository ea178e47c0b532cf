# SPDX-License-Identifier: MIT
"""Whether everybody can read the page: contrast, and colours as colour-blind people see them.

How they see: the matrices of Machado, Oliveira and Fernandes (2009) for no red, green or blue
cones, on linear RGB. How different two colours look: the distance in CIE Lab (1976).
"""

import itertools
import math
import re
from pathlib import Path

import pytest

import roburoc4_tools.dashboard

STYLE = (Path(roburoc4_tools.dashboard.__file__).parent / "static/style.css").read_text(
    encoding="utf-8"
)
THEMES = {"light": ":root {", "dark": ':root[data-theme="dark"] {'}
EYES = {
    "all cones": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "no red": ((0.1523, 1.0526, -0.2049), (0.1145, 0.7863, 0.0992), (-0.0039, -0.0481, 1.0519)),
    "no green": ((0.3673, 0.8606, -0.2280), (0.2801, 0.6726, 0.0473), (-0.0118, 0.0429, 0.9689)),
    "no blue": ((1.2555, -0.0768, -0.1788), (-0.0784, 0.9308, 0.1476), (0.0047, 0.6914, 0.3039)),
}
Colour = tuple[float, ...]


def colours(theme: str) -> dict[str, Colour]:
    """The variables of a theme, in linear RGB."""
    block = STYLE.partition(THEMES[theme])[2].partition("}")[0]
    found = {}
    for name, text in re.findall(r"--([\w-]+): #([0-9a-f]{6}|[0-9a-f]{3});", block):
        digits = text if len(text) == 6 else "".join(2 * digit for digit in text)
        shares = [int(digits[at : at + 2], 16) / 255 for at in (0, 2, 4)]
        found[name] = tuple(
            share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4
            for share in shares
        )
    return found


def mixed(one: Colour, other: Colour, share: float) -> Colour:
    """A mix, with this share of the first; browsers mix before they convert to linear RGB."""
    pairs = zip(one, other, strict=True)
    return tuple((share * a ** (1 / 2.2) + (1 - share) * b ** (1 / 2.2)) ** 2.2 for a, b in pairs)


def contrast(one: Colour, other: Colour) -> float:
    """Return the contrast of WCAG 2."""
    low, high = sorted(0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in (one, other))
    return (high + 0.05) / (low + 0.05)


def lab(colour: Colour, eyes: str) -> Colour:
    seen = [max(0.0, sum(a * b for a, b in zip(row, colour, strict=True))) for row in EYES[eyes]]
    white = (0.9505, 1.0, 1.089)
    to_xyz = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
    x, y, z = (
        math.cbrt(sum(a * b for a, b in zip(row, seen, strict=True)) / whole)
        for row, whole in zip(to_xyz, white, strict=True)
    )
    return (116 * y - 16, 500 * (x - y), 200 * (y - z))


@pytest.mark.parametrize("theme", THEMES)
def test_text_can_be_read(theme: str) -> None:
    ink = colours(theme)
    for text, ground in (
        *itertools.product(("text", "soft"), ("card", "page", "raised")),
        *(("on-colour", fill) for fill in ("red", "blue", "green", "violet")),
        ("on-orange", "orange"),
    ):
        assert contrast(ink[text], ink[ground]) >= 4.5, (text, ground)


@pytest.mark.parametrize("theme", THEMES)
def test_lines_and_signs_can_be_seen(theme: str) -> None:
    ink = colours(theme)
    for line in ("red", "orange", "blue", "sky", "green", "violet", "soft"):
        assert contrast(ink[line], ink["card"]) >= 2.5, line


@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("orange", "blue"),  # target and current, truth and odometry, voltage and charge
        ("red", "blue"),  # a warning, and driving
        ("red", "green"),  # bad and good
        ("red", "sky"),  # near and far obstacles
        ("red", "orange"),  # bad and weak
        ("orange", "green"),  # weak and good
        ("blue", "full"),  # current, and full deflection below it
        ("orange", "full"),  # target, and full deflection
    ],
)
def test_colours_of_other_meanings_look_different_to_everybody(
    one: str, other: str, theme: str, eyes: str
) -> None:
    ink = colours(theme)
    ink["full"] = mixed(ink["sky"], ink["line"], 0.4)  # as a bar has it: style.css, .full
    assert math.dist(lab(ink[one], eyes), lab(ink[other], eyes)) > 20.0
