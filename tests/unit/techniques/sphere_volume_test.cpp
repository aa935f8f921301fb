// Shadow volumes of spheres, cones and discs against the ray tracer under shape truth.
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <numbers>

#include "device/context.h"
#include "kit/rays/shape_rays.h"
#include "measure/conformance/gl_state.h"
#include "shape_world.h"
#include "small_world.h"
#include "techniques/sphere_volume/bodies.h"

extern "C" void gnomon_technique_sphere_volume(gnomon::Registry&);
extern "C" void gnomon_technique_stencil_volume(gnomon::Registry&);

namespace sphere_volume_test {
using namespace gnomon;
namespace sv = sphere_volume;

struct ShapeWorld : shape_world::ShapeWorld {
  ShapeWorld(Scene the_scene, const View& view, int width = 160, int height = 120)
      : shape_world::ShapeWorld(std::move(the_scene), view, width, height) {}

  /// Whether the answer of rays changes when the pixel's point moves by `pixels` on the screen, in its tangent plane.
  bool near_edge(const Light& light, std::size_t i, double pixels) const {
    const glm::dvec3 p = gbuffer.position(i), n = gbuffer.normal(i), eye = gbuffer.view.eye;
    const glm::dvec3 forward = glm::normalize(glm::dvec3(gbuffer.view.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(gbuffer.view.up))), up = glm::cross(right, forward);
    const double step = 2 * std::tan(glm::radians(double(gbuffer.view.fov_y_degrees)) / 2) / gbuffer.height * pixels;
    const glm::dvec3 ray = (p - eye) / glm::dot(p - eye, forward);
    bool seen[2] = {};
    for (int k = 0; k <= 16; ++k) {
      const glm::dvec3 turned = ray + (k < 16 ? step : 0) * (right * std::cos(k * 0.3927) + up * std::sin(k * 0.3927));
      const glm::dvec3 moved = eye + turned * (glm::dot(n, p - eye) / glm::dot(n, turned));
      seen[is_dark(light, gbuffer.mesh[i], moved)] = true;
    }
    return seen[0] && seen[1];
  }
  bool is_dark(const Light& light, std::uint32_t own, const glm::dvec3& p) const {
    const glm::dvec4 l = homogeneous(light);
    const double end = l.w != 0 ? 1 : INFINITY;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (m == own || !mesh.casts || !mesh.has_curved_shape()) continue;
      if (first_hit(*mesh.shape, p, to_light(l, p), 0, end).found) return true;
    }
    Scene flat;
    for (const Mesh& mesh : scene.meshes)
      if (mesh.casts && !mesh.has_curved_shape()) flat.meshes.push_back(mesh);
    return small_world::caster_distance(flat, light, p) < INFINITY;
  }
};

class SphereVolume : public testing::Test {
 protected:
  SphereVolume() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const ShapeWorld& world, const Light& light, const std::string& settings = "") {
    return small_world::run(gnomon_technique_sphere_volume, settings, world.scene, light, world.gbuffer);
  }
  static Support supports(const Scene& scene, const Light& light) {
    Registry registry;
    gnomon_technique_sphere_volume(registry);
    return registry.techniques()[0].make()->supports(scene, light, {});
  }
};

const View view{.eye = {3, 5, 7}, .target = {0, 0.6f, 0}, .fov_y_degrees = 50};

Mesh shape_mesh(const Shape& shape) { return tessellate(shape, 24, "shape"); }

/// Spheres, cones and discs over a ground that does not cast; every third touches it. None reaches into another: each has a
/// cell of its own.
Scene random_shapes(unsigned seed) {
  Random random(seed);
  Scene scene;
  scene.meshes = {small_world::ground(6, 0, false)};
  for (int cell = 0; cell < 9; ++cell) {
    const double x = 1.6 * (cell % 3 - 1) + random.uniform(-0.2, 0.2), z = 1.6 * (cell / 3 - 1) + random.uniform(-0.2, 0.2);
    const auto radius = static_cast<float>(random.uniform(0.15, 0.5));
    const double y = random.below(3) ? random.uniform(0.6, 1.4) : 0;
    const glm::vec3 axis = y == 0 ? glm::vec3(0, 1, 0) : glm::vec3(small_world::direction_of(random));
    const std::uint32_t kind = random.below(3);
    if (kind == 0) scene.meshes.push_back(shape_mesh(Sphere{{x, y + (y == 0 ? radius : 0), z}, radius}));
    if (kind == 1)
      scene.meshes.push_back(shape_mesh(Cone{{x, y, z}, axis, radius, static_cast<float>(random.uniform(0.1, 0.5))}));
    if (kind == 2)
      scene.meshes.push_back(shape_mesh(Disc{{x, y + 0.3, z}, glm::vec3(small_world::direction_of(random)), radius}));
  }
  return scene;
}

