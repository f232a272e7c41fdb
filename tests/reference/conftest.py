"""Settings for libraries that are met only here."""

import os
from pathlib import Path

_PEERS = Path(__file__).parents[2] / "benchmarks/peers/libraries"
os.environ["LOG_CFG"] = str(_PEERS / "pyswarms-logging.yaml")
