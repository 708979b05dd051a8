// Plane strip [0,1] x [0,0.1] m, unstructured triangles of 6 nodes.
// gmsh strip_tri6.geo -2 -o strip_tri6.msh
length = 1.0;
height = 0.1;
size = 0.045;

Point(1) = {0, 0, 0, size};
Point(2) = {length, 0, 0, size};
Point(3) = {length, height, 0, size};
Point(4) = {0, height, 0, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Physical Surface("body") = {1};
Physical Curve("clamp") = {4};
Physical Curve("tip") = {2};
Physical Curve("skin") = {1, 3};

Mesh.ElementOrder = 2;
Mesh.RandomSeed = 1;
Mesh.MshFileVersion = 4.1;
