"""`{public} NAME …` documents public names from their source, as it stands there.

Read with griffe rather than from what was imported: annotations read as they were written
(`Float[Array, "pop dim"]`), and fields keep the comments beside them. A public name that no page
documents, or two pages do, is a warning, which ends a strict build.
"""

import ast
import functools
import importlib
import inspect
import io
import re
import tokenize
from collections import Counter
from pathlib import Path

import griffe
from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from .runs import ROOT

STUB = ROOT / "jaxsusp" / "__init__.pyi"
_logger = logging.getLogger(__name__)


@functools.cache
def package() -> griffe.Object:
    """The package, with its public names as aliases of where they live."""
    return griffe.load("jaxsusp", search_paths=[str(ROOT)], docstring_parser="google")


@functools.cache
def public_names() -> tuple[str, ...]:
    """All names that the stub beside `__init__.py` lists, in its order."""
    body = ast.parse(STUB.read_text(encoding="utf-8")).body
    return tuple(
        str(alias.asname) for node in body if isinstance(node, ast.ImportFrom)
        for alias in node.names
    )  # fmt: skip


def entry(name: str) -> list[str]:
    """A public name as Markdown: signature, text, arguments, and what belongs to a class."""
    found = package()[name]
    found = found.final_target if found.is_alias else found
    return _described(name, found)


def _described(name: str, found: griffe.Object, inside: bool = False) -> list[str]:
    options: list[str] = []
    if isinstance(found, griffe.Function):
        kind, head = "method" if inside else "function", f"{name}{_signature(found)}"
        options += [f":{label}:" for label in ("classmethod", "staticmethod")
                    if label in found.labels]  # fmt: skip
        body = _text(found)
    elif isinstance(found, griffe.Class):
        kind, head = "class", f"{name}{_constructor(found)}"
        body = [*_text(found), *_members(found)]
    else:
        kind, head = "attribute" if inside else "data", name
        if isinstance(found, griffe.Attribute) and found.annotation is not None:
            options.append(f":type: {_annotation(found.annotation)}")
        body = _text(found) or [_beside(found)]
    fence = "`" * (5 if inside else 7)
    return [f"{fence}{{py:{kind}}} {head}", ":module: jaxsusp", *options, "", *body, fence, ""]


def _signature(function: griffe.Function, returns: bool = True) -> str:
    """Arguments with annotations and defaults as they were written, and what is returned."""
    shown, star = [], False
    for each in function.parameters:
        if each.name in ("self", "cls") and function.parent and function.parent.is_class:
            continue
        if each.kind is griffe.ParameterKind.keyword_only and not star:
            shown.append("*")
        mark = _STARS.get(each.kind, "")
        star = star or mark == "*" or each.kind is griffe.ParameterKind.keyword_only
        text = f"{mark}{each.name}"
        if each.annotation is not None:
            text += f": {_annotation(each.annotation)}"
        if each.default is not None and not mark:
            default = _default(function, each)
            text += f" = {default}" if each.annotation is not None else f"={default}"
        shown.append(text)
    told = returns and function.returns is not None
    arrow = f" -> {_annotation(function.returns)}" if told else ""
    return f"({', '.join(shown)}){arrow}"


_STARS = {
    griffe.ParameterKind.var_positional: "*",
    griffe.ParameterKind.var_keyword: "**",
}


def _constructor(found: griffe.Class) -> str:
    """Arguments where the class takes care of them itself; fields are listed one by one."""
    init = found.members.get("__init__")
    stated = isinstance(init, griffe.Function) and "dataclass" not in found.labels
    return _signature(init, returns=False) if stated else ""


def _members(found: griffe.Class) -> list[str]:
    """Fields, methods and properties that say what they are."""
    lines: list[str] = []
    for name, each in found.members.items():
        if name.startswith("_") or each.is_alias or name == "model_config":
            continue
        field = isinstance(each, griffe.Attribute) and each.annotation is not None
        if field or (isinstance(each, griffe.Function | griffe.Attribute) and each.docstring):
            lines += _described(f"{found.name}.{name}", each, inside=True)
    return lines


