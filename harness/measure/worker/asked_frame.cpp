#include "measure/worker/asked_frame.h"

#include <gnomon/error.h>

#include "measure/scene/motion.h"

namespace gnomon {

void check_size(int width, int height) {
  for (const auto& [name, side] : {std::pair("width", width), std::pair("height", height)})
    if (side < 1 || side > 16384) throw Error("a frame's {} = {} is outside 1 .. 16384 pixels", name, side);
}

Scene scene_in(const std::string& file) { return scene_from_bytes(MappedFile::open(file)->bytes()); }

AskedFrame asked_frame(const GoRequest& request, const Scene& scene) {
  check_size(request.width, request.height);
  AskedFrame asked{.key = {.view = {}, .width = request.width, .height = request.height, .truth = request.truth},
                   .lights = {},
                   .lit_by = {}};
  if (request.stand) {
    Scene holder = scene_in(*request.stand);
    asked.lights = holder.lights;
    asked.key.view = holder.views.at(0);
    holder.views.clear();
    asked.lit_by = content_hash(scene_bytes(holder));
    asked.is_free = true;
  } else {
    asked.key.view = scene.views.at(request.view);
    for (const std::size_t number : request.lights) {
      asked.lights.push_back(scene.lights.at(number));
      asked.lit_by += asked.lights.back().name + "+";
    }
  }
  if (asked.lights.empty()) throw Error("a frame has no light");
  if (request.path.empty() || request.stand) return asked;
  const Path path = find_path(scene, request.path, asked.lights.front(), asked.key.view);
  if (path.moves == Path::Moves::light && asked.lights.size() > 1) throw Error("a path moves one light");
  asked.lights.front() = light_at(path, asked.lights.front(), request.frame);
  asked.key.view = view_at(path, asked.key.view, request.frame);
  if (path.moves == Path::Moves::light) asked.lit_by += fmt::format(" {} {}", request.path, request.frame);
  return asked;
}

}  // namespace gnomon
