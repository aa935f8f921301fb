#pragma once
#include "app/viewer/engine_body.h"

namespace gnomon::viewer {

/// One side of the picture: its worker, and which of its work is up to date. Everything belongs to the side's own thread, but
/// for `interrupt` and what the lock guards.
class Engine::Body::Side {
 public:
  Side(Body& body, int index) : body_(body), index_(index) {}

  /// Under the lock: the most urgent thing to do, empty when there is nothing.
  Work next();
  /// Under the lock, before the selection changes: gives up the work, and the worker, that the new selection has no use for.
  void drop_work_before(const Selection& selection);
  /// Under the lock: causes of an older frame are given up.
  void new_frame() { causes_.give_up(); }
  /// Under the lock: whether it has answered, or will not answer, about the frame.
  bool has_finished(std::uint64_t frame) const;
  /// Under the lock.
  bool is_reference() const { return body_.state.sides[index_].is_reference; }
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
    Call(Side& side, const std::string& words);
    ~Call();
    WorkerClient* operator->() { return side_.worker_.get(); }

   private:
    Side& side_;
  };
  bool is_answered(const Frame& frame) const;
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

  Support ask_support(const Frame& frame, const std::string& words);
  std::vector<float> resolve_mask(bool is_timed);
  std::vector<std::vector<std::uint8_t>> right_on_mesh(const Frame& frame,
                                                       std::span<const std::shared_ptr<const ReferenceState>> lights);
  std::vector<std::optional<Explanation>> explain(std::span<const std::uint32_t> pixels, std::size_t light);
  /// Whether the technique supports that light of the frame.
  bool casts_shadows(std::size_t light) const { return light_supports_.empty() || light_supports_[light]; }
  Work guarded(std::function<void()> work);
  void fail(const std::string& why);
  void show_nothing(Phase phase, const std::string& why);
  SideState& state() { return body_.state.sides[index_]; }

  Body& body_;
  const int index_;
  std::unique_ptr<WorkerClient> worker_;   ///< put here and taken away under the lock; ended without it, which takes a while
  std::optional<LoadedTechnique> loaded_;  ///< what the worker was started for; stays when it failed
  std::string settings_;
  bool has_failed_ = false;
  bool is_given_up_ = false;  ///< something else was selected since the worker was started, perhaps only for a moment
  int fresh_ = 0;             ///< stages up to date
  std::uint64_t frame_ = 0;   ///< number of the frame that the worker was asked about last
  bool is_supported_ = false;
  Support support_ = Support::full();
  std::vector<Support> light_supports_;  ///< of several lights, each
  std::array<std::optional<double>, 4> stage_ms_;
  std::uint64_t repeat_ = 0;
  std::optional<Clock::time_point> since_;  ///< when the present call of the worker began
  Interruptible causes_;
  friend class Engine;
};

}  // namespace gnomon::viewer
