// A bracket in millimeters: a plate with a hole, and a boss beside it. Every face is in a named group.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 80, 40, 10};
Cylinder(2) = {60, 20, 10, 0, 0, 20, 12};
Cylinder(3) = {25, 20, -1, 0, 0, 12, 9};
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
BooleanDifference(5) = { Volume{4}; Delete; }{ Volume{3}; Delete; };
hole() = Surface In BoundingBox {15, 10, -0.1, 35, 30, 10.1};
boss() = Surface In BoundingBox {47, 7, 9.9, 73, 33, 29.9};
all() = Boundary{ Volume{5}; };
side() = {};
For i In {0 : #all() - 1}
  b() = BoundingBox Surface{all(i)};
  isHole = (b(0) > 15.5 && b(3) < 34.5);
  isBoss = (b(0) > 47.5 && b(3) < 72.5 && b(2) > 9.9 && b(2) < 10.1 && b(5) > 29);
  If (isHole)
    theHole = all(i);
  ElseIf (isBoss)
    theBoss = all(i);
  Else
    side() += all(i);
  EndIf
EndFor
Physical Surface("hole") = {theHole};
Physical Surface("boss") = {theBoss};
Physical Surface("flat") = {side()};
Physical Volume("steel") = {5};
Mesh.MeshSizeMax = 7;
Mesh.MeshSizeFromCurvature = 14;
