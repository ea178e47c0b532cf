# SPDX-License-Identifier: MIT
"""The project's aims, each beside its figure and whether it was met."""

# peer -> how many times ours its figure must be at least, in every message and both directions
CODEC = {"memcpy": 1 / 1.5, "LCM": 1.5, "nanopb": 10, "MAVLink": 10}


def met(result):
    """Whether a figure reaches its own aim; None where it has none, or could not be measured."""
    if "aim" not in result or result["value"] is None:
        return None
    if result.get("better", "lower") == "higher":
        return result["value"] >= result["aim"]
    return result["value"] <= result["aim"]


def verdict(is_met):
    """The word for it."""
    return "" if is_met is None else "met" if is_met else "**MISSED**"


def codec_rows(part, number):
    """Ours beside each peer: the ratios of all messages at once."""
    values = {}
    for result in part["results"]:
        values.setdefault(result["subject"], {})[result["name"]] = result["value"]
    own = values["roburoc4"]
    for peer, least in CODEC.items():
        ratios = [value / own[name] for name, value in values.get(peer, {}).items()]
        if not ratios:
            continue
        good = sum(ratio >= least for ratio in ratios)
        if peer == "memcpy":  # the limit: said the other way round
            aim, ratios = "at most ×1.5 of memcpy", [1 / ratio for ratio in ratios]
        else:
            aim = f"at least ×{least:g} faster than {peer}"
        figure = (
            f"×{number(min(ratios))} to ×{number(max(ratios))}; {good} of {len(ratios)} messages"
        )
        yield [part["title"], aim, figure, verdict(good == len(ratios))]


def rows(parts, number):
    """Part, aim, figure and verdict of each aim of these parts."""
    for part in parts:
        if part["part"] in ("codec", "instructions"):
            yield from codec_rows(part, number)
            continue
        for result in part["results"]:
            if met(result) is None:
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
                verdict(met(result)),
            ]
