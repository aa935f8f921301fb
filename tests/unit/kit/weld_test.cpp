// Vertices at exactly one position.
#include <gnomon/scene.h>
#include <gtest/gtest.h>

namespace gnomon::weld_test {

using Indices = std::vector<std::uint32_t>;

// The first of each position; minus zero is zero, and what is only near is not the same.
TEST(Weld, the_first_vertex_at_each_position) {
  const std::vector<glm::vec3> positions = {{1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {-0.0f, 0, -0.0f}, {1, 2, 3.0000002f}, {1, 2, 3}};
  EXPECT_EQ(weld(positions), (Indices{0, 1, 0, 1, 4, 0}));
  EXPECT_TRUE(weld({}).empty());
}

// Vertices without `wanted` stay alone, and others are not joined to them.
TEST(Weld, only_those_wanted) {
  const std::vector<glm::vec3> positions(4, glm::vec3(1));
  const std::vector<std::uint8_t> wanted = {0, 1, 0, 1};
  EXPECT_EQ(weld(positions, wanted), (Indices{0, 1, 2, 1}));
}

}  // namespace gnomon::weld_test
