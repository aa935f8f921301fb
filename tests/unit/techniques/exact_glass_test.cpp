// The exact techniques on casters with transmission: cases derived on paper, and random scenes against the exact oracle, bit
// for bit.
//
// GNOMON_PIXELS=10000000 compares about that many pixels instead of the few of every day; GNOMON_SEED=1 makes other scenes.
#include <cstdlib>

#include "exact_oracle_rig.h"
#include "glass_scenes.h"
#include "measure/frame/classify.h"

namespace gnomon::exact_oracle::exact_glass_test {

using namespace hand_made;
using glass::glass_card;
using glass_scenes::Owed;
using glass_scenes::Question;

/// Those that decide every point by exact signs and multiply.
std::vector<ExactTechnique> with_glass() {
  std::vector<ExactTechnique> all = without_epsilon();
  std::erase_if(all, [](const ExactTechnique& technique) { return technique.roll == gnomon_technique_two_pass_object; });
  return all;
}

class ExactGlass : public testing::TestWithParam<ExactTechnique> {
 protected:
  /// What arrives at a point of mesh 0, triangle 1, in every setting, which must be the same.
  static float share(const Scene& scene, const Light& light, const glm::vec3& point) {
    Picture picture(1, 1);
    picture.set(0, point, {0, 1, 0}, 0, 1);
    std::optional<float> first;
    for (const std::string& settings : GetParam().settings) {
      const float found = small_world::run(GetParam().roll, settings, scene, light, picture.gbuffer).mask[0];
      if (!first) first = found;
      EXPECT_EQ(found, *first) << settings;
    }
    return *first;
  }
  /// Of a floor below meshes, under a light straight above the point, aside of the diagonals of cards.
  static float share_below(const std::vector<Mesh>& casters, const glm::vec3& point = {0.3f, 0, 0.1f}) {
    Scene scene;
    scene.meshes = {square(4, 0)};
    scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
    const float of_point = share(scene, point_light({point.x, 9, point.z}), point),
                of_sun = share(scene, sun({0, -1, 0}), point);
    EXPECT_EQ(of_point, of_sun);
    return of_point;
  }
};

INSTANTIATE_TEST_SUITE_P(All, ExactGlass, testing::ValuesIn(with_glass()), [](const auto& info) { return info.param.id(); });

// .5 * .75 * .2 = .075, whatever the order of the meshes; what is left depends on it in no bit: .375 is 3 / 8. A receiver
// between the second and the third gets .375, and an opaque card anywhere leaves nothing.
TEST_P(ExactGlass, a_stack_lets_the_product_through) {
  std::vector<Mesh> stack = {glass_card(1, 3, 0.5f), glass_card(1, 2, 0.75f), glass_card(1, 1, 0.2f)};
  for (int turn = 0; turn < 3; ++turn) {
    std::ranges::rotate(stack, stack.begin() + 1);
    EXPECT_EQ(share_below(stack), static_cast<float>(0.375 * static_cast<double>(0.2f))) << turn;
    EXPECT_NEAR(share_below(stack), 0.075, 1e-8) << turn;
    EXPECT_EQ(share_below(stack, {0.3f, 1.5f, 0.1f}), 0.375f) << turn;
    for (const float height : {0.5f, 1.5f, 2.5f, 3.5f}) {
      std::vector<Mesh> blocked = stack;
      blocked.insert(blocked.begin() + turn, square(1, height));
      EXPECT_EQ(share_below(blocked), 0) << turn << ' ' << height;
    }
  }
}

// Nested boxes of .9 and .5: .9^2 .5^2 through both, .9 * .5 from inside of both. A closed body of glass has no half that
// stands for the other.
TEST_P(ExactGlass, a_box_is_crossed_where_the_way_enters_and_where_it_leaves) {
  const std::vector<Mesh> boxes = {glass::with_transmission(small_world::box({-2, 1, -2}, {2, 4, 2}), glm::vec3(0.9f)),
                                   glass::with_transmission(small_world::box({-1, 2, -1}, {1, 3, 1}), glm::vec3(0.5f))};
  const double outer = 0.9f;
  EXPECT_EQ(share_below(boxes), static_cast<float>(outer * outer * 0.25));
  EXPECT_EQ(share_below(boxes, {0.3f, 2.5f, 0.1f}), static_cast<float>(outer * 0.5));
}

// Both triangles of a quad are closed: .5 * .5 through its diagonal.
TEST_P(ExactGlass, a_way_through_a_diagonal_crosses_both_triangles) {
  EXPECT_EQ(share_below({glass_card(1, 1, 0.5f)}, {0.25f, 0, 0.25f}), 0.25f);
  EXPECT_EQ(share_below({glass_card(1, 1, 0.5f)}, {0.25f, 0, 0.125f}), 0.5f);
}

// Copies of a quad in one place, of one mesh: none is needless. With another mesh's in the same place: .5^2 .25.
TEST_P(ExactGlass, cards_in_one_place_all_count) {
  Mesh twice = glass_card(1, 1, 0.5f);
  const std::vector<glm::uvec3> quad = twice.triangles;
  twice.triangles.insert(twice.triangles.end(), quad.begin(), quad.end());
  finish(twice);
  ASSERT_EQ(twice.triangles.size(), 4u);
  EXPECT_EQ(share_below({twice}), 0.25f);
  EXPECT_EQ(share_below({twice, glass_card(1, 1, 0.25f)}), 0.0625f);
  // An opaque one there blocks, before or behind in the list.
  EXPECT_EQ(share_below({twice, square(1, 1)}), 0);
  EXPECT_EQ(share_below({square(1, 1), twice}), 0);
}

// Solid on the left, and there .25: lit on the right, where the card has a hole.
TEST_P(ExactGlass, a_mask_says_where_the_glass_is) {
  const Mesh card = glass::with_transmission(masked::card(1, 1, masked::mask_of({"#."})), glm::vec3(0.25f));
  EXPECT_EQ(share_below({card}, {-0.3f, 0, 0.1f}), 0.25f);
  EXPECT_EQ(share_below({card}, {0.3f, 0, 0.1f}), 1);
  EXPECT_EQ(share_below({card, glass_card(1, 2, 0.5f)}, {-0.3f, 0, 0.1f}), 0.125f);
  EXPECT_EQ(share_below({card, glass_card(1, 2, 0.5f)}, {0.3f, 0, 0.1f}), 0.5f);
}

// Column floor(4 * (x + 1) / 2) of four: .5, all, nothing, .25.
TEST_P(ExactGlass, each_texel_lets_its_own_part_through) {
  const Mesh card = glass_card(1, 1, glass::texels(4, 1, {0.5f, 1, 0, 0.25f}));
  const float x[] = {-0.8f, -0.3f, 0.3f, 0.8f}, expected[] = {0.5f, 1, 0, 0.25f};
  for (int k = 0; k < 4; ++k) EXPECT_EQ(share_below({card}, {x[k], 0, 0.1f}), expected[k]) << k;
}

std::size_t wanted_pixels() {
  const char* wanted = std::getenv("GNOMON_PIXELS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 30'000;
}
Random seeded() {
  const char* seed = std::getenv("GNOMON_SEED");
  return Random(seed ? std::strtoull(seed, nullptr, 10) : 47);
}

/// What the oracle says of random scenes.
struct Seen {
  std::size_t asked = 0, gray = 0, several = 0, blocked = 0;
  void add(const Question& question) {
    for (const std::optional<Owed>& owed : question.owed) {
      if (!owed) continue;
      const float visibility = owed->visibility();
      ++asked;
      gray += visibility > 0 && visibility < 1;
      several += visibility > 0 && owed->found.light.surfaces > 1;
      blocked += owed->is_blocked();
    }
  }
  void expect_all_kinds() const {
    EXPECT_GT(gray, asked / 10);
    EXPECT_GT(several, asked / 50);
    EXPECT_GT(blocked, asked / 20);
  }
  std::string text() const {
    return fmt::format("{} pixels, {} gray, {} behind several surfaces, {} blocked", asked, gray, several, blocked);
  }
};

/// What a technique says of them.
struct Comparison {
  std::size_t wrong = 0, misnamed = 0, named = 0;

  void add(const ExactTechnique& technique, const std::string& settings, const Question& question) {
    const auto done = small_world::run(technique.roll, settings, question.scene, question.light, question.seen);
    for (std::size_t i = 0; i < question.owed.size(); ++i) {
      const std::optional<Owed>& owed = question.owed[i];
      if (technique.owes == Owes::proper && owed && owed->is_blocked_by_edge) continue;
      if (done.mask[i] != question.visibility(i)) {
        if (wrong++ == 0)
          ADD_FAILURE() << settings << " of " << technique.id() << ": " << done.mask[i] << ", " << question.place(i);
      } else if (owed && !owed->is_blocked() && !is_named_right(*done.technique, question, i)) {
        if (misnamed++ == 0) ADD_FAILURE() << settings << " of " << technique.id() << " names another, " << question.place(i);
      }
    }
  }

 private:
  /// Of a pixel that nothing opaque shades: the first triangle that lets least through is named, or none where all do.
  bool is_named_right(const Technique& object, const Question& question, std::size_t i) {
    const std::optional<Explanation> why = object.explain(i);
    if (!why) return true;  // it names nothing at all
    if (question.visibility(i) == 1)
      return !why->element || *why->element >= question.scene.triangle_count() || !is_glass(question, *why->element);
    if (!why->element) return false;
    // Every triangle is looked at: of some pixels alone.
    if (i % 8 != 0) return is_glass(question, *why->element);
    ++named;
    return *why->element == first_of_least(question, i);
  }
  static bool is_glass(const Question& question, std::uint64_t number) {
    const std::uint32_t mesh = TriangleNumbers(question.scene).mesh_of(static_cast<std::uint32_t>(number));
    return question.scene.meshes[mesh].transmission != nullptr;
  }
  static std::uint64_t first_of_least(const Question& question, std::size_t i) {
    const Receiver receiver = question.receiver(i);
    const Segment segment{receiver.point, homogeneous(question.light)};
    float least = 1;
    std::uint64_t number = 0, found = 0;
    for (std::uint32_t m = 0; m < question.scene.meshes.size(); ++m) {
      const Mesh& mesh = question.scene.meshes[m];
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t, ++number) {
        if (!mesh.casts || !mesh.transmission || crosses(segment, mesh.corners(t)) == Crossing::none) continue;
        if (receiver.is_own(m, t) || receiver.is_coplanar(question.scene, mesh.corners(t).points)) continue;
        if (!is_solid_at(mesh, t, segment)) continue;
        const float factor = transmission_at(mesh, t, segment).x;
        if (factor >= least) continue;
        least = factor;
        found = number;
      }
    }
    return found;
  }
};

TEST_P(ExactGlass, let_through_what_the_oracle_does) {
  Random random = seeded();
  Seen seen;
  Comparison sum;
  for (int round = 0; seen.asked < wanted_pixels(); ++round) {
    const Question question(round, random);
    SCOPED_TRACE(fmt::format("round {}, {} light", round, kind_name(question.light)));
    seen.add(question);
    for (const std::string& settings : GetParam().settings_in(round)) sum.add(GetParam(), settings, question);
  }
  EXPECT_EQ(sum.wrong, 0u);
  EXPECT_EQ(sum.misnamed, 0u);
  if (GetParam().roll != gnomon_technique_exact_rays) {
    EXPECT_GT(sum.named, seen.asked / 100);
  }
  seen.expect_all_kinds();
  RecordProperty("seen", seen.text());
}

// A scene without glass and the same with glass that lets all through: the very same mask.
TEST_P(ExactGlass, glass_that_lets_all_through_is_not_there) {
  Random random = seeded();
  for (int round = 0; round < 4; ++round) {
    Question question(round, random);
    Scene without = question.scene;
    for (std::size_t m = 0; m < without.meshes.size(); ++m) {
      if (!without.meshes[m].transmission) continue;
      without.meshes[m].casts = false;
      question.scene.meshes[m].transmission = glass::constant(glm::vec3(1));
    }
    for (const std::string& settings : GetParam().settings_in(round))
      EXPECT_EQ(small_world::run(GetParam().roll, settings, question.scene, question.light, question.seen).mask,
                small_world::run(GetParam().roll, settings, without, question.light, question.seen).mask)
          << round << ' ' << settings;
  }
}

// Glass that lets nothing through is opaque: lit and dark as of the same casters without it. crow_counting counts the one and
// tests the other.
TEST_P(ExactGlass, glass_that_lets_nothing_through_is_opaque) {
  Random random = seeded();
  for (int round = 0; round < 4; ++round) {
    Question question(round, random);
    Scene opaque = question.scene;
    for (std::size_t m = 0; m < opaque.meshes.size(); ++m) {
      if (!opaque.meshes[m].transmission) continue;
      opaque.meshes[m].transmission = nullptr;
      question.scene.meshes[m].transmission = glass::constant(glm::vec3(0));
    }
    const Answers answers(opaque, question.light, question.seen);
    for (const std::string& settings : GetParam().settings_in(round)) {
      const auto done = small_world::run(GetParam().roll, settings, question.scene, question.light, question.seen);
      for (std::size_t i = 0; i < answers.size(); ++i)
        if (answers.is_owed(GetParam().owes, i)) {
          ASSERT_EQ(done.mask[i], answers.visibility(i)) << answers.place(i);
        }
    }
  }
}

// The same object under one light after the other, and an object for another light, which looks at the same casters.
TEST_P(ExactGlass, what_one_light_found_is_forgotten_under_the_next) {
  Random random = seeded();
  for (int round = 0; round < 4; ++round) {
    const Question question(round, random);
    const auto alone = small_world::run(GetParam().roll, "", question.scene, question.light, question.seen);
    const auto first = GetParam().make();
    first->setup();
    first->build(question.scene);
    const auto guest = first->for_another_light();
    ASSERT_TRUE(guest);
    VisibilityMask mask(question.seen.width, question.seen.height);
    for (Technique* object : {first.get(), guest.get()}) {
      object->relight(questions::hard_light(question.scene.meshes[0], random));
      object->resolve(question.seen, mask);
      object->relight(question.light);
      object->resolve(question.seen, mask);
      EXPECT_TRUE(std::ranges::equal(mask.read(), alone.mask)) << round;
      for (std::size_t i = 0; i < question.seen.size(); ++i) {
        const auto found = object->explain(i), expected = alone.technique->explain(i);
        ASSERT_EQ(found.has_value(), expected.has_value()) << question.place(i);
        if (found) {
          ASSERT_EQ(found->element, expected->element) << question.place(i);
        }
      }
    }
  }
}

// Rays through glass differ from the oracle in class U alone, by more than class U allows a pixel of T to move.
TEST(ShadowRays, through_glass_differ_from_the_oracle_in_class_u_alone) {
  Random random = seeded();
  Seen seen;
  std::size_t tested = 0, gray = 0, wrong = 0;
  for (int round = 0; seen.asked < wanted_pixels(); ++round) {
    const Question question(round, random);
    seen.add(question);
    const RayScene casters(question.scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> reference(question.seen.size());
    trace_shadows(casters, question.scene, question.seen, question.light, reference);
    const std::vector<PixelClass> classes = classify(question.scene, casters, question.seen, question.light, reference, {});
    for (std::size_t i = 0; i < reference.size(); ++i) {
      if (classes[i] != PixelClass::T || !question.owed[i]) continue;
      ++tested;
      gray += reference[i] > 0 && reference[i] < 1;
      if (std::abs(reference[i] - question.visibility(i)) > 1.0f / 256 && wrong++ == 0)
        ADD_FAILURE() << "round " << round << ": " << reference[i] << ", " << question.place(i);
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(tested, seen.asked / 4);
  EXPECT_GT(gray, tested / 20);
  RecordProperty("seen", fmt::format("{}; {} of T, {} gray, {} wrong", seen.text(), tested, gray, wrong));
}

}  // namespace gnomon::exact_oracle::exact_glass_test
