#include "app/viewer/posed_copies.h"

#include <algorithm>

#include "measure/scene/pose.h"

namespace gnomon::viewer {

namespace {

Scene posed(Scene scene, const RowPose& at) {
  pose(scene, animation_of(scene, at.animation), at.seconds);
  return scene;
}

}  // namespace

PosedCopy::PosedCopy(const Scene& at_rest, const RowPose& at)
    : scene_(posed(at_rest, at)), hash_(pose_hash(scene_)), tracer_(std::make_unique<FrameTracer>(scene_)) {
  // Without curved shapes both truths are one.
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    if (truth == Truth::mesh && !scene_.has_curved_shapes()) continue;
    tracer_->everything(truth);
    for (const Light& light : scene_.lights) tracer_->of(light).casters(truth);
  }
}

std::shared_ptr<const PosedCopy> PosedCopies::of(const std::shared_ptr<const Scene>& at_rest, const RowPose& at) {
  std::erase_if(copies_, [&](const Known& known) { return known.at_rest != at_rest; });
  const auto found = std::ranges::find_if(
      copies_, [&](const Known& known) { return known.animation == at.animation && known.seconds == at.seconds; });
  if (found == copies_.end())
    copies_.push_front({at_rest, at.animation, at.seconds, std::make_shared<const PosedCopy>(*at_rest, at)});
  else
    std::rotate(copies_.begin(), found, found + 1);
  if (copies_.size() > most) copies_.pop_back();
  return copies_.front().copy;
}

bool are_same_time(const std::optional<RowPose>& a, const std::optional<RowPose>& b) {
  return a.has_value() == b.has_value() && (!a || (a->animation == b->animation && a->seconds == b->seconds));
}

RowPose as_still(const RowPose& at) {
  return {.animation = at.animation, .seconds = at.seconds, .start = at.seconds, .frame_rate = at.frame_rate, .frames = 1};
}

}  // namespace gnomon::viewer
