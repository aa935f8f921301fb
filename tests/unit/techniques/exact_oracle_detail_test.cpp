// The polygons of every exact technique that makes some are what the exact oracle says at their inner points.
#include "exact_oracle_rig.h"
#include "exact_techniques.h"
#include "mixed_scene.h"

namespace gnomon::exact_oracle::exact_oracle_detail_test {

std::vector<ExactTechnique> with_surface_detail() {
  std::vector<ExactTechnique> all = exact_techniques();
  std::erase_if(all, [](const ExactTechnique& technique) { return !technique.make()->surface_detail(); });
  return all;
}

/// A scene and a light, and polygons of its triangles.
struct Divided {
  Scene scene;
  glm::dvec4 light;
  SurfaceDetail detail;
  double extent;  ///< largest coordinate of the scene, meters

  std::span<const glm::dvec3> corners(const DetailPolygon& polygon) const {
    return {detail.corners.data() + polygon.first, polygon.count};
  }

  Triangle own(const DetailPolygon& polygon) const { return scene.meshes[polygon.mesh].corners(polygon.triangle); }

  /// Calls visit(triangle) for every one of the scene.
  template <class Visit>
  void for_triangles(const Visit& visit) const {
    for (const Mesh& mesh : scene.meshes)
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) visit(mesh.corners(t));
  }

  /// Whether an inner point is far from the edges that could change its answer, and from the planes of other triangles.
  bool is_clear(const ExactScene& exact, const Receiver& receiver, const glm::dvec3& p) const {
    const double rounding = 3e-7 * extent;
    if (exact.edge_margin(receiver, light, 1e-6 * extent).clearance <= rounding) return false;
    const Triangle own = scene.meshes[receiver.mesh].corners(receiver.triangle);
    bool is_clear = true;
    for_triangles([&](const Triangle& other) {
      const double height = glm::dot(glm::normalize(other.normal()), p - glm::dvec3(other.points[0]));
      is_clear &= std::abs(height) >= rounding || std::ranges::all_of(other.points, [&](const glm::vec3& q) {
                    return coplanar(own.points[0], own.points[1], own.points[2], q);
                  });
    });
    return is_clear;
  }
};

/// Polygons come triangle after triangle, lie on them, are wound as they are and make up the areas of those that the light does
/// not see edge-on. Alone that would say little.
void expect_division(const Divided& divided) {
  double expected = 0, found = 0;
  divided.for_triangles([&](const Triangle& triangle) {
    const glm::vec3* p = triangle.points;
    if (orient3d_sign(p[0], p[1], p[2], divided.light) != 0) expected += glm::length(triangle.normal());
  });
  std::pair<std::uint32_t, std::uint32_t> last(0, 0);
  for (const DetailPolygon& polygon : divided.detail.polygons) {
    const std::pair at(polygon.mesh, polygon.triangle);
    EXPECT_GE(at, last);
    last = at;
    const Triangle own = divided.own(polygon);
    const glm::dvec3 normal = glm::normalize(own.normal());
    const std::span<const glm::dvec3> corners = divided.corners(polygon);
    ASSERT_GE(corners.size(), 3u);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      found += glm::dot(glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]), normal);
    for (const glm::dvec3& p : corners) EXPECT_NEAR(glm::dot(normal, p - glm::dvec3(own.points[0])), 0, 1e-10 * divided.extent);
  }
  EXPECT_NEAR(found, expected, 1e-7 * expected);
}

struct Points {
  int wrong = 0, checked = 0, left_out = 0, dark = 0;
  std::string text() const { return fmt::format("{} checked, {} of them dark, {} left out", checked, dark, left_out); }
};

/// Calls the oracle for a random inner point of every polygon.
void ask(const Divided& divided, Random& random, Points& points) {
  const ExactScene exact(divided.scene);
  ExactTally tally;
  for (const DetailPolygon& polygon : divided.detail.polygons) {
    glm::dvec3 p(0);
    double sum = 0;
    for (const glm::dvec3& corner : divided.corners(polygon)) {
      const double weight = random.uniform(0.02, 1);
      p += weight * corner;
      sum += weight;
    }
    p /= sum;
    const Receiver receiver{glm::vec3(p), polygon.mesh, polygon.triangle};
    if (!divided.is_clear(exact, receiver, p)) {
      ++points.left_out;
      continue;
    }
    ++points.checked;
    points.dark += !polygon.is_lit;
    points.wrong += exact.occluded(receiver, divided.light, tally).blocked == polygon.is_lit;
  }
}

struct ExactDetail : ExactOracle {};

INSTANTIATE_TEST_SUITE_P(All, ExactDetail, testing::ValuesIn(with_surface_detail()),
                         [](const auto& info) { return info.param.id(); });

// Inner points of the polygons, which no point location has to do with. Left out are the points whose way in float32 passes an
// edge, or that lie on the plane of another triangle, within rounding: 3e-7 of the extent. Pieces that are not merged are
// narrower, and more of their points are left out.
TEST_P(ExactDetail, is_what_the_oracle_says) {
  Random random(31);
  std::mt19937 engine(31);
  Points merged, pieces;
  for (int round = 0; round < 36; ++round) {
    const Scene scene = mixed_scene(random, engine, round);
    const Light light = hard_scenes::hard_light(random);
    const std::string settings = GetParam().settings_in(round / mixed_kinds)[0];
    for (Points* points : {&merged, &pieces}) {
      const std::string each = points == &merged ? settings : settings.empty() ? "merge=false" : settings + ",merge=false";
      SCOPED_TRACE(fmt::format("round {}, settings '{}'", round, each));
      const auto technique = run(each, scene, light, hand_made::Picture(1, 1).gbuffer).technique;
      const Divided divided{scene, homogeneous(light), technique->surface_detail().value(), scene.bounds().extent()};
      expect_division(divided);
      ask(divided, random, *points);
    }
  }
  for (const auto& [points, most_left_out] : {std::pair(merged, 0.1), std::pair(pieces, 0.33)}) {
    EXPECT_EQ(points.wrong, 0);
    EXPECT_GT(points.checked, 20'000);
    EXPECT_GT(points.dark, 5'000);
    EXPECT_LT(points.left_out, most_left_out * points.checked);
  }
  RecordProperty("merged", merged.text());
  RecordProperty("pieces", pieces.text());
}

}  // namespace gnomon::exact_oracle::exact_oracle_detail_test
