# SPDX-License-Identifier: MIT
"""Turn an LCM log into CSV, one file a channel, and draw the robot's path.

    python log_to_csv.py lcmlog-2026-11-21.00 run
    python log_to_csv.py lcmlog-2026-11-21.00 run --plot run/path.svg     (needs matplotlib)

makes run/ROBUROC4_LOCALIZATION.csv and so on, with a column for each field, named as in
lcm/types/*.lcm; lists get a column for each element. ``log_utime`` is when lcm-logger heard it.
"""

import argparse
import csv
import struct
import sys
from collections.abc import Iterator
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
    """Name and value of every field, those of lists and of structs in structs one by one."""
    if hasattr(value, "__slots__"):
        for field in value.__slots__:
            yield from columns(getattr(value, field), f"{name}_{field}" if name else field)
    elif isinstance(value, list | tuple):
        for index, element in enumerate(value):
            yield from columns(element, f"{name}_{index}")
    else:
        yield name, value


def read(path: Path) -> dict[str, list[dict[str, Any]]]:
    """All messages of our types, by channel; others are left out."""
    tables: dict[str, list[dict[str, Any]]] = {}
    for event in lcm.EventLog(str(path), "r"):
        kind = BY_FINGERPRINT.get(event.data[:8])
        if kind is None:
            continue
        try:
            row = dict(columns(kind.decode(event.data)))
        except (struct.error, ValueError) as error:
            print(f"{event.channel}: event {event.eventnum} left out: {error}", file=sys.stderr)
            continue
        tables.setdefault(event.channel, []).append({"log_utime": event.timestamp, **row})
    return tables


def write(folder: Path, tables: dict[str, list[dict[str, Any]]]) -> None:
    """One CSV a channel; its columns are those of all of its rows."""
    folder.mkdir(parents=True, exist_ok=True)
    for channel, rows in sorted(tables.items()):
        names = list(dict.fromkeys(name for row in rows for name in row))
        path = folder / f"{channel}.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, names)
            table.writeheader()
            table.writerows(rows)
        print(f"{path}: {len(rows)} rows, {len(names)} columns")


def plot(path: Path, tables: dict[str, list[dict[str, Any]]]) -> None:
    """Draw the way of every robot in the log, by its odometry."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    for channel, rows in sorted(tables.items()):
        if channel.endswith("_LOCALIZATION"):
            x_m, y_m = ([row[name] for row in rows] for name in ("x_m", "y_m"))
            (line,) = axes.plot(x_m, y_m, label=channel.removesuffix("_LOCALIZATION"))
            axes.plot(x_m[0], y_m[0], "o", color=line.get_color())
            axes.plot(x_m[-1], y_m[-1], "s", color=line.get_color())
    axes.set(
        xlabel="x (m), ahead", ylabel="y (m), left", title="From \u25cf to \u25a0, by odometry"
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(visible=True, alpha=0.3)
    axes.legend()
    figure.savefig(path)
    print(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("log", type=Path, help="what lcm-logger wrote")
    parser.add_argument("folder", type=Path, help="where the CSV files go; made if need be")
    parser.add_argument("--plot", type=Path, help="draw the path into this .svg or .png")
    options = parser.parse_args()
    if not options.log.is_file():
        parser.error(f"{options.log}: no such file; give a log of lcm-logger")
    tables = read(options.log)
    if not tables:
        sys.exit(f"{options.log}: no message of roburoc4_lcm; was it another LCM network's?")
    write(options.folder, tables)
    if options.plot:
        plot(options.plot, tables)


if __name__ == "__main__":
    main()
