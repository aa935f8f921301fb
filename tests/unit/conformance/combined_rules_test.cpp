// The rule about scenes that combine features finds a technique that fails at one of them, and its scenes are what they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "faulty.h"
#include "measure/conformance/combined_scene.h"
#include "measure/conformance/motion_world.h"
#include "measure/conformance/rule.h"
#include "measure/conformance/world.h"
#include "verdicts.h"

namespace combined_rules_test {

using namespace gnomon;
using namespace gnomon::conformance;
using faulty::entry;
using Kind = Verdict::Kind;

enum class Fault {
  none,
  fills_holes,    ///< as if no caster had a mask
  blocks,         ///< glass is opaque
  stays,          ///< update does nothing
  says_nothing,   ///< the reason against lights with area is empty
  names_nothing,  ///< that reason is about nothing
  names_another,  ///< that reason is about holes
  is_dim,         ///< all lit pixels have 0.9
};

/// Shadow rays for lights without area.
template <Fault fault>
class Combining final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, fault == Fault::says_nothing    ? ""
                                   : fault == Fault::names_nothing ? "it would take too long"
                                   : fault == Fault::names_another ? "casters have holes"
                                                                   : "lights with area have penumbrae");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    seen_ = scene;
    for (Mesh& mesh : seen_.meshes) {
      if (fault == Fault::fills_holes) mesh.alpha_mask.reset();
      if (fault == Fault::blocks) mesh.transmission.reset();
    }
    casters_.emplace(seen_, Truth::mesh, RayScene::Which::casters);
  }
  void update(const Scene& scene, const Changes&) override {
    if (fault != Fault::stays) build(scene);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    std::vector<float> answer(mask.pixels().size(), 1.0f);
    trace_shadows(*casters_, seen_, gbuffer, light_, answer);
    if (fault == Fault::is_dim)
      for (std::size_t i = 0; i < answer.size(); ++i)
        if (faces_light(seen_, gbuffer, light_, i)) answer[i] *= 0.9f;
    std::ranges::copy(answer, mask.pixels().begin());
  }
  Counts counts() const override { return {{.name = "bytes", .value = 0, .unit = "byte"}}; }

 private:
  Scene seen_;
  std::optional<RayScene> casters_;
  Light light_;
};

/// The environment variable GNOMON_SEED, while it lives; null: none.
class SeedVariable {
 public:
  explicit SeedVariable(const char* value) {
    if (const char* const now = std::getenv(name)) before_ = now;
    set(value);
  }
  ~SeedVariable() { set(before_ ? before_->c_str() : nullptr); }
  SeedVariable(const SeedVariable&) = delete;

 private:
  static constexpr const char* name = "GNOMON_SEED";
  static void set(const char* value) { value ? setenv(name, value, 1) : unsetenv(name); }
  std::optional<std::string> before_;
};

template <Fault fault>
Verdict verdict_of(About about = faulty::exact, const char* seed = nullptr) {
  about.handles = with_gray_transmission;
  TechniqueEntry entry;
  entry.id = "combining";
  entry.about = about;
  entry.make = [] { return made<Technique, Combining<fault>>("combining"); };
  const SeedVariable variable(seed);
  return judge(rule("combined_features"), entry);
}

TEST(combined_features, hold_of_rays_and_of_a_technique_that_handles_no_feature) {
  const Verdict rays = verdict_of<Fault::none>();
  EXPECT_EQ(rays.kind, Kind::holds) << findings(rays);
  const Verdict sampled = verdict_of<Fault::none>(faulty::sampled());
  EXPECT_EQ(sampled.kind, Kind::holds) << findings(sampled);
  const Verdict plain = judge(rule("combined_features"), entry<faulty::Fault::none>());
  EXPECT_EQ(plain.kind, Kind::holds) << findings(plain);
}

TEST(combined_features, find_an_update_that_does_nothing_and_name_the_seed) {
  expect_found(verdict_of<Fault::stays>(), "after two updates, and built there: ");
  expect_found(verdict_of<Fault::stays>(), "combined scene of seed 3 (casters that move, alpha_masks, transmission), frame ");
}

TEST(combined_features, draw_the_scene_of_one_seed_alone) {
  const std::string found = findings(verdict_of<Fault::stays>(faulty::exact, "12345678901"));
  EXPECT_NE(found.find("combined scene of seed 12345678901 (casters that move, "), std::string::npos) << found;
  EXPECT_EQ(found.find("of seed 3 "), std::string::npos) << found;
  for (const char* const word : {"", "three", "-1", "3 "})
    EXPECT_THROW(verdict_of<Fault::none>(faulty::exact, word), CannotAsk) << word;
}

