#pragma once
#include <array>

#include "measure/record/record.h"

namespace gnomon {

/// A number of a row that is another one in a second record of it.
struct NumberDifference {
  std::string path;  ///< "metrics.shape.error"
  std::string then, now;
  std::string text() const { return fmt::format("{} {} -> {}", path, then, now); }
};

/// What of a row must come out the same, to the last digit: all but times, memory of the process and machine. What came later
/// than the first record is no difference: a cause without pixels, a parameter at its default, a metric. Nor is a metric that
/// this program does not have.
std::vector<NumberDifference> number_differences(const Record& then, const Record& now);
/// What a mask alone decides of these, with causes where `with_causes`.
std::vector<NumberDifference> mask_differences(const Record& then, const Record& now, bool with_causes);

/// Without the numbers in which pixels have a part that are not tested. On another processor a ray that grazes an edge may come
/// out otherwise, and so do those pixels.
std::vector<NumberDifference> of_tested_pixels(std::vector<NumberDifference> differences);

/// "a 1 -> 2, b 3 -> 4 and 5 more".
std::string first_of(std::span<const NumberDifference> differences);

/// How many pixels of two masks are further apart than `threshold`: of the lights of a row, the most. Throws Error where a file
/// lacks a light or has another size than the row.
std::size_t pixels_apart(const Record& record, const std::filesystem::path& a, const std::filesystem::path& b,
                         double threshold);

/// What a second OpenGL may draw otherwise, tests/data/drivers.toml: the pixels of a row whose masks may differ by over 1/256.
class DriverDifferences {
 public:
  static constexpr double threshold = 1.0 / 256;
  /// Reads the file of this program; where it has none, nothing may differ. Throws Error on a file that is none of these.
  static DriverDifferences shipped();
  explicit DriverDifferences(const std::filesystem::path& file);
  std::size_t pixels_of(const Record& record) const;

 private:
  DriverDifferences() = default;
  std::map<std::array<std::string, 4>, std::size_t> pixels_;  ///< by scene, light, technique and settings
};

}  // namespace gnomon
