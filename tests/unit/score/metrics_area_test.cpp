#include <gnomon/kit/geometry/camera.h>
#include <gtest/gtest.h>

#include <numbers>

#include "measure/score/score.h"
#include "small_world.h"

namespace metrics_area_test {

using namespace small_world;

/// Twice the signed area of a polygon in the plane y = 0, by the shoelace formula.
double twice_area(const std::vector<glm::dvec3>& points) {
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const glm::dvec3 &p = points[k], &q = points[(k + 1) % points.size()];
    sum += p.x * q.z - q.x * p.z;
  }
  return sum;
}

/// Where the rays through the corners of pixel i meet the plane y = 0.
std::vector<glm::dvec3> corners_on_ground(const Camera& camera, std::size_t i) {
  std::vector<glm::dvec3> corners;
  const double x = static_cast<double>(i % camera.width), y = static_cast<double>(i / camera.width);
  for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
    const glm::dvec3 ray = camera.ray(x + dx, y + dy);
    corners.push_back(camera.eye - ray * (camera.eye.y / ray.y));
  }
  return corners;
}

std::vector<double> pixel_areas(const GBuffer& gbuffer) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  std::vector<double> areas;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) areas.push_back(pixel_area(camera, gbuffer, i));
  return areas;
}

/// A rectangle on the ground.
struct Patch {
  double x0, x1, z0, z1;
  double area() const { return (x1 - x0) * (z1 - z0); }
  bool holds(const glm::dvec3& p) const { return p.x > x0 && p.x < x1 && p.z > z0 && p.z < z1; }
};

/// The ground seen by a view, every pixel of it tested.
struct Seen {
  Scene scene;
  GBuffer gbuffer;
  std::vector<PixelClass> classes;

  explicit Seen(const View& view, int width = 640, int height = 360) {
    scene.meshes = {ground(40)};
    gbuffer = small_world::make_gbuffer(scene, view, width, height);
    for (std::size_t i = 0; i < gbuffer.size(); ++i)
      classes.push_back(gbuffer.is_background(i) ? PixelClass::B : PixelClass::T);
  }
  /// `dark` where the pixel's point lies in the patch, 1 elsewhere.
  std::vector<float> mask(const Patch& patch, float dark = 0) const {
    std::vector<float> visibility;
    for (std::size_t i = 0; i < gbuffer.size(); ++i)
      visibility.push_back(!gbuffer.is_background(i) && patch.holds(gbuffer.position(i)) ? dark : 1.0f);
    return visibility;
  }
  double area(const std::vector<float>& visibility) const { return shadow_area(gbuffer, classes, visibility); }
  std::optional<double> ratio(const std::vector<float>& reference, const std::vector<float>& answer) const {
    const Evidence evidence{.width = gbuffer.width,
                            .height = gbuffer.height,
                            .classes = classes,
                            .reference = reference,
                            .mask = answer,
                            .causes = {},
                            .gbuffer = &gbuffer};
    return measure_metrics(Scoring(evidence)).at("shadow_area_ratio");
  }
  /// Pixels within the patch decide it but for those that its rim cuts. Footprints of pixels neither overlap nor leave gaps, so
  /// that the sum over dark pixels misses, of every pixel that the rim cuts, only the part that lies on the other side of the
  /// rim than its center: less than the whole. A straight rim leaves at most one half there, and the corners are four pixels.
  double bound(const Patch& patch) const {
    const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
    double sum = 0, greatest = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (gbuffer.is_background(i)) continue;
      const auto corners = corners_on_ground(camera, i);
      const auto inside = std::ranges::count_if(corners, [&](const glm::dvec3& p) { return patch.holds(p); });
      if (inside == 0 || inside == 4) continue;
      const double area = std::abs(twice_area(corners)) / 2;
      sum += area / 2;
      greatest = std::max(greatest, area);
    }
    return sum + 4 * greatest;
  }
};

/// From the front and low, and from the side and high.
const View oblique{.eye = {0, 1.5f, 7}, .target = {0, 0, 0}, .fov_y_degrees = 40};
const View other{.eye = {-5, 4, -3}, .target = {0, 0, 0}, .fov_y_degrees = 50};

TEST(shadow_area, a_pixel_covers_the_quadrilateral_that_its_corner_rays_cut_out) {
  for (const View& view : {oblique, other}) {
    const Seen seen(view, 64, 36);
    const std::vector<double> areas = pixel_areas(seen.gbuffer);
    const Camera camera(view, 64, 36);
    std::size_t flat = 0;
    for (std::size_t i = 0; i < areas.size(); ++i) {
      if (seen.gbuffer.is_background(i)) {
        EXPECT_EQ(areas[i], 0);
        continue;
      }
      if (areas[i] == 0) {
        ++flat;
        continue;
      }
      const double expected = std::abs(twice_area(corners_on_ground(camera, i))) / 2;
      EXPECT_NEAR(areas[i] / expected, 1, 1e-6) << i;  // the point is rounded to float32
    }
    EXPECT_LE(flat, 64u);
  }
}

