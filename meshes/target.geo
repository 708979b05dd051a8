// Target of the cantilever: a bar of its length and section whose axis is an arc of a circle in the x-z plane,
// tangent to x at the clamp. The end of the axis is raised by (1 - cos(angle)) / angle = 0.300 of the length.
// gmsh target.geo -3 -o target.msh
length = 1.0;
side = 0.2;
angle = 0.62;
radius = length / angle;
size = 0.085;

Point(1) = {0, 0, 0, size};
Point(2) = {0, side, 0, size};
Point(3) = {0, side, side, size};
Point(4) = {0, 0, side, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
bar[] = Extrude { {0, 1, 0}, {0, 0, side / 2 + radius}, -angle } { Surface{1}; };

Physical Volume("body") = {bar[1]};
Physical Surface("clamp") = {1};
Physical Surface("tip") = {bar[0]};
Physical Surface("skin") = {bar[2], bar[3], bar[4], bar[5]};

Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 0;
Mesh.OptimizeNetgen = 1;
Mesh.RandomSeed = 1;
Mesh.MshFileVersion = 4.1;
