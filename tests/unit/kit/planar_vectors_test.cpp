// Every vector of tests/data/planar_vectors.json, what its formula as printed would give included: projection of points (the
// lecture), shadows of circles, triangles, spheres and cones (Pljaskovic et al.). x_i, y_i, z_i is the light, d the height over
// the plane y = 0, r a radius, h_p and a the height and base of a triangle.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "places.h"
#include "planar_conic.h"

namespace planar_vectors_test {
using namespace gnomon;
using nlohmann::json;
using planar_conic::Conic;

constexpr double pi = std::numbers::pi;
const glm::dvec4 ground(0, 1, 0, 0);

/// The values of a vector, expected or as printed. Each must be read: `finish` complains of those that nobody compared.
class Values {
 public:
  Values(const json& vector, const char* which) : tolerance_(vector.at("tolerance_abs")) {
    if (vector.contains(which)) values_ = vector.at(which);
    for (const auto& [key, value] : values_.items())
      if (!value.is_string()) open_.insert(key);
  }
  bool has(const std::string& key) const { return values_.contains(key); }
  void near(const std::string& key, double actual, double tolerance = 0) {
    EXPECT_NEAR(values_.at(key).get<double>(), actual, tolerance > 0 ? tolerance : tolerance_) << key;
    open_.erase(key);
  }
  void near(const std::string& key, const std::vector<double>& actual) {
    const auto wanted = values_.at(key).get<std::vector<double>>();
    EXPECT_EQ(wanted.size(), actual.size()) << key;
    for (std::size_t k = 0; k < std::min(wanted.size(), actual.size()); ++k)
      EXPECT_NEAR(wanted[k], actual[k], tolerance_) << key;
    open_.erase(key);
  }
  void near(const std::string& key, const glm::dvec3& actual) { near(key, std::vector{actual.x, actual.y, actual.z}); }
  template <class T>
  void equal(const std::string& key, const T& actual) {
    EXPECT_EQ(values_.at(key).get<T>(), actual) << key;
    open_.erase(key);
  }
  json take(const std::string& key) {
    open_.erase(key);
    return values_.at(key);
  }
  double tolerance() const { return tolerance_; }
  void finish() const {
    for (const std::string& key : open_) ADD_FAILURE() << "nothing was compared with " << key;
  }

 private:
  json values_ = json::object();
  double tolerance_;
  std::set<std::string> open_;
};

struct Vector {
  json inputs;
  Values expected, printed;

  double in(const char* key) const { return inputs.at(key); }
  float size(const char* key) const { return inputs.at(key).get<float>(); }
  glm::dvec3 point(const char* key) const {
    const auto p = inputs.at(key).get<std::vector<double>>();
    return {p[0], p[1], p[2]};
  }
  glm::dvec4 homogeneous(const char* key) const { return {point(key), inputs.at(key)[3].get<double>()}; }
  glm::dvec4 light() const { return {in("x_i"), in("y_i"), inputs.value("z_i", 0.0), 1}; }
};

glm::dvec3 divided(const glm::dvec4& p) { return glm::dvec3(p) / p.w; }
glm::dvec3 image(const glm::dvec3& p, const glm::dvec4& light) { return divided(image_on_plane(p, light, ground)); }

/// Area of the intersection over that of the union, from the centers of `cells` x `cells` rectangles of the ground.
double overlap(const PlanarShadow& a, const PlanarShadow& b, const glm::dvec2& low, const glm::dvec2& high, int cells = 1000) {
  double both = 0, either = 0;
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      const glm::dvec2 p = low + (high - low) * (glm::dvec2(i, k) + 0.5) / double(cells);
      const bool in_a = a.contains({p.x, 0, p.y}), in_b = b.contains({p.x, 0, p.y});
      both += in_a && in_b, either += in_a || in_b;
    }
  return both / either;
}

// --- Points on the plane z = 0 ---------------------------------------------------------------------------------------------