TEST(combined_features, find_answers_that_are_wrong_where_features_meet) {
  if (is_sanitized) GTEST_SKIP() << "answers are not judged there";
  expect_found(verdict_of<Fault::fills_holes>(), "combined scene of seed 1 (casters that move, alpha_masks), frame ");
  expect_found(verdict_of<Fault::blocks>(), "the mask is 0, the reference 0.");
  expect_found(verdict_of<Fault::blocks>(), "combined scene of seed 2 (casters that move, transmission), frame ");
  // A tenth is no wrong pixel where light is lit or not, and more than rounding where it is a share.
  const Verdict dim = verdict_of<Fault::is_dim>();
  expect_found(dim, "the reference 1 | in combined scene of seed 2 ");
  EXPECT_EQ(findings(dim).find("seed 1 "), std::string::npos) << findings(dim);
}

TEST(combined_features, find_a_reason_that_is_none) {
  expect_found(verdict_of<Fault::says_nothing>(), "it is unsupported, and gives no reason | in combined scene of seed ");
  expect_found(verdict_of<Fault::names_nothing>(),
               "the reason names nothing of scene, light or device: 'it would take too long'");
  expect_found(verdict_of<Fault::names_another>(), "for the same reason: 'casters have holes'");
  const Verdict refuses = judge(rule("combined_features"), entry<faulty::Fault::refuses_all>());
  expect_found(refuses, "the reason names nothing of scene, light or device: 'it refuses everything'");
}

// What the seeds of the rule are there for: each has its features, all of them casters that move, and every kind of light is
// there.
TEST(combined_scene, has_the_features_of_its_seed) {
  std::set<std::string_view> kinds;
  for (std::uint64_t seed = 1; seed <= 7; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = combined_scene(seed);
    EXPECT_EQ(scene.has_alpha_masks(), (seed & 1) != 0);
    EXPECT_EQ(scene.has_transmission(), (seed & 2) != 0);
    EXPECT_FALSE(scene.has_colored_transmission());
    EXPECT_LT(scene.triangle_count(), 250u);
    const auto soft = std::ranges::count_if(scene.lights, has_area);
    EXPECT_TRUE(soft == 1 || soft == 2) << soft;
    EXPECT_EQ(scene.lights.size(), 3u);
    for (const Light& light : scene.lights) kinds.insert(kind_name(light));
    const auto moves = [&](const Mesh& mesh) {
      const auto m = static_cast<std::uint32_t>(&mesh - scene.meshes.data());
      return std::ranges::count(scene.motion->rigs, m, &Rig::mesh) == 1;
    };
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_TRUE(moves(mesh) || (!mesh.alpha_mask && !mesh.transmission)) << mesh.name;
      if (mesh.transmission) {
        EXPECT_EQ(mesh.transmission->is_constant(), (seed & 4) == 0) << mesh.name;
      }
    }
    EXPECT_EQ(std::ranges::count_if(scene.meshes, [](const Mesh& m) { return m.alpha_mask && m.transmission; }),
              (seed & 3) == 3 ? 1 : 0);
  }
  EXPECT_EQ(kinds.size(), 6u);
}

TEST(combined_scene, is_the_same_of_one_seed_and_another_of_another) {
  const auto points = [](std::uint64_t seed) { return combined_scene(seed).meshes.back().positions; };
  EXPECT_EQ(points(3), points(3));
  EXPECT_NE(points(3), points(11));
}

// Every mesh that moves does, and meshes stay above the ground.
TEST(combined_scene, moves_its_casters_over_the_ground) {
  for (std::uint64_t seed = 1; seed <= 7; ++seed) {
    MovingWorld world(combined_scene(seed), Truth::mesh);
    world.take_changes();
    for (const int frame : {9, 25, 32}) {
      world.go_to(frame);
      const Changes changes = world.take_changes();
      for (const Rig& rig : world.scene().motion->rigs)
        EXPECT_NE(changes.meshes[rig.mesh].kind, MeshChange::Kind::still) << seed << ", frame " << frame;
      EXPECT_EQ(world.scene().bounds().min.y, 0) << seed << ", frame " << frame;
      EXPECT_LT(world.scene().bounds().max.y, 5) << seed << ", frame " << frame;
    }
  }
}

}  // namespace combined_rules_test
