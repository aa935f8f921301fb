#pragma once
#include <tbb/task_arena.h>

#include <algorithm>
#include <deque>

#include "app/viewer/board.h"

namespace gnomon::viewer {

/// Computes the reference at each frame, coarse first, and what scoring needs of it.
class ReferenceLane : public Lane {
 public:
  explicit ReferenceLane(Board& board) : Lane(board, 5) {}
  /// Gives up the work at an older frame.
  void give_up() { refinement_.give_up(); }

 private:
  Work next() override;
  std::shared_ptr<const ReferenceState> publish(ReferenceState reference);
  void publish_none(const std::shared_ptr<const Frame>& frame, const std::string& why_not);
  std::shared_ptr<const ReferenceState> known_reference(const Frame& frame, const Light& light);
  void remember(const Frame& frame, const Light& light, std::shared_ptr<const ReferenceState> reference);
  std::vector<float> trace_light(const Frame& frame, const GBuffer& pixels, int step, const Light& light);
  void trace_reference(const std::shared_ptr<const Frame>& frame, bool is_moving, std::uint64_t ticket);
  void find_nearest(const Frame& frame, const Light& light, std::shared_ptr<Frame>& mesh_frame, ReferenceState& reference);
  void complete_reference(ReferenceState reference, std::uint64_t ticket);

  struct KnownReference {
    std::shared_ptr<const LoadedScene> loaded;
    std::string pose;  ///< hash; empty: at rest
    std::vector<std::byte> light_and_view;
    Truth truth;
    std::shared_ptr<const ReferenceState> reference;  ///< under one light, without its frame
  };
  std::deque<KnownReference> known_references_;  ///< the newest first
  struct TracedMask {
    Light light;
    std::vector<float> mask;
  };
  std::shared_ptr<const void> traced_pixels_;  ///< of the G-buffer that the next ones are of
  /// Under several lights, each: what stays where it is need not be traced again. By name, and every how many-th pixel.
  std::map<std::pair<std::string, int>, TracedMask> traced_masks_;
  std::uint64_t refined_ = 0;  ///< the last frame that there is nothing left to do for
  double rays_per_ms_ = 0;
  Interruptible refinement_;
  tbb::task_arena half_the_cores_{std::max(1, tbb::this_task_arena::max_concurrency() / 2)};
};

}  // namespace gnomon::viewer
