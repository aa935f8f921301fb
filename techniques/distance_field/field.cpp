#include "field.h"

#include <gnomon/kit/parallel.h>

#include <array>

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

/// Fills slabs of samples, by cubes of them: where few triangles are near a cube, its samples need no search of their own.
class Sampler {
 public:
  static constexpr int side = 4;  ///< of a cube, samples

  Sampler(const MeshDistances& mesh, const Frame& frame) : mesh_(mesh), frame_(frame) {}

  /// The slices from `z` on, so many as a cube has.
  void fill(int z, std::vector<std::uint16_t>& samples) {
    near_ = 0;
    const int slices = std::min(side, frame_.cells.z + 1 - z);
    if (frame_.is_closed)
      for (int k = 0; k < slices; ++k) find_windings(mesh_, frame_, z + k, windings_[k]);
    for (int y = 0; y <= frame_.cells.y; y += side)
      for (int x = 0; x <= frame_.cells.x; x += side)
        fill_cube({x, y, z}, glm::min(glm::ivec3(x, y, z) + side, frame_.cells + 1), samples);
  }

 private:
  static constexpr std::size_t few = 32;  ///< triangles

  void fill_cube(const glm::ivec3& low, const glm::ivec3& end, std::vector<std::uint16_t>& samples) {
    const glm::dvec3 first = frame_.place(low), last = frame_.place(end - 1);
    const bool is_few = mesh_.find_near((first + last) / 2.0, glm::length(last - first) / 2, few, places_, near_);
    for (int z = low.z; z < end.z; ++z)
      for (int y = low.y; y < end.y; ++y)
        for (int x = low.x; x < end.x; ++x) {
          const glm::dvec3 p = frame_.place({x, y, z});
          const double distance = is_few ? mesh_.to_nearest_of(places_, p) : mesh_.to_nearest(p, near_);
          const bool is_inside = frame_.is_closed && windings_[z - low.z][frame_.index({x, y, 0})] != 0;
          samples[frame_.index({x, y, z})] = to_half(frame_.held(distance, is_inside));
        }
  }

  const MeshDistances& mesh_;
  const Frame& frame_;
  std::array<std::vector<int>, side> windings_;  ///< of the slices
  std::vector<std::uint32_t> places_;            ///< of the triangles near a cube
  std::uint32_t near_ = 0;                       ///< place of the triangle that was nearest to the last sample searched for
};

}  // namespace

Frame::Frame(const Mesh& mesh, int resolution) {
  Bounds box;
  box.add(mesh.positions);
  if (box.empty() || mesh.triangles.empty()) return;
  const glm::dvec3 least(box.min), most(box.max), size = most - least;
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return;
  voxel = longest / resolution;
  per_meter = 1 / voxel;
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
  const std::size_t slabs = frame_.cells.z / Sampler::side + std::size_t{1};
  for_blocks(slabs, 1, [&](std::size_t begin, std::size_t end) {
    Sampler sampler(distances, frame_);
    for (std::size_t slab = begin; slab < end; ++slab) sampler.fill(static_cast<int>(slab) * Sampler::side, samples_);
  });
}

}  // namespace gnomon::distance_field
