// Shallow arch of span 1 m, thickness 0.02 m and rise 0.04 m, its mid-line y = 0.01 + 0.02 (1 - cos 2 pi x): 24 x 1 quadrangles of 9 nodes.
// gmsh arch.geo -2 -o arch.msh
thickness = 0.02;
rise = 0.04;
cells = 24;

For i In {0:48}
  x = i / 48;
  y = 0.5 * rise * (1 - Cos(2 * Pi * x));
  Point(100 + i) = {x, y, 0};
  Point(200 + i) = {x, y + thickness, 0};
EndFor
Spline(1) = {100:148};
Spline(2) = {200:248};
Line(3) = {100, 200};
Line(4) = {148, 248};
Curve Loop(1) = {1, 4, -2, -3};
Plane Surface(1) = {1};
Transfinite Curve {1, 2} = cells + 1;
Transfinite Curve {3, 4} = 2;
Transfinite Surface {1};
Recombine Surface {1};

Physical Surface("body") = {1};
Physical Curve("left") = {3};
Physical Curve("right") = {4};
Physical Curve("skin") = {1, 2};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
