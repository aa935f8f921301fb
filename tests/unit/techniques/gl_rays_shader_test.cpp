// The shader of rays in OpenGL: its text, and what it computes of one triangle.
#include <gnomon/error.h>
#include <gnomon/kit/gl/gl.h>

#include <array>
#include <cmath>
#include <sstream>

#include "drawing_test.h"
#include "techniques/gl_rays/shader.h"

namespace gl_rays_shader_test {
using namespace gnomon;
using namespace gnomon::gl_rays;

/// Lines of a shader's text that compute with floats, an operator between blanks, and are not `precise`; of those from
/// behind the first `from` to the next `to`.
std::vector<std::string> imprecise_lines(const std::string& text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from), end = text.find(to, begin);
  if (begin == std::string::npos || end == std::string::npos) throw Error("there is no \"{}\" before a \"{}\"", from, to);
  std::vector<std::string> lines;
  std::istringstream stream(text.substr(begin + from.size(), end - begin - from.size()));
  for (std::string line; std::getline(stream, line);) {
    line.erase(0, line.find_first_not_of(' '));
    const bool computes = std::ranges::any_of(std::array{" + ", " - ", " * ", " / ", " -= ", " += ", " *= ", "dot(", "cross("},
                                              [&](const char* step) { return line.find(step) != std::string::npos; });
    if (computes && !line.starts_with("precise ")) lines.push_back(line);
  }
  return lines;
}

/// From the shear to what an edge function decides, and corners relative to the start.
std::vector<std::string> imprecise_lines(const std::string& text) {
  std::vector<std::string> lines = imprecise_lines(text, "vec2 ray_shear", "return vec3(u, v, w)");
  for (const auto& more :
       {imprecise_lines(text, "bool is_inside", "return sum"), imprecise_lines(text, "place + 2).xyz);", "if (first.w"),
        imprecise_lines(text, "vec3 size = abs", "vec3 start")})
    lines.insert(lines.end(), more.begin(), more.end());
  return lines;
}

// A driver may fuse a product and a sum that are not `precise`. The function of an edge then has two values, one for each of
// the triangles that share it, and rays slip through. No run on a renderer that does not fuse would show it. Without any one of
// its thirteen words a line is found.
TEST(gl_rays_shader, is_precise_in_every_step_of_an_edge_function) {
  for (const bool textures : {false, true}) {
    const std::string text = trace_source(textures);
    EXPECT_EQ(imprecise_lines(text), std::vector<std::string>{});
    int words = 0;
    for (std::size_t at = text.find("precise "); at != std::string::npos; at = text.find("precise ", at + 1)) {
      std::string without = text;
      without.erase(at, 8);
      EXPECT_EQ(imprecise_lines(without).size(), 1u) << without.substr(at, 40);
      ++words;
    }
    EXPECT_EQ(words, 13);
  }
}

class GlRaysShader : public DrawingTest {
 protected:
  /// Edge functions, and whether the ray meets the triangle, as the shader computes them.
  struct Met {
    glm::vec3 edges;
    bool is_hit;
  };
  /// Of the ray from the origin to a homogeneous light.
  static Met met(const glm::vec4& light, const std::array<glm::vec3, 3>& corners) {
    const StateGuard guard;
    const Program program = Program::compute("one triangle", "layout(local_size_x = 1) in;\n" + triangle_snippet + R"(
layout(std430, binding = 0) writeonly buffer Answer { vec4 answer; };
uniform vec3 a, b, c;
uniform vec4 light;
void main() {
  int axis = ray_axis(light.xyz);
  vec3 edges = edge_functions(turned(a, axis), turned(b, axis), turned(c, axis), ray_shear(turned(light.xyz, axis)));
  bool is_hit = is_inside(edges) && is_between(dvec3(a), dvec3(b), dvec3(c), dvec3(0.0), dvec4(light));
  answer = vec4(edges, is_hit);
}
)");
    const Buffer answer(nullptr, sizeof(glm::vec4), GL_DYNAMIC_STORAGE_BIT);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, answer.name());
    program.set("light", light);
    const char* const names[] = {"a", "b", "c"};
    for (int k = 0; k < 3; ++k) program.set(names[k], corners[k]);
    glUseProgram(program.name());
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glm::vec4 read;
    glGetNamedBufferSubData(answer.name(), 0, sizeof read, &read);
    return {read, read.w != 0};
  }
};

