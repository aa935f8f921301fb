#include "casters.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <unordered_map>

namespace gnomon::area_svbsp {

namespace {

/// The quadrilateral of a triangle and the one beyond its edge k, whose third corner is `tip`; nothing where it is not convex
/// or not in one plane, exactly.
std::optional<std::array<glm::vec3, 4>> joined(const Triangle& triangle, int k, const glm::vec3& tip) {
  const glm::vec3 &a = triangle.points[k], &b = triangle.points[(k + 1) % 3], &c = triangle.points[(k + 2) % 3];
  if (orient3d_sign(a, b, c, tip) != 0) return std::nullopt;
  const glm::dvec3 normal = triangle.normal();
  const auto turns_left = [&](const glm::dvec3& from, const glm::dvec3& at, const glm::dvec3& to) {
    const glm::dvec3 u = at - from, v = to - at;
    return glm::dot(glm::cross(u, v), normal) > 1e-6 * glm::length(u) * glm::length(v) * glm::length(normal);
  };
  if (!turns_left(c, a, tip) || !turns_left(a, tip, b) || !turns_left(tip, b, c) || !turns_left(b, c, a)) return std::nullopt;
  return std::array{a, tip, b, c};
}

void add_polygons(const Mesh& mesh, std::uint32_t m, std::uint32_t first, std::vector<CasterPolygon>& polygons) {
  const std::vector<std::uint32_t> welded = weld(mesh.positions);
  const auto key = [&](std::uint32_t from, std::uint32_t to) { return std::uint64_t{welded[from]} << 32 | welded[to]; };
  std::unordered_map<std::uint64_t, std::uint32_t> triangle_at;  // by directed edge; the first one there
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) triangle_at.try_emplace(key(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), t);
  std::vector<bool> is_done(mesh.triangles.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_done[t]) continue;
    is_done[t] = true;
    const Triangle triangle = mesh.corners(t);
    const auto& [a, b, c] = triangle.points;
    if (triangle.normal() == glm::dvec3(0) || is_degenerate(a, b, c)) continue;
    CasterPolygon polygon{.corners = {}, .mesh = m, .triangles = {first + t, first + t}};
    std::ranges::copy(triangle.points, polygon.corners);
    for (int k = 0; k < 3; ++k) {
      const glm::uvec3& own = mesh.triangles[t];
      const auto beyond = triangle_at.find(key(own[(k + 1) % 3], own[k]));
      if (beyond == triangle_at.end() || is_done[beyond->second]) continue;
      const glm::uvec3& other = mesh.triangles[beyond->second];
      const auto is_tip = [&](std::uint32_t v) { return welded[v] != welded[own[k]] && welded[v] != welded[own[(k + 1) % 3]]; };
      const std::uint32_t tip = is_tip(other.x) ? other.x : is_tip(other.y) ? other.y : other.z;
      const auto quad = joined(triangle, k, mesh.positions[tip]);
      if (!quad) continue;
      is_done[beyond->second] = true;
      polygon.count = 4;
      std::ranges::copy(*quad, polygon.corners);
      polygon.triangles[1] = first + beyond->second;
      break;
    }
    polygons.push_back(polygon);
  }
}

/// Makes the volumes of one polygon after the other.
class VolumeMaker {
 public:
  VolumeMaker(const LightBody& light, double epsilon) : light_(light), epsilon_(epsilon) {}

  void add(const CasterPolygon& polygon, std::uint32_t number) {
    number_ = number;
    clipper_.start();
    for (std::uint32_t k = 0; k < polygon.count; ++k) clipper_.add({glm::dvec3(polygon.corners[k])});
    plane_ = plane_of(clipper_.corners());
    is_cut_ = false;
    if (!light_.is_flat) return add_side(clipper_.corners(), 0);
    const Lies lies = clipper_.keep_positive(light_.plane, epsilon_);
    if (lies == Lies::within) return;
    is_cut_ = lies == Lies::across;
    if (lies != Lies::negative) add_side(clipper_.corners(), 1);
    if (light_.is_one_sided || lies == Lies::positive) return;
    add_side(lies == Lies::negative ? clipper_.corners() : clipper_.cut_off(), -1);
  }

  std::vector<Volume> volumes;
  std::vector<ClipPlane> planes;
  std::vector<std::uint32_t> ends;  ///< of each polygon's volumes

 private:
  /// Of the part of the polygon on one side of the light's plane.
  void add_side(std::span<const Corner> part, std::int8_t side) {
    if (!plane_) return add_volume(part, side, light_, nullptr, false);
    for (const ClipPlane& far : {*plane_, -*plane_}) {
      const auto [low, high] = values_of(light_.corners, far);
      if (low >= -epsilon_) continue;  // no light beyond the polygon, as seen from this side
      if (high <= epsilon_ || !light_.is_flat) {
        add_volume(part, side, light_, &far, high < -epsilon_);
        continue;
      }
      Clipper clipper;
      clipper.start(light_.corners);
      clipper.keep_positive(-far, epsilon_);
      LightBody behind = light_;
      behind.set_corners(clipper.corners());
      add_volume(part, side, behind, &far, false);
    }
  }

