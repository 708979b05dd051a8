"""Optimal control of actuated hyperelastic soft bodies.

>>> import nastic
>>> case = nastic.load("examples/cases/finger.json")            # doctest: +SKIP
>>> case["optimizer"]["max_iterations"] = 5                     # doctest: +SKIP
>>> best = case.optimize()                                      # doctest: +SKIP
>>> best.result["cost"]["total"], best.displacement.shape       # doctest: +SKIP

A `Case` is a dictionary with the keys of case files; `Problem` is its cost as a function of the control vector. `gradient` means
the vector of partial derivatives dj/dm_i everywhere in this package. The manual is docs/python.md.
"""

from ._nastic import VERSION as __version__
from .case import Case, load, schema
from .errors import CaseError, Error, GradientError, OutputError, SolveError
from .fits import fit
from .mesh import Mesh
from .problem import Constraint, Control, Problem
from .result import Result, State
from .shapes import Cloud, cloud, compare
from .sweeps import Run, sweep

__all__ = [
    "Case",
    "CaseError",
    "Cloud",
    "Constraint",
    "Control",
    "Error",
    "GradientError",
    "Mesh",
    "OutputError",
    "Problem",
    "Result",
    "Run",
    "SolveError",
    "State",
    "__version__",
    "cloud",
    "compare",
    "fit",
    "load",
    "schema",
    "sweep",
]
