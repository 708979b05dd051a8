// Stem: a rod [0, 0.1] m of radius 5 mm along x, 5 x 10 hexahedra of 20 nodes: a square in the middle of the section and
// four sectors around it. The lower sector (z < 0) is the region "flank", the rest "core". Clamped at x = 0; "track" is
// the right half of the upper sector's skin.
// gmsh stem.geo -3 -o stem.msh
length = 0.1;
radius = 0.005;
inner = 0.55 * radius;
layers = 5; // in each half of the length

c = Sqrt(0.5);
Point(9) = {0, 0, 0};
For k In {0:3}
  // 45, 135, 225, 315 degrees from y towards z
  sy = (k == 0 || k == 3) ? 1 : -1;
  sz = (k < 2) ? 1 : -1;
  Point(1 + k) = {0, sy * c * radius, sz * c * radius};
  Point(5 + k) = {0, sy * c * inner, sz * c * inner};
  Line(11 + k) = {5 + k, 1 + k};
EndFor
For k In {0:3}
  next = (k + 1) % 4;
  Circle(21 + k) = {1 + k, 9, 1 + next};
  Line(31 + k) = {5 + k, 5 + next};
EndFor
// sectors: top, left, bottom, right; the first curve of each is the skin
For k In {0:3}
  next = (k + 1) % 4;
  Curve Loop(41 + k) = {21 + k, -(11 + next), -(31 + k), 11 + k};
  Plane Surface(41 + k) = {41 + k};
EndFor
Curve Loop(45) = {31, 32, 33, 34};
Plane Surface(45) = {45};
Transfinite Curve {11:14, 21:24, 31:34} = 2;
Transfinite Surface {41:45};
Recombine Surface {41:45};

skin[] = {};
track[] = {};
flank[] = {};
core[] = {};
tip[] = {};
For k In {0:4}
  near[] = Extrude {length / 2, 0, 0} { Surface{41 + k}; Layers{layers}; Recombine; };
  far[] = Extrude {length / 2, 0, 0} { Surface{near[0]}; Layers{layers}; Recombine; };
  tip[] += {far[0]};
  If (k == 2)
    flank[] += {near[1], far[1]};
  Else
    core[] += {near[1], far[1]};
  EndIf
  If (k == 0)
    track[] += {far[2]};
  EndIf
  If (k < 4)
    skin[] += {near[2], far[2]};
  EndIf
EndFor

Physical Volume("flank") = {flank[]};
Physical Volume("core") = {core[]};
Physical Volume("body") = {flank[], core[]};
Physical Surface("clamp") = {41:45};
Physical Surface("tip") = {tip[]};
Physical Surface("track") = {track[]};
Physical Surface("skin") = {skin[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;
Mesh.MshFileVersion = 4.1;