// The slide's matrix [lz 0 -lx 0; 0 lz -ly 0; 0 0 1 -lz] gives w = p_z - l_z, the negative of what the first two rows go with:
// the image comes out mirrored in the origin. image_on_plane has w = l_z - p_z, positive below the light. It is a shadow on the
// plane when the point is over it, too.
void check_projection(Vector& v) {
  const glm::dvec3 l = v.point("light"), p = v.point("point");
  const glm::dvec4 plane(0, 0, 1, 0), h = image_on_plane(p, {l, 1}, plane);
  EXPECT_EQ(h.z, 0);
  v.expected.near("homogeneous", glm::dvec3(h.x, h.y, h.w));
  v.expected.near("w", h.w);
  if (v.expected.has("casts_on_plane")) v.expected.equal("casts_on_plane", h.w > 0 && p.z >= 0);
  if (v.expected.has("xy")) v.expected.near("xy", std::vector{h.x / h.w, h.y / h.w});
  // The way from the light in units of that to the point.
  if (v.expected.has("t")) v.expected.near("t", glm::distance(divided(h), l) / glm::distance(p, l));
  if (!v.printed.has("w")) return;
  const glm::dvec4 rows[] = {{l.z, 0, -l.x, 0}, {0, l.z, -l.y, 0}, {0, 0, 1, -l.z}};
  const glm::dvec4 point(p, 1);
  const double x = glm::dot(rows[0], point), y = glm::dot(rows[1], point), w = glm::dot(rows[2], point);
  v.printed.near("homogeneous", glm::dvec3(x, y, w));
  v.printed.near("w", w);
  v.printed.near("xy", std::vector{x / w, y / w});
}

// (P.L) I - L P^T, of which image_on_plane is the product with a point: its columns are the images of (1, 0, 0, 0) to (0, 0, 0,
// 1), and those of a direction are the difference of the images of two points. The plane's normal need not be of unit length.
void check_matrix(Vector& v) {
  const glm::dvec4 plane = v.homogeneous("plane"), light = v.homogeneous("light_h"), p = v.homogeneous("point_h");
  const glm::dvec4 origin = image_on_plane({0, 0, 0}, light, plane);
  const glm::dvec4 columns[] = {image_on_plane({1, 0, 0}, light, plane) - origin,
                                image_on_plane({0, 1, 0}, light, plane) - origin,
                                image_on_plane({0, 0, 1}, light, plane) - origin, origin};
  const json matrix = v.expected.take("matrix");
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_NEAR(matrix[row][column].get<double>(), columns[column][row], v.expected.tolerance()) << row << " " << column;
  const glm::dvec4 h = image_on_plane(glm::dvec3(p), light, plane);
  v.expected.near("homogeneous", std::vector{h.x, h.y, h.z, h.w});
  v.expected.near("xyz", divided(h));
}

// --- Circle and triangle ---------------------------------------------------------------------------------------------------

// (1) x_s = -d x_i / (y_i - d), (2) r_1 = r y_i / (y_i - d): the circle is right, and all forms have it. A disc in the plane
// (d = 0) has its own circle for an image and, since nothing of it is over the plane, no shadow.
void check_circle(Vector& v) {
  const Disc disc{{0, v.size("d"), 0}, {0, 1, 0}, v.size("r")};
  const glm::dvec3 center = image(disc.center, v.light()), rim = image(disc.center + glm::vec3(disc.radius, 0, 0), v.light());
  v.expected.near("x_s", center.x);
  v.expected.near("z_s", center.z);
  v.expected.near("r_1", glm::distance(center, rim));
  for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper}) {
    const PlanarShadow shadow(disc, v.light(), ground, form);
    EXPECT_EQ(shadow.parts().size(), v.in("d") > 0 ? 1u : 0u);
    for (const FlatPart& part : shadow.parts()) {
      v.expected.near("x_s", part.points[0].x);
      v.expected.near("z_s", part.points[0].z);
      v.expected.near("r_1", part.radius());
    }
  }
  const PlanarShadow exact(disc, v.light(), ground);
  for (const ShadowTest& test : exact.tests()) {
    const Conic conic(test);
    v.expected.near("x_s", conic.center().x);
    v.expected.near("z_s", conic.center().y);
    v.expected.near("r_1", conic.semi_axes().x);
    v.expected.near("r_1", conic.semi_axes().y);
  }
}

