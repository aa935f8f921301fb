#pragma once
#include <gnomon/alpha_mask.h>
#include <gnomon/light.h>
#include <gnomon/motion.h>
#include <gnomon/transmission.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

// World space everywhere: right-handed, +y up, meters. Geometry is float32, rounded once at load, so that every technique
// sees the very same points. The loader never recenters.

struct Sphere {
  glm::vec3 center{0};
  float radius = 1;
};
/// Solid cone: base disc and lateral surface; the peak is at base + height * axis.
struct Cone {
  glm::vec3 base{0};
  glm::vec3 axis{0, 1, 0};  ///< any length but zero; used normalized
  float radius = 1, height = 1;
};
struct Disc {
  glm::vec3 center{0};
  glm::vec3 normal{0, 1, 0};  ///< any length but zero; used normalized
  float radius = 1;
};
struct Triangle {
  glm::vec3 points[3];
  /// On the side where the corners run counter-clockwise; as long as twice the area.
  glm::dvec3 normal() const {
    const glm::dvec3 a(points[0]);
    return glm::cross(glm::dvec3(points[1]) - a, glm::dvec3(points[2]) - a);
  }
};
/// Finite rectangle center +- half_u +- half_v.
struct Plane {
  glm::vec3 center{0}, half_u{1, 0, 0}, half_v{0, 0, 1};
};
struct Box {
  glm::vec3 min{0}, max{1};
};
using Shape = std::variant<Sphere, Cone, Disc, Triangle, Plane, Box>;

/// "sphere", "cone", "disc", "triangle", "plane", "box".
std::string_view kind_name(const Shape& shape);

/// Whether the tessellation differs from the shape. Flat shapes (triangle, plane, box) are their triangles exactly.
bool is_curved(const Shape& shape);

/// Largest absolute coordinate of a point.
inline double extent(const glm::dvec3& p) {
  const glm::dvec3 a = glm::abs(p);
  return glm::max(glm::max(a.x, a.y), a.z);
}

struct Bounds {
  glm::vec3 min{INFINITY}, max{-INFINITY};
  void add(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add(std::span<const glm::vec3> points) {
    for (const glm::vec3& p : points) add(p);
  }
  void add(const Bounds& other) {
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
  }
  bool empty() const { return min.x > max.x; }
  /// Whether a point is inside or on the border.
  bool holds(const glm::dvec3& p) const {
    return glm::all(glm::lessThanEqual(glm::dvec3(min), p)) && glm::all(glm::lessThanEqual(p, glm::dvec3(max)));
  }
  /// Largest absolute coordinate of its points; 0 when empty.
  double extent() const { return empty() ? 0 : gnomon::extent(glm::max(glm::abs(min), glm::abs(max))); }
};

/// Measured at load on vertices welded by exact position.
struct MeshFacts {
  std::size_t boundary_edge_count = 0;     ///< edges with one triangle
  std::size_t nonmanifold_edge_count = 0;  ///< edges with more than two
  std::size_t misoriented_edge_count = 0;  ///< two-triangle edges whose two directions agree
  std::size_t degenerate_count = 0;        ///< triangles dropped at load: zero area, or a repeated vertex
  bool closed() const { return boundary_edge_count == 0 && nonmanifold_edge_count == 0 && misoriented_edge_count == 0; }
};

struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;  ///< counter-clockwise seen from outside, where the mesh has an outside
  bool casts = true;
  bool receives = true;
  glm::vec3 albedo{0.7f};      ///< linear
  std::optional<Shape> shape;  ///< exact shape beside the tessellation; a flat one where there are masks or glass
  MeshFacts facts;
  /// Where the triangles are solid; null: everywhere. Other meshes may share it.
  std::shared_ptr<const AlphaMask> alpha_mask;
  /// What part of the light its solid parts let through; null: nothing. Other meshes may share it. It casts, two-sided.
  std::shared_ptr<const Transmission> transmission;
  /// Of a mesh that moves: of all places to which its row's frames bring it. Empty: of its positions.
  Bounds reach;
  bool seen = true;           ///< by the eye; otherwise the mesh only casts
  std::vector<glm::vec2> uv;  ///< places in alpha mask and transmission, one for each position; empty where neither has texels

