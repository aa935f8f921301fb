#include <gnomon/error.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/painter.h>
#include <gnomon/kit/surface_detail.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon {

namespace {

constexpr std::uint32_t nobody = 0xffffffffu;

const Swatch& swatch(bool is_lit) {
  // sRGB 244, 178, 84 and 62, 96, 184.
  static const Swatch lit{"lit", {0.9047, 0.4452, 0.0887}}, shadowed{"shadowed", {0.0482, 0.1170, 0.4793}};
  return is_lit ? lit : shadowed;
}

std::span<const glm::dvec3> corners_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  return std::span(detail.corners).subspan(polygon.first, polygon.count);
}

struct Face {
  glm::dvec3 normal, point;
};

Face face_of(const Scene& scene, const DetailPolygon& polygon) {
  const Mesh& mesh = scene.meshes[polygon.mesh];
  const glm::uvec3& t = mesh.triangles[polygon.triangle];
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  return {glm::cross(b - a, c - a), a};
}

/// How far a point of the plane lies outside a convex polygon, at least: the largest distance from the line of an edge.
double distance_outside(std::span<const glm::dvec3> corners, const glm::dvec3& normal, const glm::dvec3& point) {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 edge = corners[k + 1 < corners.size() ? k + 1 : 0] - corners[k], outward = glm::cross(edge, normal);
    if (const double length = glm::length(outward); length > 0)
      largest = std::max(largest, glm::dot(outward, point - corners[k]) / length);
  }
  return largest;
}

/// The polygon that each pixel shows, or nobody.
std::vector<std::uint32_t> find_owners(const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                       const SurfaceDetail& detail) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  std::vector<std::uint32_t> owners(gbuffer.size(), nobody);
  std::vector<double> distances(gbuffer.size(), std::numeric_limits<double>::infinity());
  const auto is_curve = [&](std::uint32_t mesh) {
    return gbuffer.truth == Truth::shape && scene.meshes[mesh].has_curved_shape();
  };
  Painter painter(camera);
  for (std::uint32_t k = 0; k < detail.polygons.size(); ++k) {
    const DetailPolygon& polygon = detail.polygons[k];
    const bool is_on_curve = is_curve(polygon.mesh);
    for_covered_pixels(painter, corners_of(detail, polygon), [&](std::size_t i) {
      if (gbuffer.mesh[i] != polygon.mesh) return;
      if (!is_on_curve) {
        if (gbuffer.triangle[i] == polygon.triangle) owners[i] = k;
        return;
      }
      const Face face = face_of(scene, polygon);
      const glm::dvec3 ray =
          camera.ray(static_cast<double>(i % gbuffer.width) + 0.5, static_cast<double>(i / gbuffer.width) + 0.5);
      const double t = glm::dot(face.normal, face.point - camera.eye) / glm::dot(face.normal, ray);
      const double distance = glm::distance(camera.eye + t * ray, glm::dvec3(gbuffer.position(i)));
      if (distance < distances[i]) distances[i] = distance, owners[i] = k;
    });
  }
  const auto triangle_of = [](const DetailPolygon& p) { return std::pair(p.mesh, p.triangle); };
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      owners[i] = nobody;
    } else if (owners[i] == nobody && !is_curve(gbuffer.mesh[i])) {
      const auto own =
          std::ranges::equal_range(detail.polygons, std::pair(gbuffer.mesh[i], gbuffer.triangle[i]), {}, triangle_of);
      for (const DetailPolygon& polygon : own) {
        const double distance =
            distance_outside(corners_of(detail, polygon), face_of(scene, polygon).normal, gbuffer.position(i));
        if (distance < distances[i])
          distances[i] = distance, owners[i] = static_cast<std::uint32_t>(&polygon - detail.polygons.data());
      }
    }
  }
  return owners;
}

}  // namespace