Triangle triangle_of(const Vector& v, const glm::vec3& along) {
  const glm::vec3 middle(0, v.size("d"), 0), half = along * (v.size("a") / 2);
  return {{middle - half, middle + half, middle + glm::vec3(0, v.size("h_p"), 0)}};
}

// The light is in the triangle's plane: the image is a segment, from the least to the greatest x of the three points, and its
// shadow is nothing. With the light moved out of the plane to z = 1 the printed points keep their x, and the triangle has an
// area.
void check_triangle_along_x(Vector& v) {
  const Triangle triangle = triangle_of(v, {1, 0, 0});
  const glm::dvec3 p1 = image(triangle.points[0], v.light()), p2 = image(triangle.points[1], v.light()),
                   p3 = image(triangle.points[2], v.light());
  v.expected.near("a_1", p2.x - p1.x);
  v.expected.near("x_s", image({0, v.in("d"), 0}, v.light()).x);
  v.expected.near("segment", std::vector{std::min({p1.x, p2.x, p3.x}), std::max({p1.x, p2.x, p3.x})});
  for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper, ShadowForm::exact}) {
    EXPECT_EQ(PlanarShadow::objection(triangle, v.light(), ground, form), "");
    EXPECT_TRUE(PlanarShadow(triangle, v.light(), ground, form).parts().empty());
    if (form == ShadowForm::exact) continue;
    const PlanarShadow beside(triangle, v.light() + glm::dvec4(0, 0, 1, 0), ground, form);
    EXPECT_EQ(beside.parts().size(), 1u);
    for (const FlatPart& part : beside.parts())
      for (int k = 0; k < 3; ++k) v.expected.near(fmt::format("x_s{}", k + 1), part.points[k].x);
  }
}

// P1 and P2 as printed are (0, 0, -+a_1 / 2): the base stays at x = 0. Meant is x_s.
void check_triangle_along_z(Vector& v) {
  const Triangle triangle = triangle_of(v, {0, 0, 1});
  for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper}) {
    const PlanarShadow shadow(triangle, v.light(), ground, form);
    ASSERT_EQ(shadow.parts().size(), 1u);
    Values& values = form == ShadowForm::printed ? v.printed : v.expected;
    for (int k = 0; k < 3; ++k) values.near(fmt::format("P{}", k + 1), shadow.parts()[0].points[k]);
    values.near("area", planar_conic::area(shadow.outlines(3)[0]));
  }
  v.expected.near("area", planar_conic::area(PlanarShadow(triangle, v.light(), ground).outlines(3)[0]));
}

// --- Sphere ----------------------------------------------------------------------------------------------------------------

