#include "measure/score/memory_score.h"

#include <algorithm>
#include <numeric>

namespace gnomon {

GhostTimes ghost_times(std::span<const double> errors, double settled) {
  const auto first_at_most = [&](double bound) {
    const auto found = std::ranges::find_if(errors, [&](double error) { return error <= bound; });
    return found == errors.end() ? std::nullopt : std::optional(static_cast<double>(found - errors.begin()));
  };
  if (errors.empty()) return {};
  // Where the jump adds nothing, half of that is gone at once.
  const double added = std::max(errors.front() - settled, 0.0);
  return {.half_life = first_at_most(settled + added / 2), .frames = first_at_most(1.1 * settled)};
}

void MemoryScore::add_still(int number, std::optional<double> error) {
  if (number == 0) cold_ = error;
  if (number >= still_frames - settled_frames && error) settled_.push_back(*error);
}

void MemoryScore::add_frame(std::optional<double> error, const std::string& shown) {
  if (!errors_.empty() && shown != shown_) changes_.push_back(errors_.size());
  shown_ = shown;
  errors_.push_back(error);
}

std::optional<std::size_t> MemoryScore::jump() const {
  return changes_.size() == 1 && std::ranges::all_of(errors_, &std::optional<double>::has_value)
             ? std::optional(changes_.front())
             : std::nullopt;
}

Metrics MemoryScore::metrics() const {
  Metrics metrics{{"error_cold", cold_}, {"error_settled", {}}, {"ghost_half_life", {}}, {"ghost_frames", {}}};
  if (settled_.size() == settled_frames)
    metrics["error_settled"] = std::accumulate(settled_.begin(), settled_.end(), 0.0) / settled_frames;
  if (const auto at = jump()) {
    std::vector<double> errors;
    for (std::size_t k = *at; k < errors_.size(); ++k) errors.push_back(*errors_[k]);
    const GhostTimes times = ghost_times(errors, metrics["error_settled"].value_or(*errors_[*at - 1]));
    metrics["ghost_half_life"] = times.half_life;
    metrics["ghost_frames"] = times.frames;
  }
  return metrics;
}

}  // namespace gnomon
