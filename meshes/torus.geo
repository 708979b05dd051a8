// A soft torus of the size of Drake's deformable example (major radius 59.4, tube 28.4), its axis upright, its middle at z = 0, in mm.
// gmsh torus.geo -3 -o torus.msh
SetFactory("OpenCASCADE");
Mesh.MshFileVersion = 4.1;
Torus(1) = {0, 0, 0, 59.4, 28.4};
Physical Volume("body") = {1};
Mesh.MeshSizeMin = 22;
Mesh.MeshSizeMax = 22;
