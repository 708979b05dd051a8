// Finger: half (y >= 0) of a soft finger with one air chamber of five ribs, lengths in metres. A grid of boxes, those of the
// chamber left out, every box a few hexahedra of 20 nodes. Regions "soft" and "layer" (a stiff sheet below, z < 1.5 mm),
// together "body"; surfaces "clamp" (x = 0), "tip", "middle" (the plane of symmetry y = 0), "chamber" (its walls).
// gmsh finger.geo -3 -o finger.msh
SetFactory("OpenCASCADE");
mm = 1e-3;
ribs = 5;
base = 4 * mm;
period = 9 * mm;

// stations along x, and what lies before each: 0 solid, 1 wall of a rib, 2 inside of a rib, 3 gap between ribs
x[] = {0, base};
kind[] = {0};
cells[] = {2};
For k In {0:ribs-1}
  from = base + k * period;
  x[] += {from + 1.5 * mm, from + 5.5 * mm, from + 7 * mm};
  kind[] += {(k == 0) ? 0 : 1, 2, (k == ribs - 1) ? 0 : 1};
  cells[] += {1, 2, 1};
  If (k < ribs - 1)
    x[] += {from + 9 * mm};
    kind[] += {3};
    cells[] += {1};
  EndIf
EndFor
y[] = {0, 5 * mm, 7 * mm};
ycells[] = {2, 1};
z[] = {0, 1.5 * mm, 3 * mm, 6 * mm, 8 * mm, 13 * mm, 14.5 * mm};
zcells[] = {1, 1, 1, 1, 2, 1};

soft[] = {};
layer[] = {};
holes[] = {};
n = 0;
For i In {0:#kind[]-1}
  For j In {0:1}
    For k In {0:5}
      inside = (j == 0) && ((kind[i] == 2 && k >= 2 && k <= 4) || ((kind[i] == 1 || kind[i] == 3) && k == 2));
      above = kind[i] == 3 && k >= 4;
      If (inside)
        holes[] += {i, j, k};
      EndIf
      If (!inside && !above)
        n += 1;
        Box(n) = {x[i], y[j], z[k], x[i+1] - x[i], y[j+1] - y[j], z[k+1] - z[k]};
        If (k == 0)
          layer[] += {n};
        Else
          soft[] += {n};
        EndIf
      EndIf
    EndFor
  EndFor
EndFor
// boxes of one grid share whole faces, so nothing is renumbered
Coherence;

e = 1e-7;
chamber[] = {};
For h In {0:#holes[]/3-1}
  i = holes[3*h];
  j = holes[3*h+1];
  k = holes[3*h+2];
  chamber[] += Surface In BoundingBox{x[i]-e, y[j]-e, z[k]-e, x[i+1]+e, y[j+1]+e, z[k+1]+e};
EndFor
end = x[#x[]-1];
clamp[] = Surface In BoundingBox{-e, -e, -e, e, 1, 1};
tip[] = Surface In BoundingBox{end-e, -e, -e, end+e, 1, 1};
middle[] = Surface In BoundingBox{-e, -e, -e, 1, e, 1};

// cells along every edge, by its direction and place
For i In {0:#kind[]-1}
  edges[] = Curve In BoundingBox{x[i]-e, -e, -e, x[i+1]+e, 1, 1};
  For c In {0:#edges[]-1}
    box[] = BoundingBox Curve{edges[c]};
    If (box[3] - box[0] > 10 * e)
      Transfinite Curve{edges[c]} = cells[i] + 1;
    EndIf
  EndFor
EndFor
For j In {0:1}
  edges[] = Curve In BoundingBox{-e, y[j]-e, -e, 1, y[j+1]+e, 1};
  For c In {0:#edges[]-1}
    box[] = BoundingBox Curve{edges[c]};
    If (box[4] - box[1] > 10 * e)
      Transfinite Curve{edges[c]} = ycells[j] + 1;
    EndIf
  EndFor
EndFor
For k In {0:5}
  edges[] = Curve In BoundingBox{-e, -e, z[k]-e, 1, 1, z[k+1]+e};
  For c In {0:#edges[]-1}
    box[] = BoundingBox Curve{edges[c]};
    If (box[5] - box[2] > 10 * e)
      Transfinite Curve{edges[c]} = zcells[k] + 1;
    EndIf
  EndFor
EndFor
Transfinite Surface{:};
Recombine Surface{:};
Transfinite Volume{:};

Physical Volume("soft") = {soft[]};
Physical Volume("layer") = {layer[]};
Physical Volume("body") = {soft[], layer[]};
Physical Surface("clamp") = {clamp[]};
Physical Surface("tip") = {tip[]};
Physical Surface("middle") = {middle[]};
Physical Surface("chamber") = {chamber[]};

Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;
Mesh.MshFileVersion = 4.1;
