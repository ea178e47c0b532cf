# SPDX-License-Identifier: MIT
"""The command's parts that need no robot: numbers, keys, dead man, verdicts."""

import argparse
import math

import pytest

from roburoc4_tools.cli import options, output
from roburoc4_tools.cli.connecting.verdict import Findings, Stream, judge
from roburoc4_tools.terminal.deadman import FIRST_S, REPEAT_S, DeadMan
from roburoc4_tools.terminal.keyboard import Decoder, Key, is_ctrl_c

# ------------------------------------------------------------------------------------- numbers


@pytest.mark.parametrize("text", ["nan", "inf", "-1", "0", "three"])
def test_a_duration_is_finite_and_positive(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=r"0\.001 to 1e\+06 seconds"):
        options.seconds(text)


def test_negative_numbers_are_escaped_and_options_are_not() -> None:
    shielded = options.shield_numbers(["-0.5", "-.5", "-1e-3", "-inf", "--yes", "-y", "5", "-"])
    assert shielded == [" -0.5", " -.5", " -1e-3", " -inf", "--yes", "-y", "5", "-"]


def test_an_angle_is_in_radians_or_degrees() -> None:
    assert options.angle("-1.5") == -1.5
    assert options.angle(" 90deg") == pytest.approx(math.pi / 2)
    assert options.angle("-1e2DEG") == pytest.approx(-math.radians(100))
    assert options.shield_numbers(["-90deg", "-1.5"]) == [" -90deg", " -1.5"]
    for text in ("nan", "deg", "infdeg", "90 degrees", "1e5"):
        with pytest.raises(argparse.ArgumentTypeError, match=r"rad|degrees"):
            options.angle(text)


def test_a_robots_text_does_not_control_the_terminal() -> None:
    assert output.printable("Möhre\x1b[2J\n") == "Möhre\N{REPLACEMENT CHARACTER}[2J" + (
        "\N{REPLACEMENT CHARACTER}"
    )


# ---------------------------------------------------------------------------------------- keys


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        (b"w", [Key("w")]),
        (b"W ", [Key("w"), Key(" ")]),
        (b"\x1bw", []),  # Alt-W is not W
        (b"\x1b[A\x1bOD", [Key("up"), Key("left")]),
        (
            b"\x1b[1;1:1A\x1b[1;1:2A\x1b[1;1:3A",
            [Key("up", a) for a in ("press", "repeat", "release")],
        ),
        (
            b"\x1b[119u\x1b[119;1:2u\x1b[119:87;2:3u",
            [Key("w", a) for a in ("press", "repeat", "release")],
        ),
        (b"\x1b[57441;2u", []),  # the shift key alone
        (b"\x1b[97;5u", []),  # Ctrl-A is not A
        (b"\x1b[O\x1b[I", [Key("", "blur")]),
        (b"\x1b[0n", [Key("", "echo")]),
    ],
)
def test_bytes_of_a_terminal_are_keys(data: bytes, keys: list[Key]) -> None:
    assert list(Decoder().feed(data)) == keys
    decoder = Decoder()
    assert [key for byte in data for key in decoder.feed(bytes((byte,)))] == keys


def test_a_terminal_says_whether_it_reports_releases() -> None:
    decoder = Decoder()
    assert list(decoder.feed(b"\x1b[?62;c")) == []
    assert decoder.answered
    assert not decoder.reports_releases
    assert list(decoder.feed(b"\x1b[?11u")) == []
    assert decoder.reports_releases


def test_ctrl_c_is_also_read_as_a_key() -> None:
    (key,) = Decoder().feed(b"\x1b[99;5u")
    assert is_ctrl_c(key)
    (let_go,) = Decoder().feed(b"\x1b[99;5:3u")
    assert not is_ctrl_c(let_go)


# ------------------------------------------------------------------------------------ dead man


