"""The cost of a case as a function of its control vector."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _nastic
from .errors import CaseError
from .result import State

if TYPE_CHECKING:
    from .case import Case


@dataclass(frozen=True)
class Control:
    """The place of a control field in the control vector."""

    name: str
    #: Its entries: `m[control.slice]`.
    slice: slice
    #: "uniform", "region", "cell", "node" or "grid".
    space: str
    #: Numbers per unknown; entries are in the order of unknowns, components of a vector one after the other.
    components: int
    unit: str
    #: Length that its vectors must have; the bounds of the problem do not say it.
    norm: float | None
    #: Length that its vectors may have; the bounds of the problem do not say it.
    max_norm: float | None


@dataclass(frozen=True)
class Constraint:
    """The place of a group of constraints c <= 0, or c = 0, among the values of all."""

    name: str
    #: Its values: `c[constraint.slice]`.
    slice: slice
    #: Whether c = 0 is asked, else c <= 0.
    equal: bool
    #: A value that counts as one, in the unit of the values.
    scale: float


class Problem:
    """j(m), the cost of a case (`Case.problem` makes one), its gradient, and products with its second derivatives.

    **gradient** is the vector of partial derivatives dj/dm_i, in the Euclidean sense: what SciPy, JAX and PyTorch call a gradient, and what
    `derivative.json` holds. It is not the Riesz image in the control's inner product, which is what VTU files call `gradient_NAME`.

    The last evaluated control is kept with its states: `value(m)` and then `gradient(m)` solve for the equilibrium once, and
    the next control starts from there. Values depend on that history within `accuracy`, and the same history gives the same bits;
    `reset` forgets it. Nothing keeps m within its bounds here. The interpreter lock is released during computation, Ctrl-C ends it;
    calls from several threads wait for each other.

    Methods raise CaseError for a vector that does not fit and SolveError where there is no equilibrium: of kind "limit_point" where the way from the
    control before leads to a limit point, "no_convergence" where `max_newton` iterations did not suffice, "cancelled" after `stop`.
    """

    def __init__(
        self,
        case: Case,
        *,
        threads: int | None = None,
        accuracy: float = 1e-8,
        stage: int | None = None,
        max_newton: int | None = None,
        callback: Callable[[dict[str, Any]], object] | None = None,
    ) -> None:
        name, text, meshes = case._document()
        told = None if callback is None else lambda line: callback(json.loads(line))
        self._problem = _nastic.Problem(
            name,
            text,
            meshes,
            threads=threads,
            accuracy=accuracy,
            stage=stage,
            max_newton=max_newton,
            callback=told,
        )
        #: The control vector to start from.
        self.start: NDArray[np.float64] = self._problem.start()
        #: Bounds of every entry, infinite where there are none.
        self.lower: NDArray[np.float64]
        self.upper: NDArray[np.float64]
        self.lower, self.upper = self._problem.bounds()
        #: The control fields by name, in the order of the vector.
        self.layout: dict[str, Control] = {one["name"]: _control(**one) for one in self._problem.layout()}
        #: Number of continuation stages of the costs, and the one that is evaluated: the last, unless chosen otherwise.
        self.stages: int
        self.stage: int
        self.stages, self.stage = self._problem.stages()
        #: The constraints by name, in the order of their values. The cost knows nothing of them: an optimiser must be given them.
        self.constraints: dict[str, Constraint] = {}
        first = 0
        for one in self._problem.constraints():
            own = slice(first, first + one["len"])
            self.constraints[one["name"]] = Constraint(one["name"], own, one["equal"], one["scale"])
            first = own.stop
        self._values = first
        for array in (self.start, self.lower, self.upper):
            array.flags.writeable = False

    def __len__(self) -> int:
        return len(self.start)

    def __repr__(self) -> str:
        fields = ", ".join(f"{c.name} ({c.space}: {c.slice.stop - c.slice.start})" for c in self.layout.values())
        return f"nastic.Problem({len(self)} control values: {fields})"

    def value(self, m: ArrayLike) -> float:
        """The cost j(m)."""
        return self._problem.value(self._vector(m))

    def gradient(self, m: ArrayLike) -> NDArray[np.float64]:
        """The partial derivatives dj/dm_i at m, by one adjoint solve; `[len(m)]`."""
        return self.value_and_gradient(m)[1]

    def value_and_gradient(self, m: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """Both at once, as `scipy.optimize.minimize(.., jac=True)` wants them."""
        return self._problem.value_and_gradient(self._vector(m))

    def hessian_vector(self, m: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """The product of the second derivatives d2j/dm_i dm_k at m with a vector v: `hessp` of `scipy.optimize.minimize`; `[len(m)]`.

        Two linear solves where state and gradient of m are at hand; exact, no differences. Raises Error where the cost has no second
        derivatives (equal costs of all scenarios under a measure of risk that has a kink there).
        """
        return self._problem.hessian_vector(self._vector(m), self._vector(v, "direction"))

    def constraint_values(self, m: ArrayLike) -> NDArray[np.float64]:
        """The values c(m) of all constraints, group by group, at most 0 where they are met (0 of equalities); `[values]`."""
        return self._problem.constraint_values(self._vector(m))

    def constraint_vjp(self, m: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """sum_k y_k dc_k/dm at m, by one adjoint solve; `[len(m)]`."""
        y = np.ascontiguousarray(y, dtype=np.float64)
        if y.shape != (self._values,):
            raise CaseError(f"the weights of the constraints have the shape {(self._values,)}, found {y.shape}")
        return self._problem.constraint_vjp(self._vector(m), y)

    def constraint_jacobian(self, m: ArrayLike) -> NDArray[np.float64]:
        """dc_k/dm_i at m, one adjoint solve for each value: `constraint_vjp` costs less where a sum will do; `[values][len(m)]`."""
        return np.array([self.constraint_vjp(m, row) for row in np.eye(self._values)]).reshape(-1, len(self))

    def nonlinear_constraint(self, scale: float = 1.0, **options: Any) -> Any:
        """All constraints at m = scale x as `scipy.optimize.NonlinearConstraint` of x, for `minimize(.., constraints=..)`; `options` go there.

        Values are divided by the scales of their groups.
        """
        from scipy.optimize import NonlinearConstraint

        size = np.ones(self._values)
        lower = np.full(self._values, -np.inf)
        for one in self.constraints.values():
            size[one.slice] = one.scale
            if one.equal:
                lower[one.slice] = 0.0

        def values(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.constraint_values(scale * x) / size

        def jacobian(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return scale * self.constraint_jacobian(scale * x) / size[:, None]

        return NonlinearConstraint(values, lower, 0.0, jac=jacobian, **options)

    def states(self, m: ArrayLike) -> dict[str, State]:
        """The state at m of every member by its name (scenario and load case; "" where there is one), with the fields of VTU files but those of an inspection.

        Of a motion the state at its end.
        """
        mesh = self._problem.mesh()
        found = self._problem.states(self._vector(m))
        return {one["name"]: State(one["name"], mesh, one["point_data"], one["cell_data"]) for one in found}

    def state(self, m: ArrayLike, name: str | None = None) -> State:
        """The state at m of the member of that name; of the only one without a name."""
        return self.states(m)[self._member(name)]

    def displacement(self, m: ArrayLike, name: str | None = None) -> NDArray[np.float64]:
        """u at the nodes at m, of the member of that name; `[nodes][3]`."""
        return self.state(m, name).displacement

    def displacement_vjp(self, m: ArrayLike, w: ArrayLike, name: str | None = None) -> NDArray[np.float64]:
        """(du/dm)^T w at m: the derivative by m of sum(w * u) at fixed w, `[nodes][3]`, by one linear solve; `[len(m)]`.

        With it a loss on whole displacement fields has its gradient: w is the derivative of the loss by u. Of equilibria, not of motions (Error).
        """
        w = np.ascontiguousarray(w, dtype=np.float64)
        nodes = len(self._problem.mesh()["points"])
        if w.shape != (nodes, 3):
            raise CaseError(f"the weights of the displacements have the shape {(nodes, 3)}, found {w.shape}")
        if not np.isfinite(w).all():
            raise CaseError("a weight of the displacements is not finite")
        own = self._member(name)
        weights = [w.ravel() if one == own else np.empty(0) for one in self._problem.members()]
        return self._problem.displacement_vjp(self._vector(m), weights)

    def _member(self, name: str | None) -> str:
        names = self._problem.members()
        if name is None and len(names) == 1:
            return names[0]
        if name not in names:
            listed = ", ".join(repr(one) for one in names)
            raise CaseError(f"there is no state {name!r}: choose one of {listed}" if name else f"there are {len(names)} states: choose one of {listed}")
        return name

    def stop(self) -> None:
        """Ends the call that another thread has under way: it raises SolveError of kind "cancelled". Later calls begin anew."""
        self._problem.stop()

    def reset(self) -> None:
        """Forgets all states: the next control is evaluated from rest."""
        self._problem.reset()

    @property
    def evaluations(self) -> int:
        """How many controls have been evaluated: states solved for, those that failed not counted."""
        return self._problem.evaluations()

    def split(self, m: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The parts of a control vector, or of a gradient, by name: `[unknowns]`, of vectors `[unknowns][components]`."""
        m = np.asarray(m, dtype=np.float64)
        if m.shape != self.start.shape:
            raise CaseError(f"the control vector has the shape {self.start.shape}, found {m.shape}")
        fields = self.layout.values()
        return {c.name: m[c.slice].reshape(-1, c.components) if c.components > 1 else m[c.slice] for c in fields}

    def _vector(self, m: ArrayLike, what: str = "control vector") -> NDArray[np.float64]:
        m = np.ascontiguousarray(m, dtype=np.float64)
        if m.shape != self.start.shape:
            raise CaseError(f"the {what} has the shape {self.start.shape}, found {m.shape}")
        if not np.isfinite(m).all():
            at = int(np.flatnonzero(~np.isfinite(m))[0])
            raise CaseError(f"entry {at} of the {what} is {m[at]}: all must be finite")
        return m


def _control(
    *, name: str, first: int, len: int, space: str, components: int, unit: str, norm: float | None, max_norm: float | None
) -> Control:
    return Control(name, slice(first, first + len), space, components, unit, norm, max_norm)
