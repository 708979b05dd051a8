// A finger of silicone, 80 mm long, with a muscle along its upper side. Millimetres.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 80, 12, 9};
Box(2) = {0, 0, 9, 80, 12, 3};
Coherence;                        // the two share the face between them

Physical Volume("silicone") = {1};
Physical Volume("muscle") = {2};
e = 0.01;
Physical Surface("base") = Surface In BoundingBox {-e, -e, -e, e, 12 + e, 12 + e};
Physical Surface("end") = Surface In BoundingBox {80 - e, -e, -e, 80 + e, 12 + e, 12 + e};
Physical Curve("tip") = Curve In BoundingBox {80 - e, -e, -e, 80 + e, 12 + e, e};

Mesh.MeshSizeMax = 6;
Mesh.ElementOrder = 2;            // cells with nodes in the middle of their edges
