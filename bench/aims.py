# SPDX-License-Identifier: MIT
"""Judge figures against the project's aims, and say why an aim is missed.

The aim of a single figure is beside it in its measure_*.py; the codec's are here, because they are
ratios to other libraries.
"""

import dataclasses

# Library -> how many times roburoc4's cost its cost should be, for each message.
CODEC = {"memcpy": 1 / 1.5, "LCM": 1.5, "nanopb": 10, "MAVLink": 10}

CHECKED = (
    "Length and header are checked, reserved fields are cleared and a result is returned, which a "
    "bare copy of the bytes does not do."
)
LISTS = (
    "Lists (IO card, telemeter) have a length that is known only at run time, and each is checked "
    "against the datagram; the other messages reach it."
)
# (part, aim) -> why it is missed; printed only while it is.
REASONS = {
    ("codec", "memcpy"): CHECKED,
    ("instructions", "memcpy"): CHECKED,
    ("codec", "LCM"): LISTS,
    ("instructions", "LCM"): LISTS,
    ("loopback", "status to value, p50, ratio to bare"): (
        "The adapter waits for a datagram or for the client's deadline, so that a stop sequence "
        "leaves in time; that is one system call more than a `recv` that waits for ever. The row "
        "with `ppoll` is a bare loop that can wake in time, too."
    ),
    ("footprint", "codec, all of it"): (
        "It has both directions of every telegram and the readers of lists; a program links only "
        "what it calls, and the six messages of the comparison are within the aim."
    ),
    ("footprint", "firmware that drives, linked"): (
        "Since the aim was set, the client learned to find inputs and services by the words of "
        "their texts and to bound the age of a status by round trips."
    ),
    ("footprint", "moves, all of it"): (
        "Each step closes the loop on localization, brakes for obstacles and bumpers and ends with "
        "a cause; on a processor without floats that is some hundred calls of float functions. A "
        "firmware without moves does not link them."
    ),
    ("python", "decode to an object: IO card"): (
        "The status with the most values: each of 9 analog and 22 digital inputs becomes an object."
    ),
    ("python", "batch decode, a list of datagrams"): (
        "Python goes through the list, one object at a time, before NumPy decodes the joined bytes."
    ),
}
NO_REASON = "**NO REASON GIVEN: write it in bench/aims.py**"

MET, MISSED, UNDECIDED = "met", "**missed**", "undecided"


@dataclasses.dataclass(frozen=True)
class Judged:
    """One aim, and whether it was reached."""

    part: str
    aim: str
    figure: str
    verdict: str
    reason: str


def reached(low, high, aim, better):
    """Judge an interval: undecided if the aim is inside it."""
    if better == "higher":
        return MET if low >= aim else MISSED if high < aim else UNDECIDED
    return MET if high <= aim else MISSED if low > aim else UNDECIDED


def verdict(result):
    """Judge a figure that has an aim; empty if it has none, or could not be measured."""
    if "aim" not in result or result["value"] is None:
        return ""
    low, high = result.get("low", result["value"]), result.get("high", result["value"])
    return reached(low, high, result["aim"], result.get("better", "lower"))


def reason(part, aim, judged):
    if judged == UNDECIDED:
        return "the aim is inside the interval"
    return REASONS.get((part, aim), NO_REASON) if judged == MISSED else ""


def codec_ratio(peer, own):
    """A peer's figure divided by ours: value, and the ends of its interval."""
    low, high = own.get("low", own["value"]), own.get("high", own["value"])
    return (
        peer["value"] / own["value"],
        peer.get("low", peer["value"]) / high,
        peer.get("high", peer["value"]) / low,
    )


def codec_aims(part, number):
    """Judge the ratios to each peer, over all messages."""
    found = {}
    for result in part["results"]:
        found.setdefault(result["subject"], {})[result["name"]] = result
    own = found["roburoc4"]
    for peer, least in CODEC.items():
        ratios = [codec_ratio(result, own[name]) for name, result in found.get(peer, {}).items()]
        if not ratios:
            continue
        verdicts = [reached(low, high, least, "higher") for _, low, high in ratios]
        values = [value for value, _, _ in ratios]
        if peer == "memcpy":  # the lower bound: ours is divided by it
            aim, values = "at most ×1.5 of memcpy", [1 / value for value in values]
        else:
            aim = f"{peer} takes at least ×{least:g}"
        figure = (
            f"×{number(min(values))} to ×{number(max(values))}; "
            f"{verdicts.count(MET)} of {len(ratios)} messages"
        )
        undecided = verdicts.count(UNDECIDED)
        if undecided:
            figure += f", {undecided} undecided"
        worst = next(word for word in (MISSED, UNDECIDED, MET) if word in verdicts)
        yield Judged(part["title"], aim, figure, worst, reason(part["part"], peer, worst))


def judge(parts, number):
    """Judge each aim of these parts."""
    for part in parts:
        if part["part"] in ("codec", "instructions"):
            yield from codec_aims(part, number)
            continue
        for result in part["results"]:
            found = verdict(result)
            if not found:
                continue
            bound = "at least" if result.get("better", "lower") == "higher" else "at most"
            figure = f"{number(result['value'])} {result['unit']}"
            if "low" in result and result["low"] != result["high"]:
                figure += f" ({number(result['low'])} to {number(result['high'])})"
            yield Judged(
                part["title"],
                f"{result['name']}: {bound} {number(result['aim'])}",
                figure,
                found,
                reason(part["part"], result["name"], found),
            )
