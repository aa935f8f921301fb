#include "detail.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::svbsp {

void Divider::divide(std::span<const Corner> polygon, std::uint32_t triangle, bool merges, SurfaceDetail& detail) {
  const std::size_t first_corner = detail.corners.size(), first_polygon = detail.polygons.size();
  out_ = &detail;
  const std::uint32_t mesh = facing_.triangles[triangle].mesh;
  DetailPolygon whole{.mesh = mesh, .triangle = triangle - numbers_.first_of(mesh), .is_lit = false, .first = 0, .count = 0};
  part_ = whole;
  is_clockwise_ = space_.is_clockwise(facing_.signs[triangle]);
  projector_.run(space_, polygon, facing_.signs[triangle], [&](int face, std::span<const Corner> seen) {
    face_ = face;
    divide_face({seen.begin(), seen.end()});
  });
  const auto made = std::span(detail.polygons).subspan(first_polygon);
  const bool is_lit = made.empty() ? is_lit_in_the_middle(polygon) : made[0].is_lit;
  const auto is_alike = [&](const DetailPolygon& p) { return p.is_lit == is_lit; };
  if (!made.empty() && (!merges || !std::ranges::all_of(made, is_alike))) return;
  detail.corners.resize(first_corner);
  detail.polygons.resize(first_polygon);
  whole.is_lit = is_lit;
  whole.first = static_cast<std::uint32_t>(first_corner);
  whole.count = static_cast<std::uint32_t>(polygon.size());
  for (const Corner& corner : polygon) detail.corners.push_back(corner.at);
  detail.polygons.push_back(whole);
}

bool Divider::is_lit_in_the_middle(std::span<const Corner> polygon) const {
  glm::dvec3 middle(0);
  for (const Corner& corner : polygon) middle += corner.at / static_cast<double>(polygon.size());
  const auto [face, seen] = space_.of_world(middle);
  Query query = forest_.query(face, seen);
  std::uint64_t visits = 0;
  locate<1>({&query, 1}, visits);
  return !is_in_cell(query.link) ||
         facing_.plane(space_, face, triangle_in(query.link)).at(seen) >= -forest_.epsilon().meters * space_.meter(seen);
}

std::pair<Divider::Polygon, Divider::Polygon> Divider::cut(const Polygon& polygon, int axis, double at) {
  glm::dvec3 normal(0);
  normal[axis] = 1;
  clipper_.start(polygon);
  const Lies lies = clipper_.keep_positive({normal, -at}, forest_.epsilon().across, shadow_cut);
  if (lies == Lies::negative) return {polygon, {}};
  if (lies != Lies::across) return {{}, polygon};
  const std::span<const Corner> below = clipper_.cut_off(), above = clipper_.corners();
  return {{below.begin(), below.end()}, {above.begin(), above.end()}};
}

void Divider::divide_face(Polygon rest) {
  const Grid& grid = forest_.grid(face_);
  if (grid.is_empty()) return append(rest, true);
  for (int axis = 0; axis < 2 && !rest.empty(); ++axis) {
    Polygon around;
    std::tie(around, rest) = cut(rest, axis, grid.low[axis]);
    append(around, true);
    if (rest.empty()) break;
    std::tie(rest, around) = cut(rest, axis, grid.high[axis]);
    append(around, true);
  }
  for (int row = 0; row < grid.rows && !rest.empty(); ++row) {
    Polygon strip = std::move(rest);
    rest.clear();
    if (row + 1 < grid.rows) std::tie(strip, rest) = cut(strip, 1, grid.row_side(row + 1));
    for (int column = 0; column < grid.columns && !strip.empty(); ++column) {
      Polygon part = std::move(strip);
      strip.clear();
      if (column + 1 < grid.columns) std::tie(part, strip) = cut(part, 0, grid.column_side(column + 1));
      if (!part.empty()) filter(part, grid.tile(column, row));
    }
  }
}

void Divider::filter(const Polygon& polygon, std::uint32_t tile) {
  std::uint64_t thin = 0;
  filter_.run(forest_.nodes(tile), forest_.root(tile), polygon, forest_.epsilon().across, thin,
              [&](const Place&, Link cell, std::span<const Corner> fragment) {
                if (!is_in_cell(cell)) return append(fragment, true);
                values_.resize(fragment.size());
                const Lies lies = lies_at(facing_.plane(space_, face_, triangle_in(cell)), space_, fragment,
                                          forest_.epsilon().meters, values_.data());
                if (lies != Lies::across) return append(fragment, lies != Lies::negative);
                Polygon beyond(fragment.size() + 1), before(fragment.size() + 1);
                const CutCounts counts = cut_polygon(fragment, values_.data(), 0, own_edge, beyond.data(), before.data());
                append({beyond.data(), counts.negative}, false);
                append({before.data(), counts.positive}, true);
              });
}

void Divider::append(std::span<const Corner> polygon, bool is_lit) {
  if (polygon.size() < 3) return;
  part_.is_lit = is_lit;
  part_.first = static_cast<std::uint32_t>(out_->corners.size());
  part_.count = static_cast<std::uint32_t>(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i)
    out_->corners.push_back(space_.to_world(face_, polygon[is_clockwise_ ? polygon.size() - 1 - i : i].at));
  out_->polygons.push_back(part_);
}

SurfaceDetail divide_triangles(const Scene& scene, const TriangleNumbers& numbers, const ProjectedSpace& space,
                               const Forest& forest, const Facing& facing, std::span<const std::uint8_t> is_wanted,
                               bool merges) {
  constexpr std::size_t block = 4096;
  const std::span<const SceneTriangle> triangles = facing.triangles;
  std::vector<SurfaceDetail> parts((triangles.size() + block - 1) / block);
  for_blocks(triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    Divider divider(space, forest, facing, numbers);
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_wanted[i] || facing.signs[i] == 0 || !scene.meshes[triangles[i].mesh].receives) continue;
      Corner corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles[i].points[k]), own_edge};
      divider.divide(corners, static_cast<std::uint32_t>(i), merges, parts[begin / block]);
    }
  });
  SurfaceDetail all;
  for (const SurfaceDetail& part : parts) {
    const auto first = static_cast<std::uint32_t>(all.corners.size());
    for (DetailPolygon polygon : part.polygons) {
      polygon.first += first;
      all.polygons.push_back(polygon);
    }
    all.corners.insert(all.corners.end(), part.corners.begin(), part.corners.end());
  }
  return all;
}

}  // namespace gnomon::svbsp
