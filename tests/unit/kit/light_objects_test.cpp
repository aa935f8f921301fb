#include <gnomon/kit/bases/light_objects.h>
#include <gnomon/kit/shared.h>
#include <gtest/gtest.h>

namespace light_objects_test {

using namespace gnomon;

/// Shares nothing, and counts what is done to it.
class Lonely final : public Technique {
 public:
  Number<int> size{this, "size", 1, {.min = 1, .max = 9}, Stage::relight, "A size."};

  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override { ++setups; }
  void build(const Scene&) override { ++builds; }
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask&) override {}
  void forget() override { ++forgets; }
  Counts counts() const override {
    return {{"bytes", 10.0 * size, "byte"},
            {"depth", 1.0 * size, "", Count::Together::largest},
            {"mean", 4.0 * builds, "", Count::Together::mean}};
  }
  int setups = 0, builds = 0, forgets = 0;
};

const TechniqueEntry lonely{.id = "lonely", .about = {}, .make = [] { return gnomon::made<Technique, Lonely>("lonely"); }};

Lonely& as_lonely(Technique& technique) { return dynamic_cast<Lonely&>(technique); }

TEST(light_objects, a_technique_that_shares_nothing_does_every_stage_for_every_light) {
  LightObjects objects(lonely, "");
  EXPECT_FALSE(objects.shares().has_value()) << "one light shares with nobody";
  EXPECT_TRUE(objects.hold(3)) << "whole objects need setup";
  EXPECT_EQ(objects.shares(), false);
  objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(as_lonely(objects[k]).setups, 1);
  EXPECT_FALSE(objects.hold(2)) << "fewer lights need nothing";
  EXPECT_EQ(objects.count(), 2u);
  EXPECT_TRUE(objects.hold(3));
}

TEST(light_objects, counts_add_up_as_each_says) {
  LightObjects objects(lonely, "");
  objects.hold(2);
  as_lonely(objects[0]).size.set("2"), as_lonely(objects[1]).size.set("5");
  as_lonely(objects[1]).build({});
  const Counts counts = objects.counts();
  EXPECT_EQ(counts[0].value, 70) << "bytes: the sum";
  EXPECT_EQ(counts[1].value, 5) << "depth: the largest";
  EXPECT_EQ(counts[2].value, 2) << "0 and 4: the mean";
}

TEST(light_objects, forget_reaches_every_object) {
  LightObjects objects(lonely, "");
  objects.hold(3);
  objects.forget();
  objects.hold(2);
  objects.forget();
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(as_lonely(objects[k]).forgets, 2);
}

TEST(light_objects, settings_reach_every_object_and_say_what_they_spoil) {
  LightObjects objects(lonely, "");
  objects.hold(2);
  EXPECT_EQ(objects.set("size=4"), Stage::relight);
  EXPECT_EQ(as_lonely(objects[1]).size.value(), 4);
  EXPECT_FALSE(objects.set("size=4").has_value());
}

/// Shares its builds.
class Sharing final : public Technique {
 public:
  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override {}
  void build(const Scene&) override { ++*builds_; }
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask&) override {}
  Counts counts() const override { return {{"bytes", builds_.own(100) + 1, "byte"}, {"builds", 1.0 * *builds_, ""}}; }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &Sharing::builds_); }

 private:
  Shared<int> builds_;
};

const TechniqueEntry sharing{.id = "sharing", .about = {}, .make = [] { return gnomon::made<Technique, Sharing>("sharing"); }};

TEST(light_objects, objects_beside_those_of_another_share_with_its_first_and_need_no_stage_before_relight) {
  LightObjects host(sharing, "");
  host.hold(2);
  LightObjects guests(sharing, "", host[0]);
  EXPECT_FALSE(guests.hold(3));
  EXPECT_EQ(guests.count(), 3u);
  EXPECT_EQ(guests.shares(), true);
  int stages = 0;
  for (LightObjects* objects : {&host, &guests})
    objects->each(Stage::build, [&](Technique& object, std::size_t) {
      object.build({});
      ++stages;
    });
  EXPECT_EQ(stages, 1) << "of the host's first object";
  for (LightObjects* objects : {&host, &guests})
    objects->each(Stage::update, [&](Technique&, std::size_t k) {
      EXPECT_EQ(k, 0u);
      ++stages;
    });
  EXPECT_EQ(stages, 2) << "update takes build's place, of the same object";
  EXPECT_EQ(guests[2].counts()[1].value, 1) << "the build is seen";
  guests.each(Stage::relight, [&](Technique&, std::size_t) { ++stages; });
  EXPECT_EQ(stages, 5);
  EXPECT_EQ(host.counts()[0].value, 102);
  EXPECT_EQ(guests.counts()[0].value, 3) << "they count what they hold themselves";
  EXPECT_FALSE(guests.hold(1));
  EXPECT_EQ(guests.count(), 1u);
}

TEST(light_objects, objects_share_with_those_of_their_own_scene) {
  LightObjects objects(sharing, "");
  EXPECT_TRUE(objects.hold_by_scene({0, 1, 0, 1, 1})) << "the second is built on another scene";
  EXPECT_EQ(objects.shares(), true);
  std::vector<std::size_t> built, lit;
  objects.each(Stage::build, [&](Technique& object, std::size_t k) {
    object.build({});
    built.push_back(k);
  });
  objects.each(Stage::relight, [&](Technique&, std::size_t k) { lit.push_back(k); });
  EXPECT_EQ(built, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(lit, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  const Technique* const first = &objects[0];
  EXPECT_FALSE(objects.hold_by_scene({0, 1, 1})) << "those before the difference stay";
  EXPECT_EQ(&objects[0], first);
  EXPECT_EQ(objects[2].counts()[1].value, 1) << "it sees the build of the second";
  EXPECT_TRUE(objects.hold_by_scene({1})) << "it was built on scene 0";
  EXPECT_TRUE(objects.hold_by_scene({1, 0}));
  EXPECT_EQ(objects.shares(), std::nullopt) << "each has a scene of its own";
}

TEST(light_objects, lights_without_shadows_make_the_whole_approximate_and_never_go_unsaid) {
  std::vector<Light> lights(6);
  for (std::size_t k = 0; k < lights.size(); ++k) lights[k].name = fmt::format("l{}", k);
  const Support full = Support::full(), no = Support::unsupported("no area"), rough = Support::approximate("roughly");
  EXPECT_EQ(support_together(lights, {full, full, full, full, full, full}).kind(), Support::Kind::full);
  const Support some = support_together(lights, {full, no, full, no, rough, full});
  EXPECT_EQ(some.kind(), Support::Kind::approximate);
  EXPECT_EQ(some.why(), "no shadows of l1, l3: no area; l4: roughly");
  const Support none = support_together(lights, {no, no, no, no, no, no});
  EXPECT_EQ(none.kind(), Support::Kind::unsupported);
  EXPECT_EQ(none.why(), "l0, l1, l2, l3 and 2 more: no area");
}

}  // namespace light_objects_test
