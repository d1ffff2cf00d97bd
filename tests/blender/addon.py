"""Loads the add-on from its folder, as Blender does when it is installed."""

import importlib
import os
import sys

FOLDER = os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "../../integrations/blender"
)


def load():
    sys.path.insert(0, FOLDER)
    package = importlib.import_module("relumine_lights")
    package.register()
    return package
