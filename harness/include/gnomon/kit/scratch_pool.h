#pragma once
#include <memory>
#include <mutex>
#include <vector>

namespace gnomon {

/// Scratch memory that tasks on many threads borrow and give back, so that it is allocated once a thread at most and kept for
/// the next stage. It is no part of the count "bytes": which thread meets which task is open, and so is what each one grows to.
template <class Scratch>
class ScratchPool {
 public:
  /// Lends one for as long as the result lives.
  auto borrow() {
    auto give_back = [this](Scratch* scratch) {
      const std::lock_guard lock(mutex_);
      idle_.emplace_back(scratch);
    };
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) idle_.push_back(std::make_unique<Scratch>());
    std::unique_ptr<Scratch, decltype(give_back)> lent(idle_.back().release(), give_back);
    idle_.pop_back();
    return lent;
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> idle_;
};

}  // namespace gnomon
