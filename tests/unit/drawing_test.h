#pragma once
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "device/context.h"
#include "measure/conformance/gl_state.h"

namespace gnomon {

/// Has a context. Whatever a test draws, it leaves OpenGL's state at its defaults; inputs that it gave are let go.
class DrawingTest : public testing::Test {
 protected:
  DrawingTest() { process_context(); }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }
};

}  // namespace gnomon
