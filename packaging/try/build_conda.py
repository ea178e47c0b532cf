# SPDX-License-Identifier: MIT
"""Build the conda recipe and run its tests, with this machine's compiler instead of conda's.

build_conda.py RECIPE FOLDER: no channel is needed, as RECIPE loses what would come from one.
"""

import sys
from pathlib import Path

import yaml
from rattler_build import EnvironmentIsolation, Stage0Recipe, ToolConfiguration

recipe_file = Path(sys.argv[1])
recipe = yaml.safe_load(recipe_file.read_text("utf-8"))
del recipe["requirements"]["build"]
del recipe["tests"][0]["requirements"]
for result in Stage0Recipe.from_dict(recipe, recipe_dir=recipe_file.parent).run_build(
    output_dir=sys.argv[2],
    channels=[],
    env_isolation=EnvironmentIsolation.NONE,
    tool_config=ToolConfiguration(test_strategy="native"),
):
    print(result)
