#include "measure/program/changes_json.h"

#include <gtest/gtest.h>

#include "error_words.h"

namespace changes_json_test {
using namespace gnomon;

/// Three meshes of 3, 4 and 5 vertices.
Scene three_meshes() {
  Scene scene;
  scene.name = "three";
  for (std::size_t k = 0; k < 3; ++k) {
    Mesh mesh;
    mesh.positions.resize(3 + k);
    scene.meshes.push_back(mesh);
  }
  return scene;
}

TEST(changes_json, lists_the_meshes_that_moved_with_their_vertices_in_the_array_of_all) {
  Changes changes;
  changes.meshes.resize(3);
  changes.meshes[1] = {.kind = MeshChange::Kind::rigid, .first = 1, .count = 2, .before = {{0, 0.1f, 0}, {1, 2, 3}}};
  changes.meshes[1].after = {{5, 0.1f, 0}, {6, 2, 3}};
  changes.meshes[1].matrix[3] = {5, 0, 0, 1};
  changes.meshes[1].matrix[1] = {0.5, 1, 0, 0};  // the second column: x becomes x + y / 2 + 5
  changes.meshes[2] = {.kind = MeshChange::Kind::deformed, .first = 0, .count = 5, .before = {{0, 0, 0}, {1, 1, 1}}};
  changes.meshes[2].after = {{0, 0, 0}, {1, 1, 2}};
  const Json json = changes_json(three_meshes(), changes);
  EXPECT_EQ(json_text(json),
            "[{\"mesh\":1,\"kind\":\"rigid\",\"first\":4,\"count\":2,\"before\":[[0,0.1,0],[1,2,3]],"
            "\"after\":[[5,0.1,0],[6,2,3]],\"matrix\":[[1.0,0.5,0.0,5.0],[0.0,1.0,0.0,0.0],[0.0,0.0,1.0,0.0],"
            "[0.0,0.0,0.0,1.0]]},{\"mesh\":2,\"kind\":\"deformed\",\"first\":7,\"count\":5,"
            "\"before\":[[0,0,0],[1,1,1]],\"after\":[[0,0,0],[1,1,2]]}]");
}

TEST(changes_json, is_empty_where_nothing_moved_and_refuses_another_number_of_meshes) {
  Changes changes;
  changes.meshes.resize(3);
  EXPECT_EQ(json_text(changes_json(three_meshes(), changes)), "[]");
  changes.meshes.resize(2);
  EXPECT_EQ(error_words::error_of([&] { changes_json(three_meshes(), changes); }),
            "2 changes came for the 3 meshes of three; one for each is wanted");
}

}  // namespace changes_json_test
