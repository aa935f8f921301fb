#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "generated_scene.h"
#include "small_world.h"

namespace scenes_test {

using namespace gnomon;
using generated::make;
using generated::mesh;
using generated::shape;

/// The defaults, and both ends of each range with all else at its default; but `count` and `segments` multiply, so of these two
/// the one that is not tried stays at its low end. Counts are tried up to 100 000; more are a matter of their own test.
std::vector<std::string> settings_to_try(const SceneEntry& entry) {
  const auto generator = entry.make();
  std::vector<std::string> settings{""};
  for (const Parameter* row : generator->parameters())
    for (const std::string& end : row->probes()) {
      const bool is_long = row->name() == "count" && std::stod(end) > 100000;
      settings.push_back(fmt::format("{}={}", row->name(), is_long ? "100000" : end));
      for (const Parameter* other : generator->parameters())
        if (other != row && (other->name() == "count" || other->name() == "segments"))
          settings.back() += fmt::format(",{}={}", other->name(), other->probes().front());
    }
  return settings;
}

/// Calls `test` with every generated scene under all settings to try.
template <class Test>
void for_each_scene(Test test) {
  ASSERT_FALSE(registry().scenes().empty());
  for (const SceneEntry& entry : registry().scenes())
    for (const std::string& settings : settings_to_try(entry)) {
      SCOPED_TRACE(entry.id + ":" + settings);
      const auto generator = entry.make();
      generator->apply(settings);
      test(generator->make());
    }
}

template <class Kind>
std::vector<Kind> shapes(const Scene& scene) {
  std::vector<Kind> all;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.shape && std::holds_alternative<Kind>(*mesh.shape)) all.push_back(std::get<Kind>(*mesh.shape));
  return all;
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::vec3 point_light(const Scene& scene) { return std::get<PointLight>(scene.lights.at(0).kind).position; }
glm::vec3 sun(const Scene& scene) { return std::get<DirectionalLight>(scene.lights.at(1).kind).direction; }

TEST(Scenes, every_scene_has_a_point_light_a_sun_and_a_view) {
  for_each_scene([](const Scene& scene) {
    ASSERT_GE(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].name, "point");
    EXPECT_EQ(kind_name(scene.lights[0]), "point");
    EXPECT_EQ(scene.lights[1].name, "sun");
    EXPECT_EQ(kind_name(scene.lights[1]), "directional");
    EXPECT_LT(sun(scene).y, 0) << "the sun must shine downward";
    ASSERT_FALSE(scene.views.empty());
    EXPECT_EQ(scene.views[0].name, "view");
    for (const View& view : scene.views) EXPECT_GT(view.eye.y, 0) << view.name;
  });
}

TEST(Scenes, every_scene_carries_its_id_and_names_no_two_things_alike) {
  for (const SceneEntry& entry : registry().scenes()) EXPECT_EQ(entry.make()->make().name, entry.id);
  for_each_scene([](const Scene& scene) {
    std::set<std::string> meshes, lights, views;
    for (const Mesh& mesh : scene.meshes) EXPECT_TRUE(meshes.insert(mesh.name).second) << mesh.name;
    for (const Light& light : scene.lights) EXPECT_TRUE(lights.insert(light.name).second) << light.name;
    for (const View& view : scene.views) EXPECT_TRUE(views.insert(view.name).second) << view.name;
  });
}

TEST(Scenes, every_mesh_is_finite_indexed_in_range_and_without_degenerate_triangles) {
  for_each_scene([](const Scene& scene) {
    EXPECT_LE(scene.triangle_count(), 200000u);
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_FALSE(mesh.triangles.empty()) << mesh.name;
      EXPECT_EQ(mesh.facts.degenerate_count, 0u) << mesh.name;
      EXPECT_TRUE(std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite)) << mesh.name;
      for (const glm::uvec3& t : mesh.triangles) ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size()) << mesh.name;
      EXPECT_GE(std::min({mesh.albedo.r, mesh.albedo.g, mesh.albedo.b}), 0) << mesh.name;
      EXPECT_LE(std::max({mesh.albedo.r, mesh.albedo.g, mesh.albedo.b}), 1) << mesh.name;
    }
  });
}

TEST(Scenes, every_solid_is_closed) {
  // All that is neither a sheet by its shape nor soup nor cards has an inside.
  const std::set<std::string_view> sheets{"soup", "leaves", "links", "smoke", "hair", "window", "cloth", "swarm"};
  for_each_scene([&](const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
      const std::string_view kind = mesh.shape ? kind_name(*mesh.shape) : "solid";
      if (kind == "plane" || kind == "triangle" || kind == "disc" || sheets.contains(mesh.name)) continue;
      if (mesh.name.starts_with("sheet_")) continue;
      EXPECT_TRUE(mesh.facts.closed()) << mesh.name;
    }
  });
}

