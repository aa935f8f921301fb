#include "measure/worker/requested_frame.h"

#include <gnomon/kit/bases/light_objects.h>

#include "measure/scene/channels.h"
#include "measure/scene/motion.h"
#include "measure/scene/names.h"
#include "measure/worker/shared_count.h"

namespace gnomon {

void check_size(int width, int height) {
  for (const auto& [name, side] : {std::pair("width", width), std::pair("height", height)})
    if (side < 1 || side > 16384) throw Error("a frame's {} = {} is outside 1 .. 16384 pixels", name, side);
}

Scene scene_in(const std::string& file) { return scene_from_bytes(MappedFile::open(file)->bytes()); }

void require_hash(PosedScene& posed, const std::optional<WantedPose>& wanted, const std::string& scene) {
  if (!wanted || posed.hash() == wanted->hash) return;
  throw Error(
      "scene {} at {} s of animation {} is posed differently by two programs: its positions have the hash {} here, and {} in "
      "the program that requests it",
      scene, wanted->at.seconds, wanted->at.animation, posed.hash(), wanted->hash);
}

RequestedFrame requested_frame(const GoRequest& request, const Scene& scene) {
  check_size(request.width, request.height);
  RequestedFrame requested{.key = {.view = {}, .width = request.width, .height = request.height, .truth = request.truth},
                           .lights = {},
                           .lit_by = {}};
  if (request.light_and_view) {
    Scene holder = scene_in(*request.light_and_view);
    requested.lights = holder.lights;
    requested.key.view = holder.views.at(0);
    holder.views.clear();
    requested.lit_by = content_hash(scene_bytes(holder));
    requested.is_free = true;
  } else {
    requested.key.view = scene.views.at(request.view);
    for (const std::size_t number : request.lights) {
      requested.lights.push_back(scene.lights.at(number));
      requested.lit_by += requested.lights.back().name + "+";
    }
  }
  if (requested.lights.empty()) throw Error("a frame has no light");
  if (request.path.empty() || request.light_and_view) return requested;
  const Path path = find_path(scene, request.path, requested.lights.front(), requested.key.view);
  if (path.moves == Path::Moves::light && whole_count(names_of(requested.lights)) > 1) throw Error("a path moves one light");
  for (Light& light : requested.lights) light = light_at(path, light, request.frame);
  requested.key.view = view_at(path, requested.key.view, request.frame);
  if (path.moves == Path::Moves::light) requested.lit_by += fmt::format(" {} {}", request.path, request.frame);
  return requested;
}

Done RequestedTraces::make(const TraceRequest& request) {
  if (!tracer_) {
    scene_ = scene_in(request.scene);
    posed_.emplace(scene_);
    tracer_.emplace(scene_);
  }
  posed_->go_to(row_pose(request.pose));
  require_hash(*posed_, request.pose, scene_.name);
  const Scene holder = scene_in(request.light_and_view);
  check_size(request.width, request.height);
  if (!(request.error >= 1e-6)) throw Error("a reference's error = {} is below 1e-6", request.error);
  SharedCount done(request.done);
  MissingFrame missing{.scene_file = {},
                       .key = {.view = holder.views.at(0),
                               .width = request.width,
                               .height = request.height,
                               .truth = request.truth,
                               .pose = request.pose},
                       .light = {},
                       .gbuffer_file = request.gbuffer,
                       .target = {.error = request.error, .cap = request.cap},
                       .subpixel_bits = request.subpixel_bits,
                       .global_samples = request.global_samples,
                       .pixel_rays = request.pixel_rays,
                       .done = &done.value()};
  if (!holder.lights.empty()) missing.light = holder.lights[0];
  write_file(request.out, tracer_->make(missing));
  return {};
}

Support support_of_row(const std::vector<Light>& lights, const std::vector<Support>& supports) {
  std::vector<Light> whole;
  std::vector<Support> of_whole;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const std::string name(whole_name(lights[k].name));
    const bool is_another = whole.empty() || whole_name(whole.back().name) != name ||
                            of_whole.back().kind() != supports[k].kind() || of_whole.back().why() != supports[k].why();
    if (is_another) {
      whole.push_back(lights[k]);
      of_whole.push_back(supports[k]);
    } else {
      whole.back().name = name;
    }
  }
  return support_together(whole, of_whole);
}

}  // namespace gnomon
