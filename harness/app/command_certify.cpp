// gnomon certify: the reference against exact answers.
#include "app/app.h"
#include "app/time_option.h"
#include "measure/frame/certify.h"
#include "measure/frame/certify_pixels.h"
#include "measure/frame/certify_soft.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/progress.h"
#include "measure/run/suite.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon::app {

namespace {

struct CertifyCommand {
  std::string scene, size = "640x360", truth_over = "center";
  std::vector<std::string> lights, views;
  TimeOption time;
  bool json = false;
};

int run_certify(const CertifyCommand& options) {
  const auto [width, height] = parse_size(options.size, "--size");
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, options.views);
  const std::vector<const Light*> lights = chosen(scene.lights, options.lights);
  std::vector<const View*> views = chosen(scene.views, options.views);
  if (options.views.empty()) views.resize(1);  // the one that suites use
  Progress progress;
  FrameStore frames(scene, cache_root() / "frames",
                    std::make_unique<WorkerFrameMaker>(std::filesystem::path(), "", shown_on(progress, options.scene)));
  for (const Light* light : lights) require_reference(frames.scene(*light), *light, scene.views.front());
  bool all_hold = true;
  Json list = Json::array();
  const auto report = [&](const auto& certificate) {
    all_hold = all_hold && certificate.holds();
    if (options.json)
      list.push_back(certificate);
    else
      fmt::print("{}\n", text(certificate));
  };
  for (const View* view : views)
    for (const Light* light : lights) {
      // The oracle tests triangles: the certificate is of mesh truth.
      const FrameKey key{*view, width, height, Truth::mesh};
      const Reference reference = frames.reference(key, *light);
      const GBuffer gbuffer = frames.gbuffer(key);
      const std::string casters = frames.casters(Truth::mesh, *light).description();
      const auto is_uncertain = [&](std::size_t i) { return reference.classes[i] == PixelClass::U; };
      const Scene& lit = frames.scene(*light);
      if (reference.kind == AnswerKind::fraction) {
        if (options.truth_over != "center")
          print_notice("note: light {} has area, and is certified by its own truth: --truth-over is for lights without\n",
                       light->name);
        report(certify_soft(lit, *light, gbuffer, reference, {.reference = casters}));
        continue;
      }
      if (options.truth_over != "pixel")
        report(certify(lit, *light, gbuffer, reference.mask, {.is_uncertain = is_uncertain, .reference = casters}));
      if (options.truth_over != "center")
        report(certify_pixels(lit, *light, gbuffer, reference, frames.pixel_truth(key, *light)));
    }
  if (options.json) fmt::print("{}\n", json_text(list, 2));
  return all_hold ? 0 : 1;
}

}  // namespace

void add_certify(Program& program) {
  auto [command, options] = program.line.command<CertifyCommand>(
      "certify", "How far the reference may be trusted: exact answers beside it", [](CertifyCommand& read) {
        put_time(read.scene, read.time);
        return run_certify(read);
      });
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  add_time_option(command, options.time);
  command.option("--light", &options.lights, "Light names; all by default", {.delimiter = ','});
  command.option("--view", &options.views, "View names; the first by default", {.delimiter = ','});
  command.option("--size", &options.size, "Picture size in pixels, WxH");
  command.option("--truth-over", &options.truth_over,
                 "Under lights without area, which truth: that at pixel centers, over pixels as wholes, or both",
                 {.check = one_of({std::begin(truth_over_names), std::end(truth_over_names)})});
  command.flag("--json", &options.json, "As JSON");
}

}  // namespace gnomon::app