TEST(Scenes, point_light_stands_outside_every_exact_solid) {
  for_each_scene([](const Scene& scene) {
    const glm::dvec3 light(point_light(scene));
    for (const Sphere& s : shapes<Sphere>(scene)) EXPECT_GT(glm::distance(light, glm::dvec3(s.center)), s.radius);
    for (const Box& box : shapes<Box>(scene)) {
      const glm::dvec3 nearest = glm::clamp(light, glm::dvec3(box.min), glm::dvec3(box.max));
      EXPECT_NE(nearest, light) << "inside a box";
    }
  });
}

TEST(Scenes, same_settings_make_the_same_scene) {
  for (const SceneEntry& entry : registry().scenes()) {
    SCOPED_TRACE(entry.id);
    const Scene a = make(entry.id), b = make(entry.id);
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
      EXPECT_EQ(a.meshes[i].name, b.meshes[i].name);
      EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions);
      EXPECT_EQ(a.meshes[i].triangles, b.meshes[i].triangles);
      EXPECT_EQ(a.meshes[i].albedo, b.meshes[i].albedo);
    }
  }
}

TEST(Scenes, another_seed_makes_another_scene) {
  for (const char* id : {"box_city", "hair_cards", "leaf_cards", "smoke_cards", "soup", "sphere_field", "swarm", "town"})
    EXPECT_NE(make(id, "seed=1").meshes.back().positions, make(id, "seed=2").meshes.back().positions) << id;
}

TEST(Scenes, random_numbers_are_those_published_for_pcg32) {
  // The first six of the demonstration program of O'Neill's PCG library: seed 42, stream 54.
  Random random(42, 54);
  for (const std::uint32_t expected : {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    EXPECT_EQ(random.next(), expected);
}

TEST(Scenes, box_city_boxes_stand_on_the_ground_and_keep_apart) {
  for (const char* settings : {"", "count=1000", "count=1", "seed=77"}) {
    const std::vector<Box> boxes = shapes<Box>(make("box_city", settings));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(boxes[i].min.y, 0);
      for (std::size_t j = 0; j < i; ++j) {
        const Box &a = boxes[i], &b = boxes[j];
        const float gap_x = std::max(a.min.x - b.max.x, b.min.x - a.max.x);
        const float gap_z = std::max(a.min.z - b.max.z, b.min.z - a.max.z);
        ASSERT_GT(std::max(gap_x, gap_z), 0) << settings << ": boxes " << j << " and " << i;
      }
    }
  }
  EXPECT_EQ(shapes<Box>(make("box_city", "count=137")).size(), 137u);
}

TEST(Scenes, town_has_the_sun_of_the_hour_over_houses_that_keep_to_their_plots) {
  const auto sunlight = [](const std::string& settings) {
    return std::get<DirectionalLight>(make("town", settings).lights.back().kind).direction;
  };
  // 48 degrees north at an equinox: at noon 90 - 48 degrees high and due south, from where light travels to -z. At 7 the sine
  // of the height is cos 48 cos 75, and the sun is in the east, so that light travels to -x.
  const glm::dvec3 noon = sunlight("hour=12"), morning = sunlight("hour=7"), evening = sunlight("hour=17");
  EXPECT_NEAR(std::asin(-noon.y) * 180 / std::acos(-1.0), 42, 1e-4);
  EXPECT_NEAR(noon.x, 0, 1e-6);
  EXPECT_LT(noon.z, 0);
  EXPECT_NEAR(morning.y, -0.66913061 * 0.25881905, 1e-6);
  EXPECT_LT(morning.x, 0);
  EXPECT_NEAR(evening.x, -morning.x, 1e-6);
  EXPECT_NEAR(evening.y, morning.y, 1e-6);
  const std::vector<Box> houses = shapes<Box>(make("town"));
  EXPECT_GT(houses.size(), 75u);
  for (const Box& house : houses) {
    EXPECT_EQ(house.min.y, 0);
    // Plots begin 7 m behind multiples of 44 m from -220 on, and are 30 m wide.
    for (const int axis : {0, 2}) {
      const double from = house.min[axis] + 220, plot = std::floor(from / 44);
      EXPECT_GE(from - 44 * plot, 7 - 1e-4);
      EXPECT_LE(house.max[axis] + 220 - 44 * plot, 37 + 1e-4);
    }
  }
}

TEST(Scenes, sphere_field_spheres_keep_apart_and_above_the_ground) {
  for (const char* settings : {"segments=4", "segments=4,count=1000", "segments=4,seed=77"}) {
    const std::vector<Sphere> spheres = shapes<Sphere>(make("sphere_field", settings));
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      EXPECT_GE(spheres[i].center.y, spheres[i].radius);
      if (i % 3 == 0) {
        EXPECT_EQ(spheres[i].center.y, spheres[i].radius) << "every third rests on the ground";
      }
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GT(glm::distance(glm::dvec3(spheres[i].center), glm::dvec3(spheres[j].center)),
                  double{spheres[i].radius} + spheres[j].radius)
            << settings << ": spheres " << j << " and " << i;
    }
  }
}

