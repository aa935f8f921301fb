#pragma once
#include <gtest/gtest.h>

#include "device/context.h"
#include "hand_made.h"
#include "measure/conformance/world.h"
#include "small_world.h"

/// Means of hard shadows brought up to masks and refusals.
namespace averaged_hard_rig {
using namespace gnomon;
using conformance::generated_scene;
using conformance::World;

class AveragedHard : public testing::Test {
 protected:
  AveragedHard() { process_context(); }

  static std::unique_ptr<Technique> made(const std::string& id, const std::string& settings) {
    auto technique = registry().technique(id).make();
    technique->apply(settings);
    return technique;
  }
  static std::vector<float> mask_of(const std::string& id, const std::string& settings, const Scene& scene, const Light& light,
                                    const GBuffer& g) {
    const auto technique = made(id, settings);
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    VisibilityMask mask(g.width, g.height);
    technique->resolve(g, mask);
    return {mask.read().begin(), mask.read().end()};
  }
  static std::string refusal(const std::string& settings) {
    try {
      made("averaged_hard", settings);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

inline Light lamp(const glm::vec3& center, float half) {
  return {.name = "lamp", .kind = RectLight{center, {half, 0, 0}, {0, 0, half}}};
}

}  // namespace averaged_hard_rig
