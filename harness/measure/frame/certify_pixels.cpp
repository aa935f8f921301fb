#include "measure/frame/certify_pixels.h"

#include <gnomon/kit/parallel.h>
#include <gnomon/kit/random.h>

#include <algorithm>

#include "measure/frame/boundary.h"
#include "measure/frame/exact_coverage.h"

namespace gnomon {

namespace {

/// The pixels to decide exactly.
struct ChosenPixels {
  std::vector<std::size_t> near, elsewhere;
};

ChosenPixels choose(const ExactCoverage& exact, const GBuffer& gbuffer, const Reference& reference, const PixelTruth& truth,
                    std::size_t casting, const PixelCertifyOptions& options, PixelCertificate& result) {
  const std::vector<float> distance = distance_transform(
      shadow_boundary(reference.mask, reference.classes, gbuffer.width, gbuffer.height), gbuffer.width, gbuffer.height);
  ChosenPixels chosen;
  Random random(options.seed);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const bool is_drawn = random.uniform(0, 1) < options.random_share;
    if (reference.classes[i] != PixelClass::T || truth.kept[i] < least_kept_rays) continue;
    ++result.tested_count;
    if (truth.kept[i] < pixel_rays || !exact.is_within(i)) continue;
    ++result.filled_count;
    const bool is_near = distance[i] < 1.5f;
    if (is_near || is_drawn) (is_near ? chosen.near : chosen.elsewhere).push_back(i);
  }
  const std::size_t most = std::min(options.most_pixels, options.most_tests / std::max<std::size_t>(casting, 1));
  for (std::vector<std::size_t>* pixels : {&chosen.near, &chosen.elsewhere}) {
    if (pixels->size() <= most) continue;
    random.shuffle(*pixels);
    pixels->resize(most);
  }
  return chosen;
}

/// Throws Error where exact shares cannot be told.
void require_exact(const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  if (has_area(light))
    throw Error("light {} is a {} light, the truth over the pixel is of point, spot and directional lights", light.name,
                kind_name(light));
  if (gbuffer.truth == Truth::shape && scene.has_curved_shapes())
    throw Error("scene {} has exact curved shapes, only a G-buffer of mesh truth can be certified", scene.name);
  if (scene.has_transmission())
    throw Error(
        "scene {} has casters that let a part of the light through (transmission), over the pixel only opaque casters can be "
        "certified",
        scene.name);
  if (scene.has_alpha_masks())
    throw Error("scene {} has casters with holes (alpha masks), over the pixel only casters without can be certified",
                scene.name);
}

}  // namespace

PixelCertificate certify_pixels(const Scene& scene, const Light& light, const GBuffer& gbuffer, const Reference& reference,
                                const PixelTruth& truth, const PixelCertifyOptions& options) {
  require_exact(scene, light, gbuffer);
  PixelCertificate result{.scene = scene.name, .light = light.name, .view = gbuffer.view.name};
  result.false_alarm = options.false_alarm;
  std::size_t casting = 0;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.casts) casting += mesh.triangles.size();
  const ExactCoverage exact(scene, gbuffer, light);
  const ChosenPixels chosen = choose(exact, gbuffer, reference, truth, casting, options, result);
  const auto compare = [&](const char* where, std::span<const std::size_t> pixels) {
    std::vector<double> differences(pixels.size()), errors(pixels.size());
    for_blocks(pixels.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        differences[k] = truth.mean[pixels[k]] - exact.share(pixels[k]);
        errors[k] = truth.error[pixels[k]];
      }
    });
    result.comparisons.push_back(stated_errors(where, differences, errors, options.false_alarm));
  };
  compare("over pixels at shadow boundaries", chosen.near);
  compare("over pixels elsewhere", chosen.elsewhere);
  return result;
}

std::string text(const PixelCertificate& c) {
  const char* const why_not = c.filled_count > 0 ? "NOT certified" : "NOT certified: no triangle fills a pixel of class T";
  std::string out =
      fmt::format("{} / {} / {}, over the pixel: {}\n", c.scene, c.light, c.view, c.holds() ? "certified" : why_not);
  out += fmt::format("  pixels         {} of T keep half of their {} eye rays, one triangle fills {} of them\n", c.tested_count,
                     pixel_rays, c.filled_count);
  for (const StatedErrors& s : c.comparisons) out += text(s);
  return out + false_alarm_text(c.false_alarm);
}

void for_each_field(MaybeConst<PixelCertificate> auto& c, const auto& use) {
  const bool holds = c.holds();
  const std::string_view over = name(TruthOver::pixel);
  use("comparisons", c.comparisons, "false_alarm", c.false_alarm, "filled", c.filled_count, "holds", holds, "light", c.light,
      "scene", c.scene, "tested", c.tested_count, "truth_over", over, "view", c.view);
}
void to_json(Json& json, const PixelCertificate& c) { json = written(c); }

}  // namespace gnomon
