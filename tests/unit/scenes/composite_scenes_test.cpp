// The scenes for shadows in closed form: `composite`, and those put together from simple shapes.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generated_scene.h"
#include "measure/scene/load.h"

namespace composite_scenes_test {

using namespace gnomon;
using generated::mesh;
using generated::shape;

const Light& light(const Scene& scene, std::string_view name) { return *std::ranges::find(scene.lights, name, &Light::name); }

const View& view(const Scene& scene, std::string_view name) { return *std::ranges::find(scene.views, name, &View::name); }

std::string error_of(const std::string& reference) {
  try {
    load_scene(reference);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const glm::dvec4 ground(0, 1, 0, 0);

// --- composite -------------------------------------------------------------------------------------------------------------

TEST(CompositeScene, object_and_light_are_where_the_parameters_say) {
  const std::string rest = ",light_x=-3,light_y=7.5,light_z=1.25,distance=1.5,radius=0.75,height=2.5";
  const Scene circle = load_scene("composite:object=circle,tilt=30" + rest),
              sphere = load_scene("composite:object=sphere" + rest), cone = load_scene("composite:object=cone" + rest),
              triangle = load_scene("composite:object=triangle" + rest),
              across = load_scene("composite:object=triangle,base=x" + rest);
  for (const Scene* scene : {&circle, &sphere, &cone, &triangle, &across}) {
    ASSERT_EQ(scene->meshes.size(), 2u);
    EXPECT_EQ(homogeneous(light(*scene, "point")), glm::dvec4(-3, 7.5, 1.25, 1));
    EXPECT_EQ(homogeneous(light(*scene, "sun")), glm::dvec4(-3, 7.5, 1.25, 0)) << "from where the point light is";
    EXPECT_EQ(shape<Plane>(*scene, "ground").center, glm::vec3(0));
  }
  const glm::vec3 object(0, 1.5f, 0), peak(0, 4, 0);
  EXPECT_EQ(shape<Disc>(circle, "circle").center, object);
  EXPECT_EQ(shape<Disc>(circle, "circle").radius, 0.75f);
  const glm::vec3 normal = shape<Disc>(circle, "circle").normal;  // 30 degrees from +y toward +x
  EXPECT_NEAR(glm::distance(normal, glm::vec3(0.5f, std::sqrt(0.75f), 0)), 0, 1e-6);
  EXPECT_EQ(shape<Sphere>(sphere, "sphere").center, object) << "the distance is the center's";
  EXPECT_EQ(shape<Sphere>(sphere, "sphere").radius, 0.75f);
  EXPECT_EQ(shape<Cone>(cone, "cone").base, object);
  EXPECT_EQ(shape<Cone>(cone, "cone").axis, glm::vec3(0, 1, 0));
  EXPECT_EQ(shape<Cone>(cone, "cone").radius, 0.75f);
  EXPECT_EQ(shape<Cone>(cone, "cone").height, 2.5f);
  for (const auto& [scene, half] : {std::pair{&triangle, glm::vec3(0, 0, 0.75f)}, {&across, glm::vec3(0.75f, 0, 0)}}) {
    const auto& points = shape<Triangle>(*scene, "triangle").points;
    EXPECT_EQ(glm::abs(points[0] - object), half);
    EXPECT_EQ(points[0] + points[1], 2.0f * object);
    EXPECT_EQ(points[2], peak);
  }
}

TEST(CompositeScene, all_four_objects_stand_side_by_side) {
  for (const char* settings : {"composite", "composite:radius=5", "composite:radius=0.05,distance=10"}) {
    const Scene scene = load_scene(settings);
    ASSERT_EQ(scene.meshes.size(), 5u);
    const float half = glm::length(shape<Plane>(scene, "ground").half_u);
    float end = -half;
    for (std::size_t i = 1; i < 5; ++i) {
      Bounds bounds;
      for (const glm::vec3& p : scene.meshes[i].positions) bounds.add(p);
      EXPECT_GT(bounds.min.z, end) << settings << ": " << scene.meshes[i].name;
      EXPECT_NEAR(bounds.min.x, -bounds.max.x, 1e-5);
      end = bounds.max.z;
    }
    EXPECT_LT(end, half);
  }
}

// The shadows of the four are apart where the light stands unless told otherwise: along z no two meet.
TEST(CompositeScene, shadows_of_the_four_are_apart_by_default) {
  const Scene scene = load_scene("composite");
  double end = -INFINITY;
  for (std::size_t i = 1; i < 5; ++i) {
    double low = INFINITY, high = -INFINITY;
    const PlanarShadow shadow(*scene.meshes[i].shape, homogeneous(light(scene, "point")), ground);
    const auto loops = shadow.outlines(64);
    ASSERT_EQ(loops.size(), 1u);
    for (const glm::dvec4& p : loops[0]) low = std::min(low, p.z / p.w), high = std::max(high, p.z / p.w);
    EXPECT_GT(low, end) << scene.meshes[i].name;
    end = high;
  }
}

TEST(CompositeScene, light_in_an_object_is_refused) {
  for (const char* reference :
       {"composite:object=sphere,light_x=0,light_y=2.5", "composite:object=cone,light_x=0.25,light_y=3",
        "composite:object=circle,light_x=0.5,light_y=2", "composite:light_x=0,light_y=2,light_z=1.75"}) {
    const std::string error = error_of(reference);
    for (const char* word : {"composite.light_x, light_y, light_z = ", "the light is in or on the", "outside every object"})
      EXPECT_NE(error.find(word), std::string::npos) << reference << ": " << error;
  }
  EXPECT_EQ(error_of("composite:object=sphere,light_x=0,light_y=3.01"), "");
  EXPECT_EQ(error_of("composite:object=circle,light_x=0,light_y=1"), "") << "below the circle";
}

/// Whether a point is in the picture of a view, 16 to 9.
bool is_in_picture(const View& view, const glm::dvec3& point) {
  const Camera camera(view, 16, 9);
  const glm::dvec3 to = point - camera.eye;
  const double depth = glm::dot(to, camera.forward);
  return depth > 0 && std::abs(glm::dot(to, camera.up)) < camera.tan_y * depth &&
         std::abs(glm::dot(to, camera.right)) < camera.tan_y * 16 / 9 * depth;
}

// The shadow of the sphere, in closed form: for a light at (x_i, y_i, 0), with h = y_i - d and K = h^2 - r^2, an ellipse around
// x_c = -x_i (d h + r^2) / K with half axes y_i r sqrt(x_i^2 + K) / K along x and y_i r / sqrt(K) along z. What the sphere
// hides from the eye at (0, y_e, z_e) is the same ellipse with x and z changed: it ends at z = z_c + semi. When that is below
// the shadow's least z a line along x parts the two.
TEST(CompositeScene, shadow_view_shows_all_of_the_spheres_shadow) {
  for (const double y : {5.0, 9.0, 20.0, 100.0})
    for (const double x : {-8.0, -4.0, 0.0, 4.0, 8.0}) {
      const Scene scene = load_scene(fmt::format("composite:object=sphere,light_x={},light_y={}", x, y));
      const Sphere& sphere = shape<Sphere>(scene, "sphere");
      const View& eye = view(scene, "shadow");
      ASSERT_EQ(eye.eye.x, 0);
      struct Ellipse {
        double center, along, across;
      };
      const auto shadow_of = [&](double from, double height) {
        const double d = sphere.center.y, r = sphere.radius, h = height - d, K = h * h - r * r;
        return Ellipse{-from * (d * h + r * r) / K, height * r * std::sqrt(from * from + K) / K, height * r / std::sqrt(K)};
      };
      const Ellipse shadow = shadow_of(x, y), hidden = shadow_of(eye.eye.z, eye.eye.y);
      EXPECT_LT(hidden.center + hidden.along, -shadow.across) << x << " " << y;
      for (int k = 0; k < 360; ++k) {
        const double angle = glm::radians(double(k));
        const glm::dvec3 p(shadow.center + shadow.along * std::cos(angle), 0, shadow.across * std::sin(angle));
        ASSERT_TRUE(is_in_picture(eye, p)) << x << " " << y << ": " << p.x << " " << p.z;
        // The same, by the distance of the sphere from the line of sight.
        const glm::dvec3 ray = glm::normalize(p - glm::dvec3(eye.eye)), to = glm::dvec3(sphere.center) - p;
        ASSERT_GT(glm::length(glm::cross(to, ray)), sphere.radius) << x << " " << y;
      }
    }
}

// A triangle in the plane x = 0 is edge-on to the eye, and hides nothing.
TEST(CompositeScene, shadow_view_shows_all_of_the_other_shadows) {
  for (const char* object : {"circle", "cone", "triangle"})
    for (const double y : {7.0, 9.0, 100.0})
      for (const double x : {-8.0, -4.0, 0.0, 4.0, 8.0}) {
        const Scene scene = load_scene(fmt::format("composite:object={},light_x={},light_y={}", object, x, y));
        const View& eye = view(scene, "shadow");
        double low = INFINITY, hidden = -INFINITY;
        const PlanarShadow shadow(*mesh(scene, object).shape, homogeneous(light(scene, "point")), ground);
        for (const auto& loop : shadow.outlines(64))
          for (const glm::dvec4& p : loop) {
            ASSERT_TRUE(is_in_picture(eye, glm::dvec3(p) / p.w)) << object << " " << x << " " << y;
            low = std::min(low, p.z / p.w);
          }
        for (const auto& loop : PlanarShadow(*mesh(scene, object).shape, {eye.eye, 1}, ground).outlines(64))
          for (const glm::dvec4& p : loop) hidden = std::max(hidden, p.z / p.w);
        EXPECT_LT(hidden, low) << object << " " << x << " " << y;
      }
}

// --- Described scenes ------------------------------------------------------------------------------------------------------

constexpr const char* described[] = {"indoor", "snowman", "table", "tree"};

TEST(SimpleShapes, described_scenes_load_without_a_note_and_every_caster_has_a_shape) {
  for (const char* id : described) {
    SCOPED_TRACE(id);
    const Scene scene = load_scene(id);
    EXPECT_TRUE(scene.notes.empty());
    EXPECT_EQ(scene.name, id);
    EXPECT_EQ(scene.lights.front().name, "point");
    EXPECT_EQ(kind_name(light(scene, "sun")), "directional");
    EXPECT_EQ(scene.views.front().name, "view");
    EXPECT_EQ(scene.ambient, 0.2f);
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_TRUE(mesh.casts && mesh.receives) << mesh.name;
      ASSERT_TRUE(mesh.shape.has_value()) << mesh.name;
      EXPECT_EQ(mesh.facts.degenerate_count, 0u) << mesh.name;
      const std::string_view kind = kind_name(*mesh.shape);
      EXPECT_EQ(mesh.facts.closed(), kind == "sphere" || kind == "cone" || kind == "box") << mesh.name;
      for (const Light& l : scene.lights)
        if (!has_area(l)) {
          EXPECT_EQ(PlanarShadow::objection(*mesh.shape, homogeneous(l), ground, ShadowForm::exact), "")
              << mesh.name << " " << l.name;
        }
    }
  }
}

/// How many shapes a form cannot tell on the horizontal plane at a height.
std::size_t objections(const Scene& scene, const Light& light, double height, ShadowForm form) {
  return std::ranges::count_if(scene.meshes, [&](const Mesh& mesh) {
    return !PlanarShadow::objection(*mesh.shape, homogeneous(light), {0, 1, 0, -height}, form).empty();
  });
}

TEST(SimpleShapes, tree_and_table_are_in_the_domain_of_the_papers_formulas_on_every_plane) {
  const Scene tree = load_scene("tree"), table = load_scene("table");
  const double top = shape<Disc>(table, "disc_1").center.y;
  EXPECT_EQ(top, 0.75);
  for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper})
    for (const char* name : {"point", "sun"}) {
      EXPECT_EQ(objections(tree, light(tree, name), 0, form), 0u) << name;
      EXPECT_EQ(objections(table, light(table, name), 0, form), 0u) << name;
      EXPECT_EQ(objections(table, light(table, name), top, form), 0u) << name;
    }
}

