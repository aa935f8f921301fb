#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/painter.h>
#include <gnomon/kit/pictures/surface_detail.h>

#include <algorithm>
#include <limits>

namespace gnomon {

namespace {

constexpr std::uint32_t no_polygon = 0xffffffffu;

/// What a polygon sees of the light, from all of it to nothing.
enum class Sees { all, part, nothing };
Sees sees(const DetailPolygon& polygon) {
  return polygon.is_lit ? Sees::all : polygon.is_penumbra ? Sees::part : Sees::nothing;
}

const Swatch& swatch(Sees sees) {
  // sRGB 244, 178, 84; 112, 176, 130; 62, 96, 184.
  static const Swatch lit{"lit", {0.9047, 0.4452, 0.0887}}, penumbra{"penumbra", {0.1620, 0.4342, 0.2232}},
      shadowed{"shadowed", {0.0482, 0.1170, 0.4793}};
  return sees == Sees::all ? lit : sees == Sees::part ? penumbra : shadowed;
}

std::span<const glm::dvec3> corners_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  return std::span(detail.corners).subspan(polygon.first, polygon.count);
}

Triangle triangle_around(const Scene& scene, const DetailPolygon& polygon) {
  return scene.meshes[polygon.mesh].corners(polygon.triangle);
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

/// The polygon that each pixel shows; no_polygon where there is none, or where the pixel does not face the light, if one is
/// given.
std::vector<std::uint32_t> find_owners(const Scene& scene, const GBuffer& gbuffer, const SurfaceDetail& detail,
                                       const Light* light) {
  check_detail(scene, detail);
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  std::vector<std::uint32_t> owners(gbuffer.size(), no_polygon);
  std::vector<double> distances(gbuffer.size(), std::numeric_limits<double>::infinity());
  const auto is_curve = [&](std::uint32_t mesh) {
    return gbuffer.truth == Truth::shape && scene.meshes[mesh].has_curved_shape();
  };
  const auto offer = [&](std::size_t pixel, std::size_t polygon, double distance) {
    if (!(distance < distances[pixel])) return;
    distances[pixel] = distance;
    owners[pixel] = static_cast<std::uint32_t>(polygon);
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
      const Triangle triangle = triangle_around(scene, polygon);
      const glm::dvec3 normal = triangle.normal(), corner = triangle.points[0];
      const glm::dvec3 ray =
          camera.ray(static_cast<double>(i % gbuffer.width) + 0.5, static_cast<double>(i / gbuffer.width) + 0.5);
      const double t = glm::dot(normal, corner - camera.eye) / glm::dot(normal, ray);
      offer(i, k, glm::distance(camera.eye + t * ray, glm::dvec3(gbuffer.position(i))));
    });
  }
  const auto triangle_of = [](const DetailPolygon& p) { return std::pair(p.mesh, p.triangle); };
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i) || (light && !faces_light(scene, gbuffer, *light, i))) {
      owners[i] = no_polygon;
    } else if (owners[i] == no_polygon && !is_curve(gbuffer.mesh[i])) {
      const std::pair own(gbuffer.mesh[i], gbuffer.triangle[i]);
      auto polygon = std::ranges::lower_bound(detail.polygons, own, {}, triangle_of);
      for (; polygon != detail.polygons.end() && triangle_of(*polygon) == own; ++polygon) {
        const glm::dvec3 normal = triangle_around(scene, *polygon).normal();
        const double distance = distance_outside(corners_of(detail, *polygon), normal, gbuffer.position(i));
        offer(i, static_cast<std::size_t>(polygon - detail.polygons.begin()), distance);
      }
    }
  }
  return owners;
}

/// A tone for each polygon, 0 .. 1: multiples of the golden section for its place among the polygons of its triangle, plus
/// multiples of the inverse root of x^3 = x + 1 for the triangle. Both spread evenly, and neighbors get tones far apart.
std::vector<float> make_tones(const SurfaceDetail& detail) {
  constexpr double golden = 0.6180339887498949, plastic = 0.7548776662466927;
  std::vector<float> tones;
  tones.reserve(detail.polygons.size());
  std::size_t first = 0;  // of the triangle
  for (std::size_t k = 0; k < detail.polygons.size(); ++k) {
    const DetailPolygon &p = detail.polygons[k], &f = detail.polygons[first];
    if (p.mesh != f.mesh || p.triangle != f.triangle) first = k;
    const double turns = golden * static_cast<double>(k - first) + plastic * p.triangle;
    tones.push_back(static_cast<float>(turns - std::floor(turns)));
  }
  return tones;
}

/// The border between a pixel and the one to its right, or the one below it: of the two, the kind that is last in this list.
enum class Border { none, edge, split, shadow };

/// The borders of what pixels show, one pixel wide: seen from the pixel on their left or above.
class Borders {
 public:
  Borders(const GBuffer& gbuffer, const SurfaceDetail& detail, std::span<const std::uint32_t> owners)
      : kinds_(owners.size(), Border::none), all_(detail.polygons.size(), 0), border_(detail.polygons.size(), 0) {
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      if (a == b || a == no_polygon || b == no_polygon) return Border::none;
      const DetailPolygon &p = detail.polygons[a], &q = detail.polygons[b];
      if (p.mesh != q.mesh || p.triangle != q.triangle) return Border::edge;
      return sees(p) == sees(q) ? Border::split : Border::shadow;
    };
    const std::size_t width = gbuffer.width;
    for (std::size_t i = 0; i < owners.size(); ++i) {
      if (owners[i] == no_polygon) continue;
      if (i % width + 1 < width) kinds_[i] = between(owners[i], owners[i + 1]);
      if (i + width < owners.size()) kinds_[i] = std::max(kinds_[i], between(owners[i], owners[i + width]));
      ++all_[owners[i]];
      border_[owners[i]] += kinds_[i] != Border::none;
    }
  }

  Border kind(std::size_t i) const { return kinds_[i]; }
  /// Twice the share of the polygon that borders leave free, 1 at most.
  double room(std::uint32_t polygon) const {
    return std::clamp(2.0 * (all_[polygon] - border_[polygon]) / all_[polygon], 0.0, 1.0);
  }

 private:
  std::vector<Border> kinds_;
  std::vector<std::uint32_t> all_, border_;  // pixels of each polygon
};

