// A ball below two fingers with air chambers, plane strain, in mm: three bodies that share no node.
// gmsh carry.geo -2 -o carry.msh
SetFactory("OpenCASCADE");
Mesh.MshFileVersion = 4.1;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 0;

// fingers 10 wide and 60 long, closed at their tips, seven chambers in the outer half of each
Rectangle(1) = {-20, 0, 0, 10, 60};
Rectangle(2) = {10, 0, 0, 10, 60};
For i In {0:6}
  Rectangle(100 + i) = {-18, 4 + 7.5 * i, 0, 4, 5.5};
  Rectangle(200 + i) = {14, 4 + 7.5 * i, 0, 4, 5.5};
EndFor
BooleanDifference(10) = { Surface{1}; Delete; }{ Surface{100:106}; Delete; };
BooleanDifference(20) = { Surface{2}; Delete; }{ Surface{200:206}; Delete; };
Disk(30) = {0, 8, 0, 8.5};

eps = 1e-3;
left() = Curve In BoundingBox {-10 - eps, -eps, -eps, -10 + eps, 60 + eps, eps};
right() = Curve In BoundingBox {10 - eps, -eps, -eps, 10 + eps, 60 + eps, eps};
air_left() = Curve In BoundingBox {-18 - eps, 4 - eps, -eps, -14 + eps, 55 + eps, eps};
air_right() = Curve In BoundingBox {14 - eps, 4 - eps, -eps, 18 + eps, 55 + eps, eps};
root() = Curve In BoundingBox {-20 - eps, 60 - eps, -eps, 20 + eps, 60 + eps, eps};

Physical Surface("fingers") = {10, 20};
Physical Surface("ball") = {30};
Physical Curve("left") = left();
Physical Curve("right") = right();
Physical Curve("air_left") = air_left();
Physical Curve("air_right") = air_right();
Physical Curve("root") = root();
Physical Curve("rim") = Boundary{ Surface{30}; };

Mesh.MeshSizeMin = 1.4;
Mesh.MeshSizeMax = 3;
MeshSize{ PointsOf{ Surface{10, 20}; } } = 3;
MeshSize{ PointsOf{ Surface{30}; } } = 1.4;
