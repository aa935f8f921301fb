// Derived facts of a record: how it is lit, what it is called, shares of its numbers.

#include <algorithm>

#include "measure/record/record.h"
#include "measure/record/title.h"
#include "measure/scene/channels.h"

namespace gnomon {

std::optional<double> class_share(const Record& record, std::string_view letter) {
  double facing = 0, of_class = 0;
  for (const auto& [of, pixels] : record.classes) {
    if (of != "B" && of != "F") facing += static_cast<double>(pixels);
    if (of == letter) of_class = static_cast<double>(pixels);
  }
  return facing > 0 ? std::optional(of_class / facing) : std::nullopt;
}

std::size_t light_count(const Record& r) { return whole_count(light_names(r)); }

std::vector<std::string> light_names(const Record& r) {
  std::vector<std::string> names;
  for (const Record::LightFacts& light : r.lights) names.push_back(light.name);
  return names;
}

AnswerKind row_answer(const Record& r) {
  const Record::LightFacts& first = r.lights.front();
  const bool is_one = &first == &r.lights.back() || (channel_of(first.name) && whole_count(light_names(r)) == 1);
  return is_one ? first.answer : AnswerKind::received;
}

std::string setting_key(const Record& r) { return r.technique + (r.settings.empty() ? "" : ":" + r.settings); }

std::optional<std::map<std::string, double>> cause_shares(const Record& r) {
  if (r.cause_errors) return r.cause_errors;
  const auto tested = r.classes.find("T");
  if (!r.causes || tested == r.classes.end() || tested->second == 0) return std::nullopt;
  // On a path both are sums over its frames; of a light in its channels causes are sums over these.
  const std::size_t channels = r.answer == AnswerKind::received ? 1 : std::max<std::size_t>(std::size(r.lights), 1);
  std::map<std::string, double> shares;
  for (const auto& [cause, pixels] : *r.causes)
    shares[cause] = static_cast<double>(pixels) / static_cast<double>(channels * tested->second);
  return shares;
}

static std::optional<double> sum_of_medians(const ProcessTimes& relight, const ProcessTimes& resolve) {
  const auto first = median_of_medians(relight), last = median_of_medians(resolve);
  return first && last ? std::optional(*first + *last) : std::nullopt;
}

std::optional<double> frame_ms(const Record& r) { return sum_of_medians(r.times(Stage::relight), r.times(Stage::resolve)); }

std::optional<double> frame_device_ms(const Record& r) {
  return sum_of_medians(r.device_times(Stage::relight), r.device_times(Stage::resolve));
}

std::optional<double> floor_share(const Record& r) {
  if (!r.floor) return std::nullopt;
  const auto share = [](const ProcessTimes& pass, const std::optional<double>& frame) -> std::optional<double> {
    const auto least = median_of_medians(pass);
    return least && frame && *frame > 0 ? std::optional(*least / *frame) : std::nullopt;
  };
  const auto by_device = share(r.floor->device_ms, frame_device_ms(r));
  return by_device ? by_device : share(r.floor->ms, frame_ms(r));
}

std::optional<double> rays_per_second(const Record& r) {
  const auto rays = std::ranges::find(r.counts, "rays", &Count::name);
  if (rays == r.counts.end()) return std::nullopt;
  const auto by_device = frame_device_ms(r), ms = by_device ? by_device : frame_ms(r);
  return ms && *ms > 0 ? std::optional(1000 * rays->value / *ms) : std::nullopt;
}

std::optional<bool> clocks_agree(const Record& r) {
  constexpr double call_ms = 0.02, slack = 1.05;
  std::optional<bool> agree;
  const auto look = [&](const ProcessTimes& device, const ProcessTimes& host, double least_share) {
    const auto inner = median_of_medians(device), outer = median_of_medians(host);
    if (!inner || !outer) return;
    agree = agree.value_or(true) && *inner <= *outer * slack + call_ms && *inner >= *outer * least_share - call_ms;
  };
  for (std::size_t stage = 0; stage < std::size(stage_names); ++stage) look(r.device_stages[stage], r.stages[stage], 0);
  if (r.floor) look(r.floor->device_ms, r.floor->ms, 0.5);
  return agree;
}

std::string setting_name(const Record& r) { return r.label ? *r.label : setting_key(r); }

std::string title_of_place(std::string_view scene, std::string_view light, std::string_view view, std::string_view path) {
  std::string title = fmt::format("{} {} ", scene, light);
  if (!view.empty() && view != "view" && view != "-") title += fmt::format("{} ", view);
  if (!path.empty()) title += fmt::format("{} ", path);
  return title;
}

std::string title(const Record& r) { return title_of_place(r.scene, r.light, r.view, r.path) + setting_key(r); }

std::string plugin_hash(const Record& r) {
  const auto found = r.context.find("plugin");
  return found == r.context.end() || !found->is_object() ? "" : plain_text(found->value("hash", Json("")));
}

bool is_foreign(const Record& r) { return r.context.contains("foreign"); }

}  // namespace gnomon
