// Means of hard shadows: what they call of the technique within, what they pass on of it, and what is refused.
#include "averaged_hard_rig.h"

namespace averaged_hard_inner_test {
using namespace averaged_hard_rig;

/// Half of everything is lit; every object has a build of its own.
class Half final : public Technique {
 public:
  Number<int> lit{this, "lit", 1, {"", 0, 1}, Stage::resolve, "Whether everything is lit."};
  static inline int builds = 0, updates = 0;
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "it has no penumbra");
  }
  void setup() override { is_set_up_ = true; }
  void build(const Scene&) override {
    if (is_set_up_) ++builds;
    is_built_ = is_set_up_;
  }
  void update(const Scene&, const Changes&) override {
    EXPECT_TRUE(is_built_);
    ++updates;
  }
  void relight(const Light&) override { is_lit_ = is_built_; }
  void resolve(const GBuffer&, VisibilityMask& mask) override {
    std::ranges::fill(mask.pixels(), is_lit_ && lit ? 1.0f : 0.0f);
  }
  Counts counts() const override { return {{"bytes", 100 << 20, "byte"}}; }

 private:
  bool is_set_up_ = false, is_built_ = false, is_lit_ = false;
};

void register_half() {
  if (!registry().find_technique("half"))
    registry().add(TechniqueEntry{.id = "half", .about = {}, .make = [] { return gnomon::made<Technique, Half>("half"); }});
}

TEST_F(AveragedHard, an_update_reaches_every_object_that_has_been_built) {
  register_half();
  const World world(generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const auto technique = made("averaged_hard", "of=half,samples=3");
  technique->setup();
  technique->build(world.scene);
  Half::builds = 0;
  Half::updates = 0;
  technique->update(world.scene, {});
  EXPECT_EQ(Half::updates, 3);
  EXPECT_EQ(Half::builds, 0);
  technique->apply("samples=5");
  technique->update(world.scene, {});
  EXPECT_EQ(Half::updates, 6);
  EXPECT_EQ(Half::builds, 2) << "the two that are new read the scene where it is now";
}

// Also an object for another light, which shares with the first one and is not updated itself.
TEST_F(AveragedHard, after_an_update_it_answers_as_after_a_build) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-1, 1, -1}, {0, 2, 0})};
  scene.views = {{.name = "view", .eye = {3, 5, 6}, .target = {0, 0.3f, 0}}};
  const Light light = lamp({1, 5, 2}, 0.5f), other = lamp({-2, 5, 1}, 0.5f);
  for (const char* of : {"embree_rays", "svbsp", "shadow_map"}) {
    scene.meshes[1] = small_world::box({-1, 1, -1}, {0, 2, 0});
    ++scene.pose_number;
    const std::string settings = fmt::format("of={},samples=4", of);
    const auto technique = made("averaged_hard", settings);
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    const auto guest = technique->for_another_light();
    if (guest) guest->relight(other);
    Changes changes{std::vector<MeshChange>(2)};
    std::vector<glm::vec3>& moved = scene.meshes[1].positions;
    changes.meshes[1] = {.kind = MeshChange::Kind::deformed, .count = static_cast<std::uint32_t>(moved.size())};
    changes.meshes[1].before.add(moved);
    for (glm::vec3& p : moved) p += glm::vec3(1, 0.5f, 0.25f);
    changes.meshes[1].after.add(moved);
    ++scene.pose_number;
    const World world(scene, Truth::mesh);
    const GBuffer g = world.gbuffer(scene.views[0], 48, 32);
    technique->update(scene, changes);
    const auto mask_under = [&](Technique& object, const Light& lit_by) {
      object.relight(lit_by);
      VisibilityMask mask(g.width, g.height);
      object.resolve(g, mask);
      return std::vector<float>(mask.read().begin(), mask.read().end());
    };
    EXPECT_EQ(mask_under(*technique, light), mask_of("averaged_hard", settings, scene, light, g)) << of;
    if (guest) {
      EXPECT_EQ(mask_under(*guest, other), mask_of("averaged_hard", settings, scene, other, g)) << of;
    }
  }
}

TEST_F(AveragedHard, a_technique_that_shares_nothing_has_a_build_for_every_point) {
  register_half();
  const World world(generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 32, 24);
  const Light light = lamp({-2, 5, 2}, 0.5f);
  const auto technique = made("averaged_hard", "of=half,samples=3");
  technique->setup();
  Half::builds = 0;
  technique->build(world.scene);
  EXPECT_EQ(Half::builds, 3);
  technique->relight(light);
  VisibilityMask mask(g.width, g.height);
  const auto is_all = [&](float value) { return std::ranges::all_of(mask.read(), [&](float v) { return v == value; }); };
  technique->resolve(g, mask);
  EXPECT_TRUE(is_all(1));
  EXPECT_EQ(technique->for_another_light(), nullptr);
  technique->apply("samples=5");  // two more, brought up to the scene
  technique->relight(light);
  technique->resolve(g, mask);
  EXPECT_EQ(Half::builds, 5);
  EXPECT_TRUE(is_all(1));
  EXPECT_EQ(small_world::value(technique->counts(), "light_points"), 5);
  technique->apply("of.lit=0");
  technique->resolve(g, mask);
  EXPECT_FALSE(is_all(1)) << "a parameter of the hard technique is seen from the stage on that it spoils";
  technique->apply("samples=50");
  try {
    technique->relight(light);
    ADD_FAILURE() << "50 objects of 100 MiB are more than 4096 MiB";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "averaged_hard.memory = 4096 MiB is not enough for 50 objects of half: 41 of them hold 4100 MiB");
  }
}

