#include "field.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::distance_field {

namespace {

/// Winding numbers at the samples of one slice, row by row.
void find_windings(const MeshDistances& mesh, const Frame& frame, int slice, std::vector<int>& windings) {
  const std::size_t row = frame.cells.x + std::size_t{1};
  windings.assign(row * (frame.cells.y + std::size_t{1}), 0);
  const double z = frame.place({0, 0, slice}).z;
  // Each passage is written down at the first sample beyond it; sums along the rows then are the numbers.
  mesh.each([&](const Triangle& triangle) {
    const std::optional<Cut> cut = cut_at(triangle, z);
    if (!cut) return;
    const double least = std::min(cut->from.y, cut->to.y), most = std::max(cut->from.y, cut->to.y);
    const int first = std::max(static_cast<int>(std::floor((least - frame.low.y) / frame.voxel)), 0);
    for (int y = first; y <= frame.cells.y && frame.place({0, y, 0}).y <= most; ++y) {
      const std::optional<Passage> passage = passage_at(*cut, frame.place({0, y, 0}).y);
      if (!passage) continue;
      int x = std::clamp(static_cast<int>((passage->x - frame.low.x) / frame.voxel), 0, frame.cells.x);
      while (x > 0 && frame.place({x - 1, 0, 0}).x > passage->x) --x;
      while (x <= frame.cells.x && !(frame.place({x, 0, 0}).x > passage->x)) ++x;
      if (x <= frame.cells.x) windings[y * row + x] += passage->winding;
    }
  });
  for (std::size_t i = 0; i < windings.size(); ++i)
    if (i % row != 0) windings[i] += windings[i - 1];
}

}  // namespace

Frame::Frame(const Mesh& mesh, int resolution) {
  Bounds box;
  box.add(mesh.positions);
  if (box.empty() || mesh.triangles.empty()) return;
  const glm::dvec3 least(box.min), most(box.max), size = most - least;
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return;
  voxel = longest / resolution;
  for (int k = 0; k < 3; ++k) {
    const int inner = size[k] == longest ? resolution : static_cast<int>(std::ceil(size[k] / longest * resolution));
    cells[k] = (inner == 1 ? 2 : inner) + 2 * margin;
  }
  low = (least + most) / 2.0 - voxel / 2 * glm::dvec3(cells);
}

Bounds Frame::bounds() const {
  Bounds box;
  if (empty()) return box;
  const glm::dvec3 high = place(cells);
  for (int k = 0; k < 3; ++k) {
    box.min[k] = std::nextafter(static_cast<float>(low[k]), -INFINITY);
    box.max[k] = std::nextafter(static_cast<float>(high[k]), INFINITY);
  }
  return box;
}

Field::Field(const Mesh& mesh, int resolution) : frame_(mesh, resolution), samples_(frame_.sample_count()) {
  if (frame_.empty()) return;
  // Edges that are joined in the rest pose may be apart in another one.
  frame_.is_closed = mesh.is_closed() && measure_facts(mesh.positions, mesh.triangles).closed();
  const MeshDistances distances(mesh);
  for_blocks(frame_.cells.z + std::size_t{1}, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<int> windings;
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z) {
      if (frame_.is_closed) find_windings(distances, frame_, z, windings);
      const std::size_t first = frame_.index({0, 0, z});
      // The triangle that is nearest to one sample bounds the search for the next.
      std::uint32_t near = 0;
      for (int y = 0; y <= frame_.cells.y; ++y)
        for (int x = 0; x <= frame_.cells.x; ++x) {
          const std::size_t i = frame_.index({x, y, z});
          const double distance = distances.to_nearest(frame_.place({x, y, z}), near);
          samples_[i] = to_half(frame_.held(distance, frame_.is_closed && windings[i - first] != 0));
        }
    }
  });
}

}  // namespace gnomon::distance_field
