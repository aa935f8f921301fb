#include <gnomon/kit/gl/gl_pass.h>
#include <gtest/gtest.h>

#include <random>

#include "device/context.h"
#include "measure/conformance/gl_state.h"

namespace gl_pass_test {
using namespace gnomon;

class GlPass : public testing::Test {
 protected:
  GlPass() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

/// The mask that a program writes with `draw`.
template <class Draw>
std::vector<float> drawn(const Program& program, int width, int height, const Draw& draw) {
  VisibilityMask mask(width, height);
  {
    const StateGuard guard;
    const Framebuffer framebuffer = make_framebuffer();
    glUseProgram(program.name());
    draw(framebuffer, mask.texture());
  }
  const auto pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

// Each kind of constant reaches the fragments, arrays and matrices too; 1 + 2 + 3 * 4 + 5 + 6 + 7 * 8 = 82.
TEST_F(GlPass, constants_of_every_kind_reach_the_fragments) {
  const Program program = pass_program("constants", " float a;int b;\nvec3 c; vec4 d[2]; mat3 e ;uint f;", R"(
layout(location = 0) out float sum;
void main() { sum = a + float(b) + c.y * c.z + d[0].w + d[1].x + e[2].x * e[0].z + float(f); })");
  program.set("a", 1.0f);
  program.set("b", 2);
  program.set("c", glm::vec3(0, 3, 4));
  const glm::vec4 d[] = {{0, 0, 0, 5}, {6, 0, 0, 0}};
  program.set("d", std::span<const glm::vec4>(d));
  glm::mat3 e(0);
  e[2].x = 7;
  e[0].z = 8;
  program.set("e", e);
  const auto pixels = drawn(program, 5, 3, [](const Framebuffer& framebuffer, unsigned texture) {
    glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, texture, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, 5, 3);
    draw_full_screen();
  });
  EXPECT_EQ(pixels, std::vector<float>(15, 82.0f));
}

TEST_F(GlPass, what_is_no_declaration_is_an_error_that_quotes_it) {
  for (const std::string wrong : {"vec3;", "vec3 a", "vec3 a; b"}) {
    try {
      const PassConstants constants(wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("is no declaration like"), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(PassConstants(" \n"));
}

// A picture whose receivers are strewn at random: those pixels get the program's answer, all others the answer or 1.
TEST_F(GlPass, a_mask_drawn_over_receivers_has_an_answer_everywhere) {
  const Program program = pass_program("dark", "", "layout(location = 0) out float v; void main() { v = 0; }");
  std::mt19937 random(3);
  Scene scene;
  scene.meshes.resize(1);
  scene.meshes[0].receives = true;
  constexpr int width = 70, height = 50;
  for (const double share : {0.0, 0.001, 0.02, 1.0}) {
    std::vector<float> zero(width * height);
    std::vector<std::uint32_t> mesh(width * height, no_mesh), triangle(width * height);
    for (std::uint32_t& m : mesh)
      if (std::bernoulli_distribution(share)(random)) m = 0;
    GBuffer g{.view = {}, .width = width, .height = height};
    g.px = g.py = g.pz = g.nx = g.ny = g.nz = zero;
    g.mesh = mesh;
    g.triangle = triangle;
    const GBufferTextures& textures = gbuffer_textures(g, scene);
    const auto pixels = drawn(program, width, height, [&](const Framebuffer& framebuffer, unsigned texture) {
      begin_mask(framebuffer, texture, textures);
      draw_receivers(textures);
    });
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      EXPECT_TRUE(pixels[i] == 0 || (pixels[i] == 1 && mesh[i] == no_mesh)) << i;
    }
    if (share == 0) {
      EXPECT_EQ(pixels, std::vector<float>(width * height, 1.0f));
    }
    release_inputs();
  }
}

}  // namespace gl_pass_test