/// Says of everything what a setting is, and counts the calls of its supports().
class Says final : public Technique {
 public:
  Number<double> value{this, "value", 0.5, {"", -2, 2}, Stage::resolve, "What it says."};
  static inline int questions = 0;
  Support supports(const Scene&, const Light& light, const View&) const override {
    ++questions;
    return hard_lights_only(light, "it has no penumbra");
  }
  void setup() override {}
  void build(const Scene&) override {}
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask& mask) override { std::ranges::fill(mask.pixels(), static_cast<float>(value)); }
  Counts counts() const override { return {}; }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    why.covered = index % 2 == 0;
    return why;
  }
};

TEST_F(AveragedHard, hard_masks_are_checked_and_what_they_leave_out_is_passed_on) {
  if (!registry().find_technique("says"))
    registry().add(TechniqueEntry{.id = "says", .about = {}, .make = [] { return gnomon::made<Technique, Says>("says"); }});
  const World world(generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 32, 24);
  const Light light = lamp({-2, 5, 2}, 0.5f);
  const auto technique = made("averaged_hard", "of=says,samples=512");
  Says::questions = 0;
  EXPECT_TRUE(technique->supports(world.scene, light, world.scene.views[0]));
  EXPECT_LE(Says::questions, 16);
  technique->apply("samples=2");
  technique->setup();
  technique->build(world.scene);
  technique->relight(light);
  VisibilityMask mask(g.width, g.height);
  technique->resolve(g, mask);
  int left_out = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(world.scene, g, light, i)) continue;
    const auto why = technique->explain(i);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->covered, i % 2 == 0) << i;
    left_out += !why->covered;
  }
  EXPECT_GT(left_out, 100);
  technique->apply("of.value=1.5");
  try {
    technique->resolve(g, mask);
    ADD_FAILURE() << "1.5 is no visibility";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("mask value 1.5 of says"), std::string::npos) << error.what();
  }
}

TEST_F(AveragedHard, what_cannot_be_averaged_is_refused_with_what_can) {
  EXPECT_NE(refusal("of=area_rays").find("; area_rays is for lights with area only"), std::string::npos)
      << refusal("of=area_rays");
  EXPECT_NE(refusal("of=averaged_hard").find("; it does not average itself"), std::string::npos);
  const std::string unknown = refusal("of=stencl_volume");
  EXPECT_EQ(unknown.find("averaged_hard.of = stencl_volume is outside "), 0u) << unknown;
  EXPECT_NE(unknown.find("; did you mean stencil_volume?"), std::string::npos) << unknown;
  for (const char* soft : {"area_rays", "center_ray", "exact_area", "percentage_closer_soft", "backprojected_map", "path_rays",
                           "radiosity", "registered_planar"})
    EXPECT_NE(refusal(fmt::format("of={}", soft)), "") << soft;
  EXPECT_EQ(refusal("samples=1000000"), "averaged_hard.samples = 1000000 is outside 1 .. 1024 point");
  EXPECT_EQ(refusal("of=stencil_volume,of.count=zpas"), "averaged_hard.of.count = zpas is outside zpass | zfail | zpass_plus");
  EXPECT_EQ(refusal("of=stencil_volume,samples=64,of.count=zpass"), "");
  EXPECT_NE(refusal("of.cuont=zpass").find("averaged_hard has no parameter of.cuont; did you mean "), std::string::npos);
}

// Its masks would depend on how often it is resolved, and a layer that is drawn resolves it.
TEST_F(AveragedHard, a_technique_that_remembers_frames_is_refused) {
  if (!registry().find_technique("remembers_half")) {
    const auto make = [] { return gnomon::made<Technique, Half>("remembers_half"); };
    registry().add(TechniqueEntry{.id = "remembers_half", .about = {.remembers = true}, .make = make});
  }
  const std::string said = refusal("of=remembers_half");
  EXPECT_NE(said.find("; remembers_half remembers frames, and within another technique it has no sequence"), std::string::npos)
      << said;
}

TEST_F(AveragedHard, what_the_hard_technique_does_not_support_is_not_supported) {
  const World world(generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const View& view = world.scene.views[0];
  const Light point{.name = "point", .kind = PointLight{{0, 4, 0}}};
  EXPECT_EQ(made("averaged_hard", "of=embree_rays")->supports(world.scene, point, view).why(),
            "the light has no area: its shadows are hard, see embree_rays");
  const Support images =
      made("averaged_hard", "of=cascaded_map,of.placement=stable")->supports(world.scene, lamp({0, 4, 0}, 1), view);
  EXPECT_EQ(images.kind(), Support::Kind::unsupported);
  EXPECT_EQ(images.why().find("cascaded_map from points of the light: "), 0u) << images.why();
  EXPECT_TRUE(made("averaged_hard", "pattern=interleaved,samples=256")->supports(world.scene, lamp({0, 4, 0}, 1), view));
  EXPECT_EQ(made("averaged_hard", "pattern=interleaved,samples=257")->supports(world.scene, lamp({0, 4, 0}, 1), view).why(),
            "pattern interleaved of 257 points needs 4112 objects of svbsp; at most 4096: 256 points");
  // A lamp through the ball: the analytic composite supports no light inside of a shape.
  const Support inside =
      made("averaged_hard", "of=composite_planar,samples=64")->supports(world.scene, lamp({0, 1, 0}, 3), view);
  EXPECT_EQ(inside.kind(), Support::Kind::unsupported);
  EXPECT_NE(inside.why().find(" of 16 points asked: "), std::string::npos) << inside.why();
}

}  // namespace averaged_hard_inner_test
