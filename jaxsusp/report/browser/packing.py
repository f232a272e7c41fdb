"""Arrays and texts as a page can hold them: small, and harmless whatever they say."""

import base64
import json
import math
from typing import Any

import numpy as np


def packed(array: Any) -> dict[str, Any]:
    """An array as base64 of single-precision numbers, with its shape, for `unpack` in data.js."""
    array = np.asarray(array, "<f4")
    encoded = base64.b64encode(array.tobytes()).decode("ascii")
    return {"shape": list(array.shape), "base64": encoded}


def as_json(value: Any) -> str:
    """JSON that no HTML parser takes for anything else; numbers that JSON lacks become null."""
    text = json.dumps(plain(value), separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    # "<!--" and "</script" would end a data block, the separators end lines in old JavaScript.
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def plain(value: Any) -> Any:
    """Arrays as lists, and nothing where a number is none: what JSON can hold."""
    match value:
        case dict():
            return {key: plain(each) for key, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
        case np.ndarray() | np.generic():
            return plain(value.tolist())
        case float() if not math.isfinite(value):
            return None
        case _:
            return value
