"""jaxsusp: obstacle-avoidance planning for multi-robot suspension systems.

    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    problem = js.Problem.from_scenario(scenario)
    result = js.minimize(problem, js.pso(), runs=20)

Importing the package sets nothing global.
"""

from jaxsusp.comparison import compare
from jaxsusp.coordination.ends import Placement, joint_problem, place_ends
from jaxsusp.coordination.leastvariance import Coordination, fixed_ends, moving_ends
from jaxsusp.errors import InputError
from jaxsusp.feasibility import ImpossibleTaskError
from jaxsusp.fitness import FitnessTerms
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.space import FreeSpace, load_free_space
from jaxsusp.hanging import Hanging, equilibrium
from jaxsusp.minimize import Result, minimize
from jaxsusp.optim.base import Best, NoInfo, Optimizer
from jaxsusp.optim.dbo import dbo
from jaxsusp.optim.ga import ga
from jaxsusp.optim.pso import pso
from jaxsusp.optim.registry import ALGORITHMS
from jaxsusp.optim.sdbo import sdbo
from jaxsusp.planfile import load_plan
from jaxsusp.planning import plan
from jaxsusp.plans import Plan, plan_through
from jaxsusp.problem import Problem
from jaxsusp.results import append as append_results
from jaxsusp.results import load as load_results
from jaxsusp.results import save as save_results
from jaxsusp.scenario import Scenario, ScenarioError, examples, load_scenario, scenarios
from jaxsusp.studies.random_scenario import random_scenario
from jaxsusp.tensions import tensions
from jaxsusp.verification import Verification, verify_plan
from jaxsusp.workspace import Workspace, workspace

__all__ = [  # noqa: RUF022  by topic, in the order of the data flow
    # what a person states
    "Scenario",
    "load_scenario",
    "scenarios",
    "examples",
    "random_scenario",
    "InputError",
    "ScenarioError",
    # where the load and all cables are clear
    "free_space",
    "FreeSpace",
    "load_free_space",
    # mechanics and fitness
    "tensions",
    "equilibrium",
    "Hanging",
    "workspace",
    "Workspace",
    "FitnessTerms",
    "Problem",
    # optimisers
    "Optimizer",
    "Best",
    "NoInfo",
    "pso",
    "ga",
    "dbo",
    "sdbo",
    "ALGORITHMS",
    "minimize",
    "Result",
    # comparisons
    "compare",
    "append_results",
    "load_results",
    "save_results",
    # plans
    "plan",
    "Plan",
    "load_plan",
    "plan_through",
    "place_ends",
    "joint_problem",
    "Placement",
    "moving_ends",
    "fixed_ends",
    "Coordination",
    "verify_plan",
    "Verification",
    "ImpossibleTaskError",
]
