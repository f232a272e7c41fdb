"""The comparison that notebook 2 reads: six algorithms, six scenarios, 20 runs of 500 iterations.

`python notebooks/benchmark.py` computes it anew, some two minutes on two cores, and keeps it
compressed, which is all that `jaxsusp compare --algorithms pso,ga,dbo,sdbo,cmaes,routed` does not.
"""

from pathlib import Path

import jaxsusp as js
from jaxsusp._files import atomic_path
from jaxsusp.optim import devices

FILE = Path(__file__).parent / "data" / "benchmark.nc"
ALGORITHMS = ("pso", "ga", "dbo", "sdbo", "cmaes", "routed")


def main() -> None:
    devices.configure()
    ds = js.compare(js.scenarios(), ALGORITHMS, progress=lambda event: print(*event))
    compressed = {name: {"zlib": True, "complevel": 9, "shuffle": True} for name in ds.data_vars}
    with atomic_path(FILE) as scratch:
        ds.to_netcdf(scratch, engine="h5netcdf", encoding=compressed)
    js.load_results(FILE)


if __name__ == "__main__":
    main()
