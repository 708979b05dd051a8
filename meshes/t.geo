// T: stem [0,0.8] x [-0.1,0.1] m, bar [0.8,1.0] x [-0.5,0.5] m, thickness 0.05 m in z; hexahedra of 27 nodes,
// one through the thickness. Clamped at x = 0.
// gmsh t.geo -3 -o t.msh
stem = 0.8;
width = 0.2;
bar = 1.0;
thickness = 0.05;
size = 0.05;

Point(1) = {0, -width / 2, 0};
Point(2) = {stem, -width / 2, 0};
Point(3) = {stem, width / 2, 0};
Point(4) = {0, width / 2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = Round(stem / size) + 1;
Transfinite Curve {2, 4} = Round(width / size) + 1;
Transfinite Surface {1};
Recombine Surface {1};

// The middle of the bar goes on from the stem, its arms go on from the middle.
middle[] = Extrude {width, 0, 0} { Curve{2}; Layers{Round(width / size)}; Recombine; };
right[] = Extrude {0, -(bar - width) / 2, 0} { Curve{middle[3]}; Layers{Round((bar - width) / 2 / size)}; Recombine; };
left[] = Extrude {0, (bar - width) / 2, 0} { Curve{middle[2]}; Layers{Round((bar - width) / 2 / size)}; Recombine; };
body[] = Extrude {0, 0, thickness} { Surface{1, middle[1], right[1], left[1]}; Layers{1}; Recombine; };

eps = 1e-6;
Physical Volume("body") = Volume{:};
clamp[] = Surface In BoundingBox {-eps, -width, -eps, eps, width, thickness + eps};
right_end[] = Surface In BoundingBox {stem - eps, -bar / 2 - eps, -eps, stem + width + eps, -bar / 2 + eps, thickness + eps};
left_end[] = Surface In BoundingBox {stem - eps, bar / 2 - eps, -eps, stem + width + eps, bar / 2 + eps, thickness + eps};
top[] = Surface In BoundingBox {-eps, -bar, thickness - eps, 2, bar, thickness + eps};
bottom[] = Surface In BoundingBox {-eps, -bar, -eps, 2, bar, eps};
Physical Surface("clamp") = {clamp[]};
Physical Surface("right") = {right_end[]};
Physical Surface("left") = {left_end[]};
Physical Surface("top") = {top[]};
Physical Surface("bottom") = {bottom[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