const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1.5f, 4, 0.5f}}},
                                   {.name = "near", .kind = PointLight{{0.05f, 2.2f, 0.1f}}},
                                   {.name = "low", .kind = PointLight{{4, 0.5f, 2.5f}}},
                                   {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                   {.name = "evening", .kind = DirectionalLight{{1, -0.15f, 0.3f}}},
                                   {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}}};

struct Agreement {
  int tested = 0, dark = 0, false_dark = 0, false_lit = 0, far_dark = 0, far_lit = 0;
};

/// Pixels of class T only; `far` ones are farther than `pixels` from where the reference changes.
void compare(const ShapeWorld& world, const Light& light, std::span<const float> mask, double pixels, Agreement& t) {
  const std::vector<float> reference = world.reference(light);
  const std::vector<PixelClass> classes = world.classes(light, reference);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!faces_light(world.scene, world.gbuffer, light, i)) {
      EXPECT_EQ(mask[i], 1);
    }
    if (classes[i] != PixelClass::T) continue;
    ++t.tested;
    t.dark += reference[i] == 0;
    if (mask[i] == reference[i]) continue;
    const bool far = pixels > 0 && !world.near_edge(light, i, pixels);
    t.false_dark += mask[i] == 0;
    t.false_lit += mask[i] == 1;
    t.far_dark += far && mask[i] == 0;
    t.far_lit += far && mask[i] == 1;
  }
}

// Class T leaves out what changes when the point or the light moves by 16 * 2^-24 of the extent, a millionth: no other pixel is
// wrong, whatever touches the ground and wherever the light is.
TEST_F(SphereVolume, exact_agrees_with_rays_at_every_tested_pixel) {
  Agreement t;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const ShapeWorld world(random_shapes(seed), view);
    for (const Light& light : lights) {
      SCOPED_TRACE(fmt::format("seed {}, {}", seed, light.name));
      compare(world, light, run(world, light, "fit=exact").mask, 0, t);
      EXPECT_EQ(t.false_dark + t.false_lit, 0);
    }
  }
  EXPECT_GT(t.dark, 20000);
}

// The rasterizer moves an edge by less than 1/100 pixel; but for that, a polygon around never leaves light in the shadow, and
// one inside never darkens what is lit. At the angle t off the middle of a side, |t| <= s / 2, the radius of a polygon around
// errs by t^2 / 2, inside by t^2 / 2 - s^2 / 8, of equal area by t^2 / 2 - s^2 / 24: in the mean s^2 times 1/24, 1/12 and, in
// amount, 1/(9 sqrt(12)) = 1/31.2. So equal area errs on 0.77 of the pixels of one around and on 0.38 of those of one inside.
TEST_F(SphereVolume, polygons_err_on_their_side) {
  Agreement inside, around, equal;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ShapeWorld world(random_shapes(seed), view);
    for (const Light& light : lights) {
      SCOPED_TRACE(fmt::format("seed {}, {}", seed, light.name));
      compare(world, light, run(world, light, "fit=inscribed,segments=12").mask, 0.01, inside);
      compare(world, light, run(world, light, "fit=circumscribed,segments=12").mask, 0.01, around);
      compare(world, light, run(world, light, "fit=equal_area,segments=12").mask, 0, equal);
    }
  }
  EXPECT_EQ(inside.far_dark, 0);
  EXPECT_EQ(around.far_lit, 0);
  EXPECT_GT(inside.far_lit, 20);
  EXPECT_GT(around.far_dark, 20);
  const double wrong = equal.false_dark + equal.false_lit;
  EXPECT_NEAR(wrong / (inside.false_dark + inside.false_lit), 0.38, 0.1);
  EXPECT_NEAR(wrong / (around.false_dark + around.false_lit), 0.77, 0.15);
  RecordProperty("inscribed", inside.false_dark + inside.false_lit);
  RecordProperty("circumscribed", around.false_dark + around.false_lit);
  RecordProperty("equal_area", equal.false_dark + equal.false_lit);
}

