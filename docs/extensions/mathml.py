r"""Mathematics as MathML, written at build time: no script, no request, and it can be selected.

`\tag{4}` in a displayed equation puts the number of the paper beside it. The font with all
mathematical signs is that of ziamath (STIX Two Math), copied into the site; without it a browser
would have to make do with whatever the machine has.
"""

import re
from importlib import resources
from pathlib import Path
from xml.sax.saxutils import escape

import latex2mathml.converter
from docutils import nodes
from fontTools.ttLib import TTFont
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

FONT = "STIXTwoMath-Regular.ttf"
_TAG = re.compile(r"\\tag\{([^}]*)\}")


def convert(latex: str, display: str) -> str:
    """MathML of a formula; what is not understood is a warning, which ends a strict build."""
    try:
        mathml = latex2mathml.converter.convert(latex.strip(), display=display)
    except Exception as error:  # its own kinds of errors have no common base
        logging.getLogger(__name__).warning("no mathematics: %r: %s", latex, error)
        return escape(latex)
    for command in re.findall(r"\\[a-zA-Z]+", re.sub(r"<annotation.*?</annotation>", "", mathml)):
        logging.getLogger(__name__).warning("unknown %s in %r", command, latex)
    return mathml


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """A formula in a line of text."""
    self.body.append(f'<span class="math">{convert(node.astext(), "inline")}</span>')
    raise nodes.SkipNode


def block(self: HTML5Translator, node: nodes.math_block) -> None:
    """A displayed equation, with the paper's number where it has one."""
    latex = node.astext()
    anchors = "".join(f'<span id="{name}"></span>' for name in node["ids"])
    shown = ", ".join(f"({number})" for number in _TAG.findall(latex))
    mathml = convert(_TAG.sub("", latex), "block")
    self.body.append(
        f'<div class="equation">{anchors}<div class="formula">{mathml}</div>'
        f'<span class="number">{shown}</span></div>\n'
    )
    raise nodes.SkipNode


def copy_font(app: Sphinx, error: Exception | None) -> None:
    """Leave the font among the static files, compressed."""
    if error is None:
        with resources.as_file(resources.files("ziamath") / "fonts" / FONT) as source:
            font = TTFont(source)
        font.flavor = "woff"
        font.save(Path(app.outdir) / "_static" / "math.woff")


def setup(app: Sphinx) -> dict[str, bool]:
    """Name the renderer `mathml`."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", copy_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
