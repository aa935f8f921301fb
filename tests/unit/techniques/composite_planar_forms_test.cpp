// Analytic composite shadows: the paper's forms, what they differ by, and what each form supports.
#include "composite_planar_rig.h"

namespace composite_planar_forms_test {
using namespace composite_rig;
using Point = glm::dvec3;

class CompositeForms : public TestRig {};

const View view{.eye = {-4, 6, 7}, .target = {-0.5f, 0.3f, 0}, .fov_y_degrees = 35};

/// What the paper has, over a receiver whose normal is `up`: a circle, an upright triangle, a sphere and a cone.
Scene paper_scene(const Point& up) {
  const Point u = glm::normalize(glm::cross(up, Point(0.3, 0.1, 1))), v = glm::cross(u, up);
  const auto at = [&](double x, double y, double z) { return glm::vec3(x * u + y * up + z * v); };
  Scene scene;
  scene.meshes = {mesh_of(Plane{{0, 0, 0}, glm::vec3(6.0 * u), glm::vec3(6.0 * v)}),
                  mesh_of(Disc{at(-1.2, 0.8, 0.9), glm::vec3(up), 0.6f}),
                  mesh_of(Triangle{{at(0.7, 0.5, 1), at(1.7, 0.5, 1), at(1.2, 1.6, 1)}}),
                  mesh_of(Sphere{at(-1, 0.9, -1), 0.7f}), mesh_of(Cone{at(1, 0.2, -1), glm::vec3(up), 0.6f, 1.3f})};
  for (std::size_t m = 1; m < scene.meshes.size(); ++m) scene.meshes[m].receives = false;
  return scene;
}

const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{2.5f, 6, 1}}},
                                   {.name = "lower", .kind = PointLight{{-3, 3.5f, 2}}},
                                   {.name = "spot", .kind = SpotLight{{1, 5, 1}, {-0.2f, -1, -0.2f}, 20, 50}},
                                   {.name = "sun", .kind = DirectionalLight{{-0.8f, -1, 0.4f}}}};

// Every pixel of the plane has the answer of the kit's shadows of that form, and formula_differs where the exact ones answer
// otherwise. Where moving the point by the rounding of float32 changes the answer, either is right.
TEST_F(CompositeForms, each_form_is_the_kits_and_tells_where_it_differs) {
  int differs[3] = {}, dark[3] = {};
  for (const Point& up : {Point(0, 1, 0), glm::normalize(Point(0.3, 1, -0.4))}) {
    const World world(paper_scene(up), view, 192, 128);
    for (const Light& light : lights)
      for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper, ShadowForm::exact}) {
        const int f = static_cast<int>(form);
        const std::string settings = fmt::format("form={}", std::array{"printed", "paper", "exact"}[f]);
        SCOPED_TRACE(fmt::format("{}, {}", light.name, settings));
        ASSERT_TRUE(supports(world.scene, light, settings)) << supports(world.scene, light, settings).why();
        const std::vector<float> answer = mask(world, light, settings);
        std::vector<PlanarShadow> shadows, exact;
        const glm::dvec4 plane(up, 0), l = homogeneous(light);
        for (std::size_t m = 1; m < world.scene.meshes.size(); ++m) {
          shadows.emplace_back(*world.scene.meshes[m].shape, l, plane, form);
          exact.emplace_back(*world.scene.meshes[m].shape, l, plane);
        }
        const auto inside = [](const std::vector<PlanarShadow>& all, const Point& p) {
          return std::ranges::any_of(all, [&](const PlanarShadow& shadow) { return shadow.contains(p); });
        };
        const double rho = 16 * 0x1p-24 * extent(world.scene, light, view);
        int unsure = 0;
        for (std::size_t i = 0; i < answer.size(); ++i) {
          if (world.gbuffer.mesh[i] != 0 || !world.faces(light, i)) continue;
          const Point p = world.gbuffer.position(i);
          const bool is_dark = inside(shadows, p), is_dark_exactly = inside(exact, p);
          bool is_sure = true;
          for (int k = 0; k < 6; ++k) {
            Point moved = p;
            moved[k / 2] += k % 2 ? rho : -rho;
            is_sure = is_sure && inside(shadows, moved) == is_dark && inside(exact, moved) == is_dark_exactly;
          }
          if (!is_sure) {
            ++unsure;
            continue;
          }
          const Explanation why = explain(i);
          EXPECT_TRUE(why.covered) << i;
          EXPECT_EQ(answer[i], is_dark ? 0 : 1) << i;
          EXPECT_EQ(why.element.has_value(), is_dark) << i;
          EXPECT_EQ(why.formula_differs, is_dark != is_dark_exactly) << i;
          differs[f] += why.formula_differs, dark[f] += is_dark;
          if (why.element) {
            EXPECT_TRUE(shadows[*why.element - 1].contains(p)) << i;
          }
        }
        EXPECT_LT(unsure, 10);
      }
  }
  EXPECT_GT(dark[2], 5000);
  EXPECT_EQ(differs[2], 0);
  EXPECT_GT(differs[1], 300);         // balls too small, cones without their tangents
  EXPECT_GT(differs[0], differs[1]);  // and triangles out of place
}