def _beside(found: griffe.Object) -> str:
    """The comment behind a field, where it says what the field is."""
    if not isinstance(found.filepath, Path) or not found.lineno:
        return ""
    lines = found.filepath.read_text(encoding="utf-8").splitlines()
    text = "\n".join(lines[found.lineno - 1 : found.endlineno]) + "\n"
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(text.strip()).readline))
    except tokenize.TokenError:
        return ""
    said = [t.string.lstrip("# ") for t in tokens if t.type == tokenize.COMMENT]
    return " ".join(each for each in said if not each.startswith(("noqa", "fmt", "pyright")))


def _text(found: griffe.Object) -> list[str]:
    """The docstring as Markdown: its sections in their order."""
    if found.docstring is None:
        return []
    lines: list[str] = []
    for section in found.docstring.parse("google", warnings=False):
        value = section.value
        match section.kind.value:
            case "text":
                lines += ["", *value.splitlines(), ""]
            case "parameters":
                lines += [_field(f"param {each.name}", each.description) for each in value]
            case "attributes":
                lines += [f"- `{each.name}`: {' '.join(each.description.split())}"
                          for each in value]  # fmt: skip
            case "returns":
                lines += [_field("returns", " ".join(each.description for each in value))]
            case "raises":
                lines += [
                    _field(f"raises {str(each.annotation).split('.')[-1]}", each.description)
                    for each in value
                ]
            case "admonition":
                lines += [f"**{section.title}** {value.description}", ""]
            case kind:
                _logger.warning("%s: section %s of a docstring is not shown", found.path, kind)
    return lines


def _field(head: str, text: str) -> str:
    return f":{head}: {' '.join(text.split())}"


class Public(SphinxDirective):
    """`{public} NAME …`."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Every name in the order given."""
        names = " ".join(self.content).split()
        documented = vars(self.env).setdefault("jaxsusp_documented", {})
        documented[self.env.docname] = [*documented.get(self.env.docname, []), *names]
        self.env.note_dependency(str(STUB))
        found: list[nodes.Node] = []
        for name in names:
            if name not in public_names():
                _logger.warning("%s is no public name", name, location=self.get_location())
                continue
            target = package()[name]
            self.env.note_dependency(str(target.filepath))
            found += self.parse_text_to_nodes("\n".join(entry(name)))
        return found


def forget(app: Sphinx, env, docname: str) -> None:
    """A page is read anew."""
    vars(env).setdefault("jaxsusp_documented", {}).pop(docname, None)


def check(app: Sphinx, env) -> None:
    """Every public name stands on exactly one page."""
    found = Counter(name for names in vars(env).get("jaxsusp_documented", {}).values()
                    for name in names)  # fmt: skip
    for name in public_names():
        if found[name] != 1:
            _logger.warning("public name %s: documented %d times, not once", name, found[name])


_LONE_AXIS = re.compile(r"(\[(?:np\.ndarray|Array), )(\w+|\.\.\.)\]")


def _annotation(expression: object) -> str:
    """As it was written; griffe takes a single axis for the name of a type."""
    return _LONE_AXIS.sub(r'\1"\2"]', str(expression))


def _default(function: griffe.Function, parameter: griffe.Parameter) -> str:
    """As it was written where that is a plain value, else what it is."""
    written = str(parameter.default)
    try:
        ast.literal_eval(written)
    except ValueError:
        module = importlib.import_module(function.module.path)
        names = function.path.removeprefix(f"{function.module.path}.").split(".")
        actual = inspect.signature(functools.reduce(getattr, names, module))
        value = actual.parameters[parameter.name].default
        return repr(value) if type(value) in (str, int, float, tuple) else written
    return written


def link(app: Sphinx, doctree: nodes.document) -> None:
    """Code that is a public name, as `js.minimize` or `js.minimize(…)`, leads to its entry."""
    for node in list(doctree.findall(nodes.literal)):
        text = node.astext()
        if not text.startswith("js.") or isinstance(node.parent, nodes.reference):
            continue
        name = text.removeprefix("js.").partition("(")[0]
        if name.partition(".")[0] in public_names():
            target = addnodes.pending_xref(
                "", refdomain="py", reftype="obj", reftarget=f"jaxsusp.{name}",
                refexplicit=True, refwarn=True, refdoc=app.env.docname,
            )  # fmt: skip
            node.replace_self(target)
            target += node


def setup(app: Sphinx) -> dict[str, bool]:
    """Add `{public}` and the links."""
    app.add_directive("public", Public)
    app.connect("env-purge-doc", forget)
    app.connect("env-check-consistency", check)
    app.connect("doctree-read", link)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
