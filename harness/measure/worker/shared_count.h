#pragma once
#include <atomic>
#include <cstddef>
#include <string>

namespace gnomon {

/// A number that two processes have in their memory: one counts up, the other one looks. It lies in a file without a name that
/// nobody can shorten. Where it cannot be shared each process has a number of its own, and who looks sees it stand still.
class SharedCount {
 public:
  /// A new one, 0.
  SharedCount();
  /// That of another process: the path is its `place()`.
  explicit SharedCount(const std::string& place);
  ~SharedCount();
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;

  /// Where other processes of this user find it while this one lives; empty where it cannot be shared.
  std::string place() const;

  std::atomic<std::size_t>& value() { return *value_; }
  const std::atomic<std::size_t>& value() const { return *value_; }

 private:
  static_assert(std::atomic<std::size_t>::is_always_lock_free);  // no lock of one process would hold in another
  void map();

  int descriptor_ = -1;
  std::atomic<std::size_t> own_ = 0;
  std::atomic<std::size_t>* value_ = &own_;
};

}  // namespace gnomon
