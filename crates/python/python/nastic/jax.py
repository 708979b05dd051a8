"""Cost and displacements of a problem as JAX functions (needs the package jax)."""

from __future__ import annotations

from typing import Callable

import jax
import jax.numpy as jnp
import numpy as np

from .problem import Problem


def cost(problem: Problem) -> Callable[[jax.Array], jax.Array]:
    """j(m) for JAX: works under `jax.grad`, `jax.value_and_grad`, `jax.jit` and, one vector after the other, `jax.vmap`.

    Its derivative in reverse mode is `problem.gradient`; there is none in forward mode, and no second one. Values are computed in
    double precision and returned in the precision of m: set `jax_enable_x64` for all digits.
    """

    def shape(*dimensions: int, like: jax.Array) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct(dimensions, like.dtype)

    def value(m: jax.Array) -> np.ndarray:
        return np.asarray(problem.value(np.asarray(m)), dtype=m.dtype)

    def both(m: jax.Array) -> tuple[np.ndarray, np.ndarray]:
        found, gradient = problem.value_and_gradient(np.asarray(m))
        return np.asarray(found, dtype=m.dtype), gradient.astype(m.dtype)

    @jax.custom_vjp
    def of(m: jax.Array) -> jax.Array:
        return jax.pure_callback(value, shape(like=m), m, vmap_method="sequential")

    def forward(m: jax.Array) -> tuple[jax.Array, jax.Array]:
        return jax.pure_callback(both, (shape(like=m), shape(len(problem), like=m)), m, vmap_method="sequential")

    def backward(gradient: jax.Array, by_value: jax.Array) -> tuple[jax.Array]:
        return (by_value * gradient,)

    of.defvjp(forward, backward)

    def floating(m: jax.Array) -> jax.Array:
        m = jnp.asarray(m)
        return of(m if jnp.issubdtype(m.dtype, jnp.floating) else m.astype(float))

    return floating

def displacement(problem: Problem, name: str | None = None) -> Callable[[jax.Array], jax.Array]:
    """u(m) at the nodes for JAX, `[nodes][3]`, of the member of that name: a layer in a model, under `jax.grad` in reverse mode.

    Its derivative is `problem.displacement_vjp`, one linear solve.
    """
    nodes = len(problem.displacement(problem.start, name))

    def value(m: jax.Array) -> np.ndarray:
        return np.asarray(problem.displacement(np.asarray(m), name), dtype=m.dtype)

    def product(m: jax.Array, w: jax.Array) -> np.ndarray:
        return np.asarray(problem.displacement_vjp(np.asarray(m), np.asarray(w), name), dtype=m.dtype)

    @jax.custom_vjp
    def of(m: jax.Array) -> jax.Array:
        return jax.pure_callback(value, jax.ShapeDtypeStruct((nodes, 3), m.dtype), m, vmap_method="sequential")

    def forward(m: jax.Array) -> tuple[jax.Array, jax.Array]:
        return of(m), m

    def backward(m: jax.Array, w: jax.Array) -> tuple[jax.Array]:
        return (jax.pure_callback(product, jax.ShapeDtypeStruct(m.shape, m.dtype), m, w, vmap_method="sequential"),)

    of.defvjp(forward, backward)

    def floating(m: jax.Array) -> jax.Array:
        m = jnp.asarray(m)
        return of(m if jnp.issubdtype(m.dtype, jnp.floating) else m.astype(float))

    return floating
