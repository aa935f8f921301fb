#include "measure/run/worker_frame.h"

#include <gnomon/error.h>

#include "measure/scene/motion.h"

namespace gnomon {

void set_size_and_truth(FrameKey& key, const Json& request) {
  const auto side_of = [&](const char* name) {
    const auto side = request.at(name).get<std::int64_t>();
    if (side < 1 || side > 16384) throw Error("a frame's {} = {} is outside 1 .. 16384 pixels", name, side);
    return static_cast<int>(side);
  };
  key.width = side_of("width");
  key.height = side_of("height");
  key.truth = request.at("truth") == "mesh" ? Truth::mesh : Truth::shape;
}

Scene scene_in(const std::string& file) { return scene_from_bytes(MappedFile::open(file)->bytes()); }

AskedFrame asked_frame(const Json& request, const Scene& scene) {
  AskedFrame asked;
  FrameKey& key = asked.key;
  set_size_and_truth(key, request);
  if (request.contains("stand")) {
    Scene holder = scene_in(request.at("stand"));
    if (holder.lights.empty()) throw Error("a frame has no light");
    asked.lights = holder.lights;
    key.view = holder.views.at(0);
    holder.views.clear();
    asked.lit_by = content_hash(scene_bytes(holder));
    asked.is_free = true;
    return asked;
  }
  key.view = scene.views.at(request.at("view").get<std::size_t>());
  // One light may be asked for by its number alone.
  const Json numbers = request.contains("lights") ? request.at("lights") : Json::array({request.at("light")});
  for (const Json& number : numbers) {
    asked.lights.push_back(scene.lights.at(number.get<std::size_t>()));
    asked.lit_by += asked.lights.back().name + "+";
  }
  if (asked.lights.empty()) throw Error("a frame has no light");
  if (const std::string name = request.value("path", ""); !name.empty()) {
    const Path path = find_path(scene, name, asked.lights.front(), key.view);
    const int frame = request.at("frame");
    if (path.moves == Path::Moves::light && asked.lights.size() > 1) throw Error("a path moves one light");
    asked.lights.front() = light_at(path, asked.lights.front(), frame);
    key.view = view_at(path, key.view, frame);
    if (path.moves == Path::Moves::light) asked.lit_by += fmt::format(" {} {}", name, frame);
  }
  return asked;
}

}  // namespace gnomon
