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

_logger = logging.getLogger(__name__)

FONT = "STIXTwoMath-Regular.ttf"
_TAG = re.compile(r"\\tag\{([^}]*)\}")

_SPELLED = {"{aligned}": "{align*}"}
"""LaTeX that latex2mathml knows by another name."""

_ATOM = r"(<m[in]>[^<]*</m[in]>)"

_MENDED = {
    # A raised prime is raised twice in this font: it belongs to the letter, not above its index.
    rf"<msubsup>{_ATOM}{_ATOM}<mi>&#x02032;</mi></msubsup>": (
        r'<msub><mrow>\1<mo lspace="0" rspace="0">&#x02032;</mo></mrow>\2</msub>'
    ),
    # sin x needs a space, sin(x) none.
    r"<mi>(sin|cos|tan|log)</mi>(?!<mo stretchy=\"false\">&#x00028;)": (
        r'<mi>\1</mi><mspace width="0.17em"/>'
    ),
    # Bars of \lvert x \rvert and \lVert x \rVert enclose what is between them.
    r"<mo>(&#x0007C;|&#x02016;)</mo>(.*?)<mo>\1</mo>": (
        r'<mo form="prefix" stretchy="false">\1</mo>\2'
        r'<mo form="postfix" stretchy="false">\1</mo>'
    ),
}
"""MathML that is set better when it is written otherwise."""


def convert(latex: str, display: str) -> str:
    """MathML of a formula; what is not understood is a warning, which ends a strict build."""
    spelled = latex.strip()
    for before, after in _SPELLED.items():
        spelled = spelled.replace(before, after)
    try:
        mathml = latex2mathml.converter.convert(spelled, display=display)
    except Exception as error:  # its own kinds of errors have no common base
        _logger.warning("no mathematics: %r: %s", latex, error)
        return escape(latex)
    for mark in re.findall(r"\\[a-zA-Z]+|<mi>&</mi>", mathml):
        _logger.warning("%s is left in %r", mark, latex)
    for before, after in _MENDED.items():
        mathml = re.sub(before, after, mathml)
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


def check(app: Sphinx, doctree: nodes.document) -> None:
    """No formula was taken for plain text, as one with a bar in a table is."""
    verbatim = nodes.literal | nodes.literal_block | nodes.math | nodes.math_block
    for text in doctree.findall(nodes.Text):
        if ("$" in text or "\\" in text) and not isinstance(text.parent, verbatim):
            _logger.warning("mathematics or not? %r", str(text), location=text.parent)


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
    app.connect("doctree-read", check)
    app.connect("build-finished", copy_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
