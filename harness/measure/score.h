#pragma once
#include "measure/frame.h"
#include "measure/metrics.h"
#include "measure/record.h"

namespace gnomon {

/// What one technique answered for one frame and light, and what counts.
struct Answer {
  GBuffer gbuffer;
  Reference reference;
  std::vector<float> mask;
  std::vector<std::uint8_t> uncovered;  ///< empty, or 1 where the technique does not cover the pixel

  Evidence evidence() const { return {gbuffer.width, gbuffer.height, reference.classes, reference.mask, mask, uncovered}; }
};

/// All metrics of a tally.
Metrics measure_metrics(const Tally& tally);

/// "B": n, ...
std::map<std::string, std::uint64_t> class_counts(std::span<const PixelClass> classes);

/// Raw floats that a worker wrote; throws Error when the size is wrong or a value is not in 0 .. 1.
std::vector<float> read_mask_file(const std::filesystem::path& file, std::size_t size);

}  // namespace gnomon
