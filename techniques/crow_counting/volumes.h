#pragma once
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/shared.h>

#include "polygon.h"
#include "single_casters.h"

namespace gnomon::crow_counting {

/// The polygons of all shadow volumes of a scene and a light: the side quads of the silhouette, then the light caps, which are
/// the triangles that face the light. A side quad is there once and counts for its edge's count. Casters with alpha masks or
/// transmission have none (single_casters.h).
class Volumes {
 public:
  void build(const Scene& scene) {
    built_->number += 2;
    if (!scene.has_alpha_masks() && !scene.has_transmission()) {
      built_->adjacency = EdgeAdjacency(scene, Joins::in_every_pose);
      return;
    }
    Scene opaque;
    opaque.meshes = scene.meshes;
    opaque.motion = scene.motion;
    for (Mesh& mesh : opaque.meshes) mesh.casts &= !SingleCasters::is_single(mesh);
    built_->adjacency = EdgeAdjacency(opaque, Joins::in_every_pose);
  }
  /// Follows a scene that moved. Which triangles share an edge stays.
  void update(const Scene& scene, const Changes& changes) {
    if (!built_->adjacency.can_follow(changes)) return build(scene);
    built_->number += 1;
    built_->moved = built_->adjacency.move(scene, changes);
  }
  /// Those of another light, over the same edges.
  Volumes for_guest() const {
    Volumes guest;
    guest.built_ = built_.for_guest();
    return guest;
  }

  /// After one update the outline and the caps of what did not move may stay.
  void relight(const Light& light) {
    const auto triangle_count = static_cast<std::uint32_t>(adjacency().triangles().size());
    Refaced refaced{0, triangle_count};
    const bool may_keep = built_->number == number_ + 1;
    number_ = 0;  // until all is found
    if (may_keep)
      refaced = adjacency().find_silhouette(homogeneous(light), built_->moved, silhouette_);
    else
      adjacency().find_silhouette(homogeneous(light), silhouette_);
    if (!refaced.empty()) {
      caps_.erase(std::ranges::lower_bound(caps_, refaced.first), caps_.end());
      for (std::uint32_t t = refaced.first; t < triangle_count; ++t)
        if (silhouette_.facing[t] != 0) caps_.push_back(t);
    }
    // Sized to measure: growing by doubling would hold twice of what is most of the memory.
    const std::size_t count = silhouette_.edges.size() + caps_.size();
    if (polygons_.capacity() < count) {
      polygons_ = {};
      outlines_ = {};
      polygons_.reserve(count);
      outlines_.reserve(count);
    }
    polygons_.resize(count);
    outlines_.resize(count);
    number_ = built_->number;
  }

  /// Makes all polygons as they are seen from a start.
  void look_from(const Frame& frame) {
    for_blocks(polygons_.size(), 2048, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) is_side(k) ? make_side(frame, k) : make_cap(frame, k);
    });
  }

  std::size_t count() const { return polygons_.size(); }
  bool is_side(std::size_t k) const { return k < silhouette_.edges.size(); }
  /// The triangle of a light cap, counted over the scene.
  std::uint32_t cap(std::size_t k) const { return caps_[k - silhouette_.edges.size()]; }
  std::span<const std::uint32_t> caps() const { return caps_; }
  const Polygon& polygon(std::size_t k) const { return polygons_[k]; }
  const Outline& outline(std::size_t k) const { return outlines_[k]; }
  const EdgeAdjacency& adjacency() const { return built_->adjacency; }
  const Silhouette& silhouette() const { return silhouette_; }

  /// Of the edge of a side quad: low, high.
  std::pair<const glm::vec3&, const glm::vec3&> ends(std::size_t k) const {
    const SilhouetteEdge& edge = silhouette_.edges[k];
    return {adjacency().positions()[edge.low], adjacency().positions()[edge.high]};
  }

  /// By exact signs.
  Meeting meet(std::size_t k, const glm::vec3& from, const glm::vec3& to) const {
    if (is_side(k)) return meet_side(from, to, ends(k).first, ends(k).second, silhouette_.light);
    return meet_cap(from, to, adjacency().corners(cap(k)), silhouette_.light, silhouette_.facing[cap(k)]);
  }

  /// Whether of the closed body of a triangle only the half that faces the light counts.
  bool is_half(std::uint32_t triangle) const {
    const EdgeAdjacency::Part& part = adjacency().parts()[adjacency().part_of()[triangle]];
    return adjacency().half(part, silhouette_.light) != EdgeAdjacency::Half::both;
  }

  std::size_t bytes() const {
    return static_cast<std::size_t>(built_.own(static_cast<double>(adjacency().bytes()))) + silhouette_.bytes() +
           bytes_of(caps_, polygons_, outlines_);
  }

 private:
  void make_side(const Frame& frame, std::size_t k) {
    const auto [low, high] = ends(k);
    const glm::dvec4& light = silhouette_.light;
    polygons_[k] = side_polygon(frame, low, high, light, silhouette_.edges[k].count);
    const glm::dvec4 corners[] = {glm::dvec4(frame.seen(low), 1), glm::dvec4(frame.seen(high), 1),
                                  glm::dvec4(frame.turned(extruded(low, light)), 0),
                                  glm::dvec4(frame.turned(extruded(high, light)), 0)};
    outlines_[k] = outline_of(corners);
  }
  void make_cap(const Frame& frame, std::size_t k) {
    const Triangle triangle = adjacency().corners(cap(k));
    const glm::vec3* p = triangle.points;
    polygons_[k] = cap_polygon(frame, triangle, silhouette_.facing[cap(k)]);
    const glm::dvec4 corners[] = {{frame.seen(p[0]), 1}, {frame.seen(p[1]), 1}, {frame.seen(p[2]), 1}};
    outlines_[k] = polygons_[k].step == 0 ? Outline::nowhere() : outline_of(corners);
  }

  struct Built {
    EdgeAdjacency adjacency;
    EdgeAdjacency::Moved moved;  // by the last update
    std::uint64_t number = 0;    // of the geometry: 1 more with each update, 2 more with each build
  };
  Shared<Built> built_;
  std::uint64_t number_ = 0;  // of the geometry of the last relight
  Silhouette silhouette_;
  std::vector<std::uint32_t> caps_;
  std::vector<Polygon> polygons_;
  std::vector<Outline> outlines_;
};

