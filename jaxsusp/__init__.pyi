# The public names, in the order in which data passes, and where each of them lives.
# ruff: noqa: I001

__version__: str

# what a person states
from .scenario.scenario import Scenario as Scenario
from .scenario.scenario import load_scenario as load_scenario
from .scenario.builtin import scenarios as scenarios
from .scenario.builtin import examples as examples
from .studies.random_scenario import random_scenario as random_scenario
from .studies.random_scenario import random_scenarios as random_scenarios
from .errors import InputError as InputError
from .errors import ScenarioError as ScenarioError

# statics of a load at any pose (Eq. 5 to 7)
from .mechanics.posture.load import Load as Load
from .mechanics.posture.load import Pose as Pose
from .mechanics.posture.load import rotation as rotation
from .mechanics.posture.structure import structure_matrix as structure_matrix
from .mechanics.posture.structure import wrench as wrench
from .mechanics.posture.pseudoinverse import least_squares_tensions as least_squares_tensions
from .mechanics.posture.graspmap import grasp_map as grasp_map
from .mechanics.posture.graspmap import nearest_forces as nearest_forces
from .mechanics.posture.graspmap import internal_forces as internal_forces
from .mechanics.posture.graspmap import ends_of_forces as ends_of_forces

# where the load and all cables are clear
from .freespace.build import free_space as free_space
from .freespace.space import FreeSpace as FreeSpace
from .freespace.space import load_free_space as load_free_space
from .freespace.routes import routes as routes
from .freespace.space import Route as Route
from .freespace.cells.passage import passage as passage
from .freespace.cells.passage import Passage as Passage

# the suspension of a scenario at given positions
from .suspension.tensions import tensions as tensions
from .suspension.hanging import equilibrium as equilibrium
from .suspension.hanging import Hanging as Hanging
from .suspension.workspace import workspace as workspace
from .suspension.workspace import Workspace as Workspace
from .suspension.misplaced import misplaced as misplaced
from .suspension.misplaced import Misplaced as Misplaced

# fitness
from .problem.fitness import FitnessTerms as FitnessTerms
from .problem.problem import Problem as Problem

# optimisers
from .optim.base import Optimizer as Optimizer
from .optim.base import HostOptimizer as HostOptimizer
from .optim.base import Best as Best
from .optim.base import NoInfo as NoInfo
from .optim.algorithms.pso import pso as pso
from .optim.algorithms.ga import ga as ga
from .optim.algorithms.dbo import dbo as dbo
from .optim.algorithms.sdbo import sdbo as sdbo
from .optim.algorithms.cmaes import cmaes as cmaes
from .optim.algorithms.jde import jde as jde
from .optim.algorithms.routed import routed as routed
from .optim.registry import ALGORITHMS as ALGORITHMS
from .optim.registry import peer as peer
from .optim.minimize import minimize as minimize
from .optim.minimize import Result as Result

# comparisons
from .comparison.compare import compare as compare
from .comparison.bestknown import best_known as best_known
from .comparison.dataset import append_results as append_results
from .comparison.kept.files import load_results as load_results
from .comparison.kept.files import save_results as save_results

# where the cables' ends go
from .coordination.ends import place_ends as place_ends
from .coordination.ends import joint_problem as joint_problem
from .coordination.ends import Placement as Placement
from .coordination.leastvariance import moving_ends as moving_ends
from .coordination.leastvariance import fixed_ends as fixed_ends
from .coordination.leastvariance import Coordination as Coordination

# a task looked at before it is planned
from .planning.prospects.examination import examine as examine
from .planning.prospects.examination import Examination as Examination

# plans
from .planning.planner import plan as plan
from .planning.many.scenes import plan_many as plan_many
from .planning.many.kept import Planned as Planned
from .planning.plan import Plan as Plan
from .planning.loading import load_plan as load_plan
from .planning.waypoints import plan_through as plan_through
from .planning.recheck import verify_plan as verify_plan
from .planning.recheck import Verification as Verification
from .planning.refusal import why_not as why_not
from .planning.refusal import Refusal as Refusal
from .planning.feasibility import ImpossibleTaskError as ImpossibleTaskError

# scenes and plans in a browser
from .report.browser.page import show as show
from .report.browser.page import Page as Page