TEST_F(SphereVolume, casters_without_a_curved_shape_cast_by_their_triangles) {
  std::mt19937 random(3);
  Scene scene;
  scene.meshes = {small_world::ground(5), tessellate(Box{{-2, 0, -1}, {-1, 1, 0.5f}}, 8, "box"),
                  small_world::random_soup(random, 12, 1.5f, 0.8f, 2.2f, 0.5f), shape_mesh(Sphere{{1.5f, 0.6f, 1}, 0.6f})};
  const ShapeWorld world(std::move(scene), view);
  for (const char* settings : {"", "fit=exact"}) {
    Agreement t;
    for (const Light& light : lights) compare(world, light, run(world, light, settings).mask, 0.02, t);
    EXPECT_GT(t.dark, 3000);
    EXPECT_LE(t.false_dark + t.false_lit, t.tested / 2000);
    if (*settings) {
      EXPECT_EQ(t.far_dark + t.far_lit, 0);  // the soup's and the box's edges are the rasterizer's
    }
  }
}

// Without a curved shape among the casters both draw the same faces: two boxes and a soup, all with fans for dark caps unless
// the light is inside their bounds, as the light `point` is in the second box.
TEST_F(SphereVolume, without_curved_casters_draws_what_stencil_volume_draws) {
  std::mt19937 random(5);
  Scene scene;
  scene.meshes = {small_world::ground(5, 0, false), small_world::box({-2, 0.1f, -1}, {-1, 1, 0.5f}),
                  small_world::box({1, 0.5f, -2}, {3, 6, 2}), small_world::random_soup(random, 12, 1.5f, 0.8f, 2.2f, 0.5f)};
  const ShapeWorld world(std::move(scene), view);
  const auto count_of = [](const Technique& technique, std::string_view name) {
    for (const Count& count : technique.counts())
      if (count.name == name) return count.value;
    return -1.0;
  };
  for (const Light& light : lights) {
    const auto ours = run(world, light);
    const auto theirs = small_world::run(gnomon_technique_stencil_volume, "", world.scene, light, world.gbuffer);
    EXPECT_EQ(count_of(*ours.technique, "triangles"), count_of(*theirs.technique, "triangles")) << light.name;
    EXPECT_EQ(count_of(*ours.technique, "fill"), count_of(*theirs.technique, "fill")) << light.name;
    EXPECT_TRUE(std::ranges::equal(ours.mask, theirs.mask)) << light.name;
  }
}

// The middle of the ground lies under 256 discs: a count modulo 256 says lit.
TEST_F(SphereVolume, two_hundred_and_fifty_six_nested_volumes_are_dark) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  for (int k = 0; k < 256; ++k) {
    scene.meshes.push_back(shape_mesh(Disc{{0, 1.5f + 0.005f * static_cast<float>(k), 0}, {0, 1, 0}, 1}));
    scene.meshes.back().receives = false;
  }
  const ShapeWorld world(std::move(scene), {.eye = {0, 0.6f, 4}, .target = {0, 0.4f, 0}});
  for (const Light& light : {lights[0], lights[3]}) {
    Agreement t;
    const auto volumes = run(world, light);
    compare(world, light, volumes.mask, 0.3, t);
    EXPECT_GT(t.dark, 500);
    EXPECT_EQ(t.far_dark + t.far_lit, 0);
    const std::vector<float> counts = volumes.technique->draw_debug("counts");
    EXPECT_GT(*std::ranges::max_element(counts), 0.5f);
  }
}

