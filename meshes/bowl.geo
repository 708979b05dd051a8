// A bowl, in mm: the part below z = -6 of a spherical shell of inner radius 40 and a wall of 6.
// gmsh bowl.geo -3 -o bowl.msh
SetFactory("OpenCASCADE");
Mesh.MshFileVersion = 4.1;

Sphere(1) = {8, 18, 0, 46};
Sphere(2) = {8, 18, 0, 40};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {-42, -32, -50, 100, 100, 44};
BooleanIntersection(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };

Physical Volume("body") = {5};

Mesh.MeshSizeMin = 7;
Mesh.MeshSizeMax = 7;
