#include "measure/frame/frame.h"

#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>

#include "measure/frame/light_rays.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace frame_test {

using namespace gnomon;
namespace fs = std::filesystem;

std::set<std::string> file_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) names.insert(entry.path().filename());
  return names;
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Scene ball_over_ground() {
  Scene scene;
  scene.name = "ball";
  scene.meshes = {tessellate(ground_plane(4), 4, "ground"), tessellate(Sphere{{0, 1.5f, 0}, 1}, 12, "ball")};
  scene.lights = {{.name = "point", .kind = PointLight{{2, 6, 1}}}, {.name = "sun", .kind = DirectionalLight{{1, -2, 0}}}};
  scene.views = {View{.eye = {1, 4, 7}}, View{.name = "other", .eye = {1, 4, 7.5f}}};
  return scene;
}

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
  return std::ranges::equal(a, b);
}
bool same(const GBuffer& a, const GBuffer& b) {
  return same(a.px, b.px) && same(a.py, b.py) && same(a.pz, b.pz) && same(a.nx, b.nx) && same(a.ny, b.ny) && same(a.nz, b.nz) &&
         same(a.mesh, b.mesh) && same(a.triangle, b.triangle) && a.width == b.width && a.height == b.height &&
         a.truth == b.truth && a.view.eye == b.view.eye;
}

TEST(frame, what_the_cache_holds_is_what_is_computed) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  const Scene scene = ball_over_ground();
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const RayScene everything(scene, truth, RayScene::Which::seen), casters(scene, truth, RayScene::Which::casters);
    const GBuffer fresh = make_gbuffer(scene, everything, scene.views[0], 50, 30, truth);
    // The first round makes the files, the second finds them.
    for (int round = 0; round < 2; ++round) {
      FrameStore frames(scene, folder.path());
      const FrameKey key{scene.views[0], 50, 30, truth};
      EXPECT_TRUE(same(frames.gbuffer(key), fresh));
      EXPECT_TRUE(same(map_gbuffer(frames.gbuffer_file(key), key), fresh));
      for (const Light& light : scene.lights) {
        std::vector<float> mask(fresh.size());
        trace_shadows(casters, scene, fresh, light, mask);
        const std::vector<PixelClass> classes =
            classify(scene, casters, fresh, light, mask, find_silhouettes(everything, fresh));
        const Reference reference = frames.reference(key, light);
        EXPECT_TRUE(std::ranges::equal(reference.mask, mask));
        EXPECT_TRUE(std::ranges::equal(reference.classes, classes));
        EXPECT_TRUE(std::ranges::equal(reference.nearest_caster, find_nearest_casters(scene, casters, fresh, light, mask)));
        EXPECT_TRUE(
            std::ranges::equal(reference.snapping, find_snapping(scene, everything, casters, fresh, light, mask, classes)));
        EXPECT_GT(std::ranges::count(mask, 0.0f), 20);
      }
    }
  }
  EXPECT_EQ(file_names(folder.path()).size(), 7u) << "the scene, and for each truth a G-buffer and two references";
}

TEST(frame, meshes_that_do_not_cast_are_seen_and_block_nothing) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene = ball_over_ground();
  scene.meshes.push_back(tessellate(Plane{{0, 2.6f, 0}, {3, 0, 0}, {0, 0, 3}}, 4, "pane"));
  scene.meshes.back().casts = false;
  const FrameKey key{scene.views[0], 50, 30, Truth::mesh};
  const RayScene everything(scene, key.truth, RayScene::Which::seen), casters(scene, key.truth, RayScene::Which::casters);
  // In either order: the store must not take the rays of one question for those of the other.
  for (const bool casters_first : {true, false}) {
    FrameStore frames(scene, folder.path() / (casters_first ? "a" : "b"));
    if (casters_first) frames.casters(key.truth);
    const GBuffer g = frames.gbuffer(key);
    EXPECT_GT(std::ranges::count(g.mesh, 2u), 100);
    const Reference reference = frames.reference(key, scene.lights[1]);
    for (std::size_t i = 0; i < g.size(); ++i)
      EXPECT_TRUE(g.mesh[i] != 2 || reference.mask[i] == 1) << "nothing lies between the pane and the sun";
    EXPECT_TRUE(std::ranges::equal(
        reference.snapping, find_snapping(scene, everything, casters, g, scene.lights[1], reference.mask, reference.classes)));
  }
}