// With h = y_i - d and K = h^2 - r^2 an ellipse around -x_i (d h + r^2) / K with the semi-axes y_i r sqrt(x_i^2 + K) / K and
// y_i r / sqrt K; as printed the circle of (1), (2), a part of it. A resting sphere's contact, the origin, is a focus
// (Dandelin).
void check_sphere(Vector& v) {
  const Sphere sphere{{0, v.size("d"), 0}, v.size("r")};
  const PlanarShadow exact(sphere, v.light(), ground), printed(sphere, v.light(), ground, ShadowForm::printed);
  ASSERT_EQ(exact.tests().size(), 1u);
  const Conic conic(exact.tests()[0]);
  EXPECT_NEAR(conic.xz, 0, 1e-12);
  EXPECT_NEAR(conic.center().y, 0, 1e-12);
  const double x_c = conic.center().x, semi_x = conic.semi_axes().x, semi_z = conic.semi_axes().y;
  const double focal = std::sqrt(std::max(0.0, semi_x * semi_x - semi_z * semi_z));
  v.expected.near("x_c", x_c);
  v.expected.near("semi_x", semi_x);
  v.expected.near("semi_z", semi_z);
  v.expected.near("x_near", x_c + semi_x);
  v.expected.near("x_far", x_c - semi_x);
  v.expected.near("area", conic.area());
  // A difference of nearly equal squares: on the axis the rounding of the semi-axes shows as its root.
  v.expected.near("focal_distance", focal, std::max(v.expected.tolerance(), 4e-8 * semi_x));
  if (v.expected.has("contact_is_focus")) v.expected.equal("contact_is_focus", std::abs(x_c + focal) < 1e-9);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(exact.contains({x_c + side * (semi_x - 1e-8), 0, 0}));
    EXPECT_FALSE(exact.contains({x_c + side * (semi_x + 1e-8), 0, 0}));
    EXPECT_TRUE(exact.contains({x_c, 0, side * (semi_z - 1e-8)}));
    EXPECT_FALSE(exact.contains({x_c, 0, side * (semi_z + 1e-8)}));
  }
  // The outline runs on the ellipse.
  const auto loops = exact.outlines(64);
  for (const glm::dvec4& p : loops.at(0)) {
    const glm::dvec3 at = divided(p);
    EXPECT_NEAR(glm::length(glm::dvec2((at.x - x_c) / semi_x, at.z / semi_z)), 1, 1e-9);
  }
  ASSERT_EQ(printed.parts().size(), 1u);
  const FlatPart& circle = printed.parts()[0];
  const double area = pi * circle.radius() * circle.radius();
  v.printed.near("x_s", circle.points[0].x);
  v.printed.near("r_1", circle.radius());
  v.printed.near("area", area);
  v.printed.near("area_ratio_to_exact", area / conic.area());
  if (v.printed.has("iou_with_exact_approx"))
    v.printed.near("iou_with_exact_approx", overlap(exact, printed, {x_c - semi_x, -semi_z}, {x_c + semi_x, semi_z}), 2e-4);
}

// The same conic for any light, up to a positive factor.
void check_conic(Vector& v) {
  const Sphere sphere{v.point("center"), v.size("r")};
  const PlanarShadow shadow(sphere, {v.point("light"), 1}, ground);
  ASSERT_EQ(shadow.tests().size(), 1u);
  const Conic conic(shadow.tests()[0]);
  const auto wanted = v.expected.take("coefficients_xx_xz_zz_x_z_1").get<std::vector<double>>();
  const double actual[] = {conic.xx, conic.xz, conic.zz, conic.x, conic.z, conic.one}, factor = wanted[0] / actual[0];
  EXPECT_GT(factor, 0);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(wanted[k], factor * actual[k], v.expected.tolerance()) << k;
  const double discriminant = factor * factor * conic.discriminant();
  v.expected.near("discriminant", discriminant);
  v.expected.equal<std::string>("kind", discriminant < 0 ? "ellipse" : discriminant > 0 ? "hyperbola" : "parabola");
  int infinite = 0;
  const auto loops = shadow.outlines(64);
  for (const glm::dvec4& p : loops.at(0)) infinite += p.w == 0;
  EXPECT_EQ(infinite, discriminant > 0 ? 2 : 0);
}

// --- Cone ------------------------------------------------------------------------------------------------------------------

