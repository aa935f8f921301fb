#pragma once
#include <atomic>
#include <cstddef>
#include <string>

namespace gnomon {

/// A number in the memory of two processes: one counts up, the other one reads. It is stored in a file without a name that
/// nobody can shorten. Where it cannot be shared, each process has a number of its own, and the reader's does not change.
class SharedCount {
 public:
  /// A new one, 0.
  SharedCount();
  /// That of another process: the path is its `place()`.
  explicit SharedCount(const std::string& place);
  ~SharedCount();

  /// The path by which other processes of this user open it while this one lives; empty where it cannot be shared.
  std::string place() const;

  std::atomic<std::size_t>& value() { return *value_; }
  const std::atomic<std::size_t>& value() const { return *value_; }

 private:
  static_assert(std::atomic<std::size_t>::is_always_lock_free);  // no lock of one process would hold in another
  void map();

  int descriptor_ = -1;
  std::atomic<std::size_t> own_ = 0;  ///< also makes the object uncopyable
  std::atomic<std::size_t>* value_ = &own_;
};

}  // namespace gnomon