TEST(frame, dark_pixels_know_their_nearest_caster) {
  // Two plates over the ground, the lower one smaller: under both, the lower one is nearer. A ball lies beside them.
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene;
  scene.name = "plates";
  scene.meshes = {tessellate(ground_plane(4), 4, "ground"), tessellate(Plane{{-3, 3, 0}, {1, 0, 0}, {0, 0, 1}}, 4, "high"),
                  tessellate(Plane{{-1.5f, 1.5f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}, 4, "low"),
                  tessellate(Sphere{{2.5f, 0.5f, 0}, 0.5f}, 32, "ball")};
  scene.lights = {{.name = "sun", .kind = DirectionalLight{{1, -1, 0}}}, {.name = "point", .kind = PointLight{{-60, 60, 0}}}};
  scene.views = {View{.eye = {0, 12, 0.1f}, .up = {0, 0, -1}}};
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    FrameStore frames(scene, folder.path());
    const FrameKey key{scene.views[0], 128, 128, truth};
    const GBuffer g = frames.gbuffer(key);
    for (const Light& light : scene.lights) {
      const Reference reference = frames.reference(key, light);
      ASSERT_EQ(reference.nearest_caster.size(), g.size());
      int under_both = 0, under_high = 0, of_ball = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        const bool is_dark = reference.mask[i] <= 0.5f && reference.classes[i] > PixelClass::F;
        if (!is_dark || reference.classes[i] != PixelClass::T) {
          EXPECT_TRUE(is_dark || reference.nearest_caster[i] == no_mesh);
          continue;
        }
        if (g.mesh[i] != 0) continue;
        // The shadows on the ground: of the high plate |x|, |z| < 1 around 0, of the low one |x|, |z| < 0.5, of the ball around
        // x = 3. The point light at 60 meters moves them by a few centimeters.
        const glm::vec3 p = g.position(i);
        const float across = std::max(std::abs(p.x), std::abs(p.z));
        const std::uint32_t nearest_caster = reference.nearest_caster[i];
        under_both += across < 0.4f && nearest_caster == 2;
        under_high += across > 0.6f && p.x < 1.3f && nearest_caster == 1;
        of_ball += p.x > 2 && nearest_caster == 3;
        EXPECT_TRUE(across >= 0.4f || nearest_caster == 2) << p.x << ' ' << p.z;
        EXPECT_TRUE(across <= 0.6f || p.x >= 1.3f || nearest_caster == 1) << p.x << ' ' << p.z;
        EXPECT_TRUE(p.x <= 2 || nearest_caster == 3) << p.x << ' ' << p.z;
      }
      EXPECT_GT(under_both, 50);
      EXPECT_GT(under_high, 200);
      EXPECT_GT(of_ball, 50);
    }
  }
}

TEST(frame, whatever_changes_the_answer_has_a_file_of_its_own) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 20, 10, Truth::shape};
  std::set<fs::path> files;
  const auto is_new = [&](const Scene& s, const FrameKey& k) {
    return files.insert(FrameStore(s, folder.path()).gbuffer_file(k).filename()).second;
  };
  EXPECT_TRUE(is_new(scene, key));
  EXPECT_FALSE(is_new(scene, key));
  EXPECT_FALSE(is_new(ball_over_ground(), key)) << "an equal scene has an equal file";
  EXPECT_TRUE(is_new(scene, {scene.views[1], 20, 10, Truth::shape}));
  EXPECT_TRUE(is_new(scene, {scene.views[0], 10, 20, Truth::shape}));
  EXPECT_TRUE(is_new(scene, {scene.views[0], 20, 10, Truth::mesh}));
  scene.meshes[1].positions[0].x += 0.001f;
  EXPECT_TRUE(is_new(scene, key));
  // References: one file a light.
  FrameStore frames(scene, folder.path());
  const auto count = [&] { return file_names(folder.path()).size(); };
  const std::size_t before = count();
  Light light = scene.lights[0];
  frames.reference(key, light);
  frames.reference(key, light);
  EXPECT_EQ(count(), before + 1);
  std::get<PointLight>(light.kind).position.x += 1;
  frames.reference(key, light);
  frames.reference({scene.views[0], 20, 10, Truth::mesh}, light);
  EXPECT_EQ(count(), before + 4) << "the last also needs its G-buffer";
}

