"""Install a wheel with pip alone into an empty environment, and plan with it, far from here.

`python tests/installed.py dist/jaxsusp-0.1.0-py3-none-any.whl`: what somebody meets who has only
the wheel. Versions are those of `constraints.txt`.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

SCRIPT = """
import jaxsusp as js
assert "site-packages" in js.__file__, js.__file__
assert len(js.scenarios()) == 6 and js.examples()
assert js.best_known("scenario-1") > 0
from jaxsusp.report.comparison.paper import table1
assert table1().sizes
"""


def main(wheel: str) -> None:
    """Install, import, write a scenario, plan it, verify the plan."""
    wheel = str(Path(wheel).resolve())
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    with tempfile.TemporaryDirectory(prefix="jaxsusp-installed-") as folder:
        place = Path(folder)
        environment = {**kept, "JAXSUSP_CACHE": str(place / "cache")}

        def run(*command: str | Path) -> None:
            print("+", *(str(part).replace(folder, "…") for part in command), flush=True)
            subprocess.run([str(part) for part in command], cwd=place, check=True, env=environment)

        run(sys.executable, "-m", "venv", place / "env")
        bin = place / "env" / "bin"
        constraints = ROOT / "constraints.txt"
        run(bin / "python", "-m", "pip", "install", "--quiet", "--constraint", constraints, wheel)
        run(bin / "python", "-m", "pip", "check")
        run(bin / "python", "-c", SCRIPT)
        run(bin / "jaxsusp", "new", "my.toml")
        run(bin / "jaxsusp", "plan", "my.toml", "--algorithm", "taut", "--output", "out")
        run(bin / "jaxsusp", "verify", "out/my.plan.json")


if __name__ == "__main__":
    main(*sys.argv[1:])
