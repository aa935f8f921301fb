#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "measure/conformance/motion_world.h"
#include "measure/conformance/trial.h"
#include "measure/scene/motion.h"

namespace gnomon::conformance {

/// A light and an eye that slide, each in two steps of 4 % of its distance: that is a few pixels.
class Slides {
 public:
  Slides(const Scene& scene, const Light& light, const View& view);
  Light light(int step) const { return light_at(of_light_, light_, step); }
  View view(int step) const { return view_at(of_eye_, view_, step); }

 private:
  Light light_;
  View view_;
  Path of_light_, of_eye_;
};

/// A still frame, a light that moves, an eye that moves, vertices that move, and all at once.
struct Step {
  int pose, light, view;
};
inline constexpr std::array<Step, 6> sequence_steps = {{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {2, 2, 2}}};

/// The frames of these steps in a scene that moves. Vertices stay where the technique states that updates are not exact.
class Sequence {
 public:
  static constexpr std::size_t frame_count = sequence_steps.size();

  Sequence(const Trial& trial, MovingWorld& world, const Light& light);
  /// In all frames.
  bool is_supported() const { return is_supported_; }
  const Scene& scene() const { return world_.scene(); }
  const Light& light(std::size_t k) const { return frames_[k].light; }
  const GBuffer& gbuffer(std::size_t k) const { return frames_[k].gbuffer; }
  /// What moved since the last call.
  Changes go_to(std::size_t k);

 private:
  struct Frame {
    int pose;
    Light light;
    GBuffer gbuffer;
  };
  MovingWorld& world_;
  std::vector<Frame> frames_;
  bool is_supported_ = true;
};

/// The first light, and the first that has an area if that has none, or has none if that has one. The first alone where the
/// trial is short.
std::vector<Light> two_lights(const Trial& trial, const std::vector<Light>& lights);

}  // namespace gnomon::conformance