TEST(shadow_area, on_a_plane_of_any_tilt_the_footprint_is_that_of_its_corner_rays) {
  // The scene turned as a whole, eye and all: areas do not change. Rotations are random; the points are made in double and
  // rounded.
  Random random(3);
  const Seen seen(oblique, 48, 27);
  const std::vector<double> straight = pixel_areas(seen.gbuffer);
  for (int round = 0; round < 20; ++round) {
    const glm::dvec3 y = direction_of(random), x = glm::normalize(glm::cross(y, direction_of(random))), z = glm::cross(x, y);
    const glm::dmat3 turn(x, y, z);
    GBuffer turned = seen.gbuffer;
    turned.view.eye = turn * glm::dvec3(oblique.eye);
    turned.view.target = turn * glm::dvec3(oblique.target);
    turned.view.up = turn * glm::dvec3(oblique.up);
    std::vector<float> p[3], n[3];
    for (std::size_t i = 0; i < seen.gbuffer.size(); ++i) {
      const glm::dvec3 point = turn * glm::dvec3(seen.gbuffer.position(i)), normal = turn * glm::dvec3(seen.gbuffer.normal(i));
      for (int k = 0; k < 3; ++k) p[k].push_back(static_cast<float>(point[k])), n[k].push_back(static_cast<float>(normal[k]));
    }
    turned.px = p[0], turned.py = p[1], turned.pz = p[2], turned.nx = n[0], turned.ny = n[1], turned.nz = n[2];
    const std::vector<double> areas = pixel_areas(turned);
    // Directions rounded to float32 are off by 1e-7, which counts 1 / cos of the angle to the ray, at most 100 here, thrice.
    for (std::size_t i = 0; i < areas.size(); ++i)
      if (straight[i] > 0 && straight[i] < 1) {
        EXPECT_NEAR(areas[i] / straight[i], 1, 1e-4) << round << ' ' << i;
      }
  }
}

TEST(shadow_area, a_rectangle_s_shadow_has_its_area_on_paper_at_any_slant) {
  // A plate at height 2 under a sun along (1, -1, 0.5): the shadow is the plate moved by (2, 1), 3.1 x 2.3 m.
  const Patch shadow{-1.4, 1.7, -1.2, 1.1};
  Scene scene;
  scene.meshes = {ground(40), make_mesh({{-3.4f, 2, -2.2f}, {-3.4f, 2, 0.1f}, {-0.3f, 2, 0.1f}, {-0.3f, 2, -2.2f}},
                                        {{0, 1, 2}, {0, 2, 3}})};
  const Light sun{.name = "sun", .kind = DirectionalLight{{1, -1, 0.5f}}};
  for (const View& view : {oblique, other}) {
    const Seen seen(view, 1280, 720);
    std::vector<float> traced;
    for (std::size_t i = 0; i < seen.gbuffer.size(); ++i)
      traced.push_back(
          !seen.gbuffer.is_background(i) && std::isfinite(caster_distance(scene, sun, seen.gbuffer.position(i))) ? 0.0f : 1.0f);
    const double bound = seen.bound(shadow);
    EXPECT_LT(bound, 0.025 * shadow.area()) << "or the next line would say little";
    EXPECT_NEAR(seen.area(traced), shadow.area(), bound);
    // Half the light gone from the same rectangle is half the area.
    EXPECT_DOUBLE_EQ(seen.area(seen.mask(shadow, 0.5f)), seen.area(seen.mask(shadow)) / 2);
  }
}

TEST(shadow_area, the_ratio_of_two_masks_is_that_of_their_surfaces_from_every_view) {
  // The technique's shadow is the part of the reference's that is far from the first eye: 2/5 of it. Of its pixels it is
  // another share, and another one for each eye.
  const Patch reference{-1.5, 1.5, -3, 2}, answer{-1.5, 1.5, -3, -1};
  std::vector<double> by_pixels;
  for (const View& view : {oblique, other}) {
    const Seen seen(view);
    const std::vector<float> truth = seen.mask(reference), mask = seen.mask(answer);
    EXPECT_NEAR(seen.ratio(truth, mask).value(), 0.4, 0.004);
    EXPECT_NEAR(seen.ratio(mask, truth).value(), 2.5, 0.025);
    EXPECT_EQ(seen.ratio(truth, truth), 1);
    EXPECT_NEAR(seen.ratio(truth, seen.mask(answer, 0.25f)).value(), 0.3, 0.003);
    EXPECT_EQ(seen.ratio(truth, std::vector<float>(truth.size(), 1.0f)), 0);
    by_pixels.push_back(static_cast<double>(std::ranges::count(mask, 0.0f)) / std::ranges::count(truth, 0.0f));
  }
  EXPECT_LT(by_pixels[0], 0.3);
  EXPECT_GT(by_pixels[1], 0.4);
}

