//! Files that other programs make of bodies, and how each becomes a mesh that is read here.

use std::path::Path;

/// What to do with a file of this name; of a format that is not known, which names are read.
pub(crate) fn advice(file: &Path) -> String {
    let name = file.display();
    let stem = file.with_extension("").display().to_string();
    match extension(file).as_str() {
        "mesh" | "bdf" | "nas" | "su2" => format!(
            "convert it by Python's meshio: `meshio convert {name} {stem}.vtu`; its numbers of groups become the names of regions and surfaces"
        ),
        "med" => format!("convert it by Gmsh, which keeps the names of groups: `gmsh {name} -save -o {stem}.msh`"),
        "e" | "exo" | "ex2" => format!(
            "convert it by Python's pyvista: `pyvista.read(\"{name}\").combine(merge_points=True).save(\"{stem}.vtu\")` (meshio 5.3.5 leaves the nodes of \
             second-order hexahedra in an order of its own)"
        ),
        "xdmf" | "xmf" | "fem" | "avs" => {
            format!(
                "convert it, for instance by Python's meshio: `meshio convert {name} {stem}.vtu`. That keeps nodes and cells, but not the \
             names of sets: where the case names regions or surfaces, save the mesh from Gmsh as .msh, with physical groups of those names"
            )
        }
        "unv" | "cgns" => {
            format!("convert it by Gmsh: `gmsh {name} -save -o {stem}.msh`; its groups become physical groups")
        }
        "stl" | "obj" | "ply" | "off" => format!(
            "this is a surface, and a body of cells is wanted: fill it by Gmsh, with a script {stem}.geo of the lines `Merge \"{name}\"; \
             CreateTopology; Surface Loop(1) = Surface{{:}}; Volume(1) = {{1}}; Physical Volume(\"body\") = {{1}}; \
             Physical Surface(\"skin\") = Surface{{:}};` (closed chambers stay empty) and \
             `gmsh -3 {stem}.geo -order 2 -o {stem}.msh`. Several solids (`gmsh {name}` counts them) want a loop and a volume each: of the others \
             nothing is meshed, without a word"
        ),
        "step" | "stp" | "iges" | "igs" | "brep" => format!(
            "this is a geometry: mesh it by Gmsh, with a script {stem}.geo of the lines `SetFactory(\"OpenCASCADE\"); Merge \"{name}\"; \
             Physical Volume(\"body\") = {{1}}; Physical Surface(\"clamp\") = {{2}};` (its numbers are shown by `gmsh {name}`) and \
             `gmsh -3 {stem}.geo -order 2 -o {stem}.msh`. The mesh is in millimetres, whatever the unit of the geometry: \"mesh\": \
             {{ \"file\": \"{stem}.msh\", \"scale\": 1e-3 }} in a case in metres"
        ),
        "geo" => format!("this is a script of Gmsh: mesh it by `gmsh -3 {name} -o {stem}.msh` (-2 for plane strain)"),
        _ => "the name must end in .msh (Gmsh 2.2 or 4.1), .inp (Abaqus, CalculiX), .vtu (VTK XML unstructured grid) or .vtk (legacy VTK)"
            .to_owned(),
    }
}

/// The ending of a file's name, in lower case.
pub(crate) fn extension(file: &Path) -> String {
    file.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}
