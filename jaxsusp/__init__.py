"""jaxsusp: obstacle-avoidance planning for multi-robot suspension systems.

    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    problem = js.Problem.from_scenario(scenario)
    result = js.minimize(problem, js.pso(), runs=20)

Importing the package sets nothing global and loads nothing heavy: a public name is imported when it
is first used (PEP 562). `__init__.pyi` beside this file lists them all, by topic.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
