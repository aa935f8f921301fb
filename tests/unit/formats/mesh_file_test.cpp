// The contents of a mesh file as the child of an import sends them.
#include <gtest/gtest.h>

#include <utility>

#include "formats/gltf_animated.h"
#include "measure/scene/fields.h"

namespace mesh_file_test {

using namespace gnomon;
using namespace gnomon::importing;
using namespace gnomon::gltf_made;

TEST(MeshFile, a_motion_crosses_the_pipe_whole) {
  Animated file = skinned();
  file.add_target();
  file.add(0, "weights", {0, 1}, std::vector<float>{0, 1}, "STEP");
  MeshFile sent = file.read();
  sent.motion.nodes[1].matrix = glm::dmat4(3);
  Rig rig;
  rig.mesh = 4;
  rig.placement.translate = {1, 2, 3};
  rig.base = {{4, 5, 6}};
  rig.weights = {.5};
  sent.motion.rigs.push_back(rig);
  FieldWriter writer;
  visit_file(writer, std::as_const(sent));
  MeshFile read;
  FieldReader reader(writer.bytes, "too short");
  visit_file(reader, read);
  EXPECT_EQ(reader.left(), 0u);
  FieldWriter again;
  visit_file(again, std::as_const(read));
  EXPECT_EQ(writer.bytes, again.bytes);
  EXPECT_EQ(read.meshes.at(0).joints, sent.meshes.at(0).joints);
  EXPECT_EQ(read.meshes[0].targets, sent.meshes[0].targets);
  EXPECT_EQ(read.motion.nodes.at(1).matrix, glm::dmat4(3));
  EXPECT_EQ(read.motion.nodes.at(0).weights, sent.motion.nodes.at(0).weights);
  EXPECT_EQ(read.motion.animations.at(0).tracks.at(1).values, sent.motion.animations.at(0).tracks.at(1).values);
  EXPECT_EQ(read.motion.skins.at(0).joints, sent.motion.skins.at(0).joints);
  EXPECT_EQ(read.motion.rigs.at(0).placement.translate, glm::dvec3(1, 2, 3));
  for (std::size_t size = 0; size < writer.bytes.size(); size += 7) {
    FieldReader part(std::span(writer.bytes).first(size), "too short");
    MeshFile broken;
    EXPECT_THROW(visit_file(part, broken), Error) << size;
  }
}

}  // namespace mesh_file_test
