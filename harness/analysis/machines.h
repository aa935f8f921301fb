#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "measure/record/record.h"

namespace gnomon {

/// A run to be compared with others.
struct MachineRun {
  std::filesystem::path dir;  ///< of its masks
  std::vector<Record> records;
};

/// The same setting at the same place as each run has it, by run; null where one has no such row.
using MachineRow = std::vector<const Record*>;

/// In the order of the first run that has a row; of a setting that a run has twice at a place, the first one. The runs must
/// outlive the rows.
std::vector<MachineRow> rows_by_machine(std::span<const MachineRun> runs);

/// A pixel whose visibility is not the same in two masks.
struct DifferingPixel {
  int x = 0, y = 0;
  float first = 0, second = 0;
};
/// Under one light of a row.
struct DifferingPixels {
  std::string light;
  std::vector<DifferingPixel> pixels;  ///< row after row, column after column
};

/// Visibilities that differ by no more than this are the same: half a step of eight bits.
inline constexpr float same_visibility = 0.5f / 255;

/// Of two rows that both left their masks, by light, of lights that both have; nothing where a row has no mask or its file is
/// not there. Throws Error on a mask that cannot be read.
std::optional<std::vector<DifferingPixels>> differing_pixels(const Record& first, const std::filesystem::path& first_dir,
                                                             const Record& second, const std::filesystem::path& second_dir);

}  // namespace gnomon
