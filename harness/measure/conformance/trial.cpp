#include "measure/conformance/trial.h"

#include <gnomon/kit/gl/gl.h>

#include <algorithm>
#include <bit>

namespace gnomon::conformance {

Support Trial::support(const Scene& scene, const Light& light, const std::string& settings) const {
  return support_of(entry_.about, *made(settings), scene, light, scene.views[0]);
}

std::vector<Light> Trial::supported_lights(const Scene& scene, const std::string& settings) const {
  std::vector<Light> lights = lights_of_all_kinds(scene);
  std::erase_if(lights, [&](const Light& light) { return !support(scene, light, settings); });
  return lights;
}

void Trial::under_each_light(std::unique_ptr<World> w, const CheckLight& check) {
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    at(light);
    check(*w, gbuffer, light);
  }
}

const std::string& Trial::asked_with(const std::string& settings) const {
  const auto [found, is_new] = asked_with_.try_emplace(settings);
  if (is_new) found->second = rule_.has_small_pictures ? with_small_pictures(entry_, settings) : settings;
  return found->second;
}

std::unique_ptr<Technique> Trial::made(const std::string& settings) const {
  auto technique = entry_.make();
  technique->apply(asked_with(settings));
  return technique;
}

std::unique_ptr<Technique> Trial::set_up(const std::string& settings) const {
  auto technique = made(settings);
  technique->setup();
  return technique;
}

std::vector<float> Trial::resolve(Technique& technique, const GBuffer& gbuffer) const {
  begin(technique);
  return resolve_next(technique, gbuffer);
}

std::vector<float> Trial::resolve_next(Technique& technique, const GBuffer& gbuffer) const {
  VisibilityMask mask(gbuffer.width, gbuffer.height);
  device_->fill(mask, -7);
  technique.resolve(gbuffer, mask);
  const auto pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

std::vector<float> Trial::answer(Technique& technique, const Scene& scene, const Light& light, const GBuffer& gbuffer) const {
  technique.build(scene);
  technique.relight(light);
  return resolve(technique, gbuffer);
}

std::vector<float> Trial::fresh_answer(const Scene& scene, const Light& light, const GBuffer& gbuffer,
                                       const std::string& settings) const {
  return answer(*set_up(settings), scene, light, gbuffer);
}

void Trial::at(std::string scene, std::string settings) {
  place_ = {std::move(scene), "", asked_with(settings)};
  if (moves_) moves_(place_);
}

void Trial::at(const Light& light) {
  place_.light = title(light);
  if (moves_) moves_(place_);
}

void Trial::found(std::string what, std::size_t pixel, const GBuffer& gbuffer) {
  const int x = static_cast<int>(pixel) % gbuffer.width, y = static_cast<int>(pixel) / gbuffer.width;
  add({std::move(what), place_, PlacedPixel{x, y, gbuffer.width, gbuffer.height}});
}

void Trial::add(Finding finding) {
  if (verdict_.findings.size() < most_findings) verdict_.findings.push_back(std::move(finding));
  ++verdict_.finding_count;
}

void Trial::expect_same(const std::vector<float>& a, const std::vector<float>& b, std::string_view when,
                        const GBuffer* gbuffer) {
  if (a.size() != b.size()) return found(fmt::format("{}: {} and {} values", when, a.size(), b.size()));
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]) && count++ == 0) first = i;
  if (count == 0) return;
  std::string what =
      fmt::format("{}: {} of {} values differ, the first is {} and {}", when, count, a.size(), a[first], b[first]);
  return gbuffer ? found(std::move(what), first, *gbuffer) : found(std::move(what));
}

void Trial::expect_mask(const std::vector<float>& mask, const Scene& scene, const GBuffer& gbuffer, const Light& light) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!(mask[i] >= 0 && mask[i] <= 1))
      return found(fmt::format("the mask is {}, outside 0 .. 1{}", mask[i],
                               mask[i] == -7 ? ": that was there before; the pixel was not written" : ""),
                   i, gbuffer);
    if (mask[i] != 1 && !faces_light(scene, gbuffer, light, i))
      return found(fmt::format("the mask is {}, not 1, where the pixel does not face the light", mask[i]), i, gbuffer);
  }
}

Verdict Trial::verdict() const {
  Verdict verdict = verdict_;
  if (verdict.finding_count > 0) verdict.why.clear();
  verdict.kind = verdict.finding_count > 0 ? Verdict::Kind::fails
                 : verdict.why.empty()     ? Verdict::Kind::holds
                                           : Verdict::Kind::does_not_apply;
  return verdict;
}

double counted_bytes(const Counts& counts) {
  const auto found = std::ranges::find(counts, "bytes", &Count::name);
  return found == counts.end() ? 0 : found->value;
}

std::vector<std::string> settings_of(const TechniqueEntry& entry, const std::function<bool(const Parameter&)>& wanted) {
  std::vector<std::string> all = {""};
  const auto names = entry.make();
  for (const Parameter* parameter : names->parameters()) {
    if (wanted && !wanted(*parameter)) continue;
    for (const std::string& value : parameter->probes()) all.push_back(fmt::format("{}={}", parameter->name(), value));
  }
  return all;
}

namespace {

/// Of every kind of light, as it is before anything runs.
std::vector<Support::Kind> supports(const TechniqueEntry& entry, const std::string& settings) {
  static const Scene scene = generated_scene("box_city:count=12");
  std::vector<Support::Kind> kinds;
  for (const Light& light : lights_of_all_kinds(scene)) {
    const auto technique = entry.make();
    technique->apply(settings);
    kinds.push_back(support_of(entry.about, *technique, scene, light, scene.views[0]).kind());
  }
  return kinds;
}

}  // namespace

std::string with_small_pictures(const TechniqueEntry& entry, const std::string& settings, int least) {
  const auto technique = entry.make();
  technique->apply(settings);
  std::vector<std::string> sides;
  for (const Parameter* p : technique->parameters()) {
    const bool is_set = (',' + settings).find(fmt::format(",{}=", p->name())) != std::string::npos;
    if (p->unit() == "texel" && !is_set && std::stod(p->text()) >= 2 * least) sides.emplace_back(p->name());
  }
  if (sides.empty()) return technique->settings();
  const std::vector<Support::Kind> wanted = supports(entry, settings);
  for (const int texels : {128, 256, 512}) {
    if (texels < least) continue;
    for (const std::string& side : sides) technique->apply(fmt::format("{}={}", side, texels));
    if (supports(entry, technique->settings()) == wanted) return technique->settings();
  }
  return settings;
}

}  // namespace gnomon::conformance
