#include "measure/frame/certify_soft.h"

#include <gnomon/kit/parallel.h>
#include <gnomon/kit/random.h>

#include <algorithm>

#include "measure/fields.h"

namespace gnomon {

namespace {

struct SoftSample {
  std::size_t pixel;
  LightShares exact = {};
};

struct Groups {
  std::vector<SoftSample> penumbra, rest;
};

/// The pixels to decide exactly.
Groups choose(const Reference& reference, const SoftCertifyOptions& options, SoftCertificate& result) {
  Groups groups;
  Random random(options.seed);
  for (std::size_t i = 0; i < reference.mask.size(); ++i) {
    const bool is_drawn = random.uniform(0, 1) < options.random_share;
    result.uncertain_count += reference.classes[i] == PixelClass::U;
    if (reference.classes[i] != PixelClass::T) continue;
    ++result.tested_count;
    const bool is_penumbra = reference.mask[i] > 0 && reference.mask[i] < 1;
    result.penumbra_count += is_penumbra;
    if (is_penumbra || is_drawn) (is_penumbra ? groups.penumbra : groups.rest).push_back({i});
  }
  if (groups.penumbra.size() > options.most_penumbra) {
    random.shuffle(groups.penumbra);
    groups.penumbra.resize(options.most_penumbra);
  }
  return groups;
}

StatedErrors compare(const std::string& what, std::span<const SoftSample> samples, LightShare LightShares::*share,
                     std::span<const float> values, std::span<const float> errors, double false_alarm) {
  std::vector<double> differences, stated;
  for (const SoftSample& sample : samples) {
    differences.push_back(values[sample.pixel] - (sample.exact.*share).best);
    stated.push_back(errors[sample.pixel]);
  }
  return stated_errors(what, differences, stated, false_alarm);
}

}  // namespace

SoftCertificate certify_soft(const Scene& scene, const Light& light, const GBuffer& gbuffer, const Reference& reference,
                             const SoftCertifyOptions& options) {
  if (!has_area(light)) throw Error("light {} is a {} light, it has no area", light.name, kind_name(light));
  if (gbuffer.truth == Truth::shape && scene.has_curved_shapes())
    throw Error("scene {} has exact curved shapes, only a G-buffer of mesh truth can be certified", scene.name);
  if (scene.has_transmission())
    throw Error(
        "scene {} has casters that let a part of the light through (transmission), under light {} only opaque casters can be "
        "certified",
        scene.name, light.name);
  if (!features_of(scene).empty())
    throw Error("scene {} has casters with holes (alpha masks), under light {} only casters without can be certified",
                scene.name, light.name);
  SoftCertificate result{.scene = scene.name, .light = light.name, .view = gbuffer.view.name, .reference = options.reference};
  result.target = options.target;
  result.false_alarm = options.false_alarm;
  Groups groups = choose(reference, options, result);
  const AreaScene exact(scene);
  for (std::vector<SoftSample>* samples : {&groups.penumbra, &groups.rest}) {
    constexpr std::size_t block = 32;
    std::vector<AreaTally> tallies((samples->size() + block - 1) / block);
    for_blocks(samples->size(), block, [&](std::size_t begin, std::size_t end) {
      LightPieces pieces;
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i = (*samples)[k].pixel;
        const LightFigure figure(light, gbuffer.position(i), gbuffer.normal(i));
        (*samples)[k].exact = exact.seen(receiver_at(scene, gbuffer, i), figure, pieces, tallies[begin / block]);
      }
    });
    for (const AreaTally& tally : tallies) result.tally += tally;
  }
  const auto add = [&](const char* place, std::span<const SoftSample> samples) {
    result.comparisons.push_back(compare(fmt::format("area {}", place), samples, &LightShares::area, reference.mask,
                                         reference.error, options.false_alarm));
    result.comparisons.push_back(compare(fmt::format("irradiance {}", place), samples, &LightShares::irradiance,
                                         reference.irradiance, reference.irradiance_error, options.false_alarm));
  };
  add("in penumbrae", groups.penumbra);
  add("elsewhere", groups.rest);
  return result;
}

std::string text(const SoftCertificate& c) {
  const char* const why_not = c.tested_count > 0 ? "NOT certified" : "NOT certified: no pixel is of class T";
  std::string out = fmt::format("{} / {} / {}: {}\n", c.scene, c.light, c.view, c.holds() ? "certified" : why_not);
  if (!c.reference.empty()) out += fmt::format("  reference      {}\n", c.reference);
  out += fmt::format("  target         standard error {:g}, at most {} places of the light\n", c.target.error, c.target.cap);
  out += fmt::format("  pixels         {} of T, {} of them in penumbrae; {} of U\n", c.tested_count, c.penumbra_count,
                     c.uncertain_count);
  for (const StatedErrors& s : c.comparisons) out += text(s);
  return out + false_alarm_text(c.false_alarm);
}

void for_each_field(MaybeConst<SoftCertificate> auto& c, const auto& use) {
  const bool holds = c.holds();
  use("cap", c.target.cap, "comparisons", c.comparisons, "false_alarm", c.false_alarm, "holds", holds, "light", c.light,
      "penumbra", c.penumbra_count, "reference", c.reference, "scene", c.scene, "target", c.target.error, "tested",
      c.tested_count, "uncertain", c.uncertain_count, "view", c.view);
}
void to_json(Json& json, const SoftCertificate& c) { json = written(c); }

}  // namespace gnomon
