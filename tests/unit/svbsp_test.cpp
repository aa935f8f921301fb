// The SVBSP tree: light space, planes and cells on paper; areas; orders, rules
// and threads that change nothing; the painter.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>

#include "../../techniques/svbsp/detail.h"
#include "hard_scenes.h"

extern "C" void gnomon_technique_svbsp(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using namespace svbsp;
using small_world::value;

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_svbsp, settings, scene, light, gbuffer);
}

/// Without a picture to speak of.
std::unique_ptr<Technique> lit(const std::string& settings, const Scene& scene, const Light& light) {
  return run(settings, scene, light, Picture(1, 1).gbuffer).technique;
}

double area_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  const glm::dvec3* p = detail.corners.data() + polygon.first;
  glm::dvec3 twice(0);
  for (std::uint32_t k = 1; k + 1 < polygon.count; ++k) twice += glm::cross(p[k] - p[0], p[k + 1] - p[0]);
  return glm::length(twice) / 2;
}

double area(const SurfaceDetail& detail, std::uint32_t mesh, bool is_lit) {
  double sum = 0;
  for (const DetailPolygon& polygon : detail.polygons)
    if (polygon.mesh == mesh && polygon.is_lit == is_lit) sum += area_of(detail, polygon);
  return sum;
}

const char* const all_orders[] = {"", "order=bsp", "order=bsp,split=first", "order=bsp,free_cuts=false,split=fewest_splits",
                                  "order=face_planes"};

// A lamp at (1, 2, 3) sees (1, 6, 3) straight along +y at the distance 4, (2,
// 6, 1) where y's face has z / y = -2 / 4 and x / y = 1 / 4; and (-4, 2, 3)
// straight along -x.
TEST(Svbsp, a_lamp_sees_in_perspective) {
  const LightSpace space({1, 2, 3, 1}, {});
  EXPECT_EQ(space.face_count(), 6);
  ASSERT_EQ(space.face_of({1, 6, 3}), 2);
  EXPECT_EQ(space.of_world(2, {1, 6, 3}), glm::dvec3(0, 0, 0.25));
  EXPECT_EQ(space.of_world(2, {2, 6, 1}), glm::dvec3(-0.5, 0.25, 0.25));
  ASSERT_EQ(space.face_of({-4, 2, 3}), 1);
  EXPECT_EQ(space.of_world(1, {-4, 2, 3}), glm::dvec3(0, 0, 0.2));
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 p = random.uniform(glm::dvec3(-5), glm::dvec3(5));
    const int face = space.face_of(p);
    const glm::dvec3 seen = space.of_world(face, p);
    EXPECT_LE(std::max(std::abs(seen.x), std::abs(seen.y)), 1);
    EXPECT_GT(seen.z, 0);
    EXPECT_LT(glm::distance(space.to_world(face, seen), p), 1e-14);
  }
}

// Straight lines stay straight, nearer is greater, and a plane's value over
// `meter` is the distance: on either kind of light.
TEST(Svbsp, planes_are_planes_in_light_space) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Light light = hard_scenes::hard_light(random);
    const glm::dvec4 at = homogeneous(light);
    const LightSpace space(at, {{-2, -2, -2}, {2, 2, 2}});
    glm::vec3 corners[3];
    for (glm::vec3& p : corners) p = glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2)));
    const int facing = orient3d_sign(corners[0], corners[1], corners[2], at);
    if (facing == 0) continue;
    const glm::dvec3 p = random.uniform(glm::dvec3(-3), glm::dvec3(3)), a(corners[0]);
    const int face = space.face_of(p);
    glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(corners[1]) - a, glm::dvec3(corners[2]) - a));
    if (glm::dot(normal, to_light(at, a)) < 0) normal = -normal;
    const glm::dvec3 seen = space.of_world(face, p);
    EXPECT_NEAR(space.plane(face, corners, facing).at(seen) / space.meter(seen), glm::dot(normal, p - a), 1e-12);
    // Half way to a lamp, or one meter toward a sun.
    const glm::dvec3 nearer = at.w != 0 ? p + 0.5 * to_light(at, p) : p + glm::normalize(glm::dvec3(at));
    const glm::dvec3 higher = space.of_world(face, nearer);
    EXPECT_NEAR(higher.x, seen.x, 1e-12 * (1 + std::abs(seen.x)));
    EXPECT_NEAR(higher.y, seen.y, 1e-12 * (1 + std::abs(seen.y)));
    EXPECT_NEAR(higher.z, at.w != 0 ? 2 * seen.z : seen.z + 1, 1e-12 * higher.z * higher.z + 1e-12);
  }
}

