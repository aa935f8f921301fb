#pragma once
#include "analysis/machines.h"
#include "report/table/table.h"

namespace gnomon {

struct MachineTableOptions {
  std::size_t width = 0;         ///< columns of the terminal; 0: no limit
  std::filesystem::path pixels;  ///< file for the lists of differing pixels, JSON lines; empty: none
};

/// Pixels of one row and light that the file lists at most; their number is always there.
inline constexpr std::size_t most_listed_pixels = 10000;

/// Several runs side by side, row by row: what a frame costs by the host's clock and by that of what draws, what part of that
/// the bare pass takes, errors, and against the first run how many pixels of the masks differ, where both left them. Throws
/// Error with fewer than two runs, and when no row is in two of them.
std::string render_machines(std::span<const MachineRun> runs, Format format, const MachineTableOptions& options);

}  // namespace gnomon
