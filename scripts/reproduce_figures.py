"""Pictures of docs/reproduction.md from the results that scripts/reproduce.py left in out/reproduction (pyvista, matplotlib)."""

import csv
import json

import numpy as np
import pyvista as pv
from reproduce_panels import (BLUE, BODY, FIELD, GLASS, GREEN, GREY, INK, ORANGE, REMANENCE, START, Camera, Panel, Scale, axes, draw,
                              save, save_plot, surface)

BAR = Camera((0.25, -3.0, 1.1), (0.46, 0.1, 0.24), zoom=1.9)


def draw_all(out, images):
    images.mkdir(parents=True, exist_ok=True)
    for name in ("arc", "known"):
        start_and_optimum(out / name, "tension (kPa)", "tension", BAR, images / f"target_{name}.png")
    start_and_optimum(out / "stem", "turgor (kPa)", "turgor", STEM, images / "target_stem.png", forward=(0, -0.02, 0))
    iterates(out, images / "iterates.png")
    convergence(out, images / "convergence.png")
    field_over_iterations(out, images / "field_iterates.png")
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


def target_of(directory, name="target.vtu"):
    """The faces of a target that a tracking cost looks at, where they should be; all of a target shape."""
    skin = surface(moved(directory / name)[1])
    if "tracked" not in skin.point_data:
        return skin
    faces = skin.point_data_to_cell_data()["tracked"] > 0.999
    return skin.extract_cells(np.flatnonzero(faces)).extract_surface(algorithm="dataset_surface")


def arrows(rest, length):
    """Remanence at the cells' centres."""
    centres = pv.PolyData(rest.cell_centers().points)
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


def array(mesh, name):
    return mesh.point_data[name] if name in mesh.point_data else mesh.cell_data[name]


STEM = Camera((0.05, -0.5, 0.015), (0.05, 0.0, 0.01), parallel=0.036)


def start_and_optimum(here, label, name, camera, path, forward=(0, 0, 0)):
    """Both with the outline of the target, brought forward where the body would hide it."""
    target = target_of(here).translate(forward)
    optimum = moved(here / "optimum.vtu")[1]
    scale = Scale.of(label, [1e-3 * array(optimum, name)])
    start = Panel("start, outline of the target").body(moved(here / "start.vtu")[1], START).outline(target)
    draw([start, Panel(f"optimum, {name}").field(optimum, name, 1e-3, scale).outline(target)], 2, camera, path, scale)


def iterates(out, path):
    rows = accepted(out / "arc_gradient")
    shown = [0, 1, 3, 8, 15, int(rows[-1]["iteration"])]
    bodies = [moved(out / f"arc_gradient/iteration_{k:04}.vtu")[1] for k in shown]
    scale = Scale.of("tension (kPa)", [1e-3 * array(body, "tension") for body in bodies])
    target = target_of(out / "arc_gradient")
    titles = [f"iteration {k}: {1e3 * float(rows[k]['hausdorff_true']):.1f} mm" for k in shown]
    panels = [Panel(title).field(body, "tension", 1e-3, scale).outline(target) for title, body in zip(titles, bodies)]
    draw(panels, 3, BAR, path, scale)


def field_over_iterations(out, path):
    """One field on the body at rest, and beside the last one that which made the target."""
    here, rows = out / "known_fine", accepted(out / "known_fine")
    shown = [0, 1, 2, 4, 8, 16, 28, int(rows[-1]["iteration"])]
    rest = [pv.read(here / f"iteration_{k:04}.vtu") for k in shown]
    given = pv.read(out / "known_given/start.vtu")
    scale = Scale.of("tension (kPa)", [1e-3 * array(one, "tension") for one in [*rest, given]], bands=17)
    panels = [Panel(f"iteration {k}: {1e3 * float(rows[k]['hausdorff_true']):.1f} mm").field(one, "tension", 1e-3, scale, False, True)
              for k, one in zip(shown, rest)]
    panels.append(Panel("the tension that made the target").field(given, "tension", 1e-3, scale))
    draw(panels, 3, Camera((0.2, -3.0, 0.9), (0.5, 0.1, 0.1), zoom=2.2), path, scale)


