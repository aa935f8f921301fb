#include "measure/worker/shared_count.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>

#include "measure/scene/blob.h"

namespace gnomon {

namespace {

constexpr std::size_t size = sizeof(std::atomic<std::size_t>);

}  // namespace

SharedCount::SharedCount(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return;
  // Memory beyond the end of a file ends the process that touches it.
  const bool is_whole = lseek(descriptor, 0, SEEK_END) >= static_cast<off_t>(size);
  void* const memory = is_whole ? mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0) : MAP_FAILED;
  close(descriptor);
  if (memory != MAP_FAILED) value_ = static_cast<std::atomic<std::size_t>*>(memory);
}

SharedCount::~SharedCount() {
  if (value_ != &own_) munmap(value_, size);
}

void SharedCount::make(const std::filesystem::path& file) { write_file(file, std::array<std::byte, size>{}); }

}  // namespace gnomon