def test_without_releases_a_key_is_held_until_repeats_are_due() -> None:
    man = DeadMan(reports_releases=False)
    man.feed(Key("w"), 0.0)
    assert man.held(FIRST_S) == ["w"]
    assert man.held(FIRST_S + 0.01) == []


def test_without_releases_a_key_ends_soon_after_its_last_repeat() -> None:
    man = DeadMan(reports_releases=False)
    man.feed(Key("w"), 0.0)
    man.feed(Key("w"), 0.5)
    man.feed(Key("w"), 0.53)
    assert man.held(0.53 + REPEAT_S) == ["w"]
    assert man.held(0.53 + REPEAT_S + 0.01) == []
    man.feed(Key("w"), 1.0)
    assert man.held(1.0 + FIRST_S) == ["w"]


def test_without_releases_another_key_takes_over() -> None:
    man = DeadMan(reports_releases=False)
    man.feed(Key("w"), 0.0)
    man.feed(Key("a"), 0.1)
    assert man.held(0.2) == ["a"]


def test_with_releases_keys_are_held_together_until_released() -> None:
    man = DeadMan(reports_releases=True)
    man.feed(Key("w"), 0.0)
    man.feed(Key("a"), 0.1)
    assert man.held(0.2) == ["w", "a"]
    man.feed(Key("w", "release"), 0.3)
    assert man.held(0.4) == ["a"]


def test_with_releases_a_line_that_hangs_counts_as_release() -> None:
    man = DeadMan(reports_releases=True)
    man.feed(Key("w"), 0.0)
    for tenth in range(1, 30):
        man.feed(Key("", "echo"), tenth / 10)
        assert man.held(tenth / 10) == ["w"]
    assert man.held(2.9 + FIRST_S + 0.01) == []


def test_a_window_that_loses_the_keyboard_lets_go() -> None:
    man = DeadMan(reports_releases=True)
    man.feed(Key("w"), 0.0)
    man.feed(Key("", "blur"), 0.1)
    assert man.held(0.1) == []


# ------------------------------------------------------------------------------------ verdicts


def _stream(**changes: object) -> Stream:
    values: dict[str, object] = {
        "service": "iocard",
        "asked_hz": 20.0,
        "received": 100,
        "rate_hz": 20.0,
        "jitter_ms": 0.2,
    }
    return Stream(**{**values, **changes})  # type: ignore[arg-type]


def _found(**changes: object) -> Findings:
    values: dict[str, object] = {
        "robot": "robot",
        "address": "10.0.0.1:60000",
        "asked": 10,
        "answered": 10,
        "round_trip_ms": 0.5,
        "connected": True,
        "watched_s": 5.0,
        "streams": [_stream()],
    }
    return Findings(**{**values, **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("found", "number", "code"),
    [
        (_found(), 0, 0),
        (_found(fault="name"), 1, 3),
        (_found(fault="route"), 2, 3),
        (_found(fault="denied"), 3, 3),
        (_found(fault="refused"), 4, 3),
        (_found(fault="silence", answered=0), 5, 3),
        (_found(connected=False), 6, 1),
        (_found(missing=["battery"]), 7, 1),
        (_found(interruptions=2), 8, 1),
        (_found(streams=[_stream(), _stream(received=0)]), 9, 1),
        (_found(streams=[_stream(lost=10)]), 10, 1),
        (_found(streams=[_stream(lost=100), _stream(asked_hz=1.0, received=0)]), 10, 1),
        (_found(streams=[_stream(jitter_ms=40.0)]), 11, 1),
        (_found(round_trip_ms=80.0), 12, 1),
        (_found(streams=[_stream(rate_hz=10.0)]), 13, 1),
    ],
)
def test_each_fault_has_its_verdict(found: Findings, number: int, code: int) -> None:
    verdict = judge(found)
    assert (verdict.number, verdict.code) == (number, code)
    assert verdict.remedy
    assert any(character.isdigit() for character in verdict.sentence) or number == 1
