// Places the vertices of an imported mesh in double, rounds them once, and welds them.
#include "measure/scene/import_vertices.h"

#include <algorithm>

#include "measure/scene/base_scene.h"
#include "measure/scene/import_masks.h"
#include "measure/scene/import_motion.h"

namespace gnomon::importing {
namespace {

/// Marks by 1 the vertices that the faces of a mesh use. Throws Error on a face that names a missing vertex or has too many
/// corners.
std::vector<std::uint8_t> used_vertices(const std::string& where, const ImportedMesh& raw) {
  std::vector<std::uint8_t> used(raw.positions.size());
  std::span<const std::uint32_t> corners = raw.corners;
  for (std::size_t f = 0; f < raw.corner_counts.size(); ++f) {
    const std::size_t count = raw.corner_counts[f];
    if (count > most_corners) throw Error("{}, face {}: has {} corners; at most {} are taken", where, f, count, most_corners);
    if (count > corners.size()) throw Error("{}, face {}: {} corners are announced, {} there", where, f, count, corners.size());
    for (const std::uint32_t corner : corners.first(count)) {
      if (corner >= used.size())
        throw Error("{}, face {}: vertex index {} is outside 0 .. {}", where, f, corner, std::int64_t(used.size()) - 1);
      if (count >= 3) used[corner] = 1;
    }
    corners = corners.subspan(count);
  }
  return used;
}

/// The positions of the vertices that are used, rounded to float32; the others are 0.
std::vector<glm::vec3> placed_positions(const std::string& where, const ImportedMesh& raw, std::span<const std::uint8_t> used,
                                        const glm::dmat4& place, const Placement& placement, NoteCounts& counts) {
  std::vector<glm::vec3> positions(raw.positions.size());
  for (std::size_t v = 0; v < raw.positions.size(); ++v) {
    if (!used[v]) continue;
    const glm::dvec3& p = raw.positions[v];
    const glm::dvec3 placed = placement.apply(glm::dvec3(place * glm::dvec4(p, 1)));
    if (!is_sound(p) || !is_sound(placed))
      throw Error("{}, vertex {}: position = ({}, {}, {}), placed at ({}, {}, {}), is outside {}", where, v, p.x, p.y, p.z,
                  placed.x, placed.y, placed.z, coordinate_range);
    positions[v] = placed;
    counts.raw.add(p);
    counts.placed.add(placed);
  }
  return positions;
}

}  // namespace

void Reach::add(const glm::dvec3& p) {
  const glm::dvec3 size = glm::abs(p);
  farthest = std::max({farthest, size.x, size.y, size.z});
  low = glm::min(low, p);
  high = glm::max(high, p);
  is_float = is_float && glm::dvec3(glm::vec3(p)) == p;
}

bool Reach::is_coarse() const {
  constexpr double parts = 4096;  // a picture is not much wider
  return step() * parts > std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

Welded place_vertices(const std::string& where, const ImportedMesh& raw, const glm::dmat4& place, const Placement& placement,
                      const Rig* rig, std::string_view hint, NoteCounts& counts, Mesh& mesh) {
  const std::vector<std::uint8_t> used = used_vertices(where, raw);
  const std::vector<glm::vec3> positions = placed_positions(where, raw, used, place, placement, counts);
  std::vector<std::uint32_t> first = weld(positions, used);
  if (mesh.needs_uv()) {
    check_uv(where, raw, used, mesh.alpha_mask != nullptr, hint);
    first = weld_places(first, raw.uv, used);
  }
  if (rig) first = weld_rigged(first, *rig, used);
  Welded welded{std::move(first), {}};
  for (std::uint32_t v = 0; v < welded.places.size(); ++v) {
    if (!used[v]) continue;
    std::uint32_t& to = welded.places[v];
    if (to != v) {
      to = welded.places[to];
      continue;
    }
    to = static_cast<std::uint32_t>(mesh.positions.size());
    welded.sources.push_back(v);
    mesh.positions.push_back(positions[v]);
    if (mesh.needs_uv()) mesh.uv.push_back(raw.uv[v]);
  }
  return welded;
}

}  // namespace gnomon::importing
