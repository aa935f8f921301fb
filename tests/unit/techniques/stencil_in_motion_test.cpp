// Stencil volumes in scenes that move: after updates masks and work are those of an object that builds in the pose, and where
// bodies touch or triangles lose their area they are right.
#include "moving_volumes.h"
#include "stencil_rig.h"
#include "techniques/stencil_volume/gpu_finder.h"

namespace stencil_in_motion_test {
using namespace stencil_rig;
using moving_volumes::Posed;

class StencilInMotion : public TestRig {
 protected:
  static void SetUpTestSuite() {
    TestRig::SetUpTestSuite();
    for (const char* finder : {"finder=cpu", "finder=gpu"}) {
      used_[finder] = make(finder);
      used_[finder]->setup();
    }
  }
  static void TearDownTestSuite() {
    used_.clear();
    TestRig::TearDownTestSuite();
  }
  /// An object that follows, beside `technique(...)`, which builds.
  static Technique& used(const std::string& finder, const std::string& settings) {
    Technique& t = *used_.at(finder);
    for (Parameter* parameter : t.parameters())
      if (parameter->name() != "finder") parameter->set(parameter->default_text());
    t.apply(settings);
    return t;
  }
  /// One mask after another, under the light of before, another one, or none for a while.
  static void follow(Scene scene, const std::string& finder, const std::string& settings, int steps) {
    Random random(5);
    Posed posed(std::move(scene));
    const std::vector<Light>& lights = posed.scene().lights;
    Technique& follower = used(finder, settings);
    follower.build(posed.scene());
    follower.relight(lights[0]);
    for (int step = 0; step < steps; ++step) {
      const std::string when = fmt::format("{}, {} {}, step {}", posed.scene().name, finder, settings, step);
      follower.update(posed.scene(), posed.go_anywhere(random));
      if (step % 5 == 3) follower.update(posed.scene(), posed.go_anywhere(random));
      const Light& light = lights[step % 4 == 2 ? 1 : 0];
      follower.relight(light);
      const GBuffer g = small_world::make_gbuffer(posed.scene(), posed.scene().views[0], 40, 24);
      const std::vector<float> followed = moving_volumes::mask_of(follower, g);
      const std::string work = moving_volumes::work_of(follower);
      const double bytes = moving_volumes::bytes_of(follower);
      EXPECT_EQ(differences(followed, mask(finder + (settings.empty() ? "" : ",") + settings, posed.scene(), light, g)), 0)
          << when;
      EXPECT_EQ(work, moving_volumes::work_of(*technique_)) << when;
      EXPECT_TRUE(finder != "finder=cpu" || bytes <= moving_volumes::bytes_of(*technique_)) << when;
      follower.relight(light);
      EXPECT_EQ(differences(moving_volumes::mask_of(follower, g), followed), 0) << when << ", relit once more";
      EXPECT_EQ(work, moving_volumes::work_of(follower)) << when << ", relit once more";
    }
  }

