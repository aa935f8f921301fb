#include "measure/worker/shared_count.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace gnomon {

namespace {

constexpr std::size_t size = sizeof(std::atomic<std::size_t>);

}  // namespace

SharedCount::SharedCount() : descriptor_(memfd_create("gnomon-count", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  if (descriptor_ < 0) return;
  const bool is_sealed =
      ftruncate(descriptor_, size) == 0 && fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0;
  if (is_sealed) map();
}

SharedCount::SharedCount(const std::string& place) {
  const int descriptor = place.empty() ? -1 : open(place.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return;
  descriptor_ = descriptor;
  // Memory beyond the end of a file ends the process that touches it.
  if (lseek(descriptor, 0, SEEK_END) >= static_cast<off_t>(size)) map();
}

SharedCount::~SharedCount() {
  if (value_ != &own_) munmap(value_, size);
  if (descriptor_ >= 0) close(descriptor_);
}

void SharedCount::map() {
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
  if (memory != MAP_FAILED) value_ = static_cast<std::atomic<std::size_t>*>(memory);
}

std::string SharedCount::place() const { return value_ == &own_ ? "" : fmt::format("/proc/{}/fd/{}", getpid(), descriptor_); }

}  // namespace gnomon
