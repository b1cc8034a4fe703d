"""Builds librivulet.so by CMake and puts it into the Python package. The version is that of CMakeLists.txt; pyproject.toml has the rest.
In the environment: CMAKE_ARGS, more options for CMake, for example -DRIVULET_OPENCL=OFF; RIVULET_PREBUILT, the path of a librivulet.so that is
built already, which is then taken."""
import os
import pathlib
import re
import shlex
import shutil
import subprocess

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = pathlib.Path(__file__).resolve().parent


class Library(build_ext):
    """A shared library that no interpreter of Python is linked with."""

    def get_ext_filename(self, name):
        return os.path.join(*name.split(".")) + ".so"

    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(os.environ.get("RIVULET_PREBUILT") or self.library(), target)

    def library(self):
        """Builds it; returns its path."""
        build = pathlib.Path(self.build_temp).resolve()
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        options = {"CMAKE_BUILD_TYPE": "Release", "RIVULET_PROGRAM": "OFF", "RIVULET_TESTS": "OFF", "RIVULET_INSTALL": "OFF", "RIVULET_WERROR": "OFF"}
        subprocess.run(["cmake", "-S", root, "-B", build, *generator, *(f"-D{name}={value}" for name, value in options.items()),
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "rivulet_c", "--parallel", str(len(os.sched_getaffinity(0)))], check=True)
        return build / "librivulet.so"


commands = {"build_ext": Library}
try:
    from wheel.bdist_wheel import bdist_wheel
except ImportError:  # without it there is no wheel, and nothing to be said of it
    pass
else:
    class Wheel(bdist_wheel):
        """For any version of Python 3, on this system."""

        def get_tag(self):
            return ("py3", "none", super().get_tag()[2])

    commands["bdist_wheel"] = Wheel

setup(version=re.search(r"project\(rivulet VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text())[1],
      ext_modules=[Extension("rivulet.librivulet", [])], cmdclass=commands)
