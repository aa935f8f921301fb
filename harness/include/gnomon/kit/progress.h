#pragma once
#include <atomic>
#include <cstddef>

namespace gnomon {

/// For a stage that takes seconds: how much of it is done, 0 .. 1, for whoever waits for it (the viewer shows it). From any
/// thread, as often as one likes: it stores a number.
void tell_progress(double share);

/// Where it is stored, in steps of 1 / progress_steps; null: nowhere. The harness's affair.
inline constexpr std::size_t progress_steps = 1000;
void watch_progress(std::atomic<std::size_t>* steps);

}  // namespace gnomon
