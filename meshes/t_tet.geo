// The T of t.geo, unstructured tetrahedra of 10 nodes: another mesh of the same body.
// gmsh t_tet.geo -3 -o t_tet.msh
stem = 0.8;
width = 0.2;
bar = 1.0;
thickness = 0.05;
size = 0.06;

Point(1) = {0, -width / 2, 0, size};
Point(2) = {stem, -width / 2, 0, size};
Point(3) = {stem, -bar / 2, 0, size};
Point(4) = {stem + width, -bar / 2, 0, size};
Point(5) = {stem + width, bar / 2, 0, size};
Point(6) = {stem, bar / 2, 0, size};
Point(7) = {stem, width / 2, 0, size};
Point(8) = {0, width / 2, 0, size};
For i In {1:8}
  Line(i) = {i, i % 8 + 1};
EndFor
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};
body[] = Extrude {0, 0, thickness} { Surface{1}; };

// The sides come in the order of the curves.
Physical Volume("body") = {body[1]};
Physical Surface("clamp") = {body[9]};
Physical Surface("right") = {body[4]};
Physical Surface("left") = {body[6]};
Physical Surface("top") = {body[0]};
Physical Surface("bottom") = {1};

Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
Mesh.ElementOrder = 2;
Mesh.OptimizeNetgen = 1;
Mesh.RandomSeed = 1;
Mesh.MshFileVersion = 4.1;
