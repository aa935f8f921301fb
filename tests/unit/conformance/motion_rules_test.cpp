// The rule about updates finds what a technique keeps that it must not, and holds of one that keeps what it may.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "faulty.h"
#include "measure/conformance/motion_world.h"
#include "measure/conformance/rule.h"
#include "measure/conformance/trial.h"
#include "verdicts.h"

namespace motion_rules_test {

using namespace gnomon;
using namespace gnomon::conformance;
using Kind = Verdict::Kind;

enum class Fault {
  none,               ///< update builds what moved, and relight does its work always
  ignores,            ///< update does nothing
  grows,              ///< update keeps a kilobyte each time
  keeps_under_light,  ///< relight keeps its rays where it is under the light of before, whatever moved
  works_once,         ///< the second relight under a light does nothing
  throws,             ///< from update
  is_off,             ///< a millionth at each pixel, after an update
};

/// Shadow rays, built anew in relight where something moved.
template <Fault fault>
class Following final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "it has no penumbra");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    is_updated_ = false;
    kept_.clear();
    casters_.reset();
  }
  void update(const Scene& scene, const Changes& changes) override {
    EXPECT_EQ(&scene, scene_);
    EXPECT_EQ(changes.meshes.size(), scene.meshes.size());
    is_updated_ = true;
    if (fault == Fault::throws) throw Error("nobody moves me");
    if (fault == Fault::grows) kept_.resize(kept_.size() + 1024);
    if (fault == Fault::ignores || fault == Fault::keeps_under_light) return;
    if (!changes.empty()) casters_.reset();
  }
  void relight(const Light& light) override {
    const bool is_same_light = light_ && light_->name == light.name;
    light_ = light;
    relight_work_ = 0;
    if (fault == Fault::works_once && is_same_light && casters_) return;
    if (fault == Fault::keeps_under_light && !is_same_light) casters_.reset();
    if (!casters_) casters_.emplace(*scene_, Truth::mesh, RayScene::Which::casters);
    relight_work_ = static_cast<double>(scene_->triangle_count());
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    std::vector<float> answer(mask.pixels().size(), 1.0f);
    trace_shadows(*casters_, *scene_, gbuffer, *light_, answer);
    if (fault == Fault::is_off && is_updated_)
      for (std::size_t i = 0; i < answer.size(); ++i)
        if (faces_light(*scene_, gbuffer, *light_, i)) answer[i] = std::abs(answer[i] - 1e-6f);
    std::ranges::copy(answer, mask.pixels().begin());
  }
  Counts counts() const override {
    const double bytes = static_cast<double>(kept_.size() + (casters_ ? casters_->bytes() : 0));
    return {{.name = "bytes", .value = bytes, .unit = "byte"},
            {.name = "triangles", .value = relight_work_, .unit = "triangle"}};
  }

 private:
  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  std::optional<Light> light_;
  std::vector<char> kept_;
  double relight_work_ = 0;
  bool is_updated_ = false;
};

template <Fault fault>
Verdict verdict_of(float update_error = 0) {
  TechniqueEntry entry;
  entry.id = "following";
  entry.about = faulty::exact;
  entry.about.update_error = update_error;
  entry.make = [] { return made<Technique, Following<fault>>("following"); };
  return judge(rule("update_equals_build"), entry);
}

TEST(update_equals_build, holds_of_a_technique_that_builds_by_default_and_of_one_that_keeps_what_it_may) {
  const Verdict by_default = judge(rule("update_equals_build"), faulty::entry<faulty::Fault::none>());
  EXPECT_EQ(by_default.kind, Kind::holds) << findings(by_default);
  const Verdict keeps = verdict_of<Fault::none>();
  EXPECT_EQ(keeps.kind, Kind::holds) << findings(keeps);
}

TEST(update_equals_build, finds_an_update_that_does_nothing) {
  expect_found(verdict_of<Fault::ignores>(), "after 1 update, at frame 16, and built there: ");
  expect_found(verdict_of<Fault::ignores>(), "in moving_things, light point (point), pixel ");
}

