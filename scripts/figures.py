"""Pictures of docs/images from results: python scripts/figures.py (pyvista; run the examples t_magnet and petal first)."""

import numpy as np
import pyvista as pv

pv.OFF_SCREEN = True


def moved(path):
    mesh = pv.read(path)
    return mesh, mesh.warp_by_vector("displacement")


def surface(mesh):
    return mesh.extract_surface(nonlinear_subdivision=2)


def arrows(rest, shown, length):
    """Remanence at the cells' centres, drawn where the cells are."""
    centres = pv.PolyData(shown.cell_centers().points)
    centres["B_r"] = rest.cell_data["B_r"]
    centres["size"] = np.linalg.norm(rest.cell_data["B_r"], axis=1)
    return centres.glyph(orient="B_r", scale=False, factor=length, geom=pv.Arrow(tip_radius=0.16, shaft_radius=0.06))


def panel(plotter, column, title, bodies, glyphs, camera):
    plotter.subplot(0, column)
    for mesh, colour, opacity in bodies:
        if opacity > 0:
            plotter.add_mesh(surface(mesh), color=colour, opacity=opacity)
        else:
            plotter.add_mesh(surface(mesh).extract_feature_edges(40), color=colour, line_width=3)
    if glyphs is not None:
        plotter.add_mesh(glyphs, color="firebrick")
    plotter.add_text(title, font_size=11, color="black")
    plotter.camera_position = camera


def figure(path, panels, camera, zoom):
    plotter = pv.Plotter(shape=(1, len(panels)), window_size=(520 * len(panels), 420), border=False)
    plotter.set_background("white")
    for column, (title, bodies, glyphs) in enumerate(panels):
        panel(plotter, column, title, bodies, glyphs, camera)
        plotter.camera.zoom(zoom)
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    from PIL import Image

    Image.fromarray(image).quantize(96).save(path, optimize=True)


def t_magnet():
    rest, start = moved("out/t_magnet/start.vtu")
    best, optimum = moved("out/t_magnet/optimum.vtu")
    _, target = moved("out/t_magnet/target_lifted.vtu")
    wish = (target, "darkorange", 0)
    one = [
        ("start", [(start, "lightsteelblue", 1.0), wish], None),
        ("optimum", [(optimum, "steelblue", 1.0), wish], None),
        ("magnetisation", [(best, "lightgrey", 0.4)], arrows(best, best, 0.08)),
    ]
    camera = [(2.3, -2.3, 1.7), (0.5, 0.0, 0.38), (0, 0, 1)]
    figure("docs/images/t_magnet.png", one, camera, 1.1)
    two = []
    for name in ["lifted", "lowered"]:
        _, shape = moved(f"out/t_magnet/two_{name}.vtu")
        _, target = moved(f"out/t_magnet/target_{name}.vtu")
        two.append((name, [(shape, "steelblue", 1.0), (target, "darkorange", 0)], None))
    both, _ = moved("out/t_magnet/two_lifted.vtu")
    two.append(("the one magnetisation", [(both, "lightgrey", 0.4)], arrows(both, both, 0.08)))
    figure("docs/images/t_two_targets.png", two, [(2.8, -2.8, 1.2), (0.5, 0.0, 0.05), (0, 0, 1)], 1.0)


def petal():
    _, start = moved("out/petal/start.vtu")
    best, optimum = moved("out/petal/optimum.vtu")
    panels = [
        ("start", [(start, "thistle", 1.0)], None),
        ("after thirty iterations", [(optimum, "orchid", 1.0)], None),
        ("magnetisation", [(best, "lightgrey", 0.4)], arrows(best, best, 0.016)),
    ]
    figure("docs/images/petal.png", panels, [(0.36, -0.47, 0.38), (0.0, 0.0, 0.03), (0, 0, 1)], 1.15)


if __name__ == "__main__":
    t_magnet()
    petal()
