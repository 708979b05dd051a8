// Plane strip [0,1] x [0,0.1] m, 20 x 2 quadrangles of 9 nodes.
// gmsh strip_quad9.geo -2 -o strip_quad9.msh
length = 1.0;
height = 0.1;

Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Point(3) = {length, height, 0};
Point(4) = {0, height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 21;
Transfinite Curve {2, 4} = 3;
Transfinite Surface {1};
Recombine Surface {1};

Physical Surface("body") = {1};
Physical Curve("clamp") = {4};
Physical Curve("tip") = {2};
Physical Curve("skin") = {1, 3};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
