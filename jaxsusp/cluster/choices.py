"""Where work is done, as a person chooses it; light to import."""

from pathlib import Path
from typing import NamedTuple

from jaxsusp.errors import InputError, require, require_count


class ClusterError(InputError):
    """The workers cannot do the work, or no longer; what they finished is not lost."""


class Place(NamedTuple):
    """This process alone, workers of this machine, or those of a scheduler."""

    scheduler: str | None = None  # address, or a scheduler file
    workers: int | None = None  # so many processes of this machine
    tls_ca: Path | None = None  # who is trusted
    tls_cert: Path | None = None  # who we are …
    tls_key: Path | None = None  # … and its key, where the certificate does not hold it

    @property
    def here(self) -> bool:
        """Whether no worker is asked for."""
        return self.scheduler is None and self.workers is None

    def require_sense(self) -> None:
        """Refuse what contradicts itself, before anything is started.

        Raises:
            InputError: names the option.
        """
        if self.workers is not None:
            require_count("workers", self.workers)
        require(
            self.scheduler is None or self.workers is None,
            f"workers = {self.workers}: the workers are those of scheduler = {self.scheduler!r}; "
            "give one of the two",
        )
        for name in ("tls_ca", "tls_cert", "tls_key"):
            file = getattr(self, name)
            if file is not None:
                require(
                    self.scheduler is not None,
                    f"{name} = {file}: is for a connection to a scheduler; give scheduler = "
                    '"tls://HOST:PORT" with it',
                )
                require(file.is_file(), f"{name} = {file}: no such file; give one in PEM format")
