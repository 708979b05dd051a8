"""Pictures of docs/reproduction.md from the results that scripts/reproduce.py left in out/reproduction (pyvista, matplotlib)."""

import csv
import json
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
import vtk
from PIL import Image

pv.OFF_SCREEN = True
vtk.vtkObject.GlobalWarningDisplayOff()  # that there is no screen
vtk.vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()  # lines on faces are seen whole

INK, BLUE, ORANGE, GREY, GREEN = "#222222", "#1f6fb2", "#d9822b", "#888888", "#2f9e44"
BODY, TARGET = "steelblue", "darkorange"
BAR_VIEW = [(0.25, -3.0, 1.1), (0.46, 0.1, 0.24), (0, 0, 1)]


def draw_all(out, images):
    images.mkdir(parents=True, exist_ok=True)
    for name in ("arc", "known", "stem"):
        own_picture(out / name / "picture.png", images / f"target_{name}.png")
    iterates(out, images / "iterates.png")
    convergence(out, images / "convergence.png")
    tensions(out, images / "tensions.png")
    t_magnet(out, images / "t_magnet.png")
    two_loads(out, images / "t_two_loads.png")
    petal(out, images / "petal.png")
    nodes(out, images / "nodes.png")
    costs_and_pressures(out, images / "robust_costs.png")
    shapes(out, images / "robust_shapes.png")


# Of bodies


def moved(path):
    mesh = pv.read(path)
    return mesh, mesh.warp_by_vector("displacement") if "displacement" in mesh.point_data else mesh


def surface(mesh):
    return mesh.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")


def body_of(plotter, mesh, colour, opacity=1.0):
    plotter.add_mesh(surface(mesh), color=colour, opacity=opacity, ambient=0.35, diffuse=0.75)


def outline(plotter, skin):
    plotter.add_mesh(skin.extract_feature_edges(40), color=TARGET, line_width=3)


def tracked(path):
    """The faces of a target that a tracking cost looks at, where they should be."""
    skin = surface(moved(path)[1])
    faces = skin.point_data_to_cell_data()["tracked"] > 0.999
    return skin.extract_cells(np.flatnonzero(faces)).extract_surface(algorithm="dataset_surface")


def title(plotter, text):
    plotter.add_text(text, position=(0.02, 0.92), viewport=True, font_size=11, color=INK, font="arial")


def plotter_of(rows, columns, size):
    plotter = pv.Plotter(shape=(rows, columns), window_size=(size[0] * columns, size[1] * rows), border=False)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def save(plotter, path, method=Image.Quantize.MEDIANCUT):
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    quantised(Image.fromarray(image), path, 256, method)


def quantised(image, path, colours, method=Image.Quantize.MEDIANCUT):
    """Colours by how many pixels have them, for shaded bodies; by the range that they cover (MAXCOVERAGE), for colour bars."""
    image.convert("RGB").quantize(colours, method=method, kmeans=4, dither=Image.Dither.NONE).save(path, optimize=True)


def own_picture(source, path):
    """The picture that the run itself wrote, smaller."""
    image = Image.open(source).convert("RGB")
    smaller = image.resize((1000, round(1000 * image.height / image.width)), Image.Resampling.LANCZOS)
    quantised(smaller, path, 256, Image.Quantize.MAXCOVERAGE)


def arrows(rest, shown, length):
    """Remanence at the cells' centres, drawn where the cells are."""
    centres = pv.PolyData(shown.cell_centers().points)
    centres["B_r"] = rest.cell_data["B_r"]
    return centres.glyph(orient="B_r", scale=False, factor=length, geom=pv.Arrow(tip_radius=0.16, shaft_radius=0.06))


def field_arrow(rest, at, length):
    """The applied field, uniform, beside the body."""
    b = rest.cell_data["B_a"][0]
    return pv.Arrow(start=at, direction=b, scale=length, tip_radius=0.1, shaft_radius=0.04)


def accepted(directory):
    with open(directory / "history.csv") as lines:
        by_iteration = {int(row["iteration"]): row for row in csv.DictReader(lines) if row["accepted"] == "true"}
    return [by_iteration[k] for k in range(len(by_iteration))]