// The exact form has no pixel wrong where the others do.
TEST_F(CompositeForms, exact_is_right_where_the_paper_is_wrong) {
  Tally exact, paper;
  const World world(paper_scene({0, 1, 0}), view);
  for (const Light& light : lights) {
    compare(world, light, exact, "form=exact");
    compare(world, light, paper, "form=paper");
  }
  EXPECT_EQ(exact.false_dark + exact.false_lit, 0);
  EXPECT_GT(paper.false_lit, 100);
  EXPECT_EQ(paper.false_dark, 0);  // its discs and triangles lie in the true shadows
}

// A light h over the center of a ball and x aside: the paper darkens the image of the great circle, pi r^2 of the center's
// height; the ball's true shadow there is the ellipse of the tangent cone, pi r^2 h^2 sqrt(x^2 + K) / K^1.5 with K = h^2 - r^2.
// On the ground both are larger by the same factor. From straight above all pixels of the ground have the same area.
TEST_F(CompositeForms, area_of_the_papers_sphere_is_the_closed_form) {
  constexpr double d = 1.5, r = 1;
  Scene ground_only, scene;
  ground_only.meshes = scene.meshes = {mesh_of(level({0, 0, 0}, 40))};
  scene.meshes[0].casts = false;
  scene.meshes.push_back(mesh_of(Sphere{{0, d, 0}, r}));
  for (const auto& [x, h] : {std::pair{0.0, 6.0}, {4.0, 6.0}, {2.0, 2.0}, {3.0, 1.5}, {8.0, 3.0}, {5.0, 10.0}}) {
    const Light light{.kind = PointLight{{x, d + h, 0}}};
    // The G-buffer is the ground's, where the ball hides nothing. The exact shadow reaches from the image of one tangent to
    // that of the other, x = h (h x -+ r sqrt(x^2 + K)) / K before the light at the center's height: it fills the picture.
    const double k = h * h - r * r, grow = (h + d) / h;
    const double middle = x - grow * h * h * x / k, reach = grow * h * r * std::sqrt(x * x + k) / k;
    const View above{.eye = {middle, 100, 0},
                     .target = {middle, 0, 0},
                     .up = {0, 0, -1},
                     .fov_y_degrees = static_cast<float>(glm::degrees(2 * std::atan(1.1 * reach / 100)))};
    const World world(ground_only, above, 480, 480);
    double area[2];
    for (const int exactly : {0, 1}) {
      const std::vector<float> answer = mask(scene, light, world.gbuffer, exactly ? "form=exact" : "form=paper");
      area[exactly] = static_cast<double>(std::ranges::count(answer, 0.0f));
    }
    EXPECT_GT(area[1], 20000);
    const double expected = std::pow(k, 1.5) / (h * h * std::sqrt(x * x + k));
    EXPECT_NEAR(area[0] / area[1], expected, 0.01 * expected) << x << " " << h;
  }
}

