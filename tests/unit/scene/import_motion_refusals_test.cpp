// Damaged answers of the importer about what moves: this side takes none of them.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "../error_words.h"
#include "../moving_file.h"
#include "measure/scene/motion_data.h"

namespace import_motion_refusals_test {

using namespace gnomon;
using namespace moving_file;
using error_words::error_of;
using error_words::expect_words;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A change of an answer, and words of the error that it brings.
struct Damage {
  std::function<void(MeshFile&)> change;
  std::vector<std::string> words;
};
void expect_refused(const MeshFile& sound, const std::vector<Damage>& damages) {
  EXPECT_TRUE(imported(sound).motion);
  for (const auto& [change, words] : damages) {
    MeshFile file = sound;
    change(file);
    const std::string error = error_of([&] { imported(file); });
    expect_words(error, {"hand.gltf"});
    expect_words(error, words);
  }
}

TEST(import_motion_refusals, damaged_nodes_and_skins_are_refused) {
  using File = MeshFile&;
  expect_refused(
      bending(),
      {{[](File f) { f.motion.nodes[1].parent = 1; }, {"node 1", "parent = 1", "smaller"}},
       {[](File f) { f.motion.nodes[1].parent = 9; }, {"node 1", "parent = 9"}},
       {[](File f) { f.motion.nodes[1].translation.y = nan; }, {"node 1", "translation"}},
       {[](File f) { f.motion.nodes[1].scale.z = nan; }, {"node 1", "scale"}},
       {[](File f) { f.motion.nodes[1].rotation = glm::dvec4(0); }, {"node 1", "rotation = (0, 0, 0, 0)", "length 1"}},
       {[](File f) { f.motion.nodes[1].matrix = glm::dmat4(nan); }, {"node 1", "matrix"}},
       {[](File f) { f.motion.nodes[0].weights[1] = nan; }, {"node 0", "weights"}},
       {[](File f) {
          f.motion.skins[0].joints = {1, 3};
        },
        {"skin 0", "joint 1", "node 3 of 3"}},
       {[](File f) { f.motion.skins[0].joints = {1}; }, {"skin 0", "1 joints and 2 inverse"}},
       {[](File f) { f.motion.skins[0] = {}; }, {"skin 0", "no joints"}},
       {[](File f) { f.motion.skins[0].inverse_bind[1][2][3] = nan; }, {"skin 0", "joint 1", "not finite"}}});
}

TEST(import_motion_refusals, damaged_tracks_are_refused) {
  using File = MeshFile&;
  const auto tracks = [](File f) -> std::vector<Track>& { return f.motion.animations[0].tracks; };
  expect_refused(
      bending(),
      {{[&](File f) { tracks(f).clear(); }, {"animation 0 'bend'", "no tracks"}},
       {[&](File f) { tracks(f)[1].node = 3; }, {"animation 0 'bend', track 1", "node 3 of 3"}},
       {[&](File f) { tracks(f)[1].property = Track::Property{4}; }, {"track 1", "property 4"}},
       {[&](File f) { tracks(f)[1].interpolation = Track::Interpolation{3}; }, {"track 1", "interpolation 3"}},
       {[&](File f) { f.motion.nodes[2].matrix = glm::dmat4(1); }, {"track 1", "node 2", "matrix"}},
       {[&](File f) { tracks(f)[0].node = 2; }, {"track 0", "node 2", "weights", "none"}},
       {[&](File f) { tracks(f)[1].times.clear(); }, {"track 1", "no keys"}},
       {[&](File f) { tracks(f)[1].values.pop_back(); }, {"track 1", "2 keys of 4", "7 numbers"}},
       {[&](File f) { tracks(f)[1].interpolation = Track::Interpolation::cubic; }, {"track 1", "2 keys of 12", "8 numbers"}},
       {[&](File f) {
          tracks(f)[0].values = {0, 0};
        },
        {"track 0", "2 keys of 2", "2 numbers"}},
       {[&](File f) {
          tracks(f)[1].times = {-1, 1};
        },
        {"track 1, key 0", "time = -1"}},
       {[&](File f) {
          tracks(f)[1].times = {0, nan};
        },
        {"track 1, key 1", "time = nan"}},
       {[&](File f) {
          tracks(f)[1].times = {0, INFINITY};
        },
        {"track 1, key 1", "time = inf"}},
       {[&](File f) {
          tracks(f)[1].times = {2, 1};
        },
        {"track 1, key 1", "time = 1 s is before 2 s"}},
       {[&](File f) { tracks(f)[0].values[3] = INFINITY; }, {"track 0, key 1", "inf"}},
       {[&](File f) { tracks(f)[1].values = {0, 0, 0, 1, 0, 0, 0, 0}; }, {"track 1, key 1", "rotation = (0, 0, 0, 0)"}},
       {[&](File f) { tracks(f)[0] = tracks(f)[1]; }, {"track 1", "another track of node 2"}}});
}

TEST(import_motion_refusals, damaged_rigs_are_refused) {
  using File = MeshFile&;
  const auto mesh = [](File f) -> ImportedMesh& { return f.meshes[0]; };
  expect_refused(bending(), {{[&](File f) { f.motion.animations.clear(); }, {"mesh 'bender'", "no animation"}},
                             {[&](File f) { mesh(f).nodes.push_back(0); }, {"mesh 'bender'", "1 places at 2 nodes"}},
                             {[&](File f) { mesh(f).nodes = {3}; }, {"mesh 'bender'", "node 3 of 3"}},
                             {[&](File f) { mesh(f).nodes = {1}; },
                              {"mesh 'bender'", "3 vertices, 0 weights of morph targets and 6 moves"}},
                             {[&](File f) { mesh(f).skin = 1; }, {"mesh 'bender'", "skin 1 of 1"}},
                             {[&](File f) { mesh(f).skin = Rig::no_skin; }, {"mesh 'bender'", "without a skin", "6 joints"}},
                             {[&](File f) { mesh(f).joints_per_vertex = 0; }, {"mesh 'bender'", "0 joints for each"}},
                             {[&](File f) { mesh(f).joints_per_vertex = 4; }, {"mesh 'bender'", "4 joints for each, 6 joints"}},
                             {[&](File f) { mesh(f).weights.pop_back(); }, {"mesh 'bender'", "5 weights"}},
                             {[&](File f) { mesh(f).places[0][3][0] = 1; }, {"mesh 'bender'", "place beside its skin"}},
                             {[&](File f) { mesh(f).base.resize(2); }, {"mesh 'bender'", "3 vertices and 2 positions"}},
                             {[&](File f) { mesh(f).targets.pop_back(); }, {"mesh 'bender'", "5 moves"}},
                             {[&](File f) { mesh(f).joints[3] = 2; }, {"mesh 'bender', vertex 1", "joint 2 is outside 0 .. 1"}},
                             {[&](File f) { mesh(f).weights[3] = nan; }, {"mesh 'bender', vertex 1", "nan"}},
                             {[&](File f) { mesh(f).targets[4].x = INFINITY; }, {"mesh 'bender', vertex 1", "target 1", "inf"}},
                             {[&](File f) {
                                mesh(f).base = mesh(f).positions;
                                mesh(f).base[2].x = 2e17;
                              },
                              {"mesh 'bender', vertex 2", "2e+17", "-1e17 .. 1e17"}}});
}

TEST(import_motion_refusals, many_places_of_many_targets_are_refused_before_they_take_memory) {
  MeshFile file = bending();
  ImportedMesh& mesh = file.meshes[0];
  mesh.skin = Rig::no_skin;
  mesh.joints_per_vertex = 0;
  mesh.joints.clear();
  mesh.weights.clear();
  file.motion.animations[0].tracks.erase(file.motion.animations[0].tracks.begin());
  file.motion.nodes[0].weights.resize(100'000);
  mesh.targets.resize(300'000);
  mesh.places.resize(500, glm::dmat4(1));  // 500 * 3 * 300,003 numbers
  mesh.nodes.resize(500, 0);
  expect_words(error_of([&] { imported(file); }), {"mesh 'bender'", "more than 40000000 numbers"});
}

TEST(import_motion_refusals, an_answer_that_breaks_off_is_refused) {
  FieldWriter writer;
  MeshFile file = bending();
  visit_file(writer, file);
  for (std::size_t size = 0; size < writer.bytes.size(); ++size) {
    Scene scene;
    EXPECT_THROW(add_imported("hand.gltf", std::span(writer.bytes).first(size), {}, scene), Error) << size;
  }
}

// --- scenes, which no child has sent ---

TEST(import_motion_refusals, unsound_motions_of_scenes_are_refused) {
  const auto refuse = [](const std::function<void(Motion&)>& change, const std::vector<std::string>& words) {
    Scene scene = imported(bending());
    Motion motion = *scene.motion;
    change(motion);
    scene.motion = std::make_shared<const Motion>(motion);
    const std::string error = error_of([&] { finish_scene(scene, "waves"); });
    expect_words(error, {"waves: "});
    expect_words(error, words);
  };
  refuse([](Motion& m) { m.animations[0].name = "Bend"; }, {"name 'Bend'", "a..z"});
  refuse([](Motion& m) { m.animations.push_back(m.animations[0]); }, {"name 'bend'", "twice"});
  refuse([](Motion& m) { m.animations.clear(); }, {"no animation"});
  refuse([](Motion& m) { m.animations[0].tracks[0].times = {1, 0}; }, {"animation 0 'bend', track 0, key 1", "before"});
  refuse([](Motion& m) { m.rigs[0].mesh = 1; }, {"mesh 1 of 1"});
  refuse([](Motion& m) { m.rigs.push_back(m.rigs[0]); }, {"mesh 'bender'", "two ways"});
  refuse([](Motion& m) { m.rigs[0].base.pop_back(); }, {"mesh 'bender'", "3 vertices and 2 positions"});
  refuse([](Motion& m) { m.rigs[0].placement.scale.x = nan; }, {"mesh 'bender'", "placement"});
}

}  // namespace import_motion_refusals_test