// The light sees no outline at all, only 256 closed boxes around it.
TEST_F(SphereVolume, two_hundred_and_fifty_six_boxes_around_the_light_are_dark) {
  Scene scene;
  scene.meshes = {small_world::ground(4, -1)};
  for (int k = 0; k < 256; ++k)
    scene.meshes.push_back(small_world::box(glm::vec3(-0.3f - k / 512.0f), glm::vec3(0.3f + k / 512.0f)));
  const ShapeWorld world(std::move(scene), {.eye = {0, 2, 4}, .target = {0, -0.4f, 0}}, 48, 36);
  const Light light{.kind = PointLight{{0.1f, 0, 0.05f}}};
  for (const char* settings : {"", "fit=exact"}) {
    Agreement t;
    compare(world, light, run(world, light, settings).mask, 0, t);
    EXPECT_GT(t.tested, 200);
    EXPECT_EQ(t.dark, t.tested);
    EXPECT_EQ(t.false_lit, 0);
  }
}

// A sphere around everything, and the light inside: it casts on nothing that the eye inside sees. From outside, all that is
// seen of other things is dark.
TEST_F(SphereVolume, light_inside_a_solid_is_seen_from_inside_only) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), shape_mesh(Sphere{{0, 3, 0}, 1.5f}),
                  shape_mesh(Sphere{{0.5f, 2.6f, 0.3f}, 0.3f}), shape_mesh(Cone{{1.5f, 0.5f, 1}, {0, 1, 0}, 0.4f, 0.5f})};
  const Light light{.kind = PointLight{{0, 3.4f, 0}}};
  const View from_outside = view, from_inside{.eye = {-1, 3, 0.4f}, .target = {0.5f, 2.6f, 0.3f}, .fov_y_degrees = 80};
  for (const char* settings : {"", "fit=exact"}) {
    for (const View& from : {from_outside, from_inside}) {
      const ShapeWorld world(scene, from);
      Agreement t;
      compare(world, light, run(world, light, settings).mask, 0.3, t);
      EXPECT_EQ(t.far_dark + t.far_lit, 0);
      EXPECT_GT(t.tested, 1000);
      EXPECT_GT(t.dark, 100);
      if (from.eye == from_outside.eye) {
        EXPECT_EQ(t.dark, t.tested);
      }
      if (from.eye != from_outside.eye) {
        EXPECT_LT(t.dark, t.tested / 2);
      }
      EXPECT_LE(t.false_dark + t.false_lit, t.tested / 200);
    }
  }
  // The light outside, the eye inside: nothing it sees is lit.
  const ShapeWorld world(scene, from_inside);
  for (const Light& outside : {lights[0], lights[3]}) {
    Agreement t;
    compare(world, outside, run(world, outside).mask, 0, t);
    EXPECT_EQ(t.dark, t.tested);
    EXPECT_EQ(t.false_dark + t.false_lit, 0);
  }
}

// Flat meshes have the depth of their triangles, to the bit; points of curved ones have near_plane / w, within two roundings.
TEST_F(SphereVolume, depth_is_that_of_what_the_gbuffer_sees) {
  const ShapeWorld world(random_shapes(2), view);
  const GBuffer& g = world.gbuffer;
  const DepthStencil& by_mesh = depth_stencil(world.scene, g);
  const DepthStencil& by_shape = depth_stencil(world.scene, g, Truth::shape);
  EXPECT_NE(by_mesh.texture.name(), by_shape.texture.name());
  EXPECT_EQ(by_shape.bytes, g.size() * 8);
  EXPECT_EQ(&by_shape, &depth_stencil(world.scene, g, Truth::shape));
  const auto read = [&](const DepthStencil& depth) {
    std::vector<float> texels(g.size());
    glGetTextureImage(depth.texture.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(g.size() * 4), texels.data());
    return texels;
  };
  const std::vector<float> mesh = read(by_mesh), shape = read(by_shape);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(view.target) - glm::dvec3(view.eye));
  const double near_plane = gbuffer_textures(g, world.scene).near_plane;
  int curved = 0, differ = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    const double expected = near_plane / glm::dot(forward, glm::dvec3(g.position(i)) - glm::dvec3(view.eye));
    if (g.mesh[i] != 0) {
      ++curved, differ += mesh[i] != shape[i];
      EXPECT_NEAR(shape[i], expected, expected * 1e-6);
    } else {
      EXPECT_NEAR(shape[i], expected, expected * 1e-4);
    }
  }
  EXPECT_GT(curved, 500);
  EXPECT_GT(differ, curved / 2);

  // A G-buffer of triangles has one depth, whoever reads it.
  GBuffer of_mesh = small_world::make_gbuffer(world.scene, view, 32, 24);
  EXPECT_EQ(&depth_stencil(world.scene, of_mesh), &depth_stencil(world.scene, of_mesh, Truth::shape));
}

