#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/scene.h>

#include <array>
#include <cstdint>
#include <vector>

namespace gnomon::radiosity {

/// A flat piece of a surface: all places corner + s * u + t * v with s and t in 0 .. 1, of a triangle with s + t <= 1 besides.
/// World space, meters, in double.
struct Face {
  glm::dvec3 corner, u, v;
  glm::dvec3 normal{0};  ///< unit; on the front, where the corners run counter-clockwise as wound
  bool is_triangle = false;
  std::uint32_t mesh = 0;
  std::array<std::uint32_t, 2> triangles{};  ///< of the mesh: that with s + t <= 1, and of a parallelogram the other one

  glm::dvec3 at(const glm::dvec2& place) const { return corner + place.x * u + place.y * v; }
  /// The place whose point is nearest in the face's plane.
  glm::dvec2 place_of(const glm::dvec3& point) const;
  double area() const { return glm::length(glm::cross(u, v)) * (is_triangle ? 0.5 : 1); }
  std::uint32_t triangle_at(const glm::dvec2& place) const { return triangles[!is_triangle && place.x + place.y > 1]; }
};

/// All surfaces of a scene. Two triangles of a mesh that are a parallelogram together, to rounding of float32, are one face;
/// one without area has none.
class Faces {
 public:
  explicit Faces(const Scene& scene);
  const std::vector<Face>& all() const { return faces_; }
  const Face& operator[](std::size_t i) const { return faces_[i]; }
  std::size_t size() const { return faces_.size(); }
  std::uint32_t face_of(std::uint32_t mesh, std::uint32_t triangle) const { return face_of_[first_[mesh] + triangle]; }
  std::size_t bytes() const { return bytes_of(faces_, face_of_, first_); }

 private:
  void add_mesh(const Mesh& mesh, std::uint32_t index);
  std::vector<Face> faces_;
  std::vector<std::uint32_t> first_;    // of each mesh, in face_of_
  std::vector<std::uint32_t> face_of_;  // by triangle of the scene
};

}  // namespace gnomon::radiosity
