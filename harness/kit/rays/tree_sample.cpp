#include "kit/rays/tree_sample.h"

#include <gnomon/kit/parallel.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

namespace gnomon {

namespace {

/// The lowest 10 bits of a number, with two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 16) & 0x30000ff;
  bits = (bits | bits << 8) & 0x300f00f;
  bits = (bits | bits << 4) & 0x30c30c3;
  return (bits | bits << 2) & 0x9249249;
}

/// Three times the centroid; in double, since a sum of floats may overflow.
glm::dvec3 thrice_centroid(const Mesh& mesh, std::size_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  return glm::dvec3(mesh.positions[t.x]) + glm::dvec3(mesh.positions[t.y]) + glm::dvec3(mesh.positions[t.z]);
}

Bounds bounds_of(const Mesh& mesh, std::uint32_t triangle) {
  Bounds box;
  box.add(mesh.corners(triangle).points);
  return box;
}

/// The triangles of a mesh along a Morton curve (Morton 1966), in the lower half of each number; above it the cell, of 1024
/// along each axis.
std::vector<std::uint64_t> along_curve(const Mesh& mesh) {
  Bounds bounds;
  bounds.add(mesh.positions);
  const glm::dvec3 low = 3.0 * glm::dvec3(bounds.min), size = 3.0 * glm::dvec3(bounds.max) - low;
  std::vector<std::uint64_t> keys(mesh.triangles.size());
  for_blocks(keys.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const glm::dvec3 from_low = thrice_centroid(mesh, t) - low;
      std::uint64_t cell = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double place = size[axis] > 0 ? std::clamp(from_low[axis] / size[axis], 0.0, 1.0) : 0;
        cell |= spread(std::min(static_cast<std::uint64_t>(1024 * place), std::uint64_t(1023))) << axis;
      }
      keys[t] = cell << 32 | t;
    }
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

TreeSample::TreeSample(const Mesh& mesh) {
  const std::vector<std::uint64_t> keys = along_curve(mesh);
  const std::size_t every = std::max<std::size_t>(1, keys.size() / most_triangles);
  runs_.resize((keys.size() + every * run_length - 1) / (every * run_length));
  for_blocks(runs_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const std::size_t first = r * every * run_length, last = std::min(first + run_length, keys.size());
      std::vector<Bounds> boxes;
      for (std::size_t k = first; k < last; ++k) boxes.push_back(bounds_of(mesh, static_cast<std::uint32_t>(keys[k])));
      runs_[r].tree = BoxTree(boxes);
      for (const std::uint32_t item : runs_[r].tree.order())
        runs_[r].triangles.push_back(static_cast<std::uint32_t>(keys[first + item]));
    }
  });
}

double TreeSample::refit(const Mesh& mesh) {
  for_blocks(runs_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      runs_[r].tree.refit([&](std::uint32_t place) { return bounds_of(mesh, runs_[r].triangles[place]); });
  });
  return cost();
}

// One after the other, so that the sum is the same whatever the number of threads.
double TreeSample::cost() const {
  Bounds all;
  double sum = 0;
  for (const Run& run : runs_) {
    all.add(run.tree.bounds());
    sum += run.tree.weighted_area();
  }
  const double whole = half_area(all);
  return whole > 0 ? sum / whole : 0;
}

std::size_t TreeSample::bytes() const {
  std::size_t sum = bytes_of(runs_);
  for (const Run& run : runs_) sum += bytes_of(run.triangles) + run.tree.bytes();
  return sum;
}

}  // namespace gnomon
