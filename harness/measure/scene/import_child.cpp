// The child process of an import. Its parent starts it and takes its answer from a pipe. The child reads the file with the
// reader of its format and writes what the file contains into the pipe. Any fault of the child, corrupted memory included, ends
// the child alone.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <set>

#include "measure/scene/import.h"

extern char** environ;

namespace gnomon {
namespace {

using namespace importing;
namespace fs = std::filesystem;

// --- the parent's side ---

constexpr std::size_t max_answer_bytes = std::size_t{8} << 30;

/// Both ends of a pipe, closed on exec and at the end of the scope.
struct Pipe {
  int ends[2] = {-1, -1};
  explicit Pipe(const std::string& what) {
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error("{}: no pipe for the importer: {}", what, std::strerror(errno));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
};

/// Reads to the end of the pipe, then judges how the child ended.
std::vector<std::byte> collect(const std::string& what, pid_t child, Pipe& pipe) {
  pipe.close_end(1);
  std::vector<std::byte> answer;
  std::size_t size = 0;
  while (size <= max_answer_bytes) {
    if (answer.size() - size < (1u << 16)) answer.resize(std::max<std::size_t>(1u << 20, 2 * answer.size()));
    const ssize_t count = ::read(pipe.ends[0], answer.data() + size, answer.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    size += static_cast<std::size_t>(count);
  }
  if (size > max_answer_bytes) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (size > max_answer_bytes) throw Error("{}: holds more than {} bytes of geometry", what, max_answer_bytes);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGALRM)
      throw Error("{}: the importer did not finish within its limit of {} s, and {} s for each megabyte of the file", what,
                  least_import_seconds, import_seconds_per_megabyte);
    if (signal == SIGKILL) throw Error("{}: the importer was killed; the machine ran out of memory, most likely", what);
    throw Error("{}: the importer crashed (signal {}, {}); the file is damaged", what, signal, strsignal(signal));
  }
  if (WEXITSTATUS(status) != 0) throw Error("{}: the importer ended with status {}", what, WEXITSTATUS(status));
  answer.resize(size);
  return answer;
}

// --- the child's side ---

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
  void add_pixels(std::uint64_t count) {
    bytes_ += count / pixels_per_byte;
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

/// Refuses pipes and devices, which may never end.
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

/// Writes bytes into the pipe; a parent that is gone ends the child by SIGPIPE.
void send(std::span<const std::byte> rest, int fd) {
  while (!rest.empty()) {
    const ssize_t count = write(fd, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(3);
    rest = rest.subspan(static_cast<std::size_t>(count));
  }
}

void send(const MeshFile& answer, int fd) {
  FieldWriter writer;
  visit_file(writer, answer);
  send(writer.bytes, fd);
}

}  // namespace

std::vector<std::byte> importing::output_of_fork(const std::string& what, const std::function<int(int out_fd)>& body) {
  Pipe pipe(what);
  const pid_t child = fork();
  if (child < 0) throw Error("{}: no process for the importer: {}", what, std::strerror(errno));
  if (child == 0) {
    if (const int nowhere = open("/dev/null", O_RDWR); nowhere >= 0) dup2(nowhere, 2);  // the parent words the error
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM, SIGPIPE, SIGXCPU}) ::signal(signal, SIG_DFL);
    _exit(body(pipe.ends[1]));
  }
  return collect(what, child, pipe);
}

std::vector<std::byte> importing::output_of_program(const std::string& what, const std::filesystem::path& program,
                                                    const std::filesystem::path& file, bool with_all) {
  Pipe pipe(what);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe.ends[1], 3);
  for (const int stream : {0, 1, 2})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", stream == 0 ? O_RDONLY : O_WRONLY, 0);
  const std::string name = file.string();  // as it is written: errors name it so
  std::string words[] = {program.string(), "import-mesh", name.starts_with('-') ? "./" + name : name, "3"};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  std::vector<char*> variables;
  for (char** variable = environ; *variable; ++variable)
    if (!std::string_view(*variable).starts_with(all_variable)) variables.push_back(*variable);
  std::string all_wanted = fmt::format("{}=1", all_variable);
  if (with_all) variables.push_back(all_wanted.data());
  variables.push_back(nullptr);
  pid_t child = -1;
  const int failure = posix_spawn(&child, program.c_str(), &actions, nullptr, arguments, variables.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw Error("{}: cannot start the importer {}: {}", what, program.string(), std::strerror(failure));
  return collect(what, child, pipe);
}

std::vector<fs::path> importing::files_behind(const fs::path& file) {
  const std::vector<std::byte> names = output_of_fork(file.string(), [&](int out_fd) {
    Limits limits;
    const ReadFile read = [&](const fs::path& path) {
      std::string bytes = read_regular_file(path, limits);
      const std::string name = path.string();
      send(std::as_bytes(std::span(name.c_str(), name.size() + 1)), out_fd);
      return bytes;
    };
    try {
      if (has_mesh_format(file))
        read_mesh_file(file, read, true);
      else
        read(file);
    } catch (const std::exception&) {  // loading says it
    }
    return 0;
  });
  std::vector<fs::path> files;
  const std::string_view text(reinterpret_cast<const char*>(names.data()), names.size());
  for (std::size_t begin = 0, end = 0; (end = text.find('\0', begin)) != text.npos; begin = end + 1)
    if (const fs::path name = text.substr(begin, end - begin); std::ranges::find(files, name) == files.end())
      files.push_back(name);
  return files;
}

int import_child_main(const std::string& file, int out_fd, bool with_all) {
  Limits limits;
  with_all |= std::getenv(all_variable) != nullptr;
  const ReadFile read = [&](const fs::path& path) { return read_regular_file(path, limits); };
  const auto refuse = [&](const std::string& why) {
    MeshFile answer;
    answer.failure = why;
    send(answer, out_fd);
  };
  try {
    MeshFile answer;
    if (has_mesh_format(file))
      answer = read_mesh_file(file, read, with_all);
    else
      answer.mask_images.push_back({.name = file,
                                    .bytes = read(file),
                                    .is_gray_alpha = !with_all,
                                    .wants_colors = with_all,
                                    .alpha = {},
                                    .colors = {},
                                    .failure = {}});
    for (MaskImage& image : answer.mask_images)
      if (image.failure.empty()) decode(image, [&](std::uint64_t pixels) { limits.add_pixels(pixels); });
    send(answer, out_fd);
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
