#include "measure/score/score.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "measure/cause/own_causes.h"

namespace gnomon {

std::map<std::string, double> cause_errors(const Evidence& evidence) {
  if (!evidence.channels.empty()) {
    std::map<std::string, double> mean;
    for (const Evidence& channel : evidence.channels)
      for (const auto& [cause, error] : cause_errors(channel))
        mean[cause] += error / static_cast<double>(evidence.channels.size());
    return mean;
  }
  const std::vector<CauseInfo> infos = with_common(evidence.own_causes);
  std::vector<double> sums(infos.size() + 1, 0.0);
  std::size_t tested = 0;
  for (std::size_t i = 0; i < evidence.mask.size(); ++i) {
    if (evidence.classes[i] != PixelClass::T) continue;
    ++tested;
    sums[static_cast<std::size_t>(evidence.causes[i])] +=
        std::abs(static_cast<double>(evidence.mask[i]) - evidence.reference[i]);
  }
  std::map<std::string, double> errors;
  for (const CauseInfo& info : infos)
    errors[std::string(info.name)] = tested > 0 ? sums[static_cast<std::size_t>(info.cause)] / static_cast<double>(tested) : 0;
  return errors;
}

std::string causes_obstacle(const Record& record) {
  const std::string then = context_text(record, "frames"), now = fmt::format("{}", frame_version());
  if (then == now) return {};
  if (then.empty()) return "the record does not say on which references they were found";
  return fmt::format("they were found on references of version {}, today's are of version {}", then, now);
}

namespace {

/// Over the channels, where there are several: nothing where one has none.
std::optional<double> mean_value(const MetricInfo& info, const Scoring& scoring) {
  if (scoring.channels().empty() || info.name == hue_error_name) return info.value(scoring);
  double sum = 0;
  for (const Scoring& channel : scoring.channels()) {
    const std::optional<double> value = info.value(channel);
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(scoring.channels().size());
}

}  // namespace

Metrics measure_metrics(const Scoring& scoring) {
  Metrics metrics;
  for (const MetricInfo& info : metric_infos())
    if (info.value) metrics[std::string(info.name)] = mean_value(info, scoring);
  return metrics;
}

std::optional<double> measure_metric(const Scoring& scoring, std::string_view name) {
  const auto info = std::ranges::find(metric_infos(), name, &MetricInfo::name);
  assert(info != metric_infos().end() && info->value);
  return mean_value(*info, scoring);
}

std::map<std::string, std::uint64_t> class_counts(std::span<const PixelClass> classes) {
  std::map<std::string, std::uint64_t> result;
  const auto counts = count_classes(classes);
  for (std::size_t c = 0; c < counts.size(); ++c) result[std::string(class_infos()[c].letter)] = counts[c];
  return result;
}

std::vector<float> read_mask_file(const std::filesystem::path& path, std::size_t pixels, std::size_t lights) {
  const std::size_t size = pixels * lights;
  const auto file = MappedFile::copy(path);
  if (file->bytes().size() != size * sizeof(float))
    throw Error("mask {} has {} bytes; {} are required", path.string(), file->bytes().size(), size * sizeof(float));
  std::vector<float> mask(size);
  std::memcpy(mask.data(), file->bytes().data(), file->bytes().size());
  for (std::size_t i = 0; i < size; ++i)
    if (!(mask[i] >= 0 && mask[i] <= 1))
      throw Error("mask value {} at pixel {}{} is outside 0 .. 1", mask[i], i % pixels,
                  lights > 1 ? fmt::format(" under light {} of {}", i / pixels + 1, lights) : "");
  return mask;
}

}  // namespace gnomon
