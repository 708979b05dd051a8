// A strip of two layers, 32 x 8 x 0.6 mm: below four pairs of electrodes side by side, above a passive back. Millimetres;
// hexahedra of 27 nodes. Clamped at x = 0.
// gmsh bilayer.geo -3 -o bilayer.msh
length = 32;
width = 8;
layer = 0.3;
pairs = 4;

Point(1) = {0, 0, 0};
start[] = Extrude {0, width, 0} { Point{1}; Layers{4}; };
line = start[1];
For k In {1:pairs}
    next[] = Extrude {length / pairs, 0, 0} { Curve{line}; Layers{4}; Recombine; };
    line = next[0];
    face~{k} = next[1];
EndFor
For k In {1:pairs}
    below[] = Extrude {0, 0, layer} { Surface{face~{k}}; Layers{1}; Recombine; };
    above[] = Extrude {0, 0, layer} { Surface{below[0]}; Layers{1}; Recombine; };
    Physical Volume(Sprintf("pair%g", k), k) = {below[1]};
    back[] += above[1];
EndFor

eps = 1e-6;
Physical Volume("back", 10) = {back[]};
clamp[] = Surface In BoundingBox {-eps, -eps, -eps, eps, width + eps, 2 * layer + eps};
end[] = Surface In BoundingBox {length - eps, -eps, -eps, length + eps, width + eps, 2 * layer + eps};
top[] = Surface In BoundingBox {-eps, -eps, 2 * layer - eps, length + eps, width + eps, 2 * layer + eps};
bottom[] = Surface In BoundingBox {-eps, -eps, -eps, length + eps, width + eps, eps};
Physical Surface("clamp", 1) = {clamp[]};
Physical Surface("end", 2) = {end[]};
Physical Surface("top", 3) = {top[]};
Physical Surface("bottom", 4) = {bottom[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
