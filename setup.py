"""Builds the compiled part of the Python package with CMake. The packages of packages/build.txt and
packages/python.txt must be there. The environment variable CMAKE_ARGS may hold more options."""

import os
import shlex
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        source = os.path.dirname(os.path.abspath(__file__))
        folder = os.path.join(self.build_temp, "cmake")
        options = {
            "CMAKE_BUILD_TYPE": "Release",
            "RELUMINE_BUILD_PYTHON": "ON",
            "RELUMINE_BUILD_APP": "OFF",
            "RELUMINE_BUILD_TESTS": "OFF",
            "Python_EXECUTABLE": sys.executable,
            "RELUMINE_PYTHON_OUTPUT": os.path.dirname(
                os.path.abspath(self.get_ext_fullpath(extension.name))
            ),
        }
        definitions = [f"-D{name}={value}" for name, value in options.items()]
        subprocess.check_call(["cmake", "-S", source, "-B", folder, "-G", "Ninja", *definitions,
                               *shlex.split(os.environ.get("CMAKE_ARGS", ""))])  # fmt: skip
        subprocess.check_call(["cmake", "--build", folder, "--target", "relumine_python"])


setup(ext_modules=[Extension("relumine._core", [])], cmdclass={"build_ext": BuildWithCMake})
