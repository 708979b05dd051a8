// A berry on its stalk between two fingers with air chambers, plane strain, in mm: three bodies that share no node.
// gmsh berry.geo -2 -o berry.msh
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

// the berry stands a millimetre nearer to the right finger
Disk(5) = {0.5, 14, 0, 8.5};
Rectangle(6) = {-0.75, -16, 0, 2.5, 24};
BooleanUnion(30) = { Surface{5}; Delete; }{ Surface{6}; Delete; };

eps = 1e-3;
left() = Curve In BoundingBox {-10 - eps, -eps, -eps, -10 + eps, 60 + eps, eps};
right() = Curve In BoundingBox {10 - eps, -eps, -eps, 10 + eps, 60 + eps, eps};
air_left() = Curve In BoundingBox {-18 - eps, 4 - eps, -eps, -14 + eps, 55 + eps, eps};
air_right() = Curve In BoundingBox {14 - eps, 4 - eps, -eps, 18 + eps, 55 + eps, eps};
root() = Curve In BoundingBox {-20 - eps, 60 - eps, -eps, 20 + eps, 60 + eps, eps};
stalk() = Curve In BoundingBox {-1, -16 - eps, -eps, 2, -16 + eps, eps};
all() = Boundary{ Surface{30}; };
rim() = {};
For i In {0 : #all() - 1}
  box() = BoundingBox Curve { Abs(all(i)) };
  If (box(4) > 9)
    rim() += Abs(all(i));
  EndIf
EndFor

Physical Surface("fingers") = {10, 20};
Physical Surface("berry") = {30};
Physical Curve("left") = left();
Physical Curve("right") = right();
Physical Curve("air_left") = air_left();
Physical Curve("air_right") = air_right();
Physical Curve("root") = root();
Physical Curve("stalk") = stalk();
Physical Curve("rim") = rim();

Mesh.MeshSizeMin = 1.6;
Mesh.MeshSizeMax = 1.6;
Mesh.MeshSizeExtendFromBoundary = 0;
