#pragma once
#include <atomic>
#include <cstddef>
#include <filesystem>

namespace gnomon {

/// A number in a file that two processes have in their memory: one counts up, the other one looks. Where the file cannot be
/// shared each has a number of its own, and who looks sees it stand still.
class SharedCount {
 public:
  /// Of a file that `make` wrote.
  explicit SharedCount(const std::filesystem::path& file);
  ~SharedCount();
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;

  /// Writes a file whose number is 0.
  static void make(const std::filesystem::path& file);

  std::atomic<std::size_t>& value() { return *value_; }
  const std::atomic<std::size_t>& value() const { return *value_; }

 private:
  static_assert(std::atomic<std::size_t>::is_always_lock_free);  // no lock of one process would hold in another

  std::atomic<std::size_t> own_ = 0;
  std::atomic<std::size_t>* value_ = &own_;
};

}  // namespace gnomon
