#include <embree3/rtcore_config.h>

#include "app/app.h"
#include "measure/frame/certify.h"
#include "measure/frame/frame.h"
#include "measure/paths.h"
#include "measure/run/jobs.h"
#include "measure/run/progress.h"
#include "measure/scene/load.h"

namespace gnomon::app {

namespace {

struct Options {
  std::string scene, size = "640x360";
  std::vector<std::string> lights, views;
  bool json = false;
};

int run_certify(const Options& options) {
  const auto [width, height] = parse_size(options.size, "--size");
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, options.views);
  FrameStore frames(scene, cache_root() / "frames");
  bool all_hold = true;
  nlohmann::json list = nlohmann::json::array();
  const auto wanted = [](const std::vector<std::string>& names, const std::string& name) {
    return names.empty() || std::ranges::find(names, name) != names.end();
  };
  for (const Light& light : scene.lights)
    if (wanted(options.lights, light.name)) require_reference(scene, light, scene.views.front());
  for (const View& view : scene.views) {
    // Without --view, the first: the one that suites use.
    if (options.views.empty() ? &view != &scene.views.front() : !wanted(options.views, view.name)) continue;
    for (const Light& light : scene.lights) {
      if (!wanted(options.lights, light.name)) continue;
      // The oracle knows triangles: the certificate is of mesh truth.
      const FrameKey key{view, width, height, Truth::mesh};
      const Reference reference = frames.reference(key, light);
      CertifyOptions certify_options;
      certify_options.is_uncertain = [&](std::size_t i) { return reference.classes[i] == PixelClass::U; };
      certify_options.reference = frames.casters(Truth::mesh).description();
      const Certificate certificate = certify(scene, light, frames.gbuffer(key), reference.mask, certify_options);
      all_hold = all_hold && certificate.holds();
      if (options.json)
        list.push_back(certificate);
      else
        fmt::print("{}\n", text(certificate));
    }
  }
  if (options.json) fmt::print("{}\n", json_text(list, 2));
  return all_hold ? 0 : 1;
}

}  // namespace

void add_certify(Program& program) {
  auto [command, options] =
      program.line.command<Options>("certify", "How far the reference may be trusted: exact answers beside it", run_certify);
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file").required();
  command.option("--light", &options.lights, "Light names; all by default").delimiter(',');
  command.option("--view", &options.views, "View names; the first by default").delimiter(',');
  command.option("--size", &options.size, "Picture size in pixels, WxH").shows_default();
  command.flag("--json", &options.json, "As JSON");
}

}  // namespace gnomon::app
