# SPDX-License-Identifier: MIT
"""A program that drives the package's own simulator."""

from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, cmake_layout


class Try(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeDeps", "CMakeToolchain", "VirtualRunEnv"

    def requirements(self):
        self.requires(self.tested_reference_str, run=True)  # for roburoc4-sim

    def layout(self):
        cmake_layout(self)

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self):
        if can_run(self):
            program = Path(self.build_folder) / "drive"
            with_simulator = Path(self.source_folder) / "with_simulator"
            self.run(f"{with_simulator} roburoc4-sim {program}", env="conanrun")
