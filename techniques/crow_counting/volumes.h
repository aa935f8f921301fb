#pragma once
#include <gnomon/kit/edges.h>
#include <gnomon/kit/parallel.h>

#include "polygon.h"

namespace gnomon::crow_counting {

/// The polygons of all shadow volumes of a scene and a light: the side quads of the silhouette, then the light caps, which are
/// the triangles that face the light. A side quad is there once and counts for its edge's count.
class Volumes {
 public:
  void build(const Scene& scene) { adjacency_ = EdgeAdjacency(scene); }

  void relight(const Light& light) {
    adjacency_.find_silhouette(homogeneous(light), silhouette_);
    caps_.clear();
    for (std::uint32_t t = 0; t < silhouette_.facing.size(); ++t)
      if (silhouette_.facing[t] != 0) caps_.push_back(t);
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
  const EdgeAdjacency& adjacency() const { return adjacency_; }
  const Silhouette& silhouette() const { return silhouette_; }

  struct Ends {
    const glm::vec3 &low, &high;
  };
  Ends ends(std::size_t k) const {
    const SilhouetteEdge& edge = silhouette_.edges[k];
    return {adjacency_.positions()[edge.low], adjacency_.positions()[edge.high]};
  }
  Triangle corners(std::uint32_t triangle) const {
    const glm::uvec3& t = adjacency_.triangles()[triangle];
    return {{adjacency_.positions()[t.x], adjacency_.positions()[t.y], adjacency_.positions()[t.z]}};
  }

  /// By exact signs.
  Meeting meet(std::size_t k, const glm::vec3& from, const glm::vec3& to) const {
    if (is_side(k)) return meet_side(from, to, ends(k).low, ends(k).high, silhouette_.light);
    return meet_cap(from, to, corners(cap(k)), silhouette_.light, silhouette_.facing[cap(k)]);
  }

  std::size_t bytes() const {
    const auto held = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return adjacency_.bytes() + silhouette_.bytes() + held(caps_) + held(polygons_) + held(outlines_);
  }

 private:
  void make_side(const Frame& frame, std::size_t k) {
    const auto [low, high] = ends(k);
    const glm::dvec4& light = silhouette_.light;
    polygons_[k] = side_polygon(frame, low, high, light, silhouette_.edges[k].count);
    const glm::dvec4 corners[] = {{frame.seen(low), 1},
                                  {frame.seen(high), 1},
                                  {frame.turned(extruded(low, light)), 0},
                                  {frame.turned(extruded(high, light)), 0}};
    outlines_[k] = outline_of(corners);
  }
  void make_cap(const Frame& frame, std::size_t k) {
    const Triangle triangle = corners(cap(k));
    const glm::vec3* p = triangle.points;
    polygons_[k] = cap_polygon(frame, triangle, silhouette_.facing[cap(k)]);
    const glm::dvec4 corners[] = {{frame.seen(p[0]), 1}, {frame.seen(p[1]), 1}, {frame.seen(p[2]), 1}};
    outlines_[k] = polygons_[k].step == 0 ? Outline::nowhere() : outline_of(corners);
  }

  EdgeAdjacency adjacency_;
  Silhouette silhouette_;
  std::vector<std::uint32_t> caps_;
  std::vector<Polygon> polygons_;
  std::vector<Outline> outlines_;
};

}  // namespace gnomon::crow_counting
