"""A comparison that shows itself: `ds.jaxsusp` beside what xarray shows of the dataset `ds`."""

import xarray as xr

from jaxsusp._showing import Shown
from jaxsusp.errors import InputError

_DIMS = ("scenario", "algorithm", "run")


@xr.register_dataset_accessor("jaxsusp")
class Overview(Shown):
    """A comparison in a few numbers and one picture.

    Attributes:
        ds: the dataset of `jaxsusp.compare`, or a part of it along any of its dimensions that
            keeps the dimension.
    """

    def __init__(self, ds: xr.Dataset):
        if "fitness" not in ds or not set(_DIMS) <= set(ds.sizes):
            raise InputError(
                "the dataset is no comparison; give one that `jaxsusp.compare` or "
                "`jaxsusp.load_results` returned, its dimensions kept (`isel(scenario=[0])`)"
            )
        self.ds = ds

    def __repr__(self) -> str:
        counts = (f"{self.ds.sizes[dim]} {dim}{'s' * (self.ds.sizes[dim] != 1)}" for dim in _DIMS)
        return f"<Comparison: {', '.join(counts)}>"