const Swatch& swatch(Border border) {
  // sRGB 80, 165, 255; 255, 205, 45; 255, 60, 50.
  static const Swatch edge{"edge of a triangle", {0.0802, 0.3763, 1.0}}, split{"split", {1.0, 0.6105, 0.0262}},
      shadow{"border of a shadow", {1.0, 0.0452, 0.0319}};
  return border == Border::shadow ? shadow : border == Border::split ? split : edge;
}

/// Tones and borders over the shaded scene; with shadows, dark where a polygon is shadowed, and only at points that face the
/// light.
std::vector<float> paint_borders(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail,
                                 bool with_shadows) {
  const std::vector<std::uint32_t> owners = find_owners(scene, gbuffer, detail, with_shadows ? &light : nullptr);
  std::vector<float> mask(gbuffer.size(), 1.0f);
  for (std::size_t i = 0; with_shadows && i < owners.size(); ++i)
    if (owners[i] != no_polygon)
      if (const Sees what = sees(detail.polygons[owners[i]]); what != Sees::all) mask[i] = what == Sees::part ? 0.5f : 0.0f;
  std::vector<float> picture = shaded_layer(scene, gbuffer, light, mask);
  const Borders borders(gbuffer, detail, owners);
  const std::vector<float> tones = make_tones(detail);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    const std::uint32_t k = owners[i];
    if (k == no_polygon) continue;
    const Border kind = borders.kind(i);
    const double share = kind == Border::none ? 0 : kind == Border::shadow ? 1 : borders.room(k), left = 0.7 + 0.3 * tones[k];
    for (int c = 0; c < 3; ++c) {
      float& channel = picture[3 * i + c];
      channel = static_cast<float>(glm::mix(left * channel, swatch(kind).color[c], share));
    }
  }
  return picture;
}

}  // namespace

std::vector<DebugLayer> detail_layers() {
  return {{"fragments",
           "Surface-detail polygons, lit and shadowed, in tones that differ a little from one to the next and with darker "
           "borders where there is room; what is turned away from the light or beyond its cone is gray.",
           {swatch(Sees::all), swatch(Sees::nothing)}}};
}

std::vector<DebugLayer> soft_detail_layers() {
  return {{"fragments",
           "Surface-detail polygons that see all of the light, a part of it (penumbra) or nothing, in tones that differ a "
           "little from one to the next and with darker borders where there is room; what is turned away from the light is "
           "gray.",
           {swatch(Sees::all), swatch(Sees::part), swatch(Sees::nothing)}}};
}

void check_detail(const Scene& scene, const SurfaceDetail& detail) {
  const DetailPolygon* before = nullptr;
  for (const DetailPolygon& p : detail.polygons) {
    const auto k = static_cast<std::size_t>(&p - detail.polygons.data());
    if (p.mesh >= scene.meshes.size())
      throw Error("surface-detail polygon {} is of mesh {}; the scene has {}", k, p.mesh, scene.meshes.size());
    if (p.is_lit && p.is_penumbra)
      throw Error("surface-detail polygon {} is lit and in the penumbra; one of the two is allowed", k);
    if (const std::size_t count = scene.meshes[p.mesh].triangles.size(); p.triangle >= count)
      throw Error("surface-detail polygon {} is of triangle {}; mesh {} has {}", k, p.triangle, p.mesh, count);
    if (p.count < 3) throw Error("surface-detail polygon {} has {} corners; three at least are required", k, p.count);
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
  const std::vector<std::uint32_t> owners = find_owners(scene, gbuffer, detail, &light);
  std::vector<float> picture = shaded_layer(scene, gbuffer, light, std::vector<float>(gbuffer.size(), 1.0f));
  const Borders borders(gbuffer, detail, owners);
  const std::vector<float> tones = make_tones(detail);
  constexpr double left_on_border = 0.4;
  const glm::dvec3 eye = gbuffer.view.eye;
  for (std::size_t i = 0; i < owners.size(); ++i) {
    const std::uint32_t k = owners[i];
    if (k == no_polygon) continue;
    const glm::dvec3 to_eye = glm::normalize(eye - glm::dvec3(gbuffer.position(i)));
    double brightness = (1 - 0.3 * tones[k]) * (0.7 + 0.3 * std::abs(glm::dot(glm::dvec3(gbuffer.normal(i)), to_eye)));
    if (borders.kind(i) != Border::none) brightness *= 1 - (1 - left_on_border) * borders.room(k);
    const glm::dvec3 color = brightness * swatch(sees(detail.polygons[k])).color;
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(color[c]);
  }
  return picture;
}

DebugLayer splits_layer() {
  return {"splits",
          "Where polygons of the scene are divided, before parts that are alike are joined again: over the shaded picture, the "
          "edges of triangles, the borders between a triangle's lit, half lit and shadowed parts, and all other splits; darker "
          "in shadow.",
          {swatch(Border::edge), swatch(Border::shadow), swatch(Border::split)}};
}

std::vector<float> paint_splits(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail) {
  return paint_borders(scene, gbuffer, light, detail, true);
}

std::vector<float> paint_division(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail) {
  return paint_borders(scene, gbuffer, light, detail, false);
}

}  // namespace gnomon
