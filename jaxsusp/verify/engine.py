"""MuJoCo without static types: its compiled bindings carry none that a checker understands."""

import importlib
from typing import Any

mujoco: Any = importlib.import_module("mujoco")