TEST(SimpleShapes, of_the_snowman_nose_and_arms_are_beyond_the_paper) {
  const Scene scene = load_scene("snowman");
  EXPECT_EQ(objections(scene, light(scene, "point"), 0, ShadowForm::paper), 3u);
  EXPECT_EQ(objections(scene, light(scene, "sun"), 0, ShadowForm::paper), 3u);
}

TEST(SimpleShapes, things_on_the_table_touch_it) {
  const Scene scene = load_scene("table");
  const float top = shape<Disc>(scene, "disc_1").center.y;
  EXPECT_EQ(shape<Cone>(scene, "cone_2").base.y, 0);
  EXPECT_EQ(shape<Cone>(scene, "cone_2").height, top) << "the foot";
  EXPECT_EQ(shape<Sphere>(scene, "sphere_3").center.y - shape<Sphere>(scene, "sphere_3").radius, top);
  EXPECT_EQ(shape<Cone>(scene, "cone_4").base.y, top);
  EXPECT_EQ(shape<Triangle>(scene, "triangle_5").points[0].y, top);
  EXPECT_EQ(shape<Triangle>(scene, "triangle_5").points[1].y, top);
}

// Each wall ends where the next begins, to the last bit: no light leaks in through a corner.
TEST(SimpleShapes, walls_of_the_room_meet_and_face_its_inside) {
  const Scene scene = load_scene("indoor");
  const glm::dvec3 middle(0, 1.375, 0);
  for (int i = 0; i < 5; ++i) {
    const Mesh& wall = scene.meshes[i];
    ASSERT_EQ(kind_name(*wall.shape), "plane");
    const glm::uvec3 t = wall.triangles[0];
    const glm::dvec3 a(wall.positions[t.x]), b(wall.positions[t.y]), c(wall.positions[t.z]);
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), middle - a), 0) << wall.name;
    for (const glm::vec3& p : wall.positions) {
      EXPECT_EQ(std::abs(p.x), 2.5f);
      EXPECT_EQ(std::abs(p.z), 2.0f);
      EXPECT_TRUE(p.y == 0 || p.y == 2.75f);
    }
  }
}

}  // namespace composite_scenes_test
