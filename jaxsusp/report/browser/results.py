"""A comparison as one page that can be attached to a paper: tables, figures, settings, versions."""

import base64
import html
import io
import json
from collections.abc import Iterable, Mapping
from typing import Any

import matplotlib
import xarray as xr
from matplotlib.figure import Figure

from jaxsusp.report.browser.document import document
from jaxsusp.report.comparison.folder import build_tables, figures_of, scenes_of
from jaxsusp.report.render import to_html

SCENE_DPI = 120

TITLES = {
    "convergence": "Convergence",
    "fitness": "Fitness of all runs",
    "ecdf": "Running times until targets are reached (ECDF)",
    "critical-difference": "Mean ranks over the scenarios, and which differ",
}

STATISTICS = ("pairwise", "medians", "ranks")
"""Tables that go under a heading of their own."""

ORIGIN = {
    "settings": "Settings", "coefficients": "Coefficients of the algorithms",
    "versions": "Versions", "machine": "Machine",
}  # fmt: skip
"""Attributes of the dataset that tell where the numbers come from."""


def results_page(ds: xr.Dataset) -> str:
    """The text of the page.

    Args:
        ds: a whole comparison, as `jaxsusp.load_results` reads it.
    """
    notes: list[str] = []
    tables = build_tables(ds)
    scenes = [
        _figure(_png(figure), f"The best trajectory of every algorithm on {name}")
        for name, figure in scenes_of(ds, notes.append)
    ]
    sections = {
        "Results": [_table(frame) for name, frame in tables.items() if name not in STATISTICS],
        "Statistics": [_table(tables[name]) for name in STATISTICS if name in tables],
        "Figures": [_titled(TITLES[name], _svg(figure)) for name, figure in figures_of(ds)],
        "Scenes": [*scenes, *(f"<p>{html.escape(note)}.</p>" for note in notes)],
        "Origin": list(_origin(ds)),
    }
    shown = {name: parts for name, parts in sections.items() if parts}
    return document(
        "results.html",
        "A comparison of population optimisers on suspension tasks",
        ("theme.css", "results.css"),
        ("results.js",),
        summary=f"{html.escape(_summary(ds))} Headings of tables sort; <code>jaxsusp show</code> "
        "plays the trajectories of the dataset.",
        contents="".join(f'<a href="#{name.lower()}">{name}</a>' for name in shown),
        sections="\n".join(
            f'<section id="{name.lower()}"><h2>{name}</h2>\n{"".join(parts)}</section>'
            for name, parts in shown.items()
        ),
    )


def _summary(ds: xr.Dataset) -> str:
    """What was compared, in a sentence or two."""
    sizes = ds.sizes
    algorithms = ", ".join(map(str, ds["algorithm"].values))
    many = "s" * (sizes["scenario"] > 1)
    created = str(ds.attrs.get("created", ""))[:10]
    return (
        f"{algorithms} on {sizes['scenario']} scenario{many}, {sizes['run']} runs each"
        + f", computed on {created}" * bool(created)
        + "."
    )


def _table(frame: Any) -> str:
    title = html.escape(frame.attrs["title"])
    return f"<section><h3>{title}</h3>\n{to_html(frame, sortable=True)}</section>\n"


def _titled(title: str, picture: str) -> str:
    return f"<h3>{html.escape(title)}</h3>\n{_figure(picture, title)}"


def _figure(source: str, told: str) -> str:
    return f'<figure><img src="{source}" alt="{html.escape(told)}"></figure>\n'


def _svg(figure: Figure) -> str:
    """A figure that can be enlarged, the same bytes every time."""
    with matplotlib.rc_context({"svg.hashsalt": "jaxsusp"}):
        return _data(figure, "svg", "svg+xml", metadata={"Date": None, "Creator": None})


def _png(figure: Figure) -> str:
    """A scene: as vectors its many faces would take megabytes."""
    return _data(figure, "png", "png", dpi=SCENE_DPI, metadata={"Software": None})


def _data(figure: Figure, form: str, kind: str, **options: Any) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format=form, **options)
    return f"data:image/{kind};base64,{base64.b64encode(buffer.getvalue()).decode('ascii')}"


def _origin(ds: xr.Dataset) -> Iterable[str]:
    """Settings, versions and the tasks themselves."""
    for name, title in ORIGIN.items():
        if content := json.loads(ds.attrs.get(name, "{}")):
            yield f"<h3>{title}</h3>\n{_list(content)}\n"
    for name, text in json.loads(ds.attrs.get("scenario_files", "{}")).items():
        summary = f"<summary>{html.escape(name)}.toml</summary>"
        yield f"<details>{summary}<pre>{html.escape(text)}</pre></details>\n"


def _list(content: Mapping[str, Any]) -> str:
    """A table of names and values; what is nested is written as JSON."""
    rows = (
        f"<dt>{html.escape(key)}</dt><dd>"
        f"{html.escape(value if isinstance(value, str) else json.dumps(value, ensure_ascii=False))}"
        "</dd>"
        for key, value in content.items()
    )
    return f"<dl>{''.join(rows)}</dl>"
