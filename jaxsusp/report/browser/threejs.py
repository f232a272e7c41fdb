"""three.js, out of a package that is there anyway.

trimesh, which reads the meshes of obstacles, carries three.js for its own viewer: the plain build
that defines `THREE`, 624 kB, without anything to fetch at run time. Of k3d, meshcat and pythreejs
each would be one more dependency; the first two hide three.js in bundles of 0.9 to 2.6 MB.
"""

import functools
import zipfile

from jaxsusp.errors import InputError

_BEGIN, _END = "<script>", 'Object.defineProperty(t,"__esModule",{value:!0})}));'


@functools.cache
def three() -> str:
    """The text of three.js, which defines the global `THREE`.

    Raises:
        InputError: the trimesh that is installed carries none.
    """
    from importlib.resources import files

    place = files("trimesh") / "resources" / "templates" / "viewer.zip"
    try:
        with place.open("rb") as opened, zipfile.ZipFile(opened) as archive:
            page = archive.read(archive.namelist()[0]).decode("utf-8")
    except (OSError, KeyError, IndexError, zipfile.BadZipFile, UnicodeDecodeError):
        page = ""
    _, _, rest = page.partition(_BEGIN)
    text, found, _ = rest.partition(_END)
    if not found or "REVISION" not in text or "</script" in text:
        raise InputError(
            "the page's three.js is not where trimesh keeps it; install the trimesh that "
            "constraints.txt names"
        )
    return text + found