def tensions(out, path):
    panels = [
        ("the tension that made the target", "known_given/start.vtu"),
        ("the tension found for it", "known/optimum.vtu"),
        ("found for the arc", "arc/optimum.vtu"),
        ("found for the end face (nodal)", "tip/optimum.vtu"),
    ]
    bodies = [(name, moved(out / file)[1]) for name, file in panels]
    scale = Scale.of("tension (kPa)", [1e-3 * array(body, "tension") for _, body in bodies], bands=17)
    draw([Panel(name).field(body, "tension", 1e-3, scale) for name, body in bodies], 2, BAR, path, scale)


T_CAMERA = Camera((2.4, -2.4, 1.3), (0.5, 0.0, 0.0), zoom=1.3)
PETAL = Camera((0.36, -0.47, 0.35), (0.0, 0.0, 0.0), zoom=1.2)


def at_rest(title, rest, length):
    return Panel(title).body(rest, GLASS, 0.35).add(arrows(rest, length), color=REMANENCE)


def t_magnet(out, path):
    here = out / "t_magnet"
    best, optimum = moved(here / "optimum.vtu")
    target = target_of(here)
    draw([
        Panel("start, outline of the target", 0.4).body(moved(here / "start.vtu")[1], START).outline(target),
        Panel("optimum, applied field", 0.4).body(optimum, BODY).outline(target).add(field_arrow(best, (0.8, 0.1, 0.0), 0.3), color=FIELD),
        at_rest("remanence, at rest", best, 0.08),
    ], 3, T_CAMERA, path)


def two_loads(out, path):
    here, panels = out / "t_two_loads", []
    for name, height, at in [("lifted", 0.4, (0.8, 0.1, 0.0)), ("lowered", -0.3, (0.45, 0.55, 0.1))]:
        best, optimum = moved(here / f"{name}_optimum.vtu")
        panel = Panel(f"{name}, applied field", height).body(optimum, BODY).outline(target_of(here, f"{name}_target.vtu"))
        panels.append(panel.add(field_arrow(best, at, 0.3), color=FIELD))
    draw([*panels, at_rest("the one remanence, at rest", best, 0.08)], 3, T_CAMERA, path)


def petal(out, path):
    here = out / "petal"
    best, optimum = moved(here / "optimum.vtu")
    target = target_of(here)
    field = field_arrow(best, (-0.1, 0.1, 0.03), 0.06)
    draw([
        Panel("start, outline of the target", 0.02).body(moved(here / "start.vtu")[1], START).outline(target),
        Panel("optimum, applied field", 0.04).body(optimum, BODY).outline(target).add(field, color=FIELD),
        at_rest("remanence, at rest", best, 0.016),
    ], 3, PETAL, path)


# Plots


def convergence(out, path):
    figure, (left, right) = axes(2, 3.5)
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
    left.legend(frameon=False)
    save_plot(figure, path)


def scenarios_of(out, name):
    return json.loads((out / name / "result.json").read_text())["scenarios"].values()


def nodes(out, path):
    scale = {"shear": (1e-6, "shear modulus (MPa)"), "bulk": (1e-6, "bulk modulus (MPa)"), "share": (1, "share U")}
    parameters = {name: f"materials/0/{name}" for name in scale}
    values = lambda runs, name: scale[name][0] * np.array([one["set"][parameters[name]] for one in runs])
    draws, rule = list(scenarios_of(out, "draws_robust")), list(scenarios_of(out, "robust"))
    figure, all_axes = axes(3, 3.4)
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
    figure.legend(handles, labels, frameon=False, loc="upper center", ncols=2, bbox_to_anchor=(0.5, 1.0))
    figure.tight_layout(rect=(0, 0, 1, 0.93))
    save(figure, path)


CONTROLS = [("deterministic", GREY, "stem/optimum.vtu"), ("robust", GREEN, "robust/scenario_000_optimum.vtu")]


def costs_and_pressures(out, path):
    figure, (left, right) = axes(2, 3.5, width_ratios=[1.5, 1])
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
    left.legend(frameon=False)
    right.legend(frameon=False)
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
    target = target_of(out / "stem").translate((0, -0.02, 0))  # in front of the body, along the view
    bodies = [(name, mean_shape(out / f"draws_{name}")) for name, _, _ in CONTROLS]
    scale = Scale.of("standard deviation of the position (mm)", [body["deviation"] for _, body in bodies])
    panels = [Panel(f"{name}: mean shape, deviation up to {body['deviation'].max():.1f} mm").field(body, "deviation", 1.0, scale, False, True)
              .outline(target) for name, body in bodies]
    draw(panels, 2, STEM, path, scale)