TEST(frame, a_file_of_the_wrong_size_is_made_again) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  const Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 20, 10, Truth::shape};
  FrameStore frames(scene, folder.path());
  frames.reference(key, scene.lights[0]);
  frames.scene_file();
  const std::set<std::string> names = file_names(folder.path());
  ASSERT_EQ(names.size(), 3u);
  std::map<std::string, std::string> whole;
  for (const std::string& name : names) whole[name] = content(folder.path() / name);
  for (const std::size_t left : {0, 1, 799, 100000}) {
    for (const std::string& name : names) fs::resize_file(folder.path() / name, left);
    FrameStore again(scene, folder.path());
    again.gbuffer(key);
    again.reference(key, scene.lights[0]);
    again.scene_file();
    EXPECT_EQ(file_names(folder.path()), names);
    for (const std::string& name : names) EXPECT_TRUE(content(folder.path() / name) == whole[name]) << name << ' ' << left;
  }
}

// One bit anywhere: at the begin, within each array, in the hash itself.
TEST(frame, a_damaged_file_is_made_again) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  const Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 20, 10, Truth::shape};
  const auto make = [&] {
    FrameStore frames(scene, folder.path());
    frames.gbuffer(key);
    frames.reference(key, scene.lights[0]);
    frames.scene_file();
  };
  make();
  std::map<std::string, std::string> sound;
  for (const std::string& name : file_names(folder.path())) sound[name] = content(folder.path() / name);
  for (const auto& [name, text] : sound)
    for (std::size_t k = 0; k <= 16; ++k) {
      std::string damaged = text;
      damaged[k * (text.size() - 1) / 16] ^= 4;
      std::ofstream(folder.path() / name, std::ios::binary) << damaged;
      make();
      EXPECT_TRUE(content(folder.path() / name) == text) << name << ' ' << k;
    }
}

TEST(frame, a_folder_that_cannot_be_written_costs_no_row) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  std::ofstream(folder.path() / "file") << "no folder";
  const Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 20, 10, Truth::shape};
  FrameStore cached(scene, folder.path() / "cache");
  const Reference reference = cached.reference(key, scene.lights[0]);
  fs::path scratch;
  {
    FrameStore frames(scene, folder.path() / "file/cache");
    testing::internal::CaptureStderr();
    const Reference found = frames.reference(key, scene.lights[0]);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("file/cache"), std::string::npos) << said;
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << "said once";
    EXPECT_TRUE(std::ranges::equal(found.mask, reference.mask) && std::ranges::equal(found.classes, reference.classes));
    scratch = frames.scene_file().parent_path();
    EXPECT_TRUE(same(map_gbuffer(frames.gbuffer_file(key), key), cached.gbuffer(key)));
  }
  EXPECT_FALSE(fs::exists(scratch));
}

// Another program clears the cache, or has no room left for it: who uses a file keeps it, and so do its workers, who open it
// later; who comes next makes it anew.
TEST(frame, a_file_that_is_removed_stays_with_who_uses_it) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  const Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 20, 10, Truth::shape};
  FrameStore frames(scene, folder.path());
  frames.reference(key, scene.lights[0]);
  const fs::path gbuffer = frames.gbuffer_file(key), scene_file = frames.scene_file();
  const std::set<std::string> names = file_names(folder.path());
  ASSERT_EQ(names.size(), 3u);
  for (const std::string& name : names) fs::remove(folder.path() / name);
  EXPECT_EQ(map_gbuffer(gbuffer, key).size(), 200u);
  EXPECT_EQ(frames.gbuffer_file(key), gbuffer);
  EXPECT_EQ(frames.scene_file(), scene_file);
  frames.reference(key, scene.lights[0]);
  EXPECT_TRUE(file_names(folder.path()).empty());
  frames.reference(key, scene.lights[1]);
  FrameStore(scene, folder.path()).reference(key, scene.lights[0]);
  EXPECT_EQ(file_names(folder.path()).size(), 4u);
  // What stands for it goes with its owner, and what a killed one left with the next.
  const fs::path left = folder.path() / "in_use-999999999.abcdef";
  fs::create_directory(left);
  { FrameStore last(scene, folder.path()); }
  EXPECT_FALSE(fs::exists(left));
}

TEST(frame, a_gbuffer_file_that_is_too_short_is_an_error_for_who_only_maps_it) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  std::ofstream(folder.path() / "short") << "1234";
  EXPECT_THROW(map_gbuffer(folder.path() / "short", {View{}, 20, 10, Truth::shape}), Error);
}

}  // namespace frame_test
