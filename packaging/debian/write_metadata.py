# SPDX-License-Identifier: MIT
"""Write what pip would have installed of pyproject.toml: metadata, entry points, the command.

write_metadata.py PYPROJECT HEADER DIST-PACKAGES; Debian 12 has no scikit-build-core.
"""

import re
import sys
import tomllib
from pathlib import Path

pyproject, header, modules = map(Path, sys.argv[1:])
project = tomllib.loads(pyproject.read_text("utf-8"))["project"]
version = ".".join(re.findall(r"ROBUROC4_VERSION_[A-Z]+ (\d+)", header.read_text("utf-8")))
name = project["name"]
folder = modules / f"{name.replace('-', '_')}-{version}.dist-info"
folder.mkdir()

metadata = ["Metadata-Version: 2.1", f"Name: {name}", f"Version: {version}"]
metadata += [f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}"]
for extra, requirements in project.get("optional-dependencies", {}).items():
    metadata += [f"Provides-Extra: {extra}"]
    metadata += [f'Requires-Dist: {need}; extra == "{extra}"' for need in requirements]
(folder / "METADATA").write_text("\n".join(metadata) + "\n", "utf-8")

scripts = project.get("scripts", {})
groups = {"console_scripts": scripts, **project.get("entry-points", {})}
lines = []
for group, entries in groups.items():
    lines += [f"[{group}]", *(f"{name} = {target}" for name, target in entries.items()), ""]
(folder / "entry_points.txt").write_text("\n".join(lines), "utf-8")

for script, target in scripts.items():
    module, function = target.split(":")
    command = modules.parents[2] / "bin" / script
    command.write_text(
        f"#!/usr/bin/python3\nfrom {module} import {function}\n\n{function}()\n", "utf-8"
    )
    command.chmod(0o755)