TEST(update_equals_build, finds_an_update_that_keeps_memory) {
  const Verdict verdict = verdict_of<Fault::grows>();
  expect_found(verdict, "after 1 update, at frame 16: it holds ");
  expect_found(verdict, " bytes, a fresh object ");
}

TEST(update_equals_build, finds_a_relight_that_keeps_what_an_update_spoiled) {
  expect_found(verdict_of<Fault::keeps_under_light>(), ", and built there: ");
}

TEST(update_equals_build, finds_a_second_relight_that_does_not_do_its_work) {
  expect_found(verdict_of<Fault::works_once>(), "relit once more it counts triangles 0; a fresh object triangles ");
}

TEST(update_equals_build, fails_of_a_technique_that_throws_and_goes_on) {
  expect_found(verdict_of<Fault::throws>(), "it threw: nobody moves me");
}

TEST(update_equals_build, allows_as_much_as_a_technique_states_and_no_technique_more_than_1e_5) {
  expect_found(verdict_of<Fault::is_off>(), ", and built there: ");
  const Verdict stated = verdict_of<Fault::is_off>(2e-6f);
  EXPECT_EQ(stated.kind, Kind::holds) << findings(stated);
  expect_found(verdict_of<Fault::is_off>(5e-7f), "the masks differ by 1");
  expect_found(verdict_of<Fault::none>(1e-4f), "it states an update_error of 0.0001, outside 0 .. 1e-05");
}

TEST(update_equals_build, does_not_apply_where_no_light_is_supported) {
  const Verdict verdict = judge(rule("update_equals_build"), faulty::entry<faulty::Fault::refuses_all>());
  EXPECT_EQ(verdict.kind, Kind::does_not_apply);
  EXPECT_EQ(verdict.why, "it supports no light of the scenes that move");
}

std::size_t flat_triangles(const Mesh& mesh) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) count += mesh.corners(t).normal() == glm::dvec3(0);
  return count;
}

const Mesh& mesh_named(const Scene& scene, std::string_view name) {
  return *std::ranges::find(scene.meshes, name, &Mesh::name);
}

// The frames that the world's constants name: everything is at multiples of powers of two there.
TEST(motion_world, is_at_its_named_frames_where_few_techniques_expect_it) {
  MovingWorld world(moving_things(true), Truth::mesh);
  const Scene& scene = world.scene();
  EXPECT_LT(scene.triangle_count(), 300u);
  for (const Mesh& mesh : scene.meshes) EXPECT_EQ(flat_triangles(mesh), 0u) << mesh.name;
  const auto light = glm::vec3(homogeneous(scene.lights[0]));
  const auto box_of = [](const Mesh& mesh) {
    Bounds box;
    box.add(mesh.positions);
    return box;
  };
  world.go_to(MovingWorld::inside_frame);
  EXPECT_EQ(box_of(mesh_named(scene, "crosser")).min, light - glm::vec3(0.25f));
  world.go_to(MovingWorld::touched_frame);
  EXPECT_EQ(box_of(mesh_named(scene, "crosser")).min, light - glm::vec3(0, 0.25f, 0.25f));
  world.go_to(MovingWorld::collapsed_frame);
  EXPECT_EQ(flat_triangles(mesh_named(scene, "pair")), 2u);
  world.go_to(MovingWorld::gone_frame);
  EXPECT_EQ(flat_triangles(mesh_named(scene, "comer")), 12u);
  world.go_to(0);
  for (const Mesh& mesh : scene.meshes) EXPECT_EQ(flat_triangles(mesh), 0u) << mesh.name;
}

TEST(motion_world, tells_what_moved) {
  MovingWorld world(moving_things(true), Truth::mesh);
  world.take_changes();
  EXPECT_TRUE(world.take_changes().empty());
  world.go_to(5);
  const Changes changes = world.take_changes();
  const Scene& scene = world.scene();
  ASSERT_EQ(changes.meshes.size(), scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::string& mesh = scene.meshes[m].name;
    const bool is_still = mesh == "ground" || mesh == "block" || mesh == "comer";
    EXPECT_EQ(changes.meshes[m].kind == MeshChange::Kind::still, is_still) << mesh;
  }
  EXPECT_TRUE(no_changes(scene).empty());
}

}  // namespace motion_rules_test
