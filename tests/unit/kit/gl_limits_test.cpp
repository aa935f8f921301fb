#include <gnomon/error.h>
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "device/context.h"

namespace gl_limits_test {
using namespace gnomon;

/// What asking for the limits says while GNOMON_GL_LIMITS is these words; the limits are as before after it.
class GlLimitsTest : public testing::Test {
 protected:
  GlLimitsTest() {
    process_context();
    unsetenv("GNOMON_GL_LIMITS");
    ask_gl_limits();
  }
  ~GlLimitsTest() override {
    unsetenv("GNOMON_GL_LIMITS");
    ask_gl_limits();
  }
  std::string complaint(const char* words) {
    setenv("GNOMON_GL_LIMITS", words, 1);
    try {
      ask_gl_limits();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

// Table 23.53 and following of the specification of OpenGL 4.5 core.
TEST_F(GlLimitsTest, are_what_opengl_promises_at_least) {
  const GlLimits* const has = gl_limits();
  ASSERT_TRUE(has);
  EXPECT_TRUE(within_limits({.varying_components = 60,
                             .fragment_storage_blocks = 8,
                             .compute_storage_blocks = 8,
                             .storage_bindings = 8,
                             .storage_block_bytes = 1 << 27,
                             .work_group_size = 1024,
                             .work_groups = 65535,
                             .texture_size = 16384,
                             .texture_layers = 2048,
                             .subpixel_bits = 4}));
}

TEST_F(GlLimitsTest, a_limit_that_is_too_small_is_named_with_what_is_needed_and_what_there_is) {
  EXPECT_EQ(complaint("texture_size=1024,vertex_storage_blocks=0"), "");
  EXPECT_EQ(within_limits({.texture_size = 2048}).why(), "the OpenGL device has texture_size = 1024; 2048 are needed");
  EXPECT_EQ(within_limits({.vertex_storage_blocks = 3}).why(), "the OpenGL device has vertex_storage_blocks = 0; 3 are needed");
  EXPECT_TRUE(within_limits({.texture_size = 1024}));
  EXPECT_TRUE(within_limits({}));
}

TEST_F(GlLimitsTest, what_is_no_limit_is_refused_and_changes_nothing) {
  EXPECT_EQ(complaint("speed=1").substr(0, 65), "GNOMON_GL_LIMITS: speed is none of varying_components | vertex_st");
  for (const char* wrong : {"texture_size", "texture_size=", "texture_size=-1", "texture_size=big", "texture_size=1024x",
                            "texture_size=99999999", "texture_size=1.5"})
    EXPECT_EQ(complaint(wrong).substr(0, 31), "GNOMON_GL_LIMITS: texture_size ") << wrong;
  EXPECT_EQ(complaint("subpixel_bits=1,"), "");
  EXPECT_EQ(gl_limits()->subpixel_bits, 1);
}

TEST_F(GlLimitsTest, a_buffer_that_no_shader_can_read_is_an_error) {
  EXPECT_EQ(complaint("storage_block_bytes=1000"), "");
  EXPECT_NO_THROW(require_storage_block(1000));
  EXPECT_THROW(require_storage_block(1001), Error);
}

TEST_F(GlLimitsTest, without_a_context_nothing_is_too_small) {
  forget_gl_limits();
  EXPECT_EQ(gl_limits(), nullptr);
  EXPECT_TRUE(within_limits({.texture_size = 1 << 30}));
}

}  // namespace gl_limits_test