/// Pieces at a height over x and y, in a tree of their own.
struct Paper {
  LightSpace space{{0, 0, 1, 0}, {}};
  Rules rules{.epsilon = {1e-10, 1e-10}};
  std::vector<Node> nodes;
  Tally tally;
  std::vector<double> heights;
  Link root = out_cell;
  struct Plane {
    const std::vector<double>* heights;
    ClipPlane operator()(std::uint32_t piece) const { return {{0, 0, 1}, -(*heights)[piece]}; }
  };
  Builder<Plane> builder{space, rules, {&heights}, nodes, tally};

  void add(double height, std::vector<Corner> corners) {
    for (Corner& corner : corners) corner.at.z = height;
    heights.push_back(height);
    builder.add(corners, static_cast<std::uint32_t>(heights.size() - 1), root);
  }
  Link at(double x, double y) const {
    std::uint64_t visits = 0;
    Query query{.x = x, .y = y, .nodes = nodes.data(), .link = root};
    locate<1>({&query, 1}, visits);
    return query.link;
  }
};

const std::vector<Corner> left_half = {{{0, 0, 0}}, {{4, 4, 0}}, {{0, 4, 0}}},
                          right_half = {{{0, 0, 0}}, {{4, 0, 0}}, {{4, 4, 0}}};

// The first triangle makes three planes. Its neighbor across the diagonal lies
// beyond the diagonal's plane, so two more are enough; with only cut edges
// dropped it makes three.
TEST(Svbsp, an_edge_in_common_has_one_plane) {
  Paper shared;
  shared.add(1, left_half);
  EXPECT_EQ(shared.nodes.size(), 3u);
  shared.add(1, right_half);
  EXPECT_EQ(shared.nodes.size(), 5u);
  EXPECT_EQ(shared.tally.cuts, 0u);
  EXPECT_EQ(shared.tally.lit, 2u);
  for (const Drop drop : {Drop::cut, Drop::none}) {
    Paper all;
    all.rules.drop = drop;
    all.add(1, left_half), all.add(1, right_half);
    EXPECT_EQ(all.nodes.size(), 6u);
  }
  for (const auto& [x, y] : {std::pair{1, 3}, {3, 1}}) EXPECT_EQ(shared.at(x, y), in_cell(x > y));
  for (const auto& [x, y] : {std::pair{-1, 3}, {5, 1}, {1, 5}, {3, -1}}) EXPECT_EQ(shared.at(x, y), out_cell);
}

// A square across the left edge, x = 0, of a triangle is cut once by it: a
// shadowed part and a lit one, whose planes are those of its three own edges.
// Were the cut's plane made too, there would be four, and the shadow the same.
TEST(Svbsp, cuts_make_no_planes) {
  const std::vector<Corner> square = {{{-1, 2, 0}}, {{1, 2, 0}}, {{1, 3, 0}}, {{-1, 3, 0}}};
  for (const auto& [drop, planes] : {std::pair{Drop::shared, 3u}, {Drop::cut, 3u}, {Drop::none, 4u}}) {
    Paper paper;
    paper.rules.drop = drop;
    paper.add(2, left_half), paper.add(1, square);
    EXPECT_EQ(paper.nodes.size(), 3 + planes);
    EXPECT_EQ(paper.tally.cuts, 1u);
    EXPECT_EQ(paper.tally.lit, 2u);
    EXPECT_EQ(paper.tally.shadowed, 1u);
    EXPECT_EQ(paper.at(-0.5, 2.5), in_cell(1));
    EXPECT_EQ(paper.at(0.5, 2.5), in_cell(0));
    EXPECT_EQ(paper.at(-1.5, 2.5), out_cell);
  }
}