  void add_volume(std::span<const Corner> part, std::int8_t side, const LightBody& light, const ClipPlane* far,
                  bool may_hide_all) {
    const PlaneMaker maker(light, epsilon_);
    Volume volume{.polygon = number_,
                  .first = static_cast<std::uint32_t>(planes.size()),
                  .penumbra_count = 0,
                  .umbra_count = 0,
                  .light_side = side,
                  .is_whole = far && !is_cut_,
                  .is_turned_away = far && far->normal == plane_->normal};
    if (far) planes.push_back(*far);
    maker.add_penumbra(part, planes);
    volume.penumbra_count = static_cast<std::uint8_t>(planes.size() - volume.first);
    const std::size_t end = planes.size();
    if (far) planes.push_back(*far);
    if (may_hide_all && maker.add_umbra(part, planes))
      volume.umbra_count = static_cast<std::uint8_t>(planes.size() - end);
    else
      planes.resize(end);
    // The polygon's own plane stays: exact signs decide what touches it.
    for (std::size_t k = volume.first + (far ? 1 : 0); k < end; ++k) planes[k].offset += rounding * epsilon_;
    for (std::size_t k = end + 1; k < planes.size(); ++k) planes[k].offset -= rounding * epsilon_;
    volumes.push_back(volume);
  }

  const LightBody& light_;
  double epsilon_;
  std::uint32_t number_ = 0;
  std::optional<ClipPlane> plane_;
  bool is_cut_ = false;  // by the light's plane
  Clipper clipper_;
};

}  // namespace

Casters::Casters(CutMasks masks) : cut(std::move(masks)), scene(&cut.scene()), bounds(scene->bounds()), numbers(*scene) {
  for (std::uint32_t m = 0; m < scene->meshes.size(); ++m)
    if (scene->meshes[m].casts) add_polygons(scene->meshes[m], m, numbers.first_of(m), polygons);
  std::vector<Bounds> all;
  for (const CasterPolygon& polygon : polygons) all.push_back(polygon.bounds());
  boxes = BoxTree(all);
}

Triangle Casters::source(std::uint32_t number) const {
  const std::uint32_t whole = cut.source(number), mesh = numbers.mesh_of(whole);
  return scene->meshes[mesh].corners(whole - numbers.first_of(mesh));
}

bool Casters::leaves_out(const Receiver& point, const CasterPolygon& polygon) const {
  const NumberedReceiver receiver = numbers.numbered(point);
  if (receiver.is_own(cut.source(polygon.triangles[0])) || receiver.is_own(cut.source(polygon.triangles[1]))) return true;
  if (!cut.is_piece(polygon.triangles[0])) return receiver.is_coplanar(*scene, polygon.corners);
  return receiver.is_coplanar(*scene, source(polygon.triangles[0]).points);
}

bool Casters::is_coplanar(const glm::vec3* triangle, const CasterPolygon& polygon) const {
  const auto is_in_plane = [&](const glm::vec3& corner) { return coplanar(triangle[0], triangle[1], triangle[2], corner); };
  if (cut.is_piece(polygon.triangles[0])) return std::ranges::all_of(source(polygon.triangles[0]).points, is_in_plane);
  return std::ranges::all_of(std::span(polygon.corners, polygon.count), is_in_plane);
}

void Volumes::make(std::span<const CasterPolygon> polygons, const LightBody& light, double epsilon) {
  constexpr std::size_t block = 1024;
  std::vector<VolumeMaker> makers((polygons.size() + block - 1) / block, VolumeMaker(light, epsilon));
  if (!light.is_flat || light.plane.normal != glm::dvec3(0))
    for_blocks(polygons.size(), block, [&](std::size_t begin, std::size_t end) {
      VolumeMaker& maker = makers[begin / block];
      for (std::size_t i = begin; i < end; ++i) {
        maker.add(polygons[i], static_cast<std::uint32_t>(i));
        maker.ends.push_back(static_cast<std::uint32_t>(maker.volumes.size()));
      }
    });
  std::size_t volume_count = 0, plane_count = 0;
  for (const VolumeMaker& maker : makers) {
    volume_count += maker.volumes.size();
    plane_count += maker.planes.size();
  }
  volumes_.clear();
  planes_.clear();
  volumes_.reserve(volume_count);
  planes_.reserve(plane_count);
  first_of_.assign(1, 0);
  for (const VolumeMaker& maker : makers) {
    const auto first_plane = static_cast<std::uint32_t>(planes_.size()),
               first_volume = static_cast<std::uint32_t>(volumes_.size());
    planes_.insert(planes_.end(), maker.planes.begin(), maker.planes.end());
    for (Volume volume : maker.volumes) {
      volume.first += first_plane;
      volumes_.push_back(volume);
    }
    for (const std::uint32_t end : maker.ends) first_of_.push_back(first_volume + end);
  }
  first_of_.resize(polygons.size() + 1, static_cast<std::uint32_t>(volumes_.size()));
}

}  // namespace gnomon::area_svbsp