TEST_F(SphereVolume, shows_volumes_and_explains_by_mesh) {
  const ShapeWorld world(random_shapes(4), view);
  const auto volumes = run(world, lights[0]);
  const std::vector<float> picture = volumes.technique->draw_debug("volumes"), counts = volumes.technique->draw_debug("counts");
  ASSERT_EQ(picture.size(), 3 * world.gbuffer.size());
  ASSERT_EQ(counts.size(), picture.size());
  int entered = 0, dark = 0;
  for (std::size_t i = 0; i < world.gbuffer.size(); ++i) {
    const glm::vec3 c(counts[3 * i], counts[3 * i + 1], counts[3 * i + 2]);
    if (world.gbuffer.mesh[i] == 0) {
      EXPECT_EQ(volumes.mask[i] == 0, c.x != c.y || c.y != c.z);  // colors where a volume is, gray elsewhere
      dark += volumes.mask[i] == 0;
      entered += volumes.mask[i] == 0 && picture[3 * i] > 2 * picture[3 * i + 2];  // orange: front sides
    }
    const Explanation why = *volumes.technique->explain(i);
    EXPECT_TRUE(why.covered);
    EXPECT_EQ(why.element.has_value(), faces_light(world.scene, world.gbuffer, lights[0], i));
    if (why.element) {
      EXPECT_EQ(*why.element, world.gbuffer.mesh[i]);
    }
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(entered, dark * 9 / 10);  // where volumes overlap, teal comes in
}

// Inscribed octagons are off by 1 - cos(22.5 degrees) of the radius; under the lamp at height 4 what is halfway to the ground
// is thrown twice as large.
TEST_F(SphereVolume, the_error_of_an_outline_is_that_of_the_bodies_before_the_light) {
  const sv::Body bodies[] = {{0, Sphere{{0, 2, 0}, 1}}, {1, Disc{{20, 2, 0}, {0, 1, 0}, 3}}};
  const double share = 1 - std::cos(std::numbers::pi / 8);
  const auto error = [&](const glm::dvec4& light, const glm::dvec3& point) {
    return sv::outline_error(bodies, light, point, sv::inscribed, 8);
  };
  const glm::dvec4 sun(0, 1, 0, 0), lamp(0, 4, 0, 1);
  EXPECT_NEAR(error(sun, {0.9, 0, 0}), share, 1e-12);
  EXPECT_NEAR(error(sun, {21, 0, 2}), 3 * share, 1e-12);
  EXPECT_NEAR(error(lamp, {0, 0, 0}), 2 * share, 1e-12);
  EXPECT_EQ(error(sun, {0, 4, 0}), 0);   // the ball lies behind it
  EXPECT_EQ(error(sun, {10, 0, 0}), 0);  // between the two
}

TEST_F(SphereVolume, supports_every_scene_under_lights_without_area) {
  Scene scene;
  scene.meshes = {shape_mesh(Cone{{0, 0, 0}, {0, 1, 0}, 1, 2}), small_world::ground(3)};
  for (const Light& light : lights) EXPECT_EQ(supports(scene, light).kind(), Support::Kind::full);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.1f, 1, 0}}}).kind(), Support::Kind::full);  // inside
  EXPECT_EQ(supports(scene, {.kind = SphereLight{}}).kind(), Support::Kind::unsupported);
  // Half way up, the cone's radius is one half.
  const Support on_surface = supports(scene, {.kind = PointLight{{0.5f, 1, 0}}});
  EXPECT_EQ(on_surface.kind(), Support::Kind::unsupported);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.2f, 0, 0}}}).kind(), Support::Kind::unsupported);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.2f, -1e-3f, 0}}}).kind(), Support::Kind::full);
  EXPECT_EQ(on_surface.why(), "the light lies on the surface of shape, whose outline cannot be seen from there");
}

}  // namespace sphere_volume_test
