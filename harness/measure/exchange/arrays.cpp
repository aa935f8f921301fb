#include "measure/exchange/arrays.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/uio.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <numeric>

namespace gnomon {

namespace {

/// Magic, version, length of the rest, a Python dictionary, blanks up to the end, a line's end.
std::string header_of(const ArrayParts& array) {
  std::string shape;
  for (const std::size_t n : array.shape) shape += fmt::format("{}, ", n);
  std::string header("\x93NUMPY\x01\x00", 8);
  constexpr std::size_t rest = array_offset - 10;
  header += {static_cast<char>(rest % 256), static_cast<char>(rest / 256)};
  header +=
      fmt::format("{{'descr': '<{}', 'fortran_order': False, 'shape': ({})}}", array.type == "float32" ? "f4" : "u4", shape);
  if (header.size() >= array_offset) throw Error("an array of {} dimensions has no room for its shape", array.shape.size());
  header.resize(array_offset - 1, ' ');
  return header + '\n';
}

}  // namespace

Json write_array(const std::filesystem::path& file, const ArrayParts& array) {
  std::string header = header_of(array);
  std::vector<iovec> pieces = {{header.data(), header.size()}};
  std::size_t size = 0;
  for (const auto& part : array.parts) {
    pieces.push_back({const_cast<std::byte*>(part.data()), part.size()});
    size += part.size();
  }
  const std::size_t wanted = std::accumulate(array.shape.begin(), array.shape.end(), std::size_t{4}, std::multiplies<>());
  if (size != wanted) throw Error("{}: {} bytes for a shape of {}", file.string(), size, wanted);
  unlink(file.c_str());
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) throw Error("{} cannot be written: {}", file.string(), std::strerror(errno));
  std::size_t first = 0;
  while (first < pieces.size()) {
    ssize_t n = writev(descriptor, &pieces[first], static_cast<int>(pieces.size() - first));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int code = errno;
      close(descriptor);
      unlink(file.c_str());
      throw Error("{} cannot be written: {}", file.string(), std::strerror(code));
    }
    for (; first < pieces.size() && static_cast<std::size_t>(n) >= pieces[first].iov_len; ++first)
      n -= static_cast<ssize_t>(pieces[first].iov_len);
    if (n > 0) {
      pieces[first].iov_base = static_cast<char*>(pieces[first].iov_base) + n;
      pieces[first].iov_len -= static_cast<std::size_t>(n);
    }
  }
  close(descriptor);
  return json_object({{"file", file.string()}, {"type", array.type}, {"shape", array.shape}, {"offset", array_offset}});
}

std::uint64_t hash_of(const ArrayParts& array) {
  XXH3_state_t* const state = XXH3_createState();
  XXH3_64bits_reset(state);
  XXH3_64bits_update(state, array.shape.data(), array.shape.size() * sizeof(std::size_t));
  for (const auto& part : array.parts) XXH3_64bits_update(state, part.data(), part.size());
  const std::uint64_t hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return hash;
}

}  // namespace gnomon
