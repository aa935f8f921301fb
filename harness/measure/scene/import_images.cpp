// Decodes the images of masks and transmissions, in the child process of an import: a damaged image may crash what reads it.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>

#include "measure/images/image_files.h"
#include "measure/scene/import.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// Bytes under a path, for readers that open files. No name in any folder is left behind when the process crashes.
class FileInMemory {
 public:
  explicit FileInMemory(std::string_view bytes) : descriptor_(memfd_create("gnomon image", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw Error("there is no memory for it: {}", std::strerror(errno));
    while (!bytes.empty()) {
      const ssize_t count = write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw Error("there is no memory for it: {}", std::strerror(errno));
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  FileInMemory(const FileInMemory&) = delete;
  ~FileInMemory() { close(descriptor_); }
  fs::path path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

std::uint8_t rounded(float share) {
  return share > 0 ? static_cast<std::uint8_t>(std::lround(255.0 * std::min(share, 1.0f))) : 0;
}

/// Alpha, else brightness where that counts, else nothing. Brightness is the luminance of colors as the file has them, or the
/// first channel.
void read_alpha(const fs::path& path, const std::vector<std::string>& channels, MaskImage& image) {
  const auto has = [&](const char* name) { return std::ranges::find(channels, name) != channels.end(); };
  const auto channel = [&](const std::string& name) { return read_exr(path, name, image.width, image.height); };
  std::vector<float> shares;
  if (has("A")) {
    shares = channel("A");
  } else if (!image.is_gray_alpha || channels.empty()) {
    return;
  } else if (has("R") && has("G") && has("B")) {
    constexpr std::pair<const char*, float> luminance[] = {{"G", 0.7152f}, {"B", 0.0722f}};
    shares = channel("R");
    for (float& share : shares) share *= 0.2126f;
    for (const auto& [name, weight] : luminance) {
      const std::vector<float> more = channel(name);
      for (std::size_t k = 0; k < shares.size(); ++k) shares[k] += weight * more[k];
    }
  } else {
    shares = channel(channels.front());
  }
  image.alpha.resize(shares.size());
  std::ranges::transform(shares, image.alpha.begin(), rounded);
}

/// Red, green, blue; the first channel three times where one is missing.
void read_colors(const fs::path& path, const std::vector<std::string>& channels, MaskImage& image) {
  if (!image.wants_colors || channels.empty()) return;
  const auto has = [&](const char* name) { return std::ranges::find(channels, name) != channels.end(); };
  const bool is_colored = has("R") && has("G") && has("B");
  constexpr std::array<const char*, 3> names = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    if (c > 0 && !is_colored) {
      for (std::size_t k = 0; k < image.colors.size(); k += 3) image.colors[k + c] = image.colors[k];
      continue;
    }
    const std::vector<float> shares = read_exr(path, is_colored ? names[c] : channels.front(), image.width, image.height);
    image.colors.resize(3 * shares.size());
    for (std::size_t k = 0; k < shares.size(); ++k) image.colors[3 * k + c] = rounded(shares[k]);
  }
}

/// A reason with the image's name in place of the path that it was read under.
std::string named(std::string reason, const std::string& path, const std::string& name) {
  if (path.empty() || reason.find(path) == reason.npos) return fmt::format("{}: {}", name, reason);
  for (std::size_t at = reason.find(path); at != reason.npos; at = reason.find(path, at + name.size()))
    reason.replace(at, path.size(), name);
  return reason;
}

}  // namespace

void decode(MaskImage& image, const std::function<void(std::uint64_t pixels)>& make_room) {
  std::string path;
  try {
    if (image.bytes.empty()) throw Error("is empty");
    const FileInMemory file(image.bytes);
    path = file.path().string();
    std::tie(image.width, image.height) = image_files().exr_size(path);
    make_room(static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height));
    const std::vector<std::string> channels = image_files().exr_channels(path);
    read_alpha(path, channels, image);
    read_colors(path, channels, image);
  } catch (const std::bad_alloc&) {
    image.failure =
        fmt::format("{}: {} x {} pixels need more memory than the importer may take", image.name, image.width, image.height);
  } catch (const Error& error) {
    image.failure = named(error.what(), path, image.name);
  }
  image.bytes = {};
  if (image.failure.empty()) return;
  image.alpha = {};
  image.colors = {};
}

}  // namespace gnomon::importing