  inline static std::map<std::string, std::unique_ptr<Technique>> used_;
};

TEST_F(StencilInMotion, masks_and_counts_are_those_of_a_fresh_object) {
  for (const Scene& scene : moving_volumes::all_scenes()) follow(scene, "finder=cpu", "", 8);
}

TEST_F(StencilInMotion, all_settings_follow) {
  for (const char* settings : {"count=zpass", "count=zpass_plus", "extrusion=per_triangle", "counter=wide"})
    follow(moving_volumes::touching_boxes(), "finder=cpu", settings, 6);
  for (const char* settings : {"", "extrusion=per_triangle"})
    follow(moving_volumes::touching_boxes(), "finder=gpu", settings, 6);
}

TEST_F(StencilInMotion, glass_follows) {
  Scene scene = moving_volumes::touching_boxes();
  for (const std::uint32_t mesh : {moving_volumes::walker, moving_volumes::folder})
    scene.meshes[mesh].transmission = std::make_shared<Transmission>(1, 1, 1, std::vector<float>{0.5f});
  follow(scene, "finder=cpu", "", 8);
}

// What touches is not joined where one of them moves: both volumes have sides in one plane, which must cover the same pixels.
// Along a triangle without area the outline runs forth and back.
TEST_F(StencilInMotion, are_right_where_bodies_touch_and_triangles_have_no_area) {
  Posed posed(moving_volumes::touching_boxes());
  Random random(7);
  Tally tally;
  for (const double seconds : {0.0, 0.0, 0.0, moving_volumes::folded, moving_volumes::folded, moving_volumes::vanished}) {
    posed.go_to(seconds);
    View view = posed.scene().views[0];
    view.eye = random_point(random, {-3, 3, 4}, {3, 6, 7});
    const GBuffer g = small_world::make_gbuffer(posed.scene(), view, 160, 96);
    for (const Light& light : lights_around(random)) {
      const Exact exact(posed.scene(), g, light);
      for (const char* settings : {"", "count=zpass", "extrusion=per_triangle", "finder=gpu"}) {
        if (supports(settings, posed.scene(), light, g.view).kind() != Support::Kind::full) continue;
        tally.add(exact, mask(settings, posed.scene(), light, g));
      }
    }
  }
  EXPECT_EQ(tally.unexplained, 0);
  EXPECT_GT(tally.dark, 2000);
}

/// Two sheets over a ground that meet at a slanted edge. One of them has a rig; their vertices there run in opposite orders.
Scene two_sheets() {
  const glm::vec3 low(-0.35f, 1.1f, -1.3f), high(0.4f, 1.45f, 1.25f);
  Scene scene = scene_of({small_world::ground(6), mesh_of({low, high, {-1.7f, 1.2f, 0.3f}}, {{0, 1, 2}}),
                          mesh_of({high, low, {1.9f, 1.3f, -0.2f}}, {{0, 1, 2}})});
  auto motion = std::make_shared<Motion>();
  motion->nodes.resize(1);
  motion->animations = {{"walk", {{.node = 0, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
  motion->rigs = {rig_at_rest(scene, 2, 0)};
  scene.motion = motion;
  scene.meshes[2].reach.add(scene.meshes[2].positions);
  return scene;
}

// The side of either sheet along the seam ends where the other begins: its quad is the same, and turned the other way.
TEST_F(StencilInMotion, sides_in_one_plane_begin_at_one_end) {
  const Scene scene = two_sheets();
  const EdgeAdjacency adjacency(scene, Joins::in_every_pose);
  const glm::dvec4 light(0.5, 5, 0.25, 1);
  Silhouette silhouette;
  adjacency.find_silhouette(light, silhouette);
  EXPECT_EQ(silhouette.edges.size(), 4u + 3u + 3u);
  const StateGuard guard;
  stencil_volume::GpuFinder finder;
  finder.setup();
  finder.build(adjacency);
  for (const bool on_device : {false, true}) {
    FaceBuffers faces;
    const FaceCommands commands = on_device ? finder.find(scene_buffers(scene), adjacency, light, {}, faces)
                                            : write_faces(adjacency, silhouette, {}, faces);
    std::vector<glm::uvec4> sides(commands.sides.count / 6);
    ASSERT_EQ(sides.size(), 10u);
    glGetNamedBufferSubData(faces.sides.name(), 0, static_cast<GLsizeiptr>(sides.size() * sizeof(glm::uvec4)), sides.data());
    int shared = 0;
    for (const glm::uvec4& a : sides)
      for (const glm::uvec4& b : sides) {
        if (a.z >= b.z) continue;  // of two parts, each pair once
        const auto at = [&](std::uint32_t v) { return adjacency.positions()[v]; };
        EXPECT_FALSE(at(a.x) == at(b.y) && at(a.y) == at(b.x));
        if (at(a.x) != at(b.x) || at(a.y) != at(b.y)) continue;
        ++shared;
        EXPECT_NE(a.w, b.w);
      }
    EXPECT_EQ(shared, 1);
  }
}

TEST_F(StencilInMotion, seam_between_what_moves_and_what_stands_still_has_no_crack) {
  const Scene scene = two_sheets();
  Random random(9);
  Tally tally;
  for (int round = 0; round < 12; ++round) {
    const GBuffer g = small_world::make_gbuffer(scene, random_view(random, false), 160, 120);
    for (const Light& light :
         {Light{.kind = PointLight{random_point(random, {-1, 4, -1}, {1, 6, 1})}},
          Light{.kind = DirectionalLight{random_point(random, {-0.4f, -1, -0.4f}, {0.4f, -0.8f, 0.4f})}}}) {
      const Exact exact(scene, g, light);
      for (const char* settings : {"", "count=zpass", "extrusion=per_triangle", "finder=gpu"})
        if (supports(settings, scene, light, g.view).kind() == Support::Kind::full)
          tally.add(exact, mask(settings, scene, light, g));
    }
  }
  EXPECT_EQ(tally.not_snapped, 0);
  EXPECT_GT(tally.dark, 20000);
}

}  // namespace stencil_in_motion_test
