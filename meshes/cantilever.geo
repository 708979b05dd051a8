// Cantilever [0,1] x [0,0.2] x [0,0.2] m, 10 x 2 x 2 hexahedra of 27 nodes: 525 nodes.
// gmsh cantilever.geo -3 -o cantilever.msh
length = 1.0;
side = 0.2;
along = 10;
across = 2;

Point(1) = {0, 0, 0};
Point(2) = {0, side, 0};
Point(3) = {0, side, side};
Point(4) = {0, 0, side};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = across + 1;
Transfinite Surface {1};
Recombine Surface {1};
bar[] = Extrude {length, 0, 0} { Surface{1}; Layers{along}; Recombine; };

Physical Volume("body") = {bar[1]};
Physical Surface("clamp") = {1};
Physical Surface("tip") = {bar[0]};
Physical Surface("skin") = {bar[2], bar[3], bar[4], bar[5]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
