"""`jaxsusp cache`: what is kept for the next time."""

import json
from typing import Annotated

from jaxsusp._cache import CACHE, KINDS, LIMIT, cache_folder, clear, contents
from jaxsusp._files import require_folder
from jaxsusp.cli.application import command, note
from jaxsusp.cli.commands.listing import print_rows
from jaxsusp.cli.options import Json, flag
from jaxsusp.errors import InputError


@command(epilog="Example: jaxsusp cache --clear")
def cache(
    removed: Annotated[bool, flag("--clear", "Remove all of it.")] = False,
    as_json: Json = False,
) -> None:
    """Show what is kept for the next time: free spaces, compiled programs, pieces; or remove it.

    JAXSUSP_CACHE names another folder, JAXSUSP_NO_CACHE=1 keeps nothing.
    """
    folder = cache_folder("")
    if removed:
        clear()
    if folder is None:
        print(json.dumps({"folder": None}) if as_json else "Nothing is kept.")
        return
    try:
        require_folder(CACHE, folder)
    except InputError as error:
        note(f"nothing can be kept: {error}")
    found = contents()
    if as_json:
        kept = {each.kind: {"files": each.files, "bytes": each.size} for each in found}
        print(json.dumps({"folder": str(folder), "limit": LIMIT, "kept": kept}, indent=2))
        return
    print(folder)
    print_rows(
        [
            {"kept": KINDS[each.kind], "files": str(each.files), "MB": f"{each.size / 1e6:.1f}"}
            for each in found
        ],
        as_json=False,
    )
    print(f"At most {LIMIT / 2**30:g} GiB of each; what was used longest ago makes way.")
