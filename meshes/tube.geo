// Tube [0, 60] x of inner radius 6 and outer radius 8 mm along x, in millimetres: 16 hexahedra of 20 nodes around, 12 along. Clamped at x = 0; "bore" is
// the inner wall, open at both ends; "end" the ring at x = 60, "cap" its last 5 mm.
// gmsh tube.geo -3 -o tube.msh
length = 60;
cap = 5;
inner = 6;
outer = 8;

Point(9) = {0, 0, 0};
For k In {0:3}
  Point(1 + k) = {0, outer * Cos(k * Pi / 2), outer * Sin(k * Pi / 2)};
  Point(5 + k) = {0, inner * Cos(k * Pi / 2), inner * Sin(k * Pi / 2)};
  Line(11 + k) = {5 + k, 1 + k};
EndFor
For k In {0:3}
  next = (k + 1) % 4;
  Circle(21 + k) = {1 + k, 9, 1 + next};
  Circle(31 + k) = {5 + k, 9, 5 + next};
EndFor
For k In {0:3}
  next = (k + 1) % 4;
  Curve Loop(41 + k) = {21 + k, -(11 + next), -(31 + k), 11 + k};
  Plane Surface(41 + k) = {41 + k};
EndFor
Transfinite Curve {11:14} = 2;
Transfinite Curve {21:24, 31:34} = 5;
Transfinite Surface {41:44};
Recombine Surface {41:44};

bore[] = {};
wall[] = {};
ring[] = {};
end[] = {};
For k In {0:3}
  near[] = Extrude {length - cap, 0, 0} { Surface{41 + k}; Layers{11}; Recombine; };
  far[] = Extrude {cap, 0, 0} { Surface{near[0]}; Layers{1}; Recombine; };
  end[] += {far[0]};
  wall[] += {near[1]};
  ring[] += {far[1]};
  // curves of a sector: outer, next side, inner, own side
  bore[] += {near[4], far[4]};
EndFor

Physical Volume("wall") = {wall[]};
Physical Volume("cap") = {ring[]};
Physical Surface("clamp") = {41:44};
Physical Surface("end") = {end[]};
Physical Surface("bore") = {bore[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;
Mesh.MshFileVersion = 4.1;