// The hull of the base's circle (x_s, r_1) and the peak's image, which the tangents touch at +-acos(r_1 / c), c from the center
// to the image: the sector away from it and the kite between. As printed the triangle's base is the diameter at x = 0, as meant
// at x_s; that meets the circle again at the angle 2 atan(c / r_1) - pi / 2.
void check_cone(Vector& v) {
  const Cone cone{{0, v.size("d"), 0}, {0, 1, 0}, v.size("r"), v.size("h_p")};
  const PlanarShadow exact(cone, v.light(), ground), paper(cone, v.light(), ground, ShadowForm::paper);
  ASSERT_EQ(paper.parts().size(), 2u);
  const FlatPart &circle = paper.parts()[0], &triangle = paper.parts()[1];
  const double r_1 = circle.radius(), x_s = circle.points[0].x, c = glm::distance(triangle.points[2], circle.points[0]);
  v.expected.near("x_s", x_s);
  v.expected.near("r_1", r_1);
  v.expected.near("x_apex", triangle.points[2].x);
  v.expected.near("apex_offset", c);
  v.expected.near("area_disc", pi * r_1 * r_1);
  const bool circle_only = exact.parts().size() == 1;
  v.expected.equal("circle_only", circle_only);
  const Conic conic(exact.tests()[0]);
  v.expected.near("x_s", conic.center().x);
  v.expected.near("area_disc", conic.area());
  double hull = pi * r_1 * r_1;
  if (!circle_only) {
    const glm::dvec3 apex = image(exact.parts()[1].points[0], v.light());
    v.expected.near("x_apex", apex.x);
    const json tangents = v.expected.take("tangent_points");
    double half = 0;
    for (int k = 0; k < 2; ++k) {
      // The vector has that at +z first.
      const glm::dvec3 a = image(exact.parts()[1].points[1], v.light()), b = image(exact.parts()[1].points[2], v.light());
      const glm::dvec3 p = (a.z > b.z) == (k == 0) ? a : b;
      EXPECT_NEAR(tangents[k][0].get<double>(), p.x, v.expected.tolerance());
      EXPECT_NEAR(tangents[k][1].get<double>(), p.z, v.expected.tolerance());
      EXPECT_NEAR(glm::dot(p - circle.points[0], apex - p), 0, 1e-9);  // a radius and its tangent
      half = std::acos(glm::dot(p - circle.points[0], apex - circle.points[0]) / (r_1 * c));
    }
    v.expected.near("phi_rad", half);
    hull = r_1 * r_1 * (pi - half) + r_1 * c * std::sin(half);
    const double again = 2 * std::atan(c / r_1) - pi / 2;
    const double joined = pi * r_1 * r_1 + r_1 * c - r_1 * r_1 * (std::cos(again) + again);
    v.expected.near("area_union_corrected_base", joined);
    v.expected.near("missing_fraction_union", 1 - joined / hull);
    const glm::dvec2 low(std::min(apex.x, x_s - r_1), -r_1), high(std::max(apex.x, x_s + r_1), r_1);
    EXPECT_NEAR(overlap(exact, paper, low, high), joined / hull, 5e-4);
    const PlanarShadow printed(cone, v.light(), ground, ShadowForm::printed);
    if (v.printed.has("iou_with_exact_approx"))
      v.printed.near("iou_with_exact_approx", overlap(exact, printed, low, {std::max(high.x, 0.0), std::max(high.y, r_1)}),
                     5e-4);
  }
  v.expected.near("area", hull);
  EXPECT_NEAR(planar_conic::area(exact.outlines(8192)[0]), hull, 2e-7 * hull);
}

// --- All of them -----------------------------------------------------------------------------------------------------------

TEST(PlanarVectors, hold) {
  const std::pair<std::string, void (*)(Vector&)> checks[] = {{"projection_z0_", check_projection},
                                                              {"projection_4x4_", check_matrix},
                                                              {"circle_", check_circle},
                                                              {"triangle_baseX", check_triangle_along_x},
                                                              {"triangle_baseZ", check_triangle_along_z},
                                                              {"sphere_conic_", check_conic},
                                                              {"sphere_", check_sphere},
                                                              {"cone_", check_cone}};
  std::ifstream file(data_file("planar_vectors.json"));
  ASSERT_TRUE(file);
  const json all = json::parse(file);
  EXPECT_EQ(all.at("vectors").size(), 25u);
  for (const json& vector : all.at("vectors")) {
    const std::string name = vector.at("name");
    SCOPED_TRACE(name);
    const auto check = std::ranges::find_if(checks, [&](const auto& c) { return name.starts_with(c.first); });
    if (check == std::end(checks)) {
      ADD_FAILURE() << "no test has this vector";
      continue;
    }
    Vector v{vector.at("inputs"), Values(vector, "expected"), Values(vector, "as_printed")};
    check->second(v);
    v.expected.finish();
    v.printed.finish();
  }
}

}  // namespace planar_vectors_test