  Triangle corners(std::size_t triangle) const {
    const glm::uvec3& t = triangles[triangle];
    return {{positions[t.x], positions[t.y], positions[t.z]}};
  }
  /// What a light's frustum must hold, so that it stays the same while the mesh moves: its reach, else the bounds of its
  /// positions.
  Bounds reached() const;
  /// Whether mesh truth and shape truth differ.
  bool has_curved_shape() const { return shape && is_curved(*shape); }
  /// Whether it has an inside: a surface with holes or of glass has none, however its triangles meet.
  bool is_closed() const { return !alpha_mask && !transmission && facts.closed(); }
  /// Whether its places in a picture count: `uv` has one for each position.
  bool needs_uv() const { return alpha_mask || (transmission && !transmission->is_constant()); }
};

/// Pinhole camera. The image plane is perpendicular to target - eye; `up` gives its upward side.
struct View {
  std::string name = "view";
  glm::vec3 eye{0, 0, 5}, target{0}, up{0, 1, 0};
  float fov_y_degrees = 45;
  float exposure = 0;  ///< what irradiance is multiplied by in pictures, m2/W; 0: by exposure_of, from what is lit
};

/// A motion of the camera's eye or of one light through key positions, or of meshes by the scene's animation of that name, as a
/// row of still frames.
struct Path {
  enum class Moves { camera, light, geometry };
  std::string name;
  Moves moves = Moves::camera;
  std::vector<glm::vec3> positions = {};  ///< two or more, passed at equal steps of time; none where geometry moves
  int frame_count = 2;
  double start = 0, frame_rate = 60;  ///< of the animation: seconds at frame 0, frames per second
};

struct Scene {
  std::string name;
  float ambient = 0.15f;  ///< constant ambient term of the shaded picture
  std::vector<Mesh> meshes;
  std::vector<Light> lights;  ///< at least one, names unique
  std::vector<View> views;    ///< at least one, names unique
  std::vector<Path> paths;    ///< motions for suites that request them; names unique
  /// How meshes move; null: they stand still. Positions are those of the rest pose, as the file has it.
  std::shared_ptr<const Motion> motion;
  std::uint64_t pose_number = 0;   ///< raised whenever positions change in place
  std::vector<std::string> notes;  ///< what the loader did on its own account: framing camera, dropped triangles, ...

  std::size_t triangle_count() const;
  /// Of all vertices, casters and receivers alike.
  Bounds bounds() const;
  bool has_curved_shapes() const;
  /// Whether a mesh has an alpha mask.
  bool has_alpha_masks() const;
  /// Whether a caster lets light through, and whether one colors it.
  bool has_transmission() const;
  bool has_colored_transmission() const;
};

/// Largest absolute coordinate of vertices, eye and finite light: the scale of float32 rounding in this scene.
double extent(const Scene& scene, const Light& light, const View& view);

/// Which geometry is true: the exact shapes where a mesh has one, or the triangles everywhere.
enum class Truth { shape, mesh };
inline constexpr std::string_view name(Truth truth) { return truth == Truth::shape ? "shape" : "mesh"; }

/// For each vertex the first one at exactly its position; minus zero is zero. Where `wanted` is given, one for each vertex,
/// only those count that are: the others are left alone.
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions, std::span<const std::uint8_t> wanted = {});

/// Counts boundary, non-manifold and misoriented edges after welding by exact position.
MeshFacts measure_facts(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles);

/// Whether corners lie on one line. Exact: the cross product is evaluated so that only truly collinear float32 corners do.
bool is_degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

/// Drops triangles that are degenerate: of zero area, or with a repeated vertex position. Then measures the facts.
void finish(Mesh& mesh);

}  // namespace gnomon
