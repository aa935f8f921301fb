#pragma once
#include <gnomon/scene.h>

namespace gnomon {

/// Segments around a curved shape where a scene does not say how many.
inline constexpr int default_segments = 64;

/// The triangles of a shape, counter-clockwise seen from outside, with `shape` set and facts measured. Curved shapes are
/// inscribed: vertices lie on the shape, `segments` (3 .. 4096) around, half as many from pole to pole on a sphere.
/// Sphere, cone and box come out closed. A disc and a plane are one-sided sheets facing their normal (u cross v).
/// Throws Error on a shape without extent (zero radius, height, axis, normal or area), or with a coordinate that is not finite.
Mesh tessellate(const Shape& shape, int segments, std::string name);

/// Throws Error as above; `where` opens the text.
void check(const Shape& shape, const std::string& where);

// Builders for scenes.

/// A horizontal square around the origin at y = 0, facing up.
Plane ground_plane(float half_side);

/// A square light that lies level, its sides along x and z.
RectLight level_square(const glm::vec3& center, double side);

/// Closed solid: the convex `outline` (in one plane, counter-clockwise seen from the far end) swept along `sweep`.
Mesh prism(std::span<const glm::dvec3> outline, const glm::dvec3& sweep, std::string name);

/// Closed cylinder as a prism inscribed in the round one: there is no exact cylinder among the shapes.
Mesh cylinder(const glm::dvec3& base, const glm::dvec3& sweep, double radius, int segments, std::string name);

/// All parts as one mesh without a shape.
Mesh merge(std::span<const Mesh> parts, std::string name);

/// The same mesh in another color (linear).
Mesh painted(Mesh mesh, const glm::vec3& albedo);

}  // namespace gnomon
