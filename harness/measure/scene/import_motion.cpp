#include "measure/scene/import_motion.h"

#include <algorithm>
#include <utility>

#include "measure/scene/motion_data.h"

namespace gnomon::importing {
namespace {

int order(double a, double b) { return a < b ? -1 : a > b; }
int order(const glm::dvec3& a, const glm::dvec3& b) {
  for (int k = 0; k < 3; ++k)
    if (const int c = order(a[k], b[k])) return c;
  return 0;
}

/// Below, equal to or above 0: the order of what moves two vertices.
int order(const Rig& rig, std::uint32_t a, std::uint32_t b) {
  const std::size_t count = rig.base.size();
  if (const int c = order(rig.base[a], rig.base[b])) return c;
  for (std::size_t first = 0; first < rig.targets.size(); first += count)
    if (const int c = order(rig.targets[first + a], rig.targets[first + b])) return c;
  for (std::size_t k = 0; k < rig.joints_per_vertex; ++k) {
    const std::size_t i = std::size_t{a} * rig.joints_per_vertex + k, j = std::size_t{b} * rig.joints_per_vertex + k;
    if (rig.joints[i] != rig.joints[j]) return rig.joints[i] < rig.joints[j] ? -1 : 1;
    if (const int c = order(rig.weights[i], rig.weights[j])) return c;
  }
  return 0;
}

/// The rig of those vertices alone.
Rig part_of(const Rig& whole, std::span<const std::uint32_t> vertices) {
  const std::size_t count = whole.base.size(), width = whole.joints_per_vertex;
  Rig rig{.node = whole.node,
          .skin = whole.skin,
          .placement = {},
          .base = {},
          .targets = {},
          .joints_per_vertex = whole.joints_per_vertex,
          .joints = {},
          .weights = {}};
  rig.base.reserve(vertices.size());
  for (const std::uint32_t v : vertices) rig.base.push_back(whole.base[v]);
  if (!whole.targets.empty()) rig.targets.reserve(whole.targets.size() / count * vertices.size());
  for (std::size_t first = 0; first < whole.targets.size(); first += count)
    for (const std::uint32_t v : vertices) rig.targets.push_back(whole.targets[first + v]);
  if (width == 0) return rig;
  rig.joints.reserve(width * vertices.size());
  rig.weights.reserve(width * vertices.size());
  for (const std::uint32_t v : vertices)
    for (std::size_t i = v * width; i < (v + std::size_t{1}) * width; ++i) {
      rig.joints.push_back(whole.joints[i]);
      rig.weights.push_back(whole.weights[i]);
    }
  return rig;
}

}  // namespace

// A small file may name many places of a mesh with many morph targets.
FileMotion::FileMotion(const std::string& file, std::uintmax_t file_bytes, Motion motion)
    : motion_(std::move(motion)), most_numbers_(std::min<std::uintmax_t>(40'000'000 + 64 * file_bytes, 400'000'000)) {
  motion_.rigs.clear();
  check_motion(motion_, file);
}

const Rig* FileMotion::rig_of(const std::string& where, ImportedMesh& raw) {
  if (raw.nodes.empty()) return nullptr;
  if (motion_.animations.empty()) throw Error("{}: moves, and the file has no animation", where);
  if (raw.nodes.size() != raw.places.size())
    throw Error("{}: has {} places at {} nodes", where, raw.places.size(), raw.nodes.size());
  const bool has_skin = raw.skin != Rig::no_skin;
  if (has_skin && std::ranges::any_of(raw.places, [](const glm::dmat4& place) { return place != glm::dmat4(1); }))
    throw Error("{}: has a place beside its skin, which alone places it", where);
  whole_ = {.skin = raw.skin,
            .placement = {},
            .base = raw.base.empty() ? raw.positions : std::move(raw.base),
            .targets = std::move(raw.targets),
            .joints_per_vertex = raw.joints_per_vertex,
            .joints = std::move(raw.joints),
            .weights = std::move(raw.weights)};
  number_count_ += raw.nodes.size() * (3 * (whole_.base.size() + whole_.targets.size()) + 2 * whole_.joints.size());
  if (number_count_ > most_numbers_)
    throw Error("{}: with it, more than {} numbers move vertices of the file", where, most_numbers_);
  for (const std::uint32_t node : raw.nodes) {
    whole_.node = node;
    check_rig(motion_, whole_, raw.positions.size(), where);
  }
  for (std::size_t i = 0; i < whole_.joints.size(); ++i)
    if (whole_.weights[i] == 0) whole_.joints[i] = 0;  // vertices that differ in what counts for nothing are welded
  return &whole_;
}

void FileMotion::add(const ImportedMesh& raw, std::size_t place, const Placement& placement,
                     std::span<const std::uint32_t> sources, std::size_t mesh) {
  Rig rig = part_of(whole_, sources);
  rig.mesh = static_cast<std::uint32_t>(mesh);
  rig.node = raw.nodes[place];
  rig.placement = placement;
  motion_.rigs.push_back(std::move(rig));
}

void FileMotion::finish(Scene& scene) {
  if (!motion_.rigs.empty()) append_motion(std::move(motion_), scene);
}

std::vector<std::uint32_t> weld_rigged(std::span<const std::uint32_t> welded, const Rig& rig,
                                       std::span<const std::uint8_t> used) {
  std::vector<std::uint32_t> sorted;
  for (std::uint32_t v = 0; v < welded.size(); ++v)
    if (used[v]) sorted.push_back(v);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    if (welded[a] != welded[b]) return welded[a] < welded[b];
    const int c = order(rig, a, b);
    return c != 0 ? c < 0 : a < b;
  };
  std::ranges::sort(sorted, less);
  std::vector<std::uint32_t> first(welded.begin(), welded.end());
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const std::uint32_t v = sorted[k], before = k > 0 ? sorted[k - 1] : v;
    first[v] = k > 0 && welded[v] == welded[before] && order(rig, v, before) == 0 ? first[before] : v;
  }
  return first;
}

}  // namespace gnomon::importing
