#include "measure/score/score.h"

#include <gnomon/error.h>

#include <cstring>

namespace gnomon {

Metrics measure_metrics(const Scoring& scoring) {
  Metrics metrics;
  for (const MetricInfo& info : metric_infos()) metrics[std::string(info.name)] = info.value(scoring);
  return metrics;
}

std::map<std::string, std::uint64_t> class_counts(std::span<const PixelClass> classes) {
  std::map<std::string, std::uint64_t> result;
  const auto counts = count_classes(classes);
  for (std::size_t c = 0; c < counts.size(); ++c) result[std::string(class_names[c])] = counts[c];
  return result;
}

std::vector<float> read_mask_file(const std::filesystem::path& path, std::size_t size) {
  const auto file = MappedFile::open(path);
  if (file->bytes().size() != size * sizeof(float))
    throw Error("mask {} has {} bytes; {} are wanted", path.string(), file->bytes().size(), size * sizeof(float));
  std::vector<float> mask(size);
  std::memcpy(mask.data(), file->bytes().data(), file->bytes().size());
  for (std::size_t i = 0; i < size; ++i)
    if (!(mask[i] >= 0 && mask[i] <= 1)) throw Error("mask value {} at pixel {} is outside 0 .. 1", mask[i], i);
  return mask;
}

}  // namespace gnomon
