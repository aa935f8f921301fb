#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/rays/rays.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "kit/rays/embree.h"
#include "kit/rays/ray_filters.h"
#include "kit/rays/tree_sample.h"

// What a RayScene holds. rays.cpp queries it, ray_build.cpp makes it, ray_update.cpp lets it follow a scene that moves.
namespace gnomon {

/// The geometry that Embree traces in place of a mesh with an exact curved shape.
struct ShapeGeometry {
  Shape shape;
  std::uint32_t mesh;
};

/// A mesh of which Embree traces the triangles.
struct TracedMesh {
  std::uint32_t mesh = 0;
  bool moves = false;                          ///< its tree is refitted
  std::vector<std::uint32_t> degenerate = {};  ///< triangles without area, ascending; of scenes that may move alone
  TreeSample sample = {};                      ///< of one that moves
  double built_cost = 0;                       ///< of the sample, when the tree was built
};

/// The triangles of a mesh that have no area, ascending.
std::vector<std::uint32_t> degenerate_triangles(const Mesh& mesh);
/// Gives a geometry the triangles of a mesh. One without area gets its first corner three times: Embree's normal of it is then
/// exactly 0, which it takes for no hit. That of three places in a line is what float32 rounds, and may be hit.
void set_triangles(RTCGeometry geometry, const Mesh& mesh, std::span<const std::uint32_t> degenerate);

struct RayScene::Body {
  const Scene* source = nullptr;
  Truth truth = Truth::shape;
  Which which = Which::seen;
  Trees trees = Trees::fixed;
  double still_extent = 0;              ///< largest coordinate of meshes without a reach
  double scale = 1;                     ///< of the world to the frame that is traced
  bool has_masks = false;               ///< of a mesh that is traced
  bool has_transmission = false;        ///< the same
  std::atomic<std::int64_t> bytes = 0;  ///< Embree counts them per device, so every RayScene has one of its own
  std::optional<std::int64_t> bytes_of_one_thread;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<std::unique_ptr<ShapeGeometry>> shapes;
  std::vector<TracedMesh> meshes;
  std::unique_ptr<std::once_flag> is_joined = std::make_unique<std::once_flag>();
  EdgeAdjacency adjacency;

  /// Of a scene, built. Throws Error with what Embree reports.
  static std::shared_ptr<Body> built(const Scene& scene, Truth truth, Which which, Trees trees);
  Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  ~Body() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  FilterContext context(const Receivers& receivers = {}) const {
    return {.receivers = receivers, .masked = has_masks || has_transmission ? source : nullptr, .scale = scale};
  }
  /// Hits that the filter excludes, if there is one, left out.
  Hit closest(const glm::dvec3& origin, const glm::dvec3& direction, RTCFilterFunctionN filter) const;
  /// By Embree, and in `meshes` for what moves.
  std::int64_t bytes_held() const;
  /// Refits and builds trees of meshes that moved. Answers false where all must be built anew; nothing has happened then.
  bool follow(const Changes& changes);

 private:
  void build();
  void add_shape(std::uint32_t index);
  void add_triangles(std::uint32_t index);
  void attach(RTCGeometry geometry, std::uint32_t index);
  /// Writes so many of the mesh's positions to where Embree reads them.
  void write(const Mesh& mesh, std::size_t first, std::size_t count, glm::vec3* vertices) const;
  /// Throws Error with what Embree reports.
  void commit();
  bool can_follow(const Changes& changes) const;
  void refit(TracedMesh& traced, const MeshChange& change);
};

}  // namespace gnomon