// The way (1, 2, 4) is longest along z: corners are sheared by (1/4, 1/2) of their z, to (-1.5, -2), (2.5, -2) and (-0.5, 4).
// The edge functions are -0.5 * -2 - 4 * 2.5 = -9, -1.5 * 4 - -2 * -0.5 = -7 and 2.5 * -2 - -2 * -1.5 = -8.
TEST_F(GlRaysShader, computes_the_edge_functions_derived_on_paper) {
  const Met m = met({1, 2, 4, 1}, {glm::vec3(-1, -1, 2), {3, -1, 2}, {0, 5, 2}});
  EXPECT_EQ(m.edges, glm::vec3(-9, -7, -8));
  EXPECT_TRUE(m.is_hit);
}

// The way (1, 1, 4) meets z = 2 at (0.5, 0.5, 2), on the diagonal that both halves of a square have.
TEST_F(GlRaysShader, meets_both_triangles_at_their_common_edge) {
  const Met below = met({1, 1, 4, 1}, {glm::vec3(0, 0, 2), {2, 2, 2}, {2, 0, 2}});
  const Met above = met({1, 1, 4, 1}, {glm::vec3(0, 0, 2), {0, 2, 2}, {2, 2, 2}});
  EXPECT_EQ(below.edges, glm::vec3(3, 1, 0));
  EXPECT_EQ(above.edges, glm::vec3(3, 0, 1));
  EXPECT_TRUE(below.is_hit);
  EXPECT_TRUE(above.is_hit);
}

// The same triangle in all three turns of the axes, against the way, and before and behind what the ray spans.
TEST_F(GlRaysShader, meets_only_what_lies_on_the_ray) {
  for (int turn = 0; turn < 3; ++turn) {
    const auto at = [&](const glm::vec3& p) { return glm::vec3(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]); };
    const auto is_hit = [&](float z, const glm::vec3& way, float w) {
      return met(glm::vec4(at(way), w), {at({-1, -1, z}), at({3, -1, z}), at({0, 5, z})}).is_hit;
    };
    EXPECT_TRUE(is_hit(2, {1, 2, 4}, 1)) << turn;
    EXPECT_TRUE(is_hit(-2, {-1, 2, -4}, 1)) << turn;
    EXPECT_FALSE(is_hit(2, {-1, 2, -4}, 1)) << turn << ", behind the start";
    EXPECT_FALSE(is_hit(2, {-1, 2, -4}, 0)) << turn << ", behind the start";
    EXPECT_FALSE(is_hit(0, {1, 2, 4}, 1)) << turn << ", at the start";
    EXPECT_FALSE(is_hit(4, {0, 1, 4}, 1)) << turn << ", at the light";
    EXPECT_TRUE(is_hit(std::nextafter(4.0f, 0.0f), {0, 1, 4}, 1)) << turn << ", just before the light";
    EXPECT_FALSE(is_hit(4.5f, {0, 1, 4}, 1)) << turn << ", behind the light";
    EXPECT_TRUE(is_hit(4.5f, {0, 1, 4}, 0)) << turn << ", before a light at infinity";
    EXPECT_FALSE(is_hit(2, {-4, 1, 4}, 1)) << turn << ", beside the triangle";
  }
  EXPECT_FALSE(met({1, 1, 4, 1}, {glm::vec3(1, 1, 2), {1, 1, 2}, {1, 1, 2}}).is_hit) << "no area";
  EXPECT_FALSE(met({0, 0, 4, 1}, {glm::vec3(0, -1, 1), {0, 1, 2}, {0, -1, 3}}).is_hit) << "edge-on";
}

}  // namespace gl_rays_shader_test
