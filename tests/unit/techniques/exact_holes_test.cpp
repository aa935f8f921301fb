// The exact techniques on casters with holes: cases derived on paper, and random scenes against the exact oracle, which is
// itself compared with every triangle, one after the other.
//
// GNOMON_PIXELS=10000000 compares about that many pixels instead of the few of every day; GNOMON_SEED=1 makes other scenes.
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>

#include <cstdlib>

#include "exact_oracle_rig.h"
#include "masked.h"
#include "masked_scenes.h"
#include "measure/frame/classify.h"

namespace gnomon::exact_oracle::exact_holes_test {

using namespace hand_made;
using masked_scenes::mask_of;

/// Those that decide every point by exact signs and look up masks.
std::vector<ExactTechnique> with_holes() {
  std::vector<ExactTechnique> all = without_epsilon();
  std::erase_if(all, [](const ExactTechnique& technique) { return technique.roll == gnomon_technique_two_pass_object; });
  return all;
}

class ExactHoles : public testing::TestWithParam<ExactTechnique> {
 protected:
  /// The mask in every setting, which must be the same.
  static std::vector<float> mask(const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    std::vector<float> first;
    for (const std::string& settings : GetParam().settings) {
      const std::vector<float> mask = small_world::run(GetParam().roll, settings, scene, light, gbuffer).mask;
      if (first.empty()) first = mask;
      EXPECT_EQ(mask, first) << settings;
    }
    return first;
  }
};

INSTANTIATE_TEST_SUITE_P(All, ExactHoles, testing::ValuesIn(with_holes()), [](const auto& info) { return info.param.id(); });

/// 8 x 6 points of the floor, mesh 0, over |x|, |z| < 1.25. None is below an edge, a diagonal or a quarter of a level card.
struct Floor : Picture {
  Floor() : Picture(8, 6) {
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 8; ++c) {
        const auto x = static_cast<float>(-1.25 + (c + 0.37) * 2.5 / 8), z = static_cast<float>(-1.25 + (r + 0.61) * 2.5 / 6);
        set(static_cast<std::size_t>(8 * r + c), {x, 0, z}, {0, 1, 0}, 0, z > x ? 0 : 1);
      }
  }
  bool is_below_card(std::size_t i) const { return std::max(std::abs(gbuffer.px[i]), std::abs(gbuffer.pz[i])) < 1; }
};
const Light from_above = sun({0, -1, 0});

// Triangle (0,2,0) (4,2,0) (0,2,4) with places (0,0) (1,0) (0,1), light (3,6,2). The point (1,0,1) sees it at (5/3,2,4/3),
// place (5/12,1/3). Solid where column plus row is even. 8 x 8: (3.33,2.67), texel (3,2), a hole. 4 x 4: (1.67,1.33), texel
// (1,1). The point (1.5,0,1) sees it at x = 2, the edge between columns 3 and 4 of 8: column 4, row 2, solid; a little lower x:
// column 3.
TEST_P(ExactHoles, the_texel_is_that_derived_on_paper) {
  const Light light = point_light({3, 6, 2});
  Picture picture(3, 1);
  const float x[] = {1, 1.5f, std::nextafter(1.5f, 0.0f)};
  for (std::size_t i = 0; i < 3; ++i) picture.set(i, {x[i], 0, 1}, {0, 1, 0}, 0, 1);
  Scene scene;
  scene.meshes = {square(6, 0), masked::triangle_on_paper(masked::checker(8, 8))};
  EXPECT_EQ(mask(scene, light, picture.gbuffer), (std::vector<float>{1, 0, 1}));
  scene.meshes[1].alpha_mask = masked::checker(4, 4);
  EXPECT_EQ(mask(scene, light, picture.gbuffer)[0], 0);
}

// Sixteen cards over each other, each solid in one of sixteen texels: all are dark below, and without one card its texel is
// lit.
TEST_P(ExactHoles, what_lies_behind_a_hole_is_found) {
  const Floor floor;
  Scene scene;
  scene.meshes = {square(4, 0)};
  for (int k = 0; k < 16; ++k)
    scene.meshes.push_back(masked::card(1, 1 + 0.125f * static_cast<float>(k * 7 % 16),
                                        mask_of(4, 4, [&](int x, int y) { return x + 4 * y == k; })));
  for (int missing = 0; missing <= 16; ++missing) {
    const auto card = static_cast<std::size_t>(missing + 1);
    if (missing < 16) scene.meshes[card].casts = false;
    const std::vector<float> found = mask(scene, from_above, floor.gbuffer);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const int column = static_cast<int>(std::floor(2 * (floor.gbuffer.px[i] + 1))),
                row = static_cast<int>(std::floor(2 * (floor.gbuffer.pz[i] + 1)));
      const bool is_dark = floor.is_below_card(i) && column + 4 * row != missing;
      EXPECT_EQ(found[i], is_dark ? 0 : 1) << "pixel " << i << " without card " << missing;
    }
    if (missing < 16) scene.meshes[card].casts = true;
  }
}