def iterates(out, path):
    rows = accepted(out / "arc_gradient")
    last = int(rows[-1]["iteration"])
    target = surface(pv.read(out / "arc_gradient/target.vtu"))
    plotter = plotter_of(2, 3, (440, 300))
    for place, k in enumerate([0, 1, 3, 8, 15, last]):
        plotter.subplot(place // 3, place % 3)
        _, body = moved(out / f"arc_gradient/iteration_{k:04}.vtu")
        body_of(plotter, body, BODY)
        outline(plotter, target)
        title(plotter, f"iteration {k}: {1e3 * float(rows[k]['hausdorff_true']):.1f} mm")
        plotter.camera_position = BAR_VIEW
        plotter.camera.zoom(2.0)
    save(plotter, path)


def tensions(out, path):
    panels = [
        ("the tension that made the target", "known_given/start.vtu"),
        ("the tension found for it", "known/optimum.vtu"),
        ("found for the arc", "arc/optimum.vtu"),
        ("found for the end face (nodal)", "tip/optimum.vtu"),
    ]
    plotter = plotter_of(2, 2, (560, 330))
    for place, (name, file) in enumerate(panels):
        plotter.subplot(place // 2, place % 2)
        _, body = moved(out / file)
        skin = surface(body)
        skin["tension"] = 1e-3 * skin["tension"]
        bar = {"title": "tension (kPa)", "color": INK, "n_labels": 5, "fmt": "%.0f", "position_x": 0.3, "position_y": 0.02,
               "title_font_size": 15, "label_font_size": 13, "width": 0.5, "height": 0.1}
        plotter.add_mesh(skin, scalars="tension", cmap="coolwarm", clim=(-300, 300), lighting=False, copy_mesh=True,
                         show_scalar_bar=place == len(panels) - 1, scalar_bar_args=bar)
        cells = body.separate_cells().extract_surface(nonlinear_subdivision=1, algorithm="dataset_surface")
        plotter.add_mesh(cells.extract_feature_edges(30), color=INK, line_width=1, opacity=0.4)
        title(plotter, name)
        plotter.camera_position = BAR_VIEW
        plotter.camera.zoom(1.9)
    save(plotter, path, Image.Quantize.MAXCOVERAGE)


def magnet_panels(panels, camera, zoom, path):
    """Every panel: title, how high the camera looks, bodies as (mesh, colour, opacity), outlines, arrows of B_r, arrow of B_a."""
    plotter = plotter_of(1, len(panels), (440, 380))
    for column, (name, height, bodies, targets, remanence, field) in enumerate(panels):
        plotter.subplot(0, column)
        for mesh, colour, opacity in bodies:
            body_of(plotter, mesh, colour, opacity)
        for target in targets:
            outline(plotter, target)
        if remanence is not None:
            plotter.add_mesh(remanence, color="firebrick")
        if field is not None:
            plotter.add_mesh(field, color="black")
        title(plotter, name)
        eye, focus, up = camera
        plotter.camera_position = [(*eye[:2], eye[2] + height), (*focus[:2], focus[2] + height), up]
        plotter.camera.zoom(zoom)
    save(plotter, path)


T_CAMERA, T_ZOOM = [(2.4, -2.4, 1.3), (0.5, 0.0, 0.0), (0, 0, 1)], 1.3


def t_magnet(out, path):
    here = out / "t_magnet"
    _, start = moved(here / "start.vtu")
    best, optimum = moved(here / "optimum.vtu")
    target = tracked(here / "target.vtu")
    panels = [
        ("start", 0.4, [(start, "lightsteelblue", 1.0)], [target], None, None),
        ("optimum, applied field", 0.4, [(optimum, BODY, 1.0)], [target], None, field_arrow(best, (0.8, 0.1, 0.0), 0.3)),
        ("remanence, at rest", 0.0, [(best, "lightgrey", 0.35)], [], arrows(best, best, 0.08), None),
    ]
    magnet_panels(panels, T_CAMERA, T_ZOOM, path)


def two_loads(out, path):
    here, panels = out / "t_two_loads", []
    for name, height, at in [("lifted", 0.4, (0.8, 0.1, 0.0)), ("lowered", -0.3, (0.45, 0.55, 0.1))]:
        best, optimum = moved(here / f"{name}_optimum.vtu")
        target = tracked(here / f"{name}_target.vtu")
        panels.append((f"{name}, applied field", height, [(optimum, BODY, 1.0)], [target], None, field_arrow(best, at, 0.3)))
    panels.append(("the one remanence, at rest", 0.0, [(best, "lightgrey", 0.35)], [], arrows(best, best, 0.08), None))
    magnet_panels(panels, T_CAMERA, T_ZOOM, path)


def petal(out, path):
    here = out / "petal"
    _, start = moved(here / "start.vtu")
    best, optimum = moved(here / "optimum.vtu")
    target = tracked(here / "target.vtu")
    panels = [
        ("start", 0.02, [(start, "thistle", 1.0)], [target], None, None),
        ("optimum, applied field", 0.04, [(optimum, "orchid", 1.0)], [target], None,
         field_arrow(best, (-0.1, 0.1, 0.03), 0.06)),
        ("remanence, at rest", 0.0, [(best, "lightgrey", 0.35)], [], arrows(best, best, 0.016), None),
    ]
    magnet_panels(panels, [(0.36, -0.47, 0.35), (0.0, 0.0, 0.0), (0, 0, 1)], 1.2, path)


# Plots


def axes(count, size, **kind):
    figure, all_axes = plt.subplots(1, count, figsize=size, **kind)
    for ax in np.atleast_1d(all_axes):
        ax.spines[["top", "right"]].set_visible(False)
    return figure, np.atleast_1d(all_axes)


def save_plot(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
    quantised(Image.open(path), path, 64)


def convergence(out, path):
    figure, (left, right) = axes(2, (9, 3.4))
    for name, label, colour in [("arc_gradient", "projected gradient (Algorithm 1)", ORANGE), ("arc", "L-BFGS", BLUE)]:
        rows = accepted(out / name)
        k = [int(row["iteration"]) for row in rows]
        left.semilogy(k, [1e3 * float(row["hausdorff_true"]) for row in rows], "-", color=colour, label=label)
        floor = json.loads((out / name / "result.json").read_text())["hausdorff"]["self"]
        # Costs of different stages are different functions; the floor is that of the last.
        fine = [row for row in rows if row["stage"] == "1"]
        right.semilogy([int(row["iteration"]) for row in fine], [1e3 * (float(row["cost"]) - floor) for row in fine], "-", color=colour)
        change = next(int(row["iteration"]) for row in rows if row["stage"] == "1")
        left.axvline(change, color=colour, linewidth=0.8, linestyle=":")
    left.set(xlabel="iteration (dotted: the fine stage begins)", ylabel="true Hausdorff distance (mm)")
    right.set(xlabel="iteration (fine stage)", ylabel="rho - rho(T, T) (mm)")
    left.legend(frameon=False, fontsize=9)
    save_plot(figure, path)


def scenarios_of(out, name):
    return json.loads((out / name / "result.json").read_text())["scenarios"].values()


def nodes(out, path):
    scale = {"shear": (1e-6, "shear modulus (MPa)"), "bulk": (1e-6, "bulk modulus (MPa)"), "share": (1, "share U")}
    parameters = {name: f"materials/0/{name}" for name in scale}
    values = lambda runs, name: scale[name][0] * np.array([one["set"][parameters[name]] for one in runs])
    draws, rule = list(scenarios_of(out, "draws_robust")), list(scenarios_of(out, "robust"))
    figure, all_axes = axes(3, (10, 3.4))
    for ax, (a, b) in zip(all_axes, [("shear", "bulk"), ("shear", "share"), ("bulk", "share")]):
        ax.plot(values(draws, a), values(draws, b), ".", color=GREY, markersize=2.5, alpha=0.6, label=f"{len(draws)} draws")
        # Nodes behind one another in the third parameter: their probabilities together.
        weights = {}
        for x, y, one in zip(values(rule, a), values(rule, b), rule):
            weights[x, y] = weights.get((x, y), 0.0) + one["probability"]
        x, y = zip(*weights)
        area = 900 * np.array(list(weights.values()))
        ax.scatter(x, y, s=area, color=ORANGE, edgecolor=INK, linewidth=0.8, zorder=3, label="nodes, area: probability")
        ax.set(xlabel=scale[a][1], ylabel=scale[b][1])
    handles, labels = all_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, fontsize=9, loc="upper center", ncols=2, bbox_to_anchor=(0.5, 1.06))
    figure.tight_layout()
    figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)
    quantised(Image.open(path), path, 64)


CONTROLS = [("deterministic", GREY, "stem/optimum.vtu"), ("robust", GREEN, "robust/scenario_000_optimum.vtu")]


def costs_and_pressures(out, path):
    figure, (left, right) = axes(2, (9.5, 3.4), width_ratios=[1.5, 1])
    bins = np.geomspace(0.2, 1000, 38)
    for name, colour, file in CONTROLS:
        costs = [one["cost"]["total"] for one in scenarios_of(out, f"draws_{name}")]
        mean = sum(costs) / len(costs)
        left.hist(costs, bins, histtype="step", color=colour, linewidth=2, label=f"{name}: mean {mean:.1f} mm²")
        left.axvline(mean, ymax=0.75, color=colour, linewidth=1, linestyle="--")
        mesh = pv.read(out / file)
        flank = mesh.extract_cells(np.flatnonzero(mesh.cell_data["region:flank"]))
        x, pressure = 1e3 * flank.cell_centers().points[:, 0], 1e-3 * flank.cell_data["turgor"]
        order = np.argsort(x)
        right.step(x[order], pressure[order], where="mid", color=colour, linewidth=2, label=name)
    left.set(xscale="log", xlabel="cost of a draw (mm²)", ylabel=f"draws of {len(costs)}")
    left.set_ylim(top=1.35 * left.get_ylim()[1])
    right.set(xlabel="place along the stem (mm)", ylabel="turgor (kPa)", ylim=(0, 2600))
    left.legend(frameon=False, fontsize=9)
    right.legend(frameon=False, fontsize=9)
    save_plot(figure, path)


def mean_shape(directory):
    """Mean and standard deviation of the position over equally probable draws."""
    files = sorted(directory.glob("scenario_*_start.vtu"))
    mesh = pv.read(files[0])
    u = np.array([pv.read(file).point_data["displacement"] for file in files], dtype=float)
    mesh.point_data["mean"] = u.mean(axis=0)
    mesh.point_data["deviation"] = 1e3 * np.sqrt(u.var(axis=0).sum(axis=1))
    return mesh.warp_by_vector("mean")


def shapes(out, path):
    target = tracked(out / "stem/target.vtu")
    plotter = plotter_of(1, 2, (640, 400))
    bodies = [(name, mean_shape(out / f"draws_{name}")) for name, _, _ in CONTROLS]
    most = 3 * math.ceil(max(body["deviation"].max() for _, body in bodies) / 3)
    for column, (name, body) in enumerate(bodies):
        plotter.subplot(0, column)
        bar = {"title": "standard deviation of the position (mm)", "color": INK, "n_labels": 4, "fmt": "%.0f", "position_x": 0.2,
               "position_y": 0.03, "title_font_size": 16, "label_font_size": 14, "width": 0.6, "height": 0.09}
        plotter.add_mesh(surface(body), scalars="deviation", cmap="viridis", clim=(0, most), lighting=False, scalar_bar_args=bar)
        outline(plotter, target.translate((0, -0.02, 0)))  # in front of the body, along the view
        title(plotter, f"{name}: mean shape, deviation up to {body['deviation'].max():.1f} mm")
        plotter.camera_position = [(0.05, -0.5, 0.015), (0.05, 0.0, 0.01), (0, 0, 1)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 0.034
    save(plotter, path, Image.Quantize.MAXCOVERAGE)
