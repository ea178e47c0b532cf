# SPDX-License-Identifier: MIT
"""The project's aims, each beside its figure and whether it was met."""

# peer -> how many times ours its figure must be at least, in every message and both directions
CODEC = {"memcpy": 1 / 1.5, "LCM": 1.5, "nanopb": 10, "MAVLink": 10}


WORDS = MET, MISSED, UNDECIDED = "met", "**MISSED**", "undecided"


def reached(low, high, aim, better):
    """The verdict on an interval: undecided where the aim is within it."""
    if better == "higher":
        return MET if low >= aim else MISSED if high < aim else UNDECIDED
    return MET if high <= aim else MISSED if low > aim else UNDECIDED


def verdict(result):
    """Whether a figure reaches its own aim; empty where it has none, or could not be measured."""
    if "aim" not in result or result["value"] is None:
        return ""
    low, high = result.get("low", result["value"]), result.get("high", result["value"])
    return reached(low, high, result["aim"], result.get("better", "lower"))


def codec_ratios(peer, own):
    """How many times ours a peer's figure is: the value, and as little and as much as intervals
    allow."""
    low, high = own.get("low", own["value"]), own.get("high", own["value"])
    return (
        peer["value"] / own["value"],
        peer.get("low", peer["value"]) / high,
        peer.get("high", peer["value"]) / low,
    )


def codec_rows(part, number):
    """Ours beside each peer: the ratios of all messages at once."""
    found = {}
    for result in part["results"]:
        found.setdefault(result["subject"], {})[result["name"]] = result
    own = found["roburoc4"]
    for peer, least in CODEC.items():
        ratios = [codec_ratios(result, own[name]) for name, result in found.get(peer, {}).items()]
        if not ratios:
            continue
        verdicts = [reached(low, high, least, "higher") for _, low, high in ratios]
        values = [value for value, _, _ in ratios]
        if peer == "memcpy":  # the limit: said the other way round
            aim, values = "at most ×1.5 of memcpy", [1 / value for value in values]
        else:
            aim = f"at least ×{least:g} faster than {peer}"
        figure = (
            f"×{number(min(values))} to ×{number(max(values))}; "
            f"{verdicts.count(MET)} of {len(ratios)} messages"
        )
        undecided = verdicts.count(UNDECIDED)
        if undecided:
            figure += f", {undecided} undecided"
        worst = next(word for word in (MISSED, UNDECIDED, MET) if word in verdicts)
        yield [part["title"], aim, figure, worst]


def rows(parts, number):
    """Part, aim, figure and verdict of each aim of these parts."""
    for part in parts:
        if part["part"] in ("codec", "instructions"):
            yield from codec_rows(part, number)
            continue
        for result in part["results"]:
            if not verdict(result):
                continue
            bound = "at least" if result.get("better", "lower") == "higher" else "at most"
            what = result["name"]
            if part["part"] == "footprint":
                what += f", {result['subject']}"
            figure = f"{number(result['value'])} {result['unit']}"
            if "low" in result and result["low"] != result["high"]:
                figure += f" ({number(result['low'])} to {number(result['high'])})"
            yield [
                part["title"],
                f"{what}: {bound} {number(result['aim'])}",
                figure,
                verdict(result),
            ]
