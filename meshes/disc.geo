// Disc of radius 20 and thickness 2, in millimetres, its lower side in z = 0: a square of 4 x 4 cells within a ring of 3, hexahedra of 27 nodes, one
// through the thickness. Node sets: centre, above (over it), east (the middle of the square's right side).
// gmsh disc.geo -3 -o disc.msh
radius = 20;
half = 8;
thickness = 2;
core = 4;
ring = 3;

Point(5) = {0, 0, 0};
For q In {0:3}
  angle = Pi / 4 + q * Pi / 2;
  Point(10 + q) = {Sqrt(2) * half * Cos(angle), Sqrt(2) * half * Sin(angle), 0};
  Point(20 + q) = {radius * Cos(angle), radius * Sin(angle), 0};
  Line(30 + q) = {10 + q, 20 + q};
EndFor
// the square in four, so that its middle is a node with a name
Point(40) = {half, 0, 0};
Point(41) = {0, half, 0};
Point(42) = {-half, 0, 0};
Point(43) = {0, -half, 0};
For q In {0:3}
  Point(50 + q) = {radius * Cos(q * Pi / 2), radius * Sin(q * Pi / 2), 0};
EndFor
For q In {0:3}
  Line(60 + q) = {5, 40 + q};
  Line(70 + q) = {40 + q, 50 + q};
  Line(80 + q) = {40 + q, 10 + q};
  Line(90 + q) = {10 + q, 40 + (q + 1) % 4};
  Circle(100 + q) = {50 + q, 5, 20 + q};
  Circle(110 + q) = {20 + q, 5, 50 + (q + 1) % 4};
EndFor
For q In {0:3}
  next = (q + 1) % 4;
  Curve Loop(q + 1) = {60 + q, 80 + q, 90 + q, -(60 + next)};
  Plane Surface(q + 1) = {q + 1};
  Curve Loop(q + 5) = {70 + q, 100 + q, -(30 + q), -(80 + q)};
  Plane Surface(q + 5) = {q + 5};
  Curve Loop(q + 9) = {30 + q, 110 + q, -(70 + next), -(90 + q)};
  Plane Surface(q + 9) = {q + 9};
EndFor
Transfinite Curve {60:63, 80:83, 90:93, 100:103, 110:113} = core / 2 + 1;
Transfinite Curve {30:33, 70:73} = ring + 1;
Transfinite Surface {:};
Recombine Surface {:};
Extrude {0, 0, thickness} { Surface{1:12}; Layers{1}; Recombine; }

eps = 1e-6;
Physical Volume("body") = Volume{:};
Physical Surface("bottom") = Surface In BoundingBox {-radius - eps, -radius - eps, -eps, radius + eps, radius + eps, eps};
Physical Surface("top") = Surface In BoundingBox {-radius - eps, -radius - eps, thickness - eps, radius + eps, radius + eps, thickness + eps};
Physical Point("centre") = {5};
Physical Point("above") = Point In BoundingBox {-eps, -eps, thickness - eps, eps, eps, thickness + eps};
Physical Point("east") = {40};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
