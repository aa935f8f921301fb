// The child's side of an import: a reader of the file's format reads it, what it holds goes down the pipe. Whatever goes wrong
// here, corrupted memory included, stays here.
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <set>

#include "measure/scene/import.h"

namespace gnomon {
namespace {

using namespace importing;
namespace fs = std::filesystem;

/// A runaway import ends here, before it takes the machine with it. What it may take grows with the files that it opens:
/// processor time, and memory up to three quarters of what there is. A process that waits, and computes nothing, ends after ten
/// times as long.
class Limits {
 public:
  Limits() { set(); }
  void add_file(const fs::path& file, std::uint64_t size) {
    if (!known_.insert(file).second) return;
    bytes_ += size;
    set();
  }
  std::uint64_t megabytes() const { return memory() >> 20; }

 private:
  std::uint64_t memory() const {
    const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
    return std::min(least_import_memory + import_memory_factor * bytes_,
                    pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3);
  }
  void set() const {
    const auto seconds = least_import_seconds + static_cast<unsigned>(import_seconds_per_megabyte * (bytes_ >> 20));
    const rlimit time{used_seconds() + seconds, RLIM_INFINITY};
    setrlimit(RLIMIT_CPU, &time);
    alarm(10 * seconds);
#ifndef __SANITIZE_ADDRESS__  // its shadow memory alone would be over any limit
    const rlimit data{held_ + memory(), RLIM_INFINITY};
    setrlimit(RLIMIT_DATA, &data);
#endif
  }
  /// Of this process, which may be a fork of one that has worked before.
  static rlim_t used_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    return static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1);
  }
  static std::uint64_t held() {
    std::uint64_t pages = 0;
    std::ifstream statm("/proc/self/statm");
    for (int field = 0; field < 6; ++field) statm >> pages;  // the sixth: data and stack
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  }
  const std::uint64_t held_ = held();
  std::uint64_t bytes_ = 0;
  std::set<fs::path> known_;
};

/// Files that an import names are files: a pipe, or a device, may never end.
std::string read_regular_file(const fs::path& file, Limits& limits) {
  std::error_code code;
  if (!fs::is_regular_file(file, code)) throw Error("{}: is not a regular file", file.string());
  const std::uintmax_t size = fs::file_size(file, code);
  std::ifstream in(file, std::ios::binary);
  if (code || !in) throw Error("{}: cannot be read", file.string());
  limits.add_file(file, size);
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return bytes;
}

/// Writes the answer into the pipe; a parent that is gone ends the child by SIGPIPE.
void send(const MeshFile& answer, int fd) {
  FieldWriter writer;
  visit_file(writer, answer);
  for (std::span<const std::byte> rest = writer.bytes; !rest.empty();) {
    const ssize_t count = write(fd, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(3);
    rest = rest.subspan(static_cast<std::size_t>(count));
  }
}

}  // namespace

int import_child_main(const std::string& file, int out_fd) {
  Limits limits;
  const auto refuse = [&](const std::string& why) {
    MeshFile answer;
    answer.failure = why;
    send(answer, out_fd);
  };
  try {
    send(read_mesh_file(file, [&](const fs::path& path) { return read_regular_file(path, limits); }), out_fd);
  } catch (const std::bad_alloc&) {
    refuse(fmt::format("{}: cannot be read: it needs more memory than the {} MiB that a file of its size may take", file,
                       limits.megabytes()));
  } catch (const std::length_error&) {
    refuse(fmt::format("{}: cannot be read: it needs more memory than there is", file));
  } catch (const Error& error) {
    refuse(error.what());
  }
  return 0;
}

}  // namespace gnomon