TEST(Scenes, soup_fills_its_box_and_the_ground_is_a_matter_of_choice) {
  for (const char* settings : {"", "size=2.5", "count=5000,seed=3"}) {
    const Scene scene = make("soup", settings);
    EXPECT_EQ(scene.meshes.size(), 2u);
    for (const glm::vec3& p : mesh(scene, "soup").positions) {
      ASSERT_LE(std::max(std::abs(p.x), std::abs(p.z)), 8);
      ASSERT_GE(p.y, 0.2f);
      ASSERT_LE(p.y, 3.2f);
    }
  }
  const Scene bare = make("soup", "ground=false");
  ASSERT_EQ(bare.meshes.size(), 1u);
  EXPECT_EQ(bare.meshes[0].triangles.size(), 1000u);
}

TEST(Scenes, soup_edges_are_as_long_as_the_size_says) {
  // The mean over 3000 edges; slivers drawn again lengthen it a little.
  double total = 0;
  const Scene scene = make("soup");
  const Mesh& soup = mesh(scene, "soup");
  for (const glm::uvec3& t : soup.triangles)
    for (int k = 0; k < 3; ++k) total += glm::distance(soup.positions[t[k]], soup.positions[t[(k + 1) % 3]]);
  EXPECT_NEAR(total / 3000, 0.45, 0.05);
}

// A million triangles of a millimeter: none collapses in float32, whose steps in the box are at most 2^-21 m, two thousand to
// an edge. Fewer triangles are the first of them.
TEST(Scenes, soup_holds_a_million_small_triangles) {
  const Scene scene = make("soup", "count=1000000,size=0.001,ground=false"), few = make("soup", "count=100,size=0.001");
  const Mesh& soup = mesh(scene, "soup");
  EXPECT_EQ(soup.triangles.size(), 1000000u);
  EXPECT_EQ(soup.facts.degenerate_count, 0u);
  const auto& start = mesh(few, "soup").positions;
  ASSERT_EQ(start.size(), 300u);
  EXPECT_TRUE(std::equal(start.begin(), start.end(), soup.positions.begin()));
  double total = 0;
  for (const glm::uvec3& t : soup.triangles) total += glm::distance(soup.positions[t.x], soup.positions[t.y]);
  EXPECT_NEAR(total / 1e6, 0.001, 0.0002);
}

TEST(Scenes, single_triangle_shadows_are_those_on_paper) {
  const Scene scene = make("single_triangle");
  const Triangle& triangle = shape<Triangle>(scene, "triangle");
  const glm::vec3 by_point[] = {{-2, 0, 1}, {4, 0, 3}, {2, 0, -5}}, by_sun[] = {{-1, 0, 0.5f}, {2, 0, 1.5f}, {1, 0, -2.5f}};
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(2.0f * triangle.points[k] - point_light(scene), by_point[k]);
    EXPECT_EQ(triangle.points[k] + sun(scene), by_sun[k]);
  }
}

// An edge of the triangle and the lights' common center span a plane that halves every light. The triangle is half way up to
// them, so that the penumbra is about as wide as the light, 0.25 m to each side; at most sqrt(2) times that where the light has
// corners, or is a sphere whose shadow falls aslant, down to 45 degrees.
TEST(Scenes, single_triangle_halves_its_lights_where_the_point_shadow_ends) {
  const Scene scene = make("single_triangle");
  const AreaScene casters(scene);
  LightPieces pieces;
  AreaTally tally;
  const glm::vec3 shadow[] = {{-2, 0, 1}, {4, 0, 3}, {2, 0, -5}};
  std::set<std::string_view> kinds;
  for (const Light& light : scene.lights) {
    if (!has_area(light)) continue;
    SCOPED_TRACE(light.name);
    kinds.insert(kind_name(light));
    EXPECT_EQ(glm::vec3(homogeneous_of_center(light)), point_light(scene));
    const auto seen = [&](const glm::vec3& point) {
      return casters.seen({point}, LightFigure(light, point, {0, 1, 0}), pieces, tally).area.best;
    };
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 from = shadow[k], to = shadow[(k + 1) % 3], middle = (from + to) / 2.0f;
      const glm::vec3 inside = glm::normalize(glm::cross(glm::vec3(0, 1, 0), to - from));
      EXPECT_NEAR(seen(middle), 0.5, 1e-12);
      EXPECT_EQ(seen(middle + 0.5f * inside), 0);
      EXPECT_EQ(seen(middle - 0.5f * inside), 1);
    }
  }
  EXPECT_EQ(kinds, (std::set<std::string_view>{"rect", "disc", "sphere"}));
}

