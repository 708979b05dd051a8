"""Cost and displacements of a problem as PyTorch functions (needs the package torch)."""

from __future__ import annotations

from typing import Any, Callable

import torch

from .problem import Problem


class _Cost(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, m: torch.Tensor, problem: Problem) -> torch.Tensor:
        vector = m.detach().to("cpu", torch.float64).numpy()
        if ctx.needs_input_grad[0]:
            value, gradient = problem.value_and_gradient(vector)
            ctx.save_for_backward(torch.from_numpy(gradient).to(m))
        else:
            value = problem.value(vector)
        return torch.tensor(value, dtype=m.dtype, device=m.device)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, by_value: torch.Tensor) -> tuple[torch.Tensor, None]:
        (gradient,) = ctx.saved_tensors
        return by_value * gradient, None


def cost(problem: Problem) -> Callable[[torch.Tensor], torch.Tensor]:
    """j(m) for PyTorch: `cost(problem)(m).backward()` adds `problem.gradient` to `m.grad`.

    There is no second derivative. Values are computed in double precision on the processor and returned in the type and on the device
    of m: use `torch.float64` for all digits.
    """
    return lambda m: _Cost.apply(m, problem)


class _Displacement(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, m: torch.Tensor, problem: Problem, name: str | None) -> torch.Tensor:
        vector = m.detach().to("cpu", torch.float64).numpy()
        ctx.problem, ctx.name = problem, name
        ctx.save_for_backward(m)
        return torch.from_numpy(problem.displacement(vector, name)).to(m)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, w: torch.Tensor) -> tuple[torch.Tensor, None, None]:
        (m,) = ctx.saved_tensors
        weights = w.detach().to("cpu", torch.float64).numpy()
        vector = m.detach().to("cpu", torch.float64).numpy()
        return torch.from_numpy(ctx.problem.displacement_vjp(vector, weights, ctx.name)).to(m), None, None


def displacement(problem: Problem, name: str | None = None) -> Callable[[torch.Tensor], torch.Tensor]:
    """u(m) at the nodes for PyTorch, `[nodes][3]`, of the member of that name: a layer in a model.

    Its derivative is `problem.displacement_vjp`, one linear solve; there is no second one.
    """
    return lambda m: _Displacement.apply(m, problem, name)
