// A ring, outside 50 mm, inside 40 mm: gmsh ring.geo -2 -o mesh/ring.inp
SetFactory("OpenCASCADE");
outside = 50;
inside = 40;
Disk(1) = {0, 0, 0, outside};
Disk(2) = {0, 0, 0, inside};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };

Point(10) = {0, outside, 0};
Point(11) = {0, -outside, 0};
BooleanFragments{ Surface{3}; Delete; }{ Point{10, 11}; Delete; }

// what the deck names: the body, the curve that may touch, two points whose motion is recorded
e = 0.1;
Physical Surface("ring") = Surface{:};
rim() = Curve In BoundingBox {-outside - e, -outside - e, -e, outside + e, outside + e, e};
bore() = Curve In BoundingBox {-inside - e, -inside - e, -e, inside + e, inside + e, e};
rim() -= bore();
Physical Curve("rim") = rim();
Physical Point("top") = Point In BoundingBox {-e, outside - e, -e, e, outside + e, e};
Physical Point("foot") = Point In BoundingBox {-e, -outside - e, -e, e, -outside + e, e};

Mesh.MeshSizeMin = 5;
Mesh.MeshSizeMax = 5;
Mesh.ElementOrder = 2;              // 6-node triangles, curved along the arcs
Mesh.SecondOrderIncomplete = 1;     // quadrilaterals, if any, have 8 nodes instead of 9
Mesh.SaveGroupsOfNodes = 1;         // groups become sets of nodes (NSET), too
