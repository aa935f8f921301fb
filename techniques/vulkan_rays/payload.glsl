// What goes with a ray: the triangles that it does not meet, the first one and how many; and whether anything blocks it.
struct Payload {
  uvec2 own;
  uint is_blocked;
};
