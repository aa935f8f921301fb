#include "grid.h"

namespace gnomon::two_pass_object {

Node divide_face(std::span<const Footprint> footprints, double share, bool is_cube) {
  Node node{INFINITY, INFINITY, -INFINITY, -INFINITY};
  double area = 0, width = 0, height = 0;
  for (const Footprint& f : footprints) {
    node.u0 = std::min(node.u0, f.u0);
    node.u1 = std::max(node.u1, f.u1);
    node.v0 = std::min(node.v0, f.v0);
    node.v1 = std::max(node.v1, f.v1);
    area += (f.u1 - f.u0) * (f.v1 - f.v0);
    width += f.u1 - f.u0;
    height += f.v1 - f.v0;
  }
  // Never without width: points beside all triangles are lit, and those on the border are asked.
  const double size = std::max({node.u1 - node.u0, node.v1 - node.v0, 1e-6});
  const double grow = 0x1p-10 * size;
  node.u0 -= grow;
  node.u1 += grow;
  node.v0 -= grow;
  node.v1 += grow;
  // Faces of a cube meet and do not overlap.
  if (is_cube) {
    node.u0 = std::max(node.u0, -1.0);
    node.u1 = std::min(node.u1, 1.0);
    node.v0 = std::max(node.v0, -1.0);
    node.v1 = std::min(node.v1, 1.0);
  }
  const double du = node.u1 - node.u0, dv = node.v1 - node.v0, n = static_cast<double>(footprints.size());
  for (double cells = std::clamp(n / share, 1.0, 0x1p20);; cells /= 2) {
    const double stretch = std::sqrt(du / dv);
    const double columns = std::clamp(std::round(std::sqrt(cells) * stretch), 1.0, 2048.0);
    const double rows = std::clamp(std::round(std::sqrt(cells) / stretch), 1.0, 2048.0);
    const double touched = n + width / du * columns + height / dv * rows + area / (du * dv) * columns * rows;
    if (cells > 1 && touched > 4 * n + 64) continue;
    node.columns = static_cast<std::uint32_t>(columns);
    node.rows = static_cast<std::uint32_t>(rows);
    return node;
  }
}

}  // namespace gnomon::two_pass_object
