"""The compiled part of the package; its users are the other modules."""

from pathlib import Path
from typing import Any, Callable, Mapping, final

import numpy as np
from numpy.typing import NDArray

VERSION: str

def read(path: Path) -> str: ...
def schema() -> str: ...
def run(
    command: str,
    name: str,
    case: str,
    meshes: Mapping[str, Mesh],
    *,
    out: Path | None,
    threads: int | None,
    report: bool,
    restart: bool,
    callback: Callable[[str], None] | None,
) -> tuple[int, str, str, States | None]: ...
@final
class Mesh:
    def __new__(
        cls,
        name: str,
        points: NDArray[np.float64],
        cells: list[tuple[str, NDArray[np.int64]]],
        regions: list[tuple[str, NDArray[np.int64]]],
        facets: list[tuple[str, NDArray[np.int64]]],
        surfaces: list[tuple[str, NDArray[np.int64]]],
        nodes: list[tuple[str, NDArray[np.int64]]],
    ) -> Mesh: ...
    def arrays(self) -> dict[str, Any]: ...

@final
class States:
    def mesh(self) -> dict[str, Any]: ...
    def members(self) -> list[dict[str, Any]]: ...
    def controls(self) -> dict[str, NDArray[np.float64]]: ...
    def derivative(self) -> dict[str, NDArray[np.float64]] | None: ...
    def picture(self) -> bytes: ...

@final
class Problem:
    def __new__(
        cls,
        name: str,
        case: str,
        meshes: Mapping[str, Mesh],
        *,
        threads: int | None,
        accuracy: float,
        stage: int | None,
        max_newton: int | None,
        callback: Callable[[str], None] | None,
    ) -> Problem: ...
    def value(self, m: NDArray[np.float64]) -> float: ...
    def value_and_gradient(self, m: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]: ...
    def hessian_vector(self, m: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def stop(self) -> None: ...
    def reset(self) -> None: ...
    def evaluations(self) -> int: ...
    def start(self) -> NDArray[np.float64]: ...
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def layout(self) -> list[dict[str, Any]]: ...
    def stages(self) -> tuple[int, int]: ...
