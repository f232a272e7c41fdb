"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

import importlib.util

SOLVER = "CLARABEL"
"""Solver of cone programs unless another is named."""

SOLVERS = {
    "CLARABEL": "clarabel",
    "COPT": "coptpy",
    "CPLEX": "cplex",
    "CVXOPT": "cvxopt",
    "ECOS": "ecos",
    "GUROBI": "gurobipy",
    "MOSEK": "mosek",
    "QOCO": "qoco",
    "SCS": "scs",
    "XPRESS": "xpress",
}
"""Solvers of second-order cone programs, which Eq. 23 is, that cvxpy knows, and their packages."""


def solvers() -> list[str]:
    """Those that are installed; a licence may still be missing."""
    return [name for name, package in SOLVERS.items() if importlib.util.find_spec(package)]
