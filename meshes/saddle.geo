// Saddle, the target of disc.msh, in millimetres: what a cylinder of radius 20 about the z axis cuts from a shell of thickness 2 about the inner side of a
// torus whose axis is x: its middle surface passes through (0, 0, 1) with curvatures 1/100 along x, upwards, and 1/100 along y, downwards.
// gmsh saddle.geo -3 -o saddle.msh
SetFactory("OpenCASCADE");
bend = 100;
thickness = 2;
middle = thickness / 2;
Torus(1) = {0, 0, 0, 2 * bend, bend + thickness / 2};
Torus(2) = {0, 0, 0, 2 * bend, bend - thickness / 2};
shell() = BooleanDifference { Volume{1}; Delete; }{ Volume{2}; Delete; };
Rotate {{0, 1, 0}, {0, 0, 0}, Pi / 2} { Volume{shell()}; }
Translate {0, 0, middle - bend} { Volume{shell()}; }
Cylinder(10) = {0, 0, -8, 0, 0, 16, 20};
BooleanIntersection { Volume{shell()}; Delete; }{ Volume{10}; Delete; }
Physical Volume("body") = Volume{:};
Mesh.MeshSizeMax = 2.5;
Mesh.ElementOrder = 1;
Mesh.MshFileVersion = 4.1;
