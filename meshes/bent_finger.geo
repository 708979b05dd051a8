// A target for the finger of first_finger.geo: its outer half bent upwards to an arc. Millimetres.
SetFactory("OpenCASCADE");
straight = 40;
arc = 38;                          // along the middle of the section
angle = 0.8;
radius = arc / angle;
Box(1) = {0, 0, 0, straight, 12, 12};
end() = Surface In BoundingBox {straight - 0.01, -1, -1, straight + 0.01, 13, 13};
bent() = Extrude {{0, -1, 0}, {straight, 0, 6 + radius}, angle} { Surface{end(0)}; };
Coherence;
Physical Volume("body") = Volume{:};
Mesh.MeshSizeMax = 6;
Mesh.ElementOrder = 2;
Mesh.MshFileVersion = 4.1;