// Two quads of a mesh in one place, the one solid on the left and the other on the right: neither is needless.
TEST_P(ExactHoles, cards_in_one_place_fill_the_holes_of_each_other) {
  const Floor floor;
  Scene scene;
  scene.meshes = {square(4, 0), masked::card(1, 1, masked::mask_of({"#."}))};
  std::vector<float> found = mask(scene, from_above, floor.gbuffer);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i], floor.is_below_card(i) && floor.gbuffer.px[i] < 0 ? 0 : 1) << i;
  Mesh& card = scene.meshes[1];
  const std::vector<glm::vec3> corners = card.positions;
  card.positions.insert(card.positions.end(), corners.begin(), corners.end());
  for (std::size_t k = 0; k < 4; ++k) card.uv.emplace_back(1 - card.uv[k].x, card.uv[k].y);
  card.triangles.insert(card.triangles.end(), {{4, 6, 5}, {4, 7, 6}});
  finish(card);
  found = mask(scene, from_above, floor.gbuffer);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], floor.is_below_card(i) ? 0 : 1) << i;
}

// An opaque box around the light, whose bottom is a mesh of its own with holes on the left: the floor is lit there alone.
TEST_P(ExactHoles, light_leaves_a_body_through_the_holes_of_its_side) {
  const Floor floor;
  Scene scene;
  Mesh box = small_world::box({-1, 1, -1}, {1, 3, 1});
  // Triangles 4 and 5 are those of y = 1.
  ASSERT_EQ(box.triangles[4], glm::uvec3(0, 1, 5));
  box.triangles.erase(box.triangles.begin() + 4, box.triangles.begin() + 6);
  finish(box);
  scene.meshes = {square(4, 0), box, masked::card(1, 1, masked::mask_of({".#"}))};
  const std::vector<float> found = mask(scene, point_light({0, 2, 0}), floor.gbuffer);
  // Twice as far from the light as the card: all points of the floor see it at half their x.
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], floor.gbuffer.px[i] < 0 ? 1 : 0) << i;
}

/// A triangle counted over the scene.
struct Numbered {
  std::uint32_t mesh, triangle;
};
Numbered triangle_of(const Scene& scene, std::uint64_t number) {
  const TriangleNumbers numbers(scene);
  const std::uint32_t mesh = numbers.mesh_of(static_cast<std::uint32_t>(number));
  return {mesh, static_cast<std::uint32_t>(number) - numbers.first_of(mesh)};
}

/// Every other scene is on a lattice; every third pair of scenes is seen by an eye, through holes.
struct Question {
  Scene scene;
  Light light;
  Picture picture{64, 48};
  GBuffer seen;

  Question(int round, Random& random) {
    const bool on_lattice = round % 2 == 0;
    scene = masked_scenes::random_scene(random, on_lattice);
    light = questions::hard_light(scene.meshes[0], random);
    View& view = picture.gbuffer.view;
    view.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.5, -4), glm::dvec3(4, 4, 4)));
    (on_lattice ? questions::scatter_on_lattice : hard_scenes::scatter)(scene, light, random, picture);
    seen = picture.gbuffer;
    if (round / 2 % 3 == 0)
      seen = make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, 64, 48, Truth::mesh);
  }
};

