"""One HTML file out of a template, styles, scripts and data; nothing else runs or is fetched."""

import base64
import hashlib
import html
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import Any

HEIGHT = 720
"""Pixels of a page in a notebook."""


def document(
    template: str, title: str, styles: Sequence[str], scripts: Sequence[str], library: str = "",
    **parts: str,
) -> str:  # fmt: skip
    """The text of a page.

    Args:
        template: the HTML file beside this one, with places for all that follows.
        title: plain text.
        styles: CSS files beside this one.
        scripts: JavaScript files beside this one, in the order in which they use each other.
        library: a script that goes before them.
        parts: what else the template has places for, as HTML.
    """
    style = "\n".join(map(_own, styles))
    code = "\n".join(map(_own, scripts))
    content: dict[str, Any] = {
        "title": html.escape(title),
        "policy": _policy(style, *filter(None, (library, code))),
        "style": style,
        "library": library,
        "code": code,
        **parts,
    }
    return Template(_own(template)).substitute(content)


def framed(text: str) -> str:
    """A page as an element of another one."""
    look = f'width="100%" height="{HEIGHT}" style="border: 0" title="jaxsusp"'
    return f'<iframe srcdoc="{html.escape(text)}" {look}></iframe>'


def _policy(style: str, *scripts: str) -> str:
    """A Content-Security-Policy that lets nothing run but these texts, and nothing be fetched."""
    allowed = " ".join(map(_hash, scripts))
    return f"default-src 'none'; script-src {allowed}; style-src {_hash(style)}; img-src data:"


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _own(name: str) -> str:
    """A file beside this one."""
    return (Path(__file__).parent / name).read_text(encoding="utf-8")
