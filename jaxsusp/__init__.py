"""jaxsusp: obstacle-avoidance planning for multi-robot suspension systems.

    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    problem = js.Problem.from_scenario(scenario)
    result = js.minimize(problem, js.pso(), runs=20)

Importing the package sets nothing global and loads nothing heavy: a public name is imported when it
is first used (PEP 562). `__init__.pyi` beside this file lists them all, by topic.
"""

import threading

import lazy_loader

from jaxsusp._showing import draw_with

__version__ = "0.1.0"

_lazy, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
_lock = threading.RLock()


def _drawn(thing: object) -> str | None:
    """A thing of ours as a small table and a picture, for notebooks."""
    from jaxsusp.report.html import shown

    return shown(thing)


draw_with(_drawn)


def __getattr__(name: str):
    """A public name when it is first used; one thread at a time, since JAX is not loaded by two."""
    with _lock:
        return _lazy(name)