// The disc of the sun has a diameter of 0.533 degrees in the mean; it stands where the sun of parallel rays comes from.
TEST(Scenes, fence_has_a_sun_as_large_as_the_real_one) {
  const Scene scene = make("fence");
  const auto light = std::ranges::find(scene.lights, "soft_sun", &Light::name);
  ASSERT_NE(light, scene.lights.end());
  const SphereLight& sphere = std::get<SphereLight>(light->kind);
  const glm::dvec3 center(sphere.center);
  EXPECT_NEAR(2 * std::asin(sphere.radius / glm::length(center)) * 180 / M_PI, 0.533, 0.001);
  EXPECT_NEAR(glm::length(glm::cross(glm::normalize(center), glm::normalize(glm::dvec3(sun(scene))))), 0, 1e-6);
}

TEST(Scenes, sphere_over_plane_rests_exactly_when_its_height_is_zero) {
  for (const char* settings : {"height=0", "height=0,radius=0.3", "height=0,radius=2"}) {
    const Scene scene = make("sphere_over_plane", settings);
    EXPECT_EQ(shape<Sphere>(scene, "sphere").center.y, shape<Sphere>(scene, "sphere").radius);
  }
}

TEST(Scenes, contact_things_touch_exactly_where_they_should) {
  const Scene scene = make("contact");
  const Sphere& ball = shape<Sphere>(scene, "ball");
  const Box& lower = shape<Box>(scene, "box_lower");
  EXPECT_EQ(ball.center.y - ball.radius, 0);
  EXPECT_EQ(ball.center.x + ball.radius, lower.min.x);
  EXPECT_EQ(shape<Box>(scene, "slab_lying").min.y, 0);
  EXPECT_EQ(shape<Box>(scene, "slab_lying").max.y, 0.005f);
  EXPECT_EQ(shape<Box>(scene, "slab_hovering").min.y, 0.002f);
  float upper_bottom = INFINITY, card_bottom = INFINITY, card_back = INFINITY;
  for (const glm::vec3& p : mesh(scene, "box_upper").positions) upper_bottom = std::min(upper_bottom, p.y);
  for (const glm::vec3& p : mesh(scene, "card").positions) {
    card_bottom = std::min(card_bottom, p.y);
    card_back = std::min(card_back, p.z);
  }
  EXPECT_EQ(upper_bottom, lower.max.y);
  EXPECT_EQ(card_bottom, 0);
  EXPECT_EQ(card_back, shape<Box>(scene, "wall").max.z);
}

TEST(Scenes, fence_has_as_many_pickets_as_fit_eight_meters) {
  // n pickets and n - 1 gaps fit when n (width + spacing) - spacing <= 8. A picket has 10 vertices.
  EXPECT_EQ(mesh(make("fence"), "pickets").positions.size() / 10, 40u);
  EXPECT_EQ(mesh(make("fence", "width=0.5,spacing=0.5"), "pickets").positions.size() / 10, 8u);
}

// What a low view is for: texels that serve the near end of the picture are wasted on the far one.
TEST(Scenes, low_views_run_from_near_to_far_as_one_to_twenty) {
  for (const std::string_view id : {"fence", "colonnade"}) {
    const Scene scene = make(id);
    const auto low = std::ranges::find(scene.views, "low", &View::name);
    ASSERT_NE(low, scene.views.end()) << id;
    const GBuffer g = small_world::make_gbuffer(scene, *low, 64, 36);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(low->target) - glm::dvec3(low->eye));
    double near = INFINITY, far = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.is_background(i)) continue;
      const double depth = glm::dot(axis, glm::dvec3(g.position(i)) - glm::dvec3(low->eye));
      near = std::min(near, depth);
      far = std::max(far, depth);
    }
    EXPECT_GE(far / near, 20) << id << ": " << near << " to " << far << " m";
  }
}

}  // namespace scenes_test
