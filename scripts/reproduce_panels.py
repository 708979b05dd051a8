"""Pictures of bodies for scripts/reproduce_figures.py: VTK draws bodies, matplotlib titles and colour bars, so that all images of the page
have one type, one size and one palette."""

import math
from dataclasses import dataclass, field

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
import vtk
from matplotlib.colors import BoundaryNorm
from PIL import Image

pv.OFF_SCREEN = True
vtk.vtkObject.GlobalWarningDisplayOff()  # that there is no screen
vtk.vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()  # lines on faces are seen whole

INK, BLUE, ORANGE, GREY, GREEN, RED = "#222222", "#1f6fb2", "#d9822b", "#888888", "#2f9e44", "#b22222"
START, BODY, GLASS, TARGET, REMANENCE, FIELD = "#b9c4d0", BLUE, "#cccccc", ORANGE, RED, INK
WIDTH, DPI = 10, 110  # inches
plt.rcParams.update({"font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "legend.fontsize": 9, "text.color": INK})


@dataclass
class Scale:
    """What colours mean. The ends hold every value that is drawn: none is clipped."""

    label: str
    map: str
    low: float
    high: float
    bands: int

    @staticmethod
    def of(label, values, bands=13):
        """Round steps over the values; a field of both signs has zero in the middle of a band, which is grey."""
        low, high = (pick([pick(np.asarray(one)) for one in values]) for pick in (np.min, np.max))
        if low >= 0 and high > 0:
            return Scale(label, "viridis", 0.0, (bands - 1) * round_up(high / (bands - 1)), bands - 1)
        end = 0.5 * bands * round_up(2 * max(-low, high) / bands)
        return Scale(label, "coolwarm", -end, end, bands)

    def levels(self):
        return np.linspace(self.low, self.high, self.bands + 1)

    def ticks(self):
        """Every second of the levels; of bands about zero their middles."""
        levels = self.levels()
        marked = levels if self.low == 0 else 0.5 * (levels[1:] + levels[:-1])
        return marked[(self.bands // 2) % 2 :: 2]

    def check(self, values):
        if np.min(values) < self.low or np.max(values) > self.high:
            raise ValueError(f"{self.label}: {np.min(values)} to {np.max(values)} do not fit into {self.low} to {self.high}")


def round_up(step):
    """The next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(k * power for k in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if step <= k * power * (1 + 1e-12))


@dataclass
class Panel:
    """One picture of a figure: what it is called, and things to draw."""

    title: str
    height: float = 0.0  # how much higher the camera looks
    things: list = field(default_factory=list)

    def add(self, mesh, **look):
        self.things.append((mesh, look))
        return self

    def body(self, mesh, colour, opacity=1.0):
        return self.add(surface(mesh), color=colour, opacity=opacity, ambient=0.35, diffuse=0.75)

    def field(self, mesh, name, factor, scale, edges=True, contours=False):
        """A body coloured by an array times a factor, in bands."""
        skin = surface(mesh)
        skin[name] = factor * skin[name]
        scale.check(skin[name])
        self.add(skin, scalars=name, cmap=plt.get_cmap(scale.map, scale.bands), clim=(scale.low, scale.high), lighting=False,
                 show_scalar_bar=False, interpolate_before_map=True)
        if contours and np.ptp(skin[name]) > 0:
            self.add(skin.contour(scale.levels()[1:-1], scalars=name), color=INK, line_width=1, opacity=0.5)
        cells = mesh.separate_cells() if edges else mesh
        lines = cells.extract_surface(nonlinear_subdivision=1, algorithm="dataset_surface").extract_feature_edges(30)
        return self.add(lines, color=INK, line_width=1, opacity=0.4 if edges else 0.8)

    def outline(self, skin):
        return self.add(skin.extract_feature_edges(40), color=TARGET, line_width=4)


def surface(mesh):
    return mesh.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")


@dataclass
class Camera:
    eye: tuple
    focus: tuple
    up: tuple = (0, 0, 1)
    zoom: float = 1.0
    parallel: float = 0.0  # half the height of the view, without perspective


def rendered(panel, camera, size):
    plotter = pv.Plotter(window_size=size, border=False)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    for mesh, look in panel.things:
        plotter.add_mesh(mesh, copy_mesh=True, **look)
    raised = lambda point: (*point[:2], point[2] + panel.height)
    plotter.camera_position = [raised(camera.eye), raised(camera.focus), camera.up]
    if camera.parallel:
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = camera.parallel
    else:
        plotter.camera.zoom(camera.zoom)
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    return image


def cut(images):
    """All images within the part that any of them draws in."""
    drawn = np.any([image.min(axis=2) < 250 for image in images], axis=0)
    rows, columns = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    margin = 6
    window = tuple(slice(max(0, own[0] - margin), own[-1] + 1 + margin) for own in (rows, columns))
    return [image[window] for image in images]


def draw(panels, columns, camera, path, scale=None):
    """Panels in rows from one camera, and the bar of their colours below."""
    rows = math.ceil(len(panels) / columns)
    images = cut([rendered(panel, camera, (1400, 1000)) for panel in panels])
    tall = WIDTH / columns * images[0].shape[0] / images[0].shape[1] + 0.32
    below = 0.62 if scale else 0.05
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, rows * tall + below), squeeze=False)
    share = below / (rows * tall + below)
    figure.subplots_adjust(left=0.005, right=0.995, top=1 - 0.24 / (rows * tall + below), bottom=share, wspace=0.02, hspace=0.32 / tall)
    for ax in axes.flat:
        ax.axis("off")
    for ax, panel, image in zip(axes.flat, panels, images):
        ax.imshow(image, interpolation="lanczos")
        ax.set_title(panel.title, loc="left")
    if scale:
        place = figure.add_axes((0.3, 0.72 * share, 0.4, 0.16 * share))
        mapped = plt.cm.ScalarMappable(BoundaryNorm(scale.levels(), scale.bands), plt.get_cmap(scale.map, scale.bands))
        bar = figure.colorbar(mapped, cax=place, orientation="horizontal", ticks=scale.ticks(), format="%g")
        bar.set_label(scale.label)
        bar.outline.set_linewidth(0.5)
    save(figure, path)


def axes(count, height, **kind):
    figure, all_axes = plt.subplots(1, count, figsize=(WIDTH, height), **kind)
    for ax in np.atleast_1d(all_axes):
        ax.spines[["top", "right"]].set_visible(False)
    return figure, np.atleast_1d(all_axes)


def save_plot(figure, path):
    figure.tight_layout()
    save(figure, path)


def save(figure, path):
    figure.savefig(path, dpi=DPI)
    plt.close(figure)
    # colours by the range that they cover: bars of colours keep all of theirs
    image = Image.open(path).convert("RGB").quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=4, dither=Image.Dither.NONE)
    image.save(path, optimize=True)