TEST_F(CompositeForms, says_why_it_cannot) {
  const Light point{.kind = PointLight{{0, 5, 0}}};
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4), 24, "ground"), mesh_of(Sphere{{0, 1, 0}, 0.5f}, 24, "ball")};
  EXPECT_NE(supports(scene, point).kind(), Support::Kind::unsupported);
  EXPECT_EQ(why_not(scene, {.kind = RectLight{}}), "the formulas are of one point: lights with area have none");
  EXPECT_EQ(why_not(scene, {.kind = DiscLight{}}), "the formulas are of one point: lights with area have none");
  EXPECT_EQ(why_not(scene, {.kind = SphereLight{}}), "the formulas are of one point: lights with area have none");
  EXPECT_EQ(why_not(scene, {.kind = PointLight{{0, 1.2f, 0}}}), "ball: the light is in or on the sphere");
  Scene corner = scene;
  corner.meshes.push_back(mesh_of(Plane{{-4, 2, 0}, {0, 2, 0}, {0, 0, 4}}, 24, "wall"));
  EXPECT_EQ(why_not(corner, {.kind = SpotLight{{1, 0, 1}}}), "ground: the light is in or on the plane");

  Scene soup = scene;
  soup.meshes[1].shape.reset();
  EXPECT_EQ(why_not(soup, point), "ball has no exact shape");
  soup.meshes[1].casts = false;
  EXPECT_NE(supports(soup, point).kind(), Support::Kind::unsupported);

  Scene no_plane;
  no_plane.meshes = {mesh_of(Sphere{{0, 1, 0}, 0.5f})};
  EXPECT_EQ(why_not(no_plane, point), "no plane holds 0.01 of the receiving area");
  EXPECT_EQ(why_not(corner, point, "min_share=1"), "no plane holds 1 of the receiving area");

  scene.meshes[1].receives = false;
  EXPECT_EQ(supports(scene, point).kind(), Support::Kind::full);
}

TEST_F(CompositeForms, the_papers_domain_is_stated) {
  const Light point{.kind = PointLight{{0, 5, 0}}};
  const auto over_ground = [](const Shape& shape) {
    Scene scene;
    scene.meshes = {mesh_of(level({0, 0, 0}, 4), 24, "ground"), mesh_of(shape, 24, "it")};
    scene.meshes[1].receives = false;
    return scene;
  };
  const Triangle leaning{{{0, 0.5f, 0}, {1, 0.5f, 0}, {0.2f, 1, 0}}};
  for (const char* form : {"form=paper", "form=printed"}) {
    for (const Shape& shape :
         std::vector<Shape>{Sphere{{0, 1, 0}, 0.5f}, Cone{{0, 0.5f, 0}}, Disc{{0, 1, 0}}, Disc{{0, 1, 0}, {0, -2, 0}},
                            Triangle{{{0, 0.5f, 0}, {1, 0.5f, 0}, {0.5f, 1, 0}}}})
      EXPECT_EQ(supports(over_ground(shape), point, form).kind(), Support::Kind::full) << form << kind_name(shape);
    EXPECT_EQ(why_not(over_ground(Disc{{0, 1, 0}, {0.1f, 1, 0}}), point, form), "it: the disc is not parallel to the plane");
    EXPECT_EQ(why_not(over_ground(Cone{{0, 2, 0}, {0, -1, 0}}), point, form), "it: the cone does not stand upright");
    EXPECT_EQ(why_not(over_ground(Cone{{0, 2, 0}, {1, 1, 0}}), point, form), "it: the cone does not stand upright");
    EXPECT_EQ(why_not(over_ground(Box{{0, 1, 0}, {1, 2, 1}}), point, form), "it: there is no formula for a box");
    EXPECT_EQ(why_not(over_ground(level({0, 1, 0}, 1)), point, form), "it: there is no formula for a plane");
    EXPECT_EQ(why_not(over_ground(Sphere{{0, 0.4f, 0}, 0.5f}), point, form), "it: the sphere crosses the plane");
    EXPECT_EQ(why_not(over_ground(Sphere{{3, 4.6f, 0}, 0.5f}), point, form), "it: the light is not above the sphere");
    // What casts nothing is nobody's concern: below the plane, or above the light.
    EXPECT_EQ(supports(over_ground(Box{{0, -2, 0}, {1, -1, 1}}), point, form).kind(), Support::Kind::full);
    EXPECT_EQ(supports(over_ground(Box{{0, 6, 0}, {1, 7, 1}}), point, form).kind(), Support::Kind::full);
    for (const Shape& shape :
         std::vector<Shape>{Disc{{0, 1, 0}, {0.1f, 1, 0}}, Box{{0, 1, 0}, {1, 2, 1}}, Sphere{{0, 0.4f, 0}, 0.5f}})
      EXPECT_EQ(supports(over_ground(shape), point).kind(), Support::Kind::full);
  }
  EXPECT_EQ(supports(over_ground(leaning), point, "form=paper").kind(), Support::Kind::full);
  EXPECT_EQ(why_not(over_ground(leaning), point, "form=printed"), "it: the triangle is not isosceles and upright");
}

}  // namespace composite_planar_forms_test
