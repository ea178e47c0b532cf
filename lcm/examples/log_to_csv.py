# SPDX-License-Identifier: MIT
"""Convert an LCM log to CSV, one file per channel, and draw the robot's path.

    python log_to_csv.py lcmlog-2026-11-21.00 run
    python log_to_csv.py lcmlog-2026-11-21.00 run --plot run/path.svg     (needs matplotlib)

writes run/ROBUROC4_LOCALIZATION.csv and so on, with a column for each field, named as in
lcm/types/*.lcm; lists get a column for each element. Characters that do not belong in a file name,
such as the slash of LAB/ROBUROC4_LOCALIZATION, become ``_``. ``log_utime`` is when lcm-logger
received the message.
"""

import argparse
import csv
import re
import struct
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import lcm
import roburoc4_lcm

TYPES = [
    getattr(roburoc4_lcm, name)
    for name in dir(roburoc4_lcm)
    if hasattr(getattr(roburoc4_lcm, name), "decode")
]
BY_FINGERPRINT = {kind._get_packed_fingerprint(): kind for kind in TYPES}


def columns(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Name and value of every field; lists and nested structs are flattened."""
    if hasattr(value, "__slots__"):
        for field in value.__slots__:
            yield from columns(getattr(value, field), f"{name}_{field}" if name else field)
    elif isinstance(value, list | tuple):
        for index, element in enumerate(value):
            yield from columns(element, f"{name}_{index}")
    else:
        yield name, value


def rows(log: Path) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Channel, type and fields of each message of our types; others are skipped."""
    for event in lcm.EventLog(str(log), "r"):
        kind = BY_FINGERPRINT.get(event.data[:8])
        if kind is None:
            continue
        try:
            row = dict(columns(kind.decode(event.data)))
        except (struct.error, ValueError) as error:
            print(f"{event.channel}: event {event.eventnum} left out: {error}", file=sys.stderr)
            continue
        yield event.channel, kind, {"log_utime": event.timestamp, **row}


def file_of(folder: Path, channel: str) -> Path:
    """Return a file in the folder, whatever the channel is called."""
    return folder / (re.sub(r"[^A-Za-z0-9_.-]", "_", channel) + ".csv")


def write(log: Path, folder: Path) -> int:
    """Write one CSV file per channel, with the columns of all of its rows; return their number."""
    names: dict[Path, dict[str, None]] = {}
    counts: Counter[Path] = Counter()
    for channel, _, row in rows(log):
        names.setdefault(file_of(folder, channel), {}).update(dict.fromkeys(row))
    if names:
        folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as files:
        tables = {}
        for path, columns_of_it in names.items():
            file = files.enter_context(path.open("w", newline="", encoding="utf-8"))
            tables[path] = csv.DictWriter(file, list(columns_of_it))
            tables[path].writeheader()
        for channel, _, row in rows(log):  # a second pass, because logs may be larger than memory
            path = file_of(folder, channel)
            tables[path].writerow(row)
            counts[path] += 1
    for path in sorted(names):
        print(f"{path}: {counts[path]} rows, {len(names[path])} columns")
    return len(names)


def plot(log: Path, picture: Path) -> None:
    """Draw the path of every robot in the log, by its odometry."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    ways: dict[str, tuple[list[float], list[float]]] = {}
    for channel, kind, row in rows(log):
        if kind is roburoc4_lcm.localization_status_t:
            x_m, y_m = ways.setdefault(channel, ([], []))
            x_m.append(row["x_m"])
            y_m.append(row["y_m"])
    if not ways:
        sys.exit(f"{log}: no localization_status_t to draw")
    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    for channel, (x_m, y_m) in sorted(ways.items()):
        (line,) = axes.plot(x_m, y_m, label=channel.removesuffix("_LOCALIZATION"))
        axes.plot(x_m[0], y_m[0], "o", color=line.get_color())
        axes.plot(x_m[-1], y_m[-1], "s", color=line.get_color())
    axes.set(
        xlabel="x (m), ahead", ylabel="y (m), left", title="From \u25cf to \u25a0, by odometry"
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(visible=True, alpha=0.3)
    axes.legend()
    figure.savefig(picture)
    print(picture)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("log", type=Path, help="what lcm-logger wrote")
    parser.add_argument("folder", type=Path, help="where the CSV files go; created if necessary")
    parser.add_argument("--plot", type=Path, help="draw the path into this .svg or .png")
    options = parser.parse_args()
    if not options.log.is_file():
        parser.error(f"{options.log}: no such file; give a log of lcm-logger")
    try:
        if write(options.log, options.folder) == 0:
            sys.exit(f"{options.log}: no message of roburoc4_lcm; was it another LCM network's?")
        if options.plot:
            plot(options.log, options.plot)
    except (OSError, ValueError) as error:
        sys.exit(f"{Path(__file__).name}: {error}")


if __name__ == "__main__":
    main()
