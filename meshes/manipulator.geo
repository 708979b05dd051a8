// Manipulator: a soft rod of 40 mm along z with three closed chambers, a third of a turn apart, lengths in metres. Region "body";
// surfaces "clamp" (z = 0), "tip" (z = 40 mm), "one", "two", "three" (the walls of the chambers; the first lies on the x axis).
// gmsh manipulator.geo -3 -o manipulator.msh
SetFactory("OpenCASCADE");
mm = 1e-3;
length = 40 * mm;
radius = 9 * mm;
wall = 4 * mm;
offset = 5.2 * mm;
bore = 2.2 * mm;

Cylinder(1) = {0, 0, 0, 0, 0, length, radius};
For k In {0:2}
  Cylinder(2 + k) = {offset * Cos(2 * Pi * k / 3), offset * Sin(2 * Pi * k / 3), wall, 0, 0, length - 2 * wall, bore};
EndFor
BooleanDifference(5) = { Volume{1}; Delete; }{ Volume{2:4}; Delete; };

e = 1e-6;
For k In {0:2}
  x = offset * Cos(2 * Pi * k / 3);
  y = offset * Sin(2 * Pi * k / 3);
  chamber~{k}[] = Surface In BoundingBox{x-bore-e, y-bore-e, wall-e, x+bore+e, y+bore+e, length-wall+e};
EndFor
clamp[] = Surface In BoundingBox{-1, -1, -e, 1, 1, e};
tip[] = Surface In BoundingBox{-1, -1, length-e, 1, 1, length+e};

Physical Volume("body") = {5};
Physical Surface("clamp") = clamp[];
Physical Surface("tip") = tip[];
Physical Surface("one") = chamber_0[];
Physical Surface("two") = chamber_1[];
Physical Surface("three") = chamber_2[];

Mesh.MeshSizeMin = 2.6 * mm;
Mesh.MeshSizeMax = 4.5 * mm;
Mesh.MeshSizeFromCurvature = 8;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.MshFileVersion = 4.1;
