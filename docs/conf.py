"""The site: `make docs` builds it into `site/`, every warning an error.

Pages are Markdown (MyST). What they show of the package is taken from the package while they are
built: commands run, docstrings are read, keys of files are listed. See `extensions/`.
"""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS), str(DOCS.parent)]

from extensions.runs import digest  # noqa: E402

from jaxsusp import __version__  # noqa: E402  the tree that is documented, wherever it is

project = "jaxsusp"
author = "The jaxsusp authors"
copyright = author  # no year: a page built tomorrow is the same
release = version = __version__

extensions = [
    "myst_parser",
    "extensions.mathml",
    "extensions.runs",
    "extensions.commands",
    "extensions.reference",
    "extensions.keys",
]
myst_enable_extensions = ["dollarmath", "deflist", "fieldlist"]
myst_heading_anchors = 3
myst_dmath_double_inline = False
exclude_patterns = ["extensions", "static", "images"]
nitpicky = True
nitpick_ignore_regex = [("py:class", ".*")]  # types of others in signatures; ours become links
highlight_language = "text"
python_maximum_signature_line_length = 70
add_module_names = False
toc_object_entries_show_parents = "hide"

package_digest = digest()
"""Every page may show something of the package, and is read anew when that has changed."""

html_theme = "furo"
html_title = f"jaxsusp {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f4e79", "color-brand-content": "#1f5f99"},
    "dark_css_variables": {"color-brand-primary": "#8ab8e6", "color-brand-content": "#8ab8e6"},
}
