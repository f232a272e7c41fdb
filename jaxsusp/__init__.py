"""jaxsusp: obstacle-avoidance planning for multi-robot suspension systems.

    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    problem = js.Problem.from_scenario(scenario)
    result = js.minimize(problem, js.pso(), runs=20)

The public names are those below; importing the package sets nothing global.
"""

# What a person states
from jaxsusp.errors import InputError as InputError
from jaxsusp.scenario import Scenario as Scenario
from jaxsusp.scenario import ScenarioError as ScenarioError
from jaxsusp.scenario import load_scenario as load_scenario
from jaxsusp.scenario import scenarios as scenarios

# Mechanics
from jaxsusp.tensions import tensions as tensions

# Fitness and optimisation
from jaxsusp.fitness import FitnessTerms as FitnessTerms
from jaxsusp.problem import Problem as Problem
from jaxsusp.minimize import Result as Result
from jaxsusp.minimize import minimize as minimize
from jaxsusp.optim.base import Optimizer as Optimizer
from jaxsusp.optim.dbo import dbo as dbo
from jaxsusp.optim.ga import ga as ga
from jaxsusp.optim.pso import pso as pso
from jaxsusp.optim.registry import ALGORITHMS as ALGORITHMS
from jaxsusp.optim.sdbo import sdbo as sdbo

# Comparisons and their results
from jaxsusp.comparison import compare as compare
from jaxsusp.results import append as append
from jaxsusp.results import load as load_results
from jaxsusp.results import save as save_results