// The trap: an edge that the regular BSP tree made lies on no plane of this
// tree. A polygon whose only edge toward x > 4 is such a cut must not shade
// what is there.
TEST(Svbsp, cuts_of_the_regular_tree_make_planes) {
  Paper paper;
  paper.add(1, {{{0, 0, 0}}, {{4, 0, 0}, bsp_cut}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(paper.nodes.size(), 4u);
  EXPECT_EQ(paper.at(3, 2), in_cell(0));
  EXPECT_EQ(paper.at(5, 2), out_cell);
  Paper wrong;
  wrong.add(1, {{{0, 0, 0}}, {{4, 0, 0}, shadow_cut}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(wrong.at(5, 2), in_cell(0));
}

// An edge without length has no plane: two corners in one place change nothing.
TEST(Svbsp, edges_without_length_make_no_planes) {
  Paper paper;
  paper.add(1, {{{0, 0, 0}}, {{4, 0, 0}}, {{4, 0, 0}}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(paper.nodes.size(), 4u);
  EXPECT_EQ(paper.at(3, 2), in_cell(0));
  EXPECT_EQ(paper.at(5, 2), out_cell);
}

// In whatever order: the nearer one is found where it is, and the farther one
// around it; none counts twice.
TEST(Svbsp, cells_know_what_is_nearest_in_any_order) {
  const std::vector<Corner> large = {{{0, 0, 0}}, {{8, 0, 0}}, {{8, 8, 0}}, {{0, 8, 0}}},
                            small = {{{2, 2, 0}}, {{3, 2, 0}}, {{3, 3, 0}}, {{2, 3, 0}}};
  Paper near_first, far_first;
  near_first.add(5, small), near_first.add(1, large);
  far_first.add(1, large), far_first.add(5, small);
  for (const auto& [x, y] : {std::pair{2.5, 2.5}, {2.5, 1.0}, {1.0, 2.5}, {7.0, 7.0}}) {
    const bool is_small = x == 2.5 && y == 2.5;
    EXPECT_EQ(near_first.at(x, y), in_cell(is_small ? 0 : 1));
    EXPECT_EQ(far_first.at(x, y), in_cell(is_small ? 1 : 0));
  }
  EXPECT_EQ(far_first.tally.shadowed, 0u);
  EXPECT_EQ(near_first.tally.shadowed, 1u);
}

// All cells IN, the least height 1: what is no higher is hidden, and only that.
// An OUT cell remains until the square is full.
TEST(Svbsp, a_full_tile_hides_what_is_farther) {
  Paper paper;
  const auto bounded = [](std::vector<Corner> corners) {  // the tile's borders are no edges
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 &a = corners[i].at, &b = corners[(i + 1) % corners.size()].at;
      if (a.x == b.x || a.y == b.y) corners[i].edge = shadow_cut;
    }
    return corners;
  };
  paper.builder.start();
  paper.add(2, bounded(left_half));
  EXPECT_FALSE(paper.builder.hides(0));
  paper.add(1, bounded(right_half));
  EXPECT_TRUE(paper.builder.hides(1));
  EXPECT_FALSE(paper.builder.hides(1.5));
  EXPECT_EQ(paper.nodes.size(), 1u);
}

// Occluder 1 is the square of side 2 at the height 5 below a lamp at 10: on the
// ground, twice as large, it covers (-2 .. 2)^2; at the height 2 its shadow
// is 1.6 times as large and covers (0 .. 1.6)^2 of occluder 2, (0 .. 2)^2,
// whose own shadow is 1.25 times as large, (0 .. 2.5)^2. So on the ground 16
// + 6.25 - 4 = 18.25 of 400 are dark, and on occluder 2 2.56 of 4.
TEST(Svbsp, areas_of_two_squares_over_a_ground) {
  const auto rectangle = [](float low, float high, float height) {
    return mesh_of({{low, height, low}, {low, height, high}, {high, height, high}, {high, height, low}},
                   {{0, 1, 2}, {0, 2, 3}});
  };
  Scene scene;
  scene.meshes = {rectangle(-10, 10, 0), rectangle(-1, 1, 5), rectangle(0, 2, 2)};
  for (const char* const settings : all_orders) {
    SCOPED_TRACE(settings);
    const auto technique = lit(settings, scene, point_light({0, 10, 0}));
    const SurfaceDetail detail = *technique->surface_detail();
    EXPECT_NEAR(area(detail, 0, false), 18.25, 1e-9);
    EXPECT_NEAR(area(detail, 0, true), 381.75, 1e-9);
    EXPECT_NEAR(area(detail, 2, false), 2.56, 1e-9);
    EXPECT_NEAR(area(detail, 2, true), 1.44, 1e-9);
    EXPECT_EQ(area(detail, 1, false), 0);
    EXPECT_NEAR(area(detail, 1, true), 4, 1e-9);
  }
  EXPECT_FALSE(lit("", scene, point_light({0, 10, 0}))->surface_detail()->polygons.empty());
  Registry registry;
  gnomon_technique_svbsp(registry);
  EXPECT_TRUE(registry.techniques()[0].make()->surface_detail()->polygons.empty());  // of a fresh object
}

// Merged, a polygon has all its corners and stands alone; else there are more
// of them, with the same areas, lit and dark.
TEST(Svbsp, merging_changes_no_area) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    Scene scene;
    scene.meshes = {square(6, -2), hard_scenes::boxes(random, 6, false)};
    const Light light = hard_scenes::hard_light(random);
    for (const char* const order : {"", "order=bsp", "order=face_planes"}) {
      const std::string settings = *order ? std::string(order) + "," : "";
      const auto merged = lit(settings + "merge=true", scene, light)->surface_detail();
      const auto loose = lit(settings + "merge=false", scene, light)->surface_detail();
      EXPECT_LE(merged->polygons.size(), loose->polygons.size());
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> parts;
      for (const DetailPolygon& polygon : merged->polygons) ++parts[{polygon.mesh, polygon.triangle}];
      for (const DetailPolygon& polygon : merged->polygons)
        if (parts[{polygon.mesh, polygon.triangle}] == 1) {
          EXPECT_EQ(polygon.count, 3u);
        }
      for (const std::uint32_t mesh : {0u, 1u})
        for (const bool is_lit : {true, false}) EXPECT_NEAR(area(*merged, mesh, is_lit), area(*loose, mesh, is_lit), 1e-7);
    }
  }
}

// Light at every kind of place; a picture of points away from all edges and
// planes by 1e-6.
TEST(Svbsp, orders_and_rules_change_no_answer) {
  Random random(4);
  std::size_t compared = 0, dark = 0;
  for (int round = 0; round < 40; ++round) {
    Scene scene;
    scene.meshes = {hard_scenes::boxes(random, 8, round % 2), hard_scenes::grid_soup(random, 30), hard_scenes::cycle(2, 1.5f),
                    square(6, -2)};
    scene.meshes[1].casts = round % 3 != 0;
    const Light light = hard_scenes::hard_light(random);
    Picture picture(40, 25);
    hard_scenes::scatter(scene, light, random, picture);
    const ExactScene exact(scene);
    std::vector<bool> is_plain(picture.gbuffer.size());
    for (std::size_t i = 0; i < is_plain.size(); ++i)
      is_plain[i] =
          std::isinf(exact.edge_margin(exact_receiver(scene, picture.gbuffer, i), homogeneous(light), 1e-6).clearance);
    const auto wanted = run("", scene, light, picture.gbuffer).mask;
    for (const char* const settings :
         {"drop_edges=cut", "drop_edges=none", "tile_size=1", "tile_size=4096", "order=bsp", "order=bsp,drop_edges=cut",
          "order=bsp,drop_edges=none", "order=bsp,split=first", "order=bsp,free_cuts=false", "order=face_planes"}) {
      const auto mask = run(settings, scene, light, picture.gbuffer).mask;
      for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!is_plain[i]) continue;
        ++compared, dark += mask[i] == 0;
        ASSERT_EQ(mask[i], wanted[i]) << "round " << round << ", " << settings << ", pixel " << i;
      }
    }
  }
  EXPECT_GT(compared, 100'000u);
  EXPECT_GT(dark, 20'000u);
}

TEST(Svbsp, threads_change_nothing) {
  std::mt19937 engine(5);
  Scene scene;
  scene.meshes = {square(3, 0), small_world::random_soup(engine, 12'000, 2, 0.1f, 2, 0.05f)};
  Random random(5);
  const Light light = point_light({0.7f, 3, 1.1f});
  Picture picture(100, 50);
  hard_scenes::scatter(scene, light, random, picture);
  for (const char* const settings : {"", "order=bsp", "order=face_planes"}) {
    const auto many = run(settings, scene, light, picture.gbuffer);
    const auto many_parts = many.technique->surface_detail();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const auto one = run(settings, scene, light, picture.gbuffer);
    EXPECT_EQ(one.mask, many.mask);
    const Counts a = one.technique->counts(), b = many.technique->counts();
    for (std::size_t k = 0; k < a.size(); ++k)
      if (a[k].name != "bytes") {
        EXPECT_EQ(a[k].value, b[k].value) << a[k].name;
      }
    const auto one_parts = one.technique->surface_detail();
    EXPECT_EQ(one_parts->corners, many_parts->corners);
  }
}

// A triangle edge-on to the sun casts and receives nothing. One a hundred-billionth of the scene wide, as the light sees it,
// casts nothing either. It lies along the plane of the ground's diagonal, so that no fragment of it is left; it is divided all
// the same, into itself.
TEST(Svbsp, what_has_no_width_casts_nothing) {
  Scene scene;
  scene.meshes = {square(5, 0), mesh_of({{0, 1, -1}, {0, 1, 1}, {0, 2, 0}, {-1, 3, -1}, {1, 3, 1}, {0x1p-36f, 4, -0x1p-36f}},
                                        {{0, 1, 2}, {3, 4, 5}})};
  for (const char* const settings : {"", "merge=false"}) {
    const auto technique = lit(settings, scene, sun({0, -1, 0}));
    EXPECT_EQ(value(technique->counts(), "shadow_planes"),
              5);  // of the ground's two triangles
    const SurfaceDetail detail = *technique->surface_detail();
    EXPECT_EQ(area(detail, 0, false), 0);
    ASSERT_EQ(std::ranges::count(detail.polygons, 1u, &DetailPolygon::mesh), 1);
    const DetailPolygon& narrow = detail.polygons.back();
    EXPECT_EQ(narrow.triangle, 1u);
    EXPECT_TRUE(narrow.is_lit);
    EXPECT_EQ(narrow.count, 3u);
  }
}

// Without casters there is nothing to center light space on; a sun's direction may have any length.
TEST(Svbsp, a_long_direction_moves_no_corner) {
  Scene scene;
  scene.meshes = {square(1, 0.25f)};
  scene.meshes[0].casts = false;
  const auto detail = lit("merge=false", scene, sun({0, -1e20f, 0}))->surface_detail();
  ASSERT_EQ(detail->polygons.size(), 2u);
  for (const glm::dvec3& corner : detail->corners) {
    EXPECT_NEAR(std::abs(corner.x), 1, 1e-14);
    EXPECT_NEAR(corner.y, 0.25, 1e-14);
    EXPECT_NEAR(std::abs(corner.z), 1, 1e-14);
  }
}

// Steep triangles reach up through a tilted plate by tips less than 10^-10 of the scene wide: these hide nothing of the plate,
// so that all below it stays dark.
TEST(Svbsp, tips_bound_no_cells) {
  for (const float height : {3e-10f, 1e-9f, 3e-9f, 1e-8f}) {
    Scene scene;
    scene.meshes = {square(2, 0), square(3, -1.5f)};
    for (glm::vec3& p : scene.meshes[0].positions) p.y = p.x / 4;
    for (const float z : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f})
      scene.meshes.push_back(mesh_of({{0, height, z}, {0.1f, -1, z + 0.05f}, {0, -1, z + 0.1f}}, {{0, 1, 2}}));
    for (const char* const settings : {"", "order=face_planes", "order=face_planes,drop_edges=none"}) {
      SCOPED_TRACE(settings);
      const auto detail = lit(settings, scene, sun({0, -1, 0}))->surface_detail();
      EXPECT_NEAR(area(*detail, 1, false), 16, 1e-8);
      for (std::uint32_t mesh = 2; mesh < 7; ++mesh) EXPECT_NEAR(area(*detail, mesh, true), 0, 1e-8);
    }
  }
}

// Leaves 1e-4 above a floor, seen from 1e7 times as far away as they are wide apart: eight squares of side 1/2 are 2 of 64
// square meters.
TEST(Svbsp, a_far_lamp_sees_which_of_two_is_nearer) {
  Scene scene;
  scene.meshes = {square(4, 0)};
  for (int i = 0; i < 8; ++i) {
    scene.meshes.push_back(square(0.25f, 1e-4f));
    for (glm::vec3& p : scene.meshes.back().positions) p.x += static_cast<float>(i) - 3.5f;
  }
  for (const char* const settings : all_orders) {
    SCOPED_TRACE(settings);
    const auto detail = lit(settings, scene, point_light({0, 1e7f, 0}))->surface_detail();
    EXPECT_NEAR(area(*detail, 0, false), 2, 1e-5);
    EXPECT_NEAR(area(*detail, 0, true), 62, 1e-5);
  }
}

// Every copy of one triangle lies in all tiles. So there are 64 at most, however many copies, and the work grows as they do.
TEST(Svbsp, copies_do_not_multiply) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t i = 0; i < 60'000; i += 3) {
    positions.insert(positions.end(), {{-1, 1, -1}, {1, 1, -1}, {0, 1, 1}});
    triangles.push_back({i, i + 1, i + 2});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles)};
  const Counts counts = lit("", scene, sun({0, -1, 0}))->counts();
  EXPECT_EQ(value(counts, "polygons"), 20'000);
  EXPECT_LE(value(counts, "tiles"), 64);
  EXPECT_LE(value(counts, "fragments") + value(counts, "hidden"), 64 * 20'000);
}

// Planes are counted, and so is what they do: one triangle over a ground casts
// by three planes, and the ground's two by five; lit are the triangle, whole,
// and the ground's parts around it.
TEST(Svbsp, counts_on_paper) {
  Scene scene;
  scene.meshes = {square(5, 0), mesh_of({{1, 1, 0}, {2, 1, 0}, {1, 1, -0.5f}}, {{0, 1, 2}})};
  for (const char* const settings : {"order=bsp", ""}) {
    const Counts counts = lit(settings, scene, sun({0, -1, 0}))->counts();
    EXPECT_EQ(value(counts, "polygons"), 3);
    EXPECT_EQ(value(counts, "nodes"), value(counts, "shadow_planes"));
    EXPECT_EQ(value(counts, "tiles"), 1);
    EXPECT_GE(value(counts, "shadow_planes"), 8);
    EXPECT_GE(value(counts, "fragments"), value(counts, "lit_fragments") + 1);
    EXPECT_GT(value(counts, "bytes"), 0);
  }
}

// Under the sun a steep triangle stands within the outline of a level one and reaches through its plane: all that this adds to
// the splits is the crossing. One triangle alone is a chain of three planes. A thousand side by side are no chain in the order
// `face_planes`, which shuffles them.
TEST(Svbsp, counts_of_crossings_and_depth) {
  const auto counts = [](const char* settings, std::vector<Mesh> meshes) {
    Scene scene;
    scene.meshes = std::move(meshes);
    return lit(settings, scene, sun({0, -1, 0}))->counts();
  };
  const Mesh level = mesh_of({{-4, 1, -4}, {0, 1, 6}, {5, 1, -4}}, {{0, 1, 2}});
  const auto steep = [](float lift) {
    return mesh_of({{0, lift, 0}, {0.5f, 1.5f + lift, 0.25f}, {0, lift, 0.5f}}, {{0, 1, 2}});
  };
  for (const char* const settings : {"", "order=face_planes"})
    EXPECT_EQ(value(counts(settings, {level, steep(0.5f)}), "splits"),
              value(counts(settings, {level, steep(2)}), "splits") + 1);
  const Counts one = counts("", {level});
  EXPECT_EQ(value(one, "nodes"), 3);
  EXPECT_EQ(value(one, "depth"), 3);
  std::vector<Mesh> row;
  for (int i = 0; i < 1000; ++i) {
    const float x = static_cast<float>(i);
    row.push_back(mesh_of({{x, 0, 0}, {x, 0, 1}, {x + 0.5f, 0, 0.5f}}, {{0, 1, 2}}));
  }
  EXPECT_LT(value(counts("order=face_planes", row), "depth"), 200);
}

// Below a plate, whose tiles are cut by their borders, squares are hidden, all of those in tiles in its middle.
TEST(Svbsp, counts_of_what_a_plate_hides) {
  Scene scene;
  scene.meshes = {square(8, 3)};
  for (int x = -4; x < 4; ++x)
    for (int z = -4; z < 4; ++z) {
      scene.meshes.push_back(square(0.25f, 1));
      for (glm::vec3& p : scene.meshes.back().positions)
        p += glm::vec3(static_cast<float>(x) + 0.5f, 0, static_cast<float>(z) + 0.5f);
    }
  const auto technique = lit("tile_size=4", scene, sun({0, -1, 0}));
  EXPECT_GT(value(technique->counts(), "tile_splits"), 0);
  EXPECT_GE(value(technique->counts(), "hidden"), 64);
  for (std::uint32_t mesh = 1; mesh < scene.meshes.size(); ++mesh)
    EXPECT_EQ(area(*technique->surface_detail(), mesh, true), 0) << mesh;
}

// Twenty rows of one point are as many queries, with as many visits each as there are for the point alone; and a second picture
// counts anew.
TEST(Svbsp, counts_of_queries_are_those_of_the_picture) {
  Scene scene;
  scene.meshes = {square(5, 0), square(1, 1)};
  const Light light = sun({0, -1, 0});
  Picture single(1, 1), many(3, 20);
  single.set(0, {0.3f, 0, 0.6f}, {0, 1, 0}, 0, 0);
  for (std::size_t i = 0; i < 60; ++i) many.set(i, {0.3f, 0, 0.6f}, {0, i % 3 == 0 ? -1.0f : 1.0f, 0}, 0, 0);
  const Counts one = run("", scene, light, single.gbuffer).technique->counts();
  EXPECT_EQ(value(one, "queries"), 1);
  EXPECT_GT(value(one, "visits"), 0);
  const auto technique = run("", scene, light, many.gbuffer).technique;
  const double queries = value(technique->counts(), "queries");
  EXPECT_GE(queries, 40);
  VisibilityMask mask(3, 20);
  technique->resolve(many.gbuffer, mask);
  EXPECT_EQ(value(technique->counts(), "queries"), queries);
  EXPECT_EQ(value(technique->counts(), "visits"), value(one, "visits"));
}

// What shades a point is named, counted over the scene; lit points and those that are turned away name nothing.
TEST(Svbsp, a_shaded_point_names_its_triangle) {
  Scene scene;
  scene.meshes = {square(5, 0), square(1, 1)};
  Picture picture(3, 1);
  picture.set(0, {-0.5f, 0, 0.25f}, {0, 1, 0}, 0, 0);  // below the plate's first triangle, x < z
  picture.set(1, {3, 0, 2}, {0, 1, 0}, 0, 1);
  picture.set(2, {-0.5f, 0, 0.25f}, {0, 1, 0}, 0, 0);
  for (const char* const settings : all_orders) {
    const auto above = run(settings, scene, sun({0, -1, 0}), picture.gbuffer);
    ASSERT_TRUE(above.technique->explain(0));
    EXPECT_EQ(above.technique->explain(0)->element, 2u);
    ASSERT_TRUE(above.technique->explain(1));
    EXPECT_FALSE(above.technique->explain(1)->element);
    const auto below = run(settings, scene, sun({0, 1, 0}), picture.gbuffer);
    EXPECT_FALSE(below.technique->explain(0));
  }
}

// One object, relit in another order after another scene, knows nothing of the tree it had.
TEST(Svbsp, a_new_order_forgets_the_regular_tree) {
  Scene before, after;
  before.meshes = {square(5, 0), square(2, 1)};
  after.meshes = {square(5, 0), square(1, 2)};
  const Light light = sun({0, -1, 0});
  const auto technique = lit("order=bsp", before, light);
  technique->apply("order=tiles");
  technique->build(after);
  technique->relight(light);
  EXPECT_NEAR(area(*technique->surface_detail(), 0, false), 4, 1e-9);
  for (const Count& count : technique->counts()) EXPECT_NE(count.name, "bsp_nodes");
}

TEST(Svbsp, area_lights_are_refused) {
  const auto technique = lit("", {}, sun({0, -1, 0}));
  EXPECT_FALSE(technique->supports({}, {.name = "area", .kind = SphereLight{}}, {}));
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// Unmerged, the two squares over a ground leave more polygons than merged.
TEST(Svbsp, merging_leaves_fewer_polygons) {
  Scene scene;
  scene.meshes = {square(10, 0), square(1, 5), square(1, 2)};
  for (const char* const order : {"order=tiles", "order=bsp", "order=face_planes"}) {
    const auto count = [&](const std::string& merge) {
      return lit(order + merge, scene, point_light({0.5f, 10, 0.25f}))->surface_detail()->polygons.size();
    };
    EXPECT_LT(count(",merge=true"), count(",merge=false")) << order;
  }
}

// Where a mesh reaches beyond its exact shape, as a ball of radius 1 in triangles beyond one of 0.9, it shades no point of the
// shape that faces the light; in a picture of the mesh the shape means nothing, and a plate shades the other one of its mesh.
TEST(Svbsp, a_mesh_shades_itself_only_as_a_mesh) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 24, "ball")};
  scene.meshes[0].shape = Sphere{{0, 0, 0}, 0.9f};
  Picture curve(20, 20, Truth::shape);
  Random random(8);
  for (std::size_t i = 0; i < curve.gbuffer.size(); ++i) {
    const glm::dvec3 n = small_world::direction_of(random);
    curve.set(i, glm::vec3(0.9 * n), glm::vec3(n), 0, 0);
  }
  EXPECT_EQ(std::ranges::count(run("", scene, sun({0, -1, 0}), curve.gbuffer).mask, 0.0f), 0);
  Mesh plates = square(3, 0);
  for (const glm::vec3& p : square(1, 1).positions) plates.positions.push_back(p);
  plates.triangles.insert(plates.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
  scene.meshes = {mesh_of(plates.positions, plates.triangles)};
  scene.meshes[0].shape = Sphere{};
  Picture flat(1, 1);
  flat.set(0, {0.5f, 0, 0.25f}, {0, 1, 0}, 0, 1);
  EXPECT_EQ(run("", scene, sun({0, -1, 0}), flat.gbuffer).mask[0], 0);
}

// A body on an exact shape leaves itself out; its shadow on the floor, and a
// plate's shadow on it, remain.
TEST(Svbsp, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  Picture picture(100, 20, Truth::shape);
  Random random(6);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const glm::vec3 n(small_world::direction_of(random));
    picture.set(i, n, n, 0, 0);
  }
  const auto with = run("", scene, light, picture.gbuffer).mask;
  EXPECT_GT(std::ranges::count(with, 0.0f), 10);
  const ExactScene exact(scene);
  std::vector<float> wanted(picture.gbuffer.size(), 1);
  exact.decide(picture.gbuffer, light, wanted);
  EXPECT_EQ(with, wanted);
  scene.meshes[2].casts = false;
  EXPECT_EQ(std::ranges::count(run("", scene, light, picture.gbuffer).mask, 0.0f), 0);
}

// The second pass: away from edges the painter's picture is the depth-buffered
// one with the mask, wherever the eye goes.
TEST(Svbsp, the_painter_shows_the_mask) {
  Random random(7);
  std::mt19937 engine(7);
  int plain = 0, dark = 0;
  for (int round = 0; round < 12; ++round) {
    Scene scene;
    scene.meshes = {small_world::ground(3, 0), small_world::random_soup(engine, 25, 2, 0.2f, 2, 0.6f),
                    hard_scenes::boxes(random, 3, false), hard_scenes::cycle(1, 1.5f)};
    const Light light = round % 2 ? sun({0.3f, -1, 0.2f}) : point_light({0.5f, 5, 0.3f});
    const char* const settings = all_orders[round % 5];
    for (int eye = 0; eye < 3; ++eye) {
      const View view{.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.4, -4), glm::dvec3(4, 4, 4))), .target = {0, 0.5f, 0}};
      const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 64, 48);
      const auto done = run(settings, scene, light, gbuffer);
      const std::vector<float> painted = done.technique->draw_debug("painter"),
                               wanted = shaded_layer(scene, gbuffer, light, done.mask);
      const auto same = [&](std::size_t i, std::size_t j) {
        return gbuffer.mesh[i] == gbuffer.mesh[j] && gbuffer.triangle[i] == gbuffer.triangle[j] && done.mask[i] == done.mask[j];
      };
      for (std::size_t y = 1; y + 1 < 48; ++y)
        for (std::size_t x = 1; x + 1 < 64; ++x) {
          const std::size_t i = 64 * y + x;
          bool is_plain = true;
          for (const std::size_t j : {i - 65, i - 64, i - 63, i - 1, i + 1, i + 63, i + 64, i + 65}) is_plain &= same(i, j);
          if (!is_plain) continue;
          ++plain, dark += done.mask[i] == 0;
          for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
            ASSERT_NEAR(painted[c], wanted[c], 2e-6) << "round " << round << ", " << settings << ", eye " << eye << ", " << i;
        }
    }
  }
  EXPECT_GT(plain, 40'000);
  EXPECT_GT(dark, 2'000);
}

}  // namespace
}  // namespace gnomon