std::size_t wanted_pixels() {
  const char* wanted = std::getenv("GNOMON_PIXELS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 60'000;
}
Random seeded() {
  const char* seed = std::getenv("GNOMON_SEED");
  return Random(seed ? std::strtoull(seed, nullptr, 10) : 43);
}

/// What a technique says of random scenes.
struct Comparison {
  std::size_t asked = 0, dark = 0, through_holes = 0, wrong = 0, misnamed = 0;

  void add(const ExactTechnique& technique, const std::string& settings, const Question& question, const Answers& answers) {
    const auto done = small_world::run(technique.roll, settings, question.scene, question.light, question.seen);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers.is_owed(technique.owes, i)) continue;
      if (done.mask[i] != answers.visibility(i)) {
        if (wrong++ == 0) ADD_FAILURE() << settings << " of " << technique.id() << ": " << answers.place(i);
      } else if (answers.faces_light(i) && done.mask[i] == 0) {
        check_name(technique, *done.technique, question, answers, i);
      }
    }
  }

 private:
  /// The caster named is solid where the way to the light crosses it. What crow_counting names may be another volume that the
  /// eye's way enters, but never a triangle with holes.
  void check_name(const ExactTechnique& technique, const Technique& object, const Question& question, const Answers& answers,
                  std::size_t i) {
    const std::optional<Explanation> why = object.explain(i);
    if (!why || !why->element) {
      if (technique.names_casters && misnamed++ == 0) ADD_FAILURE() << "nothing is named, " << answers.place(i);
      return;
    }
    if (*why->element >= question.scene.triangle_count()) return;
    const auto [mesh, triangle] = triangle_of(question.scene, *why->element);
    if (!technique.names_casters && !question.scene.meshes[mesh].alpha_mask) return;
    const Segment segment{question.seen.position(i), homogeneous(question.light)};
    const bool is_met = answers.is_on_way(i, *why->element) && is_solid_at(question.scene.meshes[mesh], triangle, segment);
    if (!is_met && misnamed++ == 0) ADD_FAILURE() << "mesh " << mesh << ", triangle " << triangle << ", " << answers.place(i);
  }
};

TEST_P(ExactHoles, decide_as_the_oracle_does) {
  Random random = seeded();
  Comparison sum;
  for (int round = 0; sum.asked < wanted_pixels(); ++round) {
    const Question question(round, random);
    SCOPED_TRACE(fmt::format("round {}, {} light", round, kind_name(question.light)));
    const Answers answers(question.scene, question.light, question.seen);
    const Scene solid = masked_scenes::filled(question.scene);
    const Answers without_holes(solid, question.light, question.seen);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers.faces_light(i)) continue;
      ++sum.asked;
      sum.dark += answers[i].blocked;
      sum.through_holes += without_holes[i].blocked && !answers[i].blocked;
    }
    for (const std::string& settings : GetParam().settings_in(round)) sum.add(GetParam(), settings, question, answers);
  }
  EXPECT_EQ(sum.wrong, 0u);
  EXPECT_EQ(sum.misnamed, 0u);
  EXPECT_GT(sum.dark, sum.asked / 10);
  EXPECT_GT(sum.through_holes, sum.asked / 50);
  RecordProperty("seen", fmt::format("{} pixels, {} dark, {} lit through holes", sum.asked, sum.dark, sum.through_holes));
}

/// Every triangle, one after the other.
ExactAnswer brute_force(const Scene& scene, const Receiver& receiver, const glm::dvec4& light) {
  bool crossed = false, touched = false;
  const Segment segment{receiver.point, light};
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; scene.meshes[m].casts && t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle caster = scene.meshes[m].corners(t);
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, caster.points)) continue;
      const Crossing crossing = crosses(segment, caster);
      if (crossing == Crossing::none || !is_solid_at(scene.meshes[m], t, segment)) continue;
      crossed |= crossing == Crossing::crosses;
      touched |= crossing == Crossing::degenerate;
    }
  return {crossed || touched, touched && !crossed};
}

TEST(ExactScene, with_holes_answers_like_brute_force) {
  Random random = seeded();
  for (int round = 0; round < 12; ++round) {
    const Question question(round, random);
    const Answers answers(question.scene, question.light, question.seen);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers.faces_light(i)) continue;
      const Receiver receiver = receiver_at(question.scene, question.seen, i);
      ASSERT_EQ(answers[i], brute_force(question.scene, receiver, homogeneous(question.light))) << answers.place(i);
    }
  }
}

TEST(ShadowRays, through_holes_differ_from_the_oracle_in_class_u_alone) {
  Random random = seeded();
  std::size_t asked = 0, tested = 0, uncertain = 0, wrong = 0;
  for (int round = 0; asked < wanted_pixels(); ++round) {
    const Question question(round, random);
    const RayScene casters(question.scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> reference(question.seen.size());
    trace_shadows(casters, question.scene, question.seen, question.light, reference);
    const std::vector<PixelClass> classes = classify(question.scene, casters, question.seen, question.light, reference, {});
    const Answers answers(question.scene, question.light, question.seen);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers.faces_light(i)) continue;
      ++asked;
      uncertain += classes[i] == PixelClass::U;
      if (classes[i] != PixelClass::T) continue;
      ++tested;
      if (reference[i] != answers.visibility(i) && wrong++ == 0) ADD_FAILURE() << "round " << round << ", " << answers.place(i);
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(tested, asked / 4);
  RecordProperty("seen", fmt::format("{} pixels, {} of T, {} of U, {} wrong", asked, tested, uncertain, wrong));
}

}  // namespace gnomon::exact_oracle::exact_holes_test
