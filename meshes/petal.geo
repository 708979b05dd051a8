// Petal: four arms 0.13 x 0.06 m about a square of 0.06 m that is held, thickness 1 mm in z; hexahedra of 27 nodes,
// one through the thickness.
// gmsh petal.geo -3 -o petal.msh
arm = 0.13;
width = 0.06;
thickness = 1e-3;
across = 6;
along = 13;

Point(1) = {-width / 2, -width / 2, 0};
Point(2) = {width / 2, -width / 2, 0};
Point(3) = {width / 2, width / 2, 0};
Point(4) = {-width / 2, width / 2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = across + 1;
Transfinite Surface {1};
Recombine Surface {1};

south[] = Extrude {0, -arm, 0} { Curve{1}; Layers{along}; Recombine; };
east[] = Extrude {arm, 0, 0} { Curve{2}; Layers{along}; Recombine; };
north[] = Extrude {0, arm, 0} { Curve{3}; Layers{along}; Recombine; };
west[] = Extrude {-arm, 0, 0} { Curve{4}; Layers{along}; Recombine; };
body[] = Extrude {0, 0, thickness} { Surface{1, south[1], east[1], north[1], west[1]}; Layers{1}; Recombine; };

eps = 1e-6;
far = width / 2 + arm;
Physical Volume("body") = Volume{:};
square[] = Surface In BoundingBox {-width / 2 - eps, -width / 2 - eps, -eps, width / 2 + eps, width / 2 + eps, eps};
lid[] = Surface In BoundingBox {-width / 2 - eps, -width / 2 - eps, thickness - eps, width / 2 + eps, width / 2 + eps, thickness + eps};
all_top[] = Surface In BoundingBox {-far - eps, -far - eps, thickness - eps, far + eps, far + eps, thickness + eps};
all_bottom[] = Surface In BoundingBox {-far - eps, -far - eps, -eps, far + eps, far + eps, eps};
east_end[] = Surface In BoundingBox {far - eps, -width, -eps, far + eps, width, thickness + eps};
west_end[] = Surface In BoundingBox {-far - eps, -width, -eps, -far + eps, width, thickness + eps};
north_end[] = Surface In BoundingBox {-width, far - eps, -eps, width, far + eps, thickness + eps};
south_end[] = Surface In BoundingBox {-width, -far - eps, -eps, width, -far + eps, thickness + eps};
Physical Surface("square") = {square[], lid[]};
Physical Surface("top") = {all_top[]};
Physical Surface("bottom") = {all_bottom[]};
Physical Surface("east") = {east_end[]};
Physical Surface("west") = {west_end[]};
Physical Surface("north") = {north_end[]};
Physical Surface("south") = {south_end[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 0;
Mesh.MshFileVersion = 4.1;
