#include "measure/run/scene_run.h"

#include <gnomon/error.h>

#include "measure/scene/motion.h"

namespace gnomon {

namespace {

template <class Item>
std::size_t index_of(const std::vector<Item>& items, const std::string& name) {
  const Item* found = find_named(items, name);
  if (!found) throw Error("there is no {}", name);
  return static_cast<std::size_t>(found - items.data());
}

}  // namespace

RowFrame SceneRun::first_frame(const Job& job) const {
  RowFrame frame{.light = index_of(scene.lights, job.light),
                 .view = index_of(scene.views, job.view),
                 .width = job.width,
                 .height = job.height,
                 .path = {}};
  if (!job.path.empty()) frame.path = find_path(scene, job.path, scene.lights[frame.light], scene.views[frame.view]);
  return frame;
}

Light SceneRun::light(const RowFrame& frame) const {
  const Light& still = scene.lights[frame.light];
  return frame.path ? light_at(*frame.path, still, frame.number) : still;
}

FrameKey SceneRun::key(const RowFrame& frame, Truth truth) const {
  const View& still = scene.views[frame.view];
  return {frame.path ? view_at(*frame.path, still, frame.number) : still, frame.width, frame.height,
          scene.has_curved_shapes() ? truth : Truth::shape};
}

FrameRequest SceneRun::request(const RowFrame& frame, Truth truth) {
  const FrameKey of = key(frame, truth);
  return {
      .gbuffer_file = frames.gbuffer_file(of),
      .width = of.width,
      .height = of.height,
      .truth = of.truth,
      .seen = SceneLightAndView{
          .light = frame.light, .view = frame.view, .path = frame.path ? frame.path->name : "", .path_frame = frame.number}};
}

}  // namespace gnomon