/// Volumes that hold a point only because of the surface that it lies on, and which therefore never shade it: those of the
/// triangles that kit/geometry/receiver.h leaves out.
class OwnVolumes {
 public:
  /// Both arguments must outlive the volumes.
  void build(const Scene& scene, const TriangleNumbers& numbers) {
    scene_ = &scene;
    numbers_ = &numbers;
    curved_.clear();
    for (const Mesh& mesh : scene.meshes) curved_.push_back(curved(mesh));
  }
  void update(const Changes& changes) {
    for (std::size_t m = 0; m < curved_.size(); ++m)
      if (changes.meshes[m].kind != MeshChange::Kind::still) curved_[m] = curved(scene_->meshes[m]);
  }

  NumberedReceiver surface(const GBuffer& gbuffer, std::size_t i) const {
    return numbers_->numbered(receiver_at(*scene_, gbuffer, i));
  }

  /// Whether the volume of a triangle holds the point, seen from the start that the volumes were counted from: where the way to
  /// the light goes exactly through an edge, the point is taken a vanishing step nearer to the start, as the count takes it.
  static bool holds(const Volumes& volumes, std::uint32_t triangle, const glm::vec3& point, const glm::vec3& start) {
    const Silhouette& silhouette = volumes.silhouette();
    const Triangle t = volumes.adjacency().corners(triangle);
    const glm::vec3* p = t.points;
    if (silhouette.facing[triangle] == 0) return false;
    if (orient3d_sign(p[0], p[1], p[2], point) != -silhouette.facing[triangle]) return false;
    int turns = 0;
    for (int k = 0; k < 3; ++k) {
      const int turn = orient3d_sign(point, p[k], p[(k + 1) % 3], silhouette.light);
      turns += turn != 0 ? turn : orient3d_sign(start, p[k], p[(k + 1) % 3], silhouette.light);
    }
    return std::abs(turns) == 3;
  }

  /// Calls visit(triangle) for those that hold the point. Returns whether the point lies behind the plane of its own triangle,
  /// as the light sees it, so that there may be any. `near` are light caps that ways from the start to the point and its
  /// neighbors may cross. A way from the lit side of the own triangle crosses its plane just before a point below it, so they
  /// contain every coplanar triangle that matters, except under a grazing light (unresolved_points.h). From any other start all
  /// caps are tested.
  bool for_holding(const Volumes& volumes, const NumberedReceiver& surface, const glm::vec3& start,
                   std::span<const std::uint32_t> near, const auto& visit) const {
    const glm::dvec4& light = volumes.silhouette().light;
    const auto test = [&](std::uint32_t triangle) {
      if (holds(volumes, triangle, surface.point, start)) visit(triangle);
    };
    if (!surface.has_triangle()) {
      const BoxTree& tree = curved_[surface.mesh];
      tree.any(SegmentSlabs(Segment{surface.point, light}), 0, [&](std::uint32_t place) {
        test(surface.first_own + tree.order()[place]);
        return false;
      });
      return false;
    }
    const Triangle own = volumes.adjacency().corners(surface.first_own);
    const glm::vec3* p = own.points;
    // From the plane itself or the light's side of it, no way to the light crosses the plane.
    const int of_light = orient3d_sign(p[0], p[1], p[2], light);
    if (orient3d_sign(p[0], p[1], p[2], surface.point) * of_light >= 0) return false;
    test(surface.first_own);
    for (const std::uint32_t triangle : orient3d_sign(p[0], p[1], p[2], start) == of_light ? near : volumes.caps())
      if (!surface.is_own(triangle) && coplanar(own, volumes.adjacency().corners(triangle).points)) test(triangle);
    return true;
  }

  /// Whether the edge a b is one of what is left out.
  bool is_own_edge(const Volumes& volumes, const NumberedReceiver& surface, const glm::vec3& a, const glm::vec3& b) const {
    if (!surface.has_triangle()) {
      const std::vector<glm::vec3>& positions = scene_->meshes[surface.mesh].positions;
      return std::ranges::find(positions, a) != positions.end() && std::ranges::find(positions, b) != positions.end();
    }
    const Triangle own = volumes.adjacency().corners(surface.first_own);
    const auto on_plane = [&](const glm::vec3& p) { return coplanar(own.points[0], own.points[1], own.points[2], p); };
    return on_plane(a) && on_plane(b);
  }

  std::size_t bytes() const {
    std::size_t sum = bytes_of(curved_);
    for (const BoxTree& tree : curved_) sum += tree.bytes();
    return sum;
  }

 private:
  /// Empty where a mesh has no exact curved shape, or casts not.
  static BoxTree curved(const Mesh& mesh) {
    if (!mesh.has_curved_shape() || !mesh.casts) return {};
    std::vector<Bounds> bounds(mesh.triangles.size());
    for (std::size_t t = 0; t < bounds.size(); ++t) bounds[t].add(mesh.corners(t).points);
    return BoxTree(bounds);
  }

  const Scene* scene_ = nullptr;
  const TriangleNumbers* numbers_ = nullptr;
  std::vector<BoxTree> curved_;  // of each mesh with an exact curved shape
};

}  // namespace gnomon::crow_counting