std::vector<DebugLayer> detail_layers() {
  return {{"fragments",
           "Surface-detail polygons, lit and shadowed, in tones that differ a little from one to the next and with darker "
           "borders where there is room; what is turned away from the light or beyond its cone is gray.",
           {swatch(true), swatch(false)}}};
}

void check_detail(const Scene& scene, const SurfaceDetail& detail) {
  const DetailPolygon* before = nullptr;
  for (const DetailPolygon& p : detail.polygons) {
    const auto k = static_cast<std::size_t>(&p - detail.polygons.data());
    if (p.mesh >= scene.meshes.size())
      throw Error("surface-detail polygon {} is of mesh {}; the scene has {}", k, p.mesh, scene.meshes.size());
    if (const std::size_t count = scene.meshes[p.mesh].triangles.size(); p.triangle >= count)
      throw Error("surface-detail polygon {} is of triangle {}; mesh {} has {}", k, p.triangle, p.mesh, count);
    if (p.count < 3) throw Error("surface-detail polygon {} has {} corners; three at least are wanted", k, p.count);
    if (p.first > detail.corners.size() || p.count > detail.corners.size() - p.first)
      throw Error("surface-detail polygon {} has corners from {} to {}; there are {}", k, p.first,
                  std::uint64_t{p.first} + p.count - 1, detail.corners.size());
    for (const glm::dvec3& c : corners_of(detail, p))
      if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z))
        throw Error("surface-detail polygon {} has a corner at {}, {}, {}", k, c.x, c.y, c.z);
    if (before && std::pair(before->mesh, before->triangle) > std::pair(p.mesh, p.triangle))
      throw Error("surface-detail polygon {} of triangle {} of mesh {} comes after one of triangle {} of mesh {}", k,
                  p.triangle, p.mesh, before->triangle, before->mesh);
    before = &p;
  }
}

std::vector<float> paint_detail(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail) {
  check_detail(scene, detail);
  std::vector<float> picture = shaded_layer(scene, gbuffer, light, std::vector<float>(gbuffer.size(), 1.0f));
  const std::vector<std::uint32_t> owners = find_owners(scene, gbuffer, light, detail);

  // Borders one pixel wide: seen from the pixel on their left or above.
  const int width = gbuffer.width, height = gbuffer.height;
  const auto is_border = [&](std::size_t i) {
    const auto differs = [&](std::size_t j) { return owners[j] != nobody && owners[j] != owners[i]; };
    return (static_cast<int>(i % width) + 1 < width && differs(i + 1)) ||
           (static_cast<int>(i / width) + 1 < height && differs(i + width));
  };
  std::vector<std::uint32_t> all(detail.polygons.size(), 0), border(detail.polygons.size(), 0);
  for (std::size_t i = 0; i < owners.size(); ++i)
    if (owners[i] != nobody) ++all[owners[i]], border[owners[i]] += is_border(i);

  constexpr double golden = 0.6180339887498949, left_on_border = 0.4;
  const glm::dvec3 eye = gbuffer.view.eye;
  for (std::size_t i = 0; i < owners.size(); ++i) {
    const std::uint32_t k = owners[i];
    if (k == nobody) continue;
    // Multiples of the golden section are spread evenly, and those of neighbors lie far apart.
    const double turn = golden * k - std::floor(golden * k);
    const glm::dvec3 to_eye = glm::normalize(eye - glm::dvec3(gbuffer.position(i)));
    double brightness = (1 - 0.3 * turn) * (0.7 + 0.3 * std::abs(glm::dot(glm::dvec3(gbuffer.normal(i)), to_eye)));
    if (is_border(i)) {
      const double room = std::clamp(2.0 * (all[k] - border[k]) / all[k], 0.0, 1.0);
      brightness *= 1 - (1 - left_on_border) * room;
    }
    const glm::dvec3 color = brightness * swatch(detail.polygons[k].is_lit).color;
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(color[c]);
  }
  return picture;
}

}  // namespace gnomon