TEST(shadow_area, on_a_sphere_it_is_the_area_of_the_cap) {
  // All that lies within 60 degrees of the direction to the eye: a cap of 2 pi R^2 (1 - cos 60) = pi R^2. A pixel is R / 60
  // wide and more: its footprint on the tangent plane differs from that on the sphere by the square of that. The rim is 2 pi R
  // sin 60 long, and a pixel there covers twice its width along the slope.
  constexpr int size = 360;
  constexpr double radius = 2;
  const View view{.eye = {0, 0, 9}, .target = {0, 0, 0}, .fov_y_degrees = 30};
  const Camera camera(view, size, size);
  std::vector<float> p[3], n[3], mask;
  std::vector<std::uint32_t> mesh;
  std::vector<PixelClass> classes;
  for (int i = 0; i < size * size; ++i) {
    const glm::dvec3 ray = camera.ray(i % size + 0.5, i / size + 0.5);
    const double b = glm::dot(ray, camera.eye), c = glm::dot(camera.eye, camera.eye) - radius * radius;
    const double root = b * b - glm::dot(ray, ray) * c;
    const glm::dvec3 point = root > 0 ? camera.eye + ray * ((-b - std::sqrt(root)) / glm::dot(ray, ray)) : glm::dvec3(0);
    for (int k = 0; k < 3; ++k) {
      p[k].push_back(static_cast<float>(point[k]));
      n[k].push_back(static_cast<float>(point[k] / radius));
    }
    mesh.push_back(root > 0 ? 0 : no_mesh);
    classes.push_back(root > 0 ? PixelClass::T : PixelClass::B);
    mask.push_back(point.z > radius / 2 ? 0.0f : 1.0f);
  }
  const GBuffer gbuffer{view, Truth::shape, size, size, p[0], p[1], p[2], n[0], n[1], n[2], mesh, mesh, nullptr};
  EXPECT_NEAR(shadow_area(gbuffer, classes, mask) / (std::numbers::pi * radius * radius), 1, 0.003);
}

TEST(shadow_area, is_nothing_without_a_dark_reference_or_a_g_buffer_and_looks_at_tested_pixels_only) {
  Seen seen(oblique, 64, 36);
  const Patch patch{-1, 1, -1, 1};
  const std::vector<float> lit(seen.gbuffer.size(), 1.0f), dark = seen.mask(patch);
  EXPECT_EQ(seen.ratio(lit, dark), std::nullopt);
  EXPECT_EQ(seen.ratio(lit, lit), std::nullopt);
  const Evidence blind{.width = 64, .height = 36, .classes = seen.classes, .reference = dark, .mask = dark, .causes = {}};
  EXPECT_EQ(measure_metrics(Scoring(blind)).at("shadow_area_ratio"), std::nullopt);
  // What is not of class T counts on neither side.
  const std::vector<float> left = seen.mask({-1, 0, -1, 1});
  for (std::size_t i = 0; i < lit.size(); ++i)
    if (seen.classes[i] == PixelClass::T && seen.gbuffer.px[i] > 0) seen.classes[i] = PixelClass::U;
  EXPECT_EQ(seen.ratio(dark, left), 1);
  std::ranges::fill(seen.classes, PixelClass::G);
  EXPECT_EQ(seen.ratio(dark, left), std::nullopt);
}

TEST(shadow_area, a_pixel_that_sees_its_plane_too_flatly_covers_nothing) {
  // An eye 1 above a plane that reaches to the horizon, which lies between rows 4 and 5. The distance of a corner goes as 1
  // over its rows below the horizon: in row 5 the upper corners meet the plane nowhere, in row 6 they are twice as far as the
  // lower.
  constexpr int size = 10;
  const View view{.eye = {0, 1, 0}, .target = {0, 1, -1}, .fov_y_degrees = 60};
  const Camera camera(view, size, size);
  std::vector<float> p[3], zero(size * size, 0.0f), one(size * size, 1.0f);
  std::vector<std::uint32_t> mesh;
  for (int i = 0; i < size * size; ++i) {
    const glm::dvec3 ray = camera.ray(i % size + 0.5, i / size + 0.5);
    const glm::dvec3 point = ray.y < 0 ? camera.eye - ray / ray.y : glm::dvec3(0);
    for (int k = 0; k < 3; ++k) p[k].push_back(static_cast<float>(point[k]));
    mesh.push_back(ray.y < 0 ? 0 : no_mesh);
  }
  const GBuffer gbuffer{view, Truth::mesh, size, size, p[0], p[1], p[2], zero, one, zero, mesh, mesh, nullptr};
  const std::vector<double> areas = pixel_areas(gbuffer);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) EXPECT_EQ(areas[y * size + x] > 0, y > size / 2) << x << ' ' << y;
}

}  // namespace metrics_area_test
