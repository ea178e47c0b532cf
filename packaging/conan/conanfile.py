# SPDX-License-Identifier: MIT
"""Conan 2: `conan create build/release/recipes/conan`; it takes the sources of build/release."""

from pathlib import Path
from typing import ClassVar

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, unzip


class Roburoc4(ConanFile):
    name = "roburoc4"
    version = "@VERSION@"
    description = "Client library and simulator for the RobuROC4 mobile robot"
    license = "MIT"
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options: ClassVar = {"shared": [True, False]}
    default_options: ClassVar = {"shared": False}

    def export_sources(self):
        archives = str(Path(self.recipe_folder).parents[1])
        copy(self, f"roburoc4-source-{self.version}.tar.gz", archives, self.export_sources_folder)

    def configure(self):
        self.settings.rm_safe("compiler.cppstd")
        self.settings.rm_safe("compiler.libcxx")

    def layout(self):
        cmake_layout(self)

    def source(self):
        archive = f"roburoc4-source-{self.version}.tar.gz"
        unzip(self, str(Path(self.export_sources_folder) / archive), strip_root=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["ROBUROC4_EXAMPLES"] = False
        toolchain.cache_variables["ROBUROC4_MATLAB"] = False
        toolchain.cache_variables["ROBUROC4_WITH_LCM"] = "OFF"
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, str(Path(self.package_folder) / "licenses"))

    def package_info(self):
        windows = self.settings.os == "Windows"
        self.cpp_info.set_property("cmake_file_name", "roburoc4")
        core = self.cpp_info.components["roburoc4"]
        core.libs = ["roburoc4"]
        core.set_property("cmake_target_name", "roburoc4::roburoc4")
        udp = self.cpp_info.components["udp"]
        udp.libs = ["roburoc4_udp"]
        udp.requires = ["roburoc4"]
        udp.system_libs = ["ws2_32"] if windows else ["pthread"]
        udp.set_property("cmake_target_name", "roburoc4::udp")
        udp.set_property("pkg_config_name", "roburoc4-udp")
        sim = self.cpp_info.components["sim"]
        sim.libs = ["roburoc4_sim"]
        sim.requires = ["roburoc4"]
        sim.system_libs = [] if windows else ["m"]
        sim.set_property("cmake_target_name", "roburoc4::sim")
        sim.set_property("pkg_config_name", "roburoc4-sim")
