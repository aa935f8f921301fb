#include "measure/worker/shared_count.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace gnomon {

constexpr std::size_t count_bytes = sizeof(std::atomic<std::size_t>);

SharedCount::SharedCount() : descriptor_(memfd_create("gnomon-count", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  if (descriptor_ < 0 || ftruncate(descriptor_, count_bytes) != 0) return;
  if (fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0) map();
}

SharedCount::SharedCount(const std::string& place)
    : descriptor_(place.empty() ? -1 : open(place.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
  // Memory beyond the end of a file ends the process that touches it.
  if (descriptor_ >= 0 && lseek(descriptor_, 0, SEEK_END) >= static_cast<off_t>(count_bytes)) map();
}

SharedCount::~SharedCount() {
  if (value_ != &own_) munmap(value_, count_bytes);
  if (descriptor_ >= 0) close(descriptor_);
}

void SharedCount::map() {
  void* const memory = mmap(nullptr, count_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
  if (memory != MAP_FAILED) value_ = static_cast<std::atomic<std::size_t>*>(memory);
}

std::string SharedCount::place() const { return value_ == &own_ ? "" : fmt::format("/proc/{}/fd/{}", getpid(), descriptor_); }

}  // namespace gnomon
