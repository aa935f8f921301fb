#include "measure/conformance/sequence.h"

namespace gnomon::conformance {
namespace {

Path wide_slide(const Scene& scene, const char* name, const Light& light, const View& view) {
  Path path = find_path(scene, name, light, view);
  path.positions[1] = path.positions[0] + 8.0f * (path.positions[1] - path.positions[0]);
  path.frame_count = 3;
  return path;
}

}  // namespace

Slides::Slides(const Scene& scene, const Light& light, const View& view)
    : light_(light),
      view_(view),
      of_light_(wide_slide(scene, "light_slide", light, view)),
      of_eye_(wide_slide(scene, "camera_slide", light, view)) {}

Sequence::Sequence(const Trial& trial, MovingWorld& world, const Light& light) : world_(world) {
  world_.go_to(0);
  const Slides slides(world_.scene(), light, world_.scene().views[0]);
  const bool moves = trial.entry().about.update_error == 0;
  for (const Step& step : sequence_steps) {
    Frame frame{moves ? step.pose : 0, slides.light(step.light), {}};
    world_.go_to(frame.pose);
    frame.gbuffer = world_.gbuffer(slides.view(step.view));
    is_supported_ = is_supported_ && trial.support(world_.scene(), frame.light);
    frames_.push_back(std::move(frame));
  }
}

Changes Sequence::go_to(std::size_t k) {
  world_.go_to(frames_[k].pose);
  return world_.take_changes();
}

std::vector<Light> two_lights(const Trial& trial, const std::vector<Light>& lights) {
  std::vector<Light> two;
  for (const Light& light : lights) {
    if (two.size() == (trial.is_short() ? 1u : 2u)) break;
    if (two.empty() || has_area(light) != has_area(two.front())) two.push_back(light);
  }
  return two;
}

}  // namespace gnomon::conformance
