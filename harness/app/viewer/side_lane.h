#pragma once
#include "app/viewer/board.h"

namespace gnomon::viewer {

/// One side of the picture: its worker, and which of its work is up to date.
class SideLane : public Lane {
 public:
  SideLane(Board& board, int index) : Lane(board), index_(index) {}

  /// Before the selection changes: gives up the work, and the worker, that the new selection has no use for.
  void drop_work_before(const Selection& selection);
  /// Gives up the causes of an older frame.
  void give_up_causes() { causes_.give_up(); }
  /// Whether it has answered, or will not answer, about the frame.
  bool has_finished(std::uint64_t frame) const;
  bool is_reference() const { return state().is_reference; }
  /// Fills in how long the present call of the worker has taken, and how much of it is done.
  void report_progress(SideState& report) const;
  void interrupt();

 private:
  /// What a worker is started for; it serves all settings.
  struct LoadedTechnique {
    std::shared_ptr<const LoadedScene> scene;
    std::string technique;
    int attempt = 0;
    friend bool operator==(const LoadedTechnique&, const LoadedTechnique&) = default;
  };
  /// A call of the worker: while it lives, the state says what for, without waking anybody.
  class Call {
   public:
    Call(SideLane& side, const std::string& words) : side_(side) {
      const std::lock_guard lock(side_.board_.mutex);
      side_.state().words = words;
      side_.since_ = Clock::now();
    }
    ~Call() {
      const std::lock_guard lock(side_.board_.mutex);
      side_.since_.reset();
      side_.fresh_ = side_.worker_->fresh_count();
    }
    WorkerClient* operator->() { return side_.worker_.get(); }

   private:
    SideLane& side_;
  };
  Work next() override;
  LoadedTechnique selected_technique(const Selection& selection) const;
  Work next_answer(const SideSelection& selection, const std::shared_ptr<const Frame>& frame);
  Work next_finding(const SideSelection& selection, const std::shared_ptr<const Frame>& frame);
  Work show_reference(const std::shared_ptr<const Frame>& frame);
  void start(const LoadedTechnique& selected, const std::string& settings);
  void set(const std::string& settings);
  void go_to(const std::shared_ptr<const Frame>& frame);
  void answer(const std::shared_ptr<const Frame>& frame, std::uint64_t repeat);
  void count(const std::shared_ptr<const SideAnswer>& answer);
  void draw_layer(const std::shared_ptr<const SideAnswer>& answer, const std::string& name);
  void explain_picked(const std::shared_ptr<const SideAnswer>& answer, std::optional<std::uint32_t> pixel);
  void count_wrong(const std::shared_ptr<const SideAnswer>& answer, const std::shared_ptr<const ReferenceState>& reference);
  void find_causes_of(const std::shared_ptr<const Verdict>& verdict, const std::shared_ptr<const ReferenceState>& truth);

  Support set_frame(const Frame& frame, const std::string& words);
  void note_time(Stage stage, double ms);
  std::vector<float> resolve_mask(bool is_timed);
  std::vector<std::vector<std::uint8_t>> right_on_mesh(const Frame& frame,
                                                       std::span<const std::shared_ptr<const ReferenceState>> lights);
  Work guarded(Work work);
  void fail(const std::string& why);
  void show_nothing(Phase phase, const std::string& why);
  SideState& state() { return board_.state.sides[index_]; }
  const SideState& state() const { return board_.state.sides[index_]; }
  /// Changes the state of the side as Board::change does.
  template <class Change>
  void change(const Change& change) {
    board_.change([&](EngineState&) { change(state()); });
  }

  const int index_;
  std::unique_ptr<WorkerClient> worker_;   ///< set and taken under the lock; destroyed without it, which takes a while
  std::optional<LoadedTechnique> loaded_;  ///< what the worker was started for; stays when it failed
  std::string settings_;
  bool has_failed_ = false;
  bool is_given_up_ = false;  ///< something else was selected since the worker was started, perhaps only for a moment
  int fresh_ = 0;             ///< stages up to date
  std::uint64_t frame_ = 0;   ///< number of the frame that the worker was set to last
  bool is_supported_ = false;
  Support support_ = Support::full();
  std::vector<Support> light_supports_;  ///< of several lights, each
  bool tells_parts_ = false;             ///< the technique has told the parts of an error since the worker was started
  StageTimes stage_ms_;
  std::uint64_t repeat_ = 0;
  std::optional<Clock::time_point> since_;  ///< when the present call of the worker began
  Interruptible causes_;
};

}  // namespace gnomon::viewer
