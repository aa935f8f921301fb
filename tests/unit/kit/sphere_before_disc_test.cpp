// A sphere before a disc light, in closed form: exact shares of its triangles and rays to the exact sphere.
//
// The point is the origin, its normal +z. From there a sphere of radius r around (0, 0, d) covers a cone of half angle
// asin(r / d), which meets the plane z = D of the light in a circle around (0, 0, D) of radius
//   q = D tan(asin(r / d)) = D r / sqrt(d^2 - r^2).
// The light is a disc of radius R around (e, 0, D): what is covered of its area is where two circles overlap, the lens
//   R^2 acos((e^2 + R^2 - q^2) / 2eR) + q^2 acos((e^2 + q^2 - R^2) / 2eq) - sqrt((q+R-e)(e+q-R)(e-q+R)(e+q+R)) / 2,
// or, inside each other, the smaller one. Irradiance (over pi, for radiance 1): a whole cone around the normal gives the square
// of its sine, (r / d)^2; a disc parallel to the surface gives (1 - (D^2 + e^2 - R^2) / sqrt((D^2 + e^2 + R^2)^2 - 4 R^2 e^2))
// / 2.
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gnomon::sphere_before_disc_test {

constexpr double d = 1.5, D = 3, R = 0.75;
constexpr glm::dvec3 up(0, 0, 1);

double covered_radius(double r) { return D * r / std::sqrt(d * d - r * r); }

/// Share of the light's area that is seen.
double area_seen(double r, double e) {
  const double q = covered_radius(r), whole = std::numbers::pi * R * R;
  if (e + q <= R) return 1 - q * q / (R * R);
  if (e + R <= q) return 0;
  if (e >= q + R) return 1;
  const double lens = R * R * std::acos((e * e + R * R - q * q) / (2 * e * R)) +
                      q * q * std::acos((e * e + q * q - R * R) / (2 * e * q)) -
                      0.5 * std::sqrt((q + R - e) * (e + q - R) * (e - q + R) * (e + q + R));
  return 1 - lens / whole;
}

/// Share of its irradiance, where all of the cone goes to the light.
double irradiance_seen(double r, double e) {
  const double sum = D * D + e * e + R * R;
  const double disc = 0.5 * (1 - (D * D + e * e - R * R) / std::sqrt(sum * sum - 4 * R * R * e * e));
  return 1 - r * r / (d * d) / disc;
}

Light light_at(double e) { return {.kind = DiscLight{{e, 0, D}, up, R}}; }

Scene ball(double r) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, d}, static_cast<float>(r)}, 128, "ball")};
  return scene;
}

/// Radius of the largest ball around the sphere's center inside its triangles.
double inner_radius(const Mesh& mesh) {
  double least = d;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle c = mesh.corners(t);
    const glm::dvec3 a(c.points[0]), normal = glm::cross(glm::dvec3(c.points[1]) - a, glm::dvec3(c.points[2]) - a);
    least = std::min(least, glm::dot(glm::normalize(normal), a - glm::dvec3(0, 0, d)));
  }
  return least;
}

struct Place {
  double r, e;
  bool is_inside;  ///< the whole cone goes to the light
};
// Circles of radius 0.251 and 1.06 in the light's plane: concentric, inside, crossing, around the light, beside it.
constexpr Place places[] = {{0.125, 0, true},      {0.125, 0.25, true}, {0.125, 0.625, false},
                            {0.125, 0.875, false}, {0.125, 1.5, false}, {0.5, 0.25, false},
                            {0.5, 0.5, false},     {0.5, 1.25, false},  {0.5, 1.75, false}};

// The triangles lie within the sphere and around a smaller ball, so that the share they leave is between those of both balls;
// bounds of a round light add to that.
TEST(SphereBeforeDisc, exact_shares_of_the_triangles_lie_between_two_spheres) {
  int partly = 0;
  for (const auto& [r, e, is_inside] : places) {
    const Scene scene = ball(r);
    const double inner = inner_radius(scene.meshes[0]);
    ASSERT_GT(inner, 0.999 * r);
    LightPieces pieces;
    AreaTally tally;
    const LightShares shares = AreaScene(scene).seen({}, LightFigure(light_at(e), {}, up), pieces, tally);
    const double least = area_seen(r, e), most = area_seen(inner, e);
    EXPECT_LE(shares.area.low, most + 1e-12) << r << ", " << e;
    EXPECT_GE(shares.area.high, least - 1e-12) << r << ", " << e;
    EXPECT_GE(shares.area.best, least - 2e-6) << r << ", " << e;
    EXPECT_LE(shares.area.best, most + 2e-6) << r << ", " << e;
    EXPECT_LT(most - least, 0.002);
    partly += least > 0 && least < 1;
    if (!is_inside) continue;
    EXPECT_GE(shares.irradiance.best, irradiance_seen(r, e) - 2e-6) << r << ", " << e;
    EXPECT_LE(shares.irradiance.best, irradiance_seen(inner, e) + 2e-6) << r << ", " << e;
  }
  EXPECT_EQ(partly, 7);
}

// Twenty seeds of each place. Of 220 differences of seven degrees of freedom one is beyond 9 standard errors once in 100 times;
// their mean is 0 within five times what 0.0005 allows.
TEST(SphereBeforeDisc, rays_to_the_exact_sphere_find_the_closed_form) {
  constexpr int seeds = 20;
  for (const auto& [r, e, is_inside] : places) {
    const Scene scene = ball(r);
    const RayScene casters(scene, Truth::shape, RayScene::Which::casters);
    const glm::vec3 lift(0, 0, 1e-6f);
    const LightFigure face(light_at(e), {}, up);
    const FaceRays rays(casters, lift, lift, no_mesh, 0, face);
    double area = 0, irradiance = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      const SampledShares shares = sample_shares(rays, static_cast<std::uint64_t>(seed), {.error = 0.0005, .cap = 1 << 16});
      EXPECT_LE(shares.area_error, 0.0005);
      EXPECT_LE(std::abs(shares.area - area_seen(r, e)), 9 * shares.area_error) << r << ", " << e;
      if (is_inside) {
        EXPECT_LE(std::abs(shares.irradiance - irradiance_seen(r, e)), 9 * shares.irradiance_error) << r << ", " << e;
      }
      area += shares.area / seeds;
      irradiance += shares.irradiance / seeds;
    }
    EXPECT_NEAR(area, area_seen(r, e), 5 * 0.0005 / std::sqrt(seeds)) << r << ", " << e;
    if (is_inside) {
      EXPECT_NEAR(irradiance, irradiance_seen(r, e), 5 * 0.0005 / std::sqrt(seeds)) << r << ", " << e;
    }
  }
}

}  // namespace gnomon::sphere_before_disc_test
