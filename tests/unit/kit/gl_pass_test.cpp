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

// Each kind of constant reaches the fragments, arrays and matrices and several of one type too;
// 1 + 2 + 3 * 4 + 5 + 6 + 7 * 8 + 100 + 200 = 382.
TEST_F(GlPass, constants_of_every_kind_reach_the_fragments) {
  const Program program = pass_program("constants", " float a , g;int b;\nvec3 c; vec4 h,d[2]; mat3 e ;uint f;", R"(
layout(location = 0) out float sum;
void main() {
  sum = a + float(b) + c.y * c.z + d[0].w + d[1].x + e[2].x * e[0].z + float(f) + g + h.y;
})");
  program.set("a", 1.0f);
  program.set("g", 100.0f);
  program.set("h", glm::vec4(0, 200, 0, 0));
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
  EXPECT_EQ(pixels, std::vector<float>(15, 382.0f));
}

TEST_F(GlPass, what_is_no_declaration_is_an_error_that_quotes_it) {
  for (const std::string wrong : {"vec3;", "vec3 a", "vec3 a; b", "vec3 a,;", "vec3 a b;", "float a = 1;"}) {
    try {
      const PassConstants constants(wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("is no declaration like"), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(PassConstants(" \n"));
}

/// A picture of random pixels that show a receiver. Its points are (number of the pixel, 0, 0), its triangles that number.
struct StrewnPicture {
  static constexpr int width = 70, height = 50;
  Scene scene;
  std::vector<float> number, zero, one;
  std::vector<std::uint32_t> mesh, triangle;
  GBuffer gbuffer{.view = {}, .width = width, .height = height};

  StrewnPicture(double share, unsigned seed) {
    std::mt19937 random(seed);
    scene.meshes.resize(1);
    scene.meshes[0].receives = true;
    for (std::uint32_t i = 0; i < width * height; ++i) {
      number.push_back(static_cast<float>(i));
      triangle.push_back(i);
      mesh.push_back(std::bernoulli_distribution(share)(random) ? 0 : no_mesh);
    }
    zero.assign(number.size(), 0);
    one.assign(number.size(), 1);
    gbuffer.px = number;
    gbuffer.py = gbuffer.pz = gbuffer.nx = gbuffer.nz = zero;
    gbuffer.ny = one;
    gbuffer.mesh = mesh;
    gbuffer.triangle = triangle;
  }
};

/// The mask that a mask_program of both kinds draws.
template <class Set>
std::vector<float> answered(MaskPass by, const StrewnPicture& picture, std::string_view constants, std::string_view answer,
                            const Set& set) {
  const Program program = mask_program("answer", constants, answer, by);
  set(program);
  const GBufferTextures& textures = gbuffer_textures(picture.gbuffer, picture.scene);
  return drawn(program, picture.width, picture.height, [&](const Framebuffer& framebuffer, unsigned texture) {
    draw_mask(program, by, framebuffer, texture, textures);
  });
}

// The answer of each pixel comes from its own point, normal, mesh and triangle: i + 2 (0 + 1) + i / 2 of pixel i.
TEST_F(GlPass, both_passes_answer_each_pixel_from_its_own_facts) {
  for (const double share : {0.0, 0.001, 0.02, 1.0}) {
    const StrewnPicture picture(share, 5);
    for (const MaskPass by : {MaskPass::fragment, MaskPass::compute}) {
      const auto pixels = answered(by, picture, "", R"(
float visibility_here() {
  bool is_seen = position_here().w * normal_here().w > 0;
  return is_seen ? position_here().x + 2 * normal_here().y * float(ids_here().x) + float(ids_here().y) / 2 : 1;
})",
                                   [](const Program&) {});
      for (std::size_t i = 0; i < pixels.size(); ++i)
        ASSERT_EQ(pixels[i], picture.mesh[i] == no_mesh ? 1 : 1.5f * static_cast<float>(i) + 2) << name(by) << ' ' << i;
    }
    release_inputs();
  }
}

// 1 + 2 + 3 * 4 + 5 + 6 + 7 * 8 = 82.
TEST_F(GlPass, constants_of_every_kind_reach_both_passes) {
  const StrewnPicture picture(1, 5);
  for (const MaskPass by : {MaskPass::fragment, MaskPass::compute}) {
    const auto pixels = answered(by, picture, " float a;int b;\nvec3 c; vec4 d[2]; mat3 e ;", R"(
float visibility_here() { return a + float(b) + c.y * c.z + d[0].w + d[1].x + e[2].x * e[0].z; })",
                                 [](const Program& program) {
                                   program.set("a", 1.0f);
                                   program.set("b", 2);
                                   program.set("c", glm::vec3(0, 3, 4));
                                   const glm::vec4 d[] = {{0, 0, 0, 5}, {6, 0, 0, 0}};
                                   program.set("d", std::span<const glm::vec4>(d));
                                   glm::mat3 e(0);
                                   e[2].x = 7;
                                   e[0].z = 8;
                                   program.set("e", e);
                                 });
    EXPECT_EQ(pixels, std::vector<float>(pixels.size(), 82.0f)) << name(by);
  }
  release_inputs();
}

// A picture whose receivers are strewn at random: those pixels get the program's answer, all others the answer or 1.
TEST_F(GlPass, a_mask_drawn_over_receivers_has_an_answer_everywhere) {
  const Program program = pass_program("dark", "", "layout(location = 0) out float v; void main() { v = 0; }");
  for (const double share : {0.0, 0.001, 0.02, 1.0}) {
    const StrewnPicture picture(share, 3);
    const GBufferTextures& textures = gbuffer_textures(picture.gbuffer, picture.scene);
    const auto pixels = drawn(program, picture.width, picture.height, [&](const Framebuffer& framebuffer, unsigned texture) {
      begin_mask(framebuffer, texture, textures);
      draw_receivers(textures);
    });
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      EXPECT_TRUE(pixels[i] == 0 || (pixels[i] == 1 && picture.mesh[i] == no_mesh)) << i;
    }
    if (share == 0) {
      EXPECT_EQ(pixels, std::vector<float>(pixels.size(), 1.0f));
    }
    release_inputs();
  }
}

}  // namespace gl_pass_test
