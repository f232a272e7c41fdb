"""Settings for libraries that are met only here."""

import os
from pathlib import Path

os.environ["LOG_CFG"] = str(Path(__file__).with_name("pyswarms-logging.yaml"))
