"""The libraries of Rivulet, without the program, for Conan 2: conan create third_party/conan. The program glad, which writes the OpenGL loader
(pip install glad2), must be on the path."""
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.gnu import PkgConfigDeps


class Rivulet(ConanFile):
    name = "rivulet"
    description = "A real-time fluid module for OpenGL engines"
    license = "MIT"
    package_type = "static-library"  # and one shared library, the C interface
    settings = "os", "arch", "compiler", "build_type"
    options = {"opencl": [True, False]}
    default_options = {"opencl": False}

    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):  # runs where the recipe is exported: beside the sources
        with open(os.path.join(self._root(), "CMakeLists.txt")) as file:
            self.version = re.search(r"project\(rivulet VERSION ([0-9.]+)", file.read()).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "engine/*", "fluid/*", "shaders/*", "third_party/*", "docs/*.md"):
            copy(self, pattern, self._root(), self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def requirements(self):
        self.requires("glm/[>=0.9.9 <2]", transitive_headers=True)
        self.requires("eigen/[>=3.4 <4]", visible=False)
        self.requires("stb/cci.20240213", visible=False)
        for library in ("fmt/[>=9 <12]", "jsoncpp/[>=1.9.5 <2]", "onetbb/[>=2021.8 <2023]", "xxhash/[>=0.8 <1]", "zstd/[>=1.5 <2]"):
            self.requires(library)
        if self.options.opencl:
            self.requires("opencl-icd-loader/[>=2021]")

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25]")
        self.tool_requires("pkgconf/[>=2 <3]")

    def validate(self):
        check_min_cppstd(self, 20)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for option in ("PROGRAM", "TESTS", "WERROR"):
            toolchain.cache_variables[f"RIVULET_{option}"] = False
        toolchain.cache_variables["RIVULET_OPENCL"] = "ON" if self.options.opencl else "OFF"
        toolchain.generate()
        CMakeDeps(self).generate()
        PkgConfigDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "rivulet")
        base = self.cpp_info.components["base"]
        base.set_property("cmake_target_name", "rivulet::base")
        base.libs = ["rivulet_base", "rivulet_glad"]
        base.system_libs = ["pthread", "dl"]
        base.requires = ["glm::glm", "fmt::fmt", "jsoncpp::jsoncpp", "onetbb::onetbb", "xxhash::xxhash"]
        if self.options.opencl:
            base.requires.append("opencl-icd-loader::opencl-icd-loader")
        fluid = self.cpp_info.components["fluid"]
        fluid.set_property("cmake_target_name", "rivulet::fluid")
        fluid.set_property("pkg_config_name", "rivulet-fluid")
        fluid.libs = ["rivulet_fluid"]
        fluid.requires = ["base", "zstd::zstd"]
        c = self.cpp_info.components["c"]
        c.set_property("cmake_target_name", "rivulet::c")
        c.set_property("pkg_config_name", "rivulet")
        c.libs = ["rivulet"]
