// The finger of first_finger.geo with two muscles along its upper side, one behind the other. Millimetres.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 80, 12, 9};
Box(2) = {0, 0, 9, 40, 12, 3};
Box(3) = {40, 0, 9, 40, 12, 3};
Coherence;

Physical Volume("silicone") = {1};
Physical Volume("inner") = {2};
Physical Volume("outer") = {3};
e = 0.01;
Physical Surface("base") = Surface In BoundingBox {-e, -e, -e, e, 12 + e, 12 + e};
Physical Surface("end") = Surface In BoundingBox {80 - e, -e, -e, 80 + e, 12 + e, 12 + e};

Mesh.MeshSizeMax = 6;
Mesh.ElementOrder = 2;
Mesh.MshFileVersion = 4.1;
