"""Results: numbers, fields and pictures of a run."""

from __future__ import annotations

import html
import importlib
import io
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _nastic
from .errors import Error

if TYPE_CHECKING:
    import meshio
    import pyvista

#: Kinds of cells: meshio's names and VTK's numbers.
_KINDS = {
    "tri3": ("triangle", 5),
    "tri6": ("triangle6", 22),
    "quad4": ("quad", 9),
    "quad8": ("quad8", 23),
    "quad9": ("quad9", 28),
    "tet4": ("tetra", 10),
    "tet10": ("tetra10", 24),
    "hex8": ("hexahedron", 12),
    "hex20": ("hexahedron20", 25),
    "hex27": ("hexahedron27", 29),
}


class State:
    """One equilibrium: the mesh, and fields on it.

    `points`: reference positions, `[nodes][3]`. `cells`: node numbers by kind, in VTK's order. `regions`: numbers of cells by name, counted
    through all kinds. `point_data`, `cell_data`: the arrays of VTU files (docs/results.md): `displacement`, `J`, `cauchy_stress`
    (`[cells][3][3]`), controls under their names, `gradient_NAME` (the Riesz image in the control's inner product) ..
    """

    def __init__(self, name: str, mesh: dict[str, Any], point_data: dict[str, Any], cell_data: dict[str, Any]) -> None:
        #: Scenario and load case; empty where there is one state.
        self.name = name
        self.points: NDArray[np.float64] = mesh["points"]
        self.cells: dict[str, NDArray[np.int64]] = mesh["cells"]
        self.regions: dict[str, NDArray[np.int64]] = mesh["regions"]
        self.point_data: dict[str, NDArray[np.float64]] = point_data
        self.cell_data: dict[str, NDArray[np.float64]] = cell_data

    @property
    def displacement(self) -> NDArray[np.float64]:
        """u at the nodes, `[nodes][3]`."""
        return self.point_data["displacement"]

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(own)} {kind}" for kind, own in self.cells.items())
        return f"nastic.State({self.name!r}: {len(self.points)} points, {cells}; {', '.join(self.point_data)}; {', '.join(self.cell_data)})"

    def to_meshio(self) -> meshio.Mesh:
        """A `meshio.Mesh` in the reference position, with all fields."""
        meshio = _import("meshio")
        ends = np.cumsum([len(own) for own in self.cells.values()])[:-1]
        cells = [(_KINDS[kind][0], own) for kind, own in self.cells.items()]
        cell_data = {name: np.split(_flat(values), ends) for name, values in self.cell_data.items()}
        point_data = {name: _flat(values) for name, values in self.point_data.items()}
        return meshio.Mesh(self.points, cells, point_data=point_data, cell_data=cell_data)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A `pyvista.UnstructuredGrid` in the reference position, with all fields; `grid.warp_by_vector("displacement")` moves it."""
        pyvista = _import("pyvista")
        types = np.concatenate([np.full(len(own), _KINDS[kind][1], dtype=np.uint8) for kind, own in self.cells.items()])
        counted = [np.column_stack([np.full(len(own), own.shape[1]), own]).ravel() for own in self.cells.values()]
        grid = pyvista.UnstructuredGrid(np.concatenate(counted), types, self.points)
        for name, values in self.point_data.items():
            grid.point_data[name] = _flat(values)
        for name, values in self.cell_data.items():
            grid.cell_data[name] = _flat(values)
        return grid


class Result:
    """What a command found. Pickleable; it shows itself in Jupyter, as the page of its directory or as a table.

    `result`: the dictionary of result.json. `log`: the text that the program prints. `directory`: where files were written, or None.
    `history`: one dictionary per trial of an optimisation, as in history.jsonl. `controls`: values by name, `[unknowns]`, of vectors
    `[unknowns][components]`. `gradient`: partial derivatives dj/dm_i by name, in the same shapes; empty after `solve`. `states`: the
    `State` of every member by name (scenario and load case), of a plain case one with the name ""; empty after `check`.

    `points`, `cells`, `displacement`, `point_data`, `cell_data`, `to_meshio` and `to_pyvista` are those of the only state.
    """

    def __init__(
        self,
        result: dict[str, Any],
        log: str,
        directory: Path | None,
        history: list[dict[str, Any]],
        controls: dict[str, NDArray[np.float64]],
        gradient: dict[str, NDArray[np.float64]],
        states: dict[str, State],
    ) -> None:
        self.result = result
        self.log = log
        self.directory = directory
        self.history = history
        self.controls = controls
        self.gradient = gradient
        self.states = states
        self._source: _nastic.States | None = None
        self._png: bytes | None = None

    @classmethod
    def _of(
        cls,
        result: dict[str, Any],
        log: str,
        directory: Path | None,
        history: list[dict[str, Any]],
        source: _nastic.States | None,
    ) -> Result:
        if source is None:
            return cls(result, log, directory, history, {}, {}, {})
        mesh = source.mesh()
        members = {one["name"]: State(one["name"], mesh, one["point_data"], one["cell_data"]) for one in source.members()}
        out = cls(result, log, directory, history, source.controls(), source.derivative() or {}, members)
        out._source = source
        return out

    @property
    def converged(self) -> bool | None:
        """Whether an optimisation ended by its own test; None of other commands."""
        return self.result.get("converged")

    @property
    def state(self) -> State:
        """The only state; an Error where there are several, or none."""
        if len(self.states) != 1:
            names = ", ".join(repr(name) for name in self.states)
            raise Error(f"{self.result['command']} has {len(self.states)} states: choose one of result.states[..] {names}".rstrip())
        return next(iter(self.states.values()))

    @property
    def points(self) -> NDArray[np.float64]:
        """Reference positions, `[nodes][3]`."""
        return self.state.points

    @property
    def cells(self) -> dict[str, NDArray[np.int64]]:
        """Node numbers by kind of cell."""
        return self.state.cells

    @property
    def displacement(self) -> NDArray[np.float64]:
        """u at the nodes, `[nodes][3]`."""
        return self.state.displacement

    @property
    def point_data(self) -> dict[str, NDArray[np.float64]]:
        """Nodal fields by name."""
        return self.state.point_data

    @property
    def cell_data(self) -> dict[str, NDArray[np.float64]]:
        """Cell-wise fields by name."""
        return self.state.cell_data

    def to_meshio(self) -> meshio.Mesh:
        """As `State.to_meshio`."""
        return self.state.to_meshio()

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """As `State.to_pyvista`."""
        return self.state.to_pyvista()

    def figure(
        self,
        file: str | os.PathLike[str] | None = None,
        *,
        state: str | None = None,
        field: str | None = None,
        range: tuple[float, float] | None = None,
        view: tuple[float, float, float] | None = None,
        clip: tuple[tuple[float, float, float], float] | None = None,
        size: tuple[int, int] | None = None,
        behind: list[str] | None = None,
        paths: list[str] | None = None,
        edges: bool = False,
    ) -> Path:
        """Draws a state for print, as `nastic figure` does (docs/tutorials/11-figures.md), of a run with `out`; figure.png there unless `file` names another.

        `clip`: normal and offset of a plane beyond which the body is cut away, x . normal > offset.
        """
        if self.directory is None:
            raise Error("a figure is drawn from the files of a run: give the command an out=\"DIRECTORY\"")
        target = self.directory / "figure.png" if file is None else Path(file)
        return _nastic.figure(
            self.directory,
            target,
            frames=None,
            state=state,
            field=field,
            range=range,
            view=view,
            clip=clip,
            size=size,
            behind=behind,
            paths=paths or [],
            edges=edges,
        )

    def frames(
        self,
        directory: str | os.PathLike[str] | None = None,
        *,
        fps: float = 10.0,
        series: str | None = None,
        field: str | None = None,
        range: tuple[float, float] | None = None,
        view: tuple[float, float, float] | None = None,
        clip: tuple[tuple[float, float, float], float] | None = None,
        size: tuple[int, int] | None = None,
        behind: list[str] | None = None,
        paths: list[str] | None = None,
        edges: bool = False,
    ) -> Path:
        """Draws all states of a motion, ramp, path or optimisation with one view, scale and range of colours, as `nastic figure --frames` does, of a run
        with `out`: frame_0000.png .. and frames.gif there unless `directory` names another place; where the GIF is.

        `series`: motion, ramp, path or iteration; the first of these that there is. `fps`: frames in a second, 1 to 50. The others as of `figure`.
        """
        if self.directory is None:
            raise Error("frames are drawn from the files of a run: give the command an out=\"DIRECTORY\"")
        if not 1.0 <= fps <= 50.0:
            raise Error(f"fps is from 1 to 50, not {fps}")
        return _nastic.figure(
            self.directory,
            self.directory if directory is None else Path(directory),
            frames=fps,
            state=series,
            field=field,
            range=range,
            view=view,
            clip=clip,
            size=size,
            behind=behind,
            paths=paths or [],
            edges=edges,
        )

    def plot(self) -> Any:
        """A `matplotlib` figure: the picture of the states, and of an optimisation the costs of its trials beside it."""
        pyplot = _import("matplotlib.pyplot", "plot")
        png = self._repr_png_()
        trials = [one for one in self.history if one.get("cost") is not None]
        if png is None and not trials:
            raise Error(f"there is nothing to plot of {self.result['command']}: it has no state")
        shown = [what for what in (png, trials) if what]
        figure, axes = pyplot.subplots(1, len(shown), figsize=(8 * len(shown), 5), squeeze=False, layout="constrained")
        if png is not None:
            axes[0, 0].imshow(pyplot.imread(io.BytesIO(png)))
            axes[0, 0].set_axis_off()
        if trials:
            best = [one for one in trials if one.get("accepted")]
            right = axes[0, -1]
            right.plot([one["trial"] for one in trials], [one["cost"] for one in trials], ".", color="0.6", label="trials")
            right.plot([one["trial"] for one in best], [one["cost"] for one in best], "o-", label="accepted")
            right.set(xlabel="trial", ylabel="cost")
            if all(one["cost"] > 0 for one in trials):
                right.set_yscale("log")
            right.legend()
        return figure

    def __repr__(self) -> str:
        return f"nastic.Result({', '.join(f'{key}: {value}' for key, value in self._figures())})"

    def __getstate__(self) -> dict[str, Any]:
        # The picture is drawn before what draws it is left behind.
        self._repr_png_()
        return {**self.__dict__, "_source": None}

    def _repr_png_(self) -> bytes | None:
        """The picture: start, target and the state that was found (of the first load case)."""
        if self._png is None and self._source is not None:
            self._png = self._source.picture()
        return self._png

    def _repr_html_(self) -> str:
        """The page of results where one was written, else a table of the most important figures."""
        page = None if self.directory is None else self.directory / "report.html"
        if page is not None and "report.html" in self.result.get("files", []) and page.is_file():
            text = html.escape(page.read_text(encoding="utf-8"), quote=True)
            return f'<iframe srcdoc="{text}" style="width: 100%; height: 800px; border: 0"></iframe>'
        rows = "".join(
            f"<tr><th>{html.escape(key)}</th><td>{html.escape(str(value))}</td></tr>" for key, value in self._figures()
        )
        return f"<table>{rows}</table>"

    def _figures(self) -> list[tuple[str, object]]:
        found = self.result
        out = [("command", found["command"]), ("case", found.get("title") or found["case"])]
        if "cost" in found:
            out.append(("cost", f"{found['cost']['total']:.6g}"))
        if "hausdorff" in found and "true" in found["hausdorff"]:
            out.append(("true Hausdorff distance", f"{found['hausdorff']['true']:.4g} {found['units']['length']}"))
        for key in ("iterations", "stop", "min_J", "inertia"):
            if key in found:
                value = found[key]
                out.append((key, f"{value:.4g}" if isinstance(value, float) else value))
        if found.get("warnings"):
            out.append(("warnings", ", ".join(warning["code"] for warning in found["warnings"])))
        return out


def _flat(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Tensors as rows of nine numbers, as files have them."""
    return values.reshape(len(values), -1) if values.ndim == 3 else values


def _import(name: str, method: str | None = None) -> Any:
    package = name.split(".")[0]
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{method or f'to_{name}'}() needs the package {package}: pip install {package}") from error
