# SPDX-License-Identifier: MIT
"""`roburoc4 dissector`: the plugin with which Wireshark and tshark decode the telegrams."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from pathlib import Path

from ..errors import ExitCode, refused
from ..options import Options
from ..output import note

NAME = "roburoc4.lua"


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "dissector",
        help="find or install the dissector for Wireshark",
        description="Print where the dissector for Wireshark and tshark is; with --install, copy "
        "it into the folder for your own plugins.",
        epilog="example: roburoc4 dissector --install",
    )
    parser.add_argument("--install", action="store_true", help="copy it for this user's Wireshark")
    parser.set_defaults(run=run)


def plugin_folder() -> Path:
    """Return the folder of this user's plugins, as in Wireshark's Help > About > Folders."""
    if sys.platform == "win32":
        return Path(os.environ["APPDATA"]) / "Wireshark" / "plugins"
    return Path.home() / ".local" / "lib" / "wireshark" / "plugins"


def run(options: Options) -> int:
    """Print the path of the file that is used."""
    path = Path(__file__).resolve().parents[2] / NAME
    if options.install:
        folder = plugin_folder()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path = Path(shutil.copyfile(path, folder / NAME))
        except OSError as error:
            raise refused(f"{folder} cannot be written to: {error.strerror}") from error
        note("installed: restart Wireshark, or try: tshark -r FILE -Y roburoc4")
    print(path)
    return ExitCode.FINE
