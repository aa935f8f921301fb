#include "measure/scene/blob.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <type_traits>

namespace gnomon {

namespace {

constexpr std::uint32_t layout_version = 1;

/// One visitor for both directions, so that writing and reading cannot disagree.
class Writer {
 public:
  std::vector<std::byte> bytes;
  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(T));
  }
  template <class Container>
  void array(const Container& items) {
    plain(static_cast<std::uint64_t>(items.size()));
    const auto* begin = reinterpret_cast<const std::byte*>(items.data());
    bytes.insert(bytes.end(), begin, begin + items.size() * sizeof(*items.data()));
  }
  template <class T, class Visit>
  void list(const std::vector<T>& items, Visit visit) {
    plain(static_cast<std::uint64_t>(items.size()));
    for (const T& item : items) visit(*this, item);
  }
  template <class T>
  bool has_more(const std::vector<T>& items) const {
    return !items.empty();
  }
  template <class Variant>
  void variant(const Variant& value) {
    plain(static_cast<std::uint32_t>(value.index()));
    std::visit([&](const auto& v) { plain(v); }, value);
  }
};

class Reader {
 public:
  std::span<const std::byte> bytes;
  template <class T>
  void plain(T& value) {
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
  }
  template <class Container>
  void array(Container& items) {
    std::uint64_t count = 0;
    plain(count);
    using Item = typename Container::value_type;
    if (count > bytes.size() / sizeof(Item)) throw Error("scene bytes end too early");
    items.resize(count);
    if (count) std::memcpy(items.data(), take(count * sizeof(Item)), count * sizeof(Item));
  }
  template <class T, class Visit>
  void list(std::vector<T>& items, Visit visit) {
    std::uint64_t count = 0;
    plain(count);
    if (count > bytes.size()) throw Error("scene bytes end too early");
    items.resize(count);
    for (T& item : items) visit(*this, item);
  }
  template <class T>
  bool has_more(const std::vector<T>&) const {
    return !bytes.empty();
  }
  template <class Variant>
  void variant(Variant& value) {
    std::uint32_t index = 0;
    plain(index);
    read_variant(value, index, std::make_index_sequence<std::variant_size_v<Variant>>{});
  }

 private:
  const std::byte* take(std::size_t count) {
    if (count > bytes.size()) throw Error("scene bytes end too early");
    const std::byte* begin = bytes.data();
    bytes = bytes.subspan(count);
    return begin;
  }
  template <class Variant, std::size_t... I>
  void read_variant(Variant& value, std::uint32_t index, std::index_sequence<I...>) {
    const bool known = ((index == I && (plain(value.template emplace<I>()), true)) || ...);
    if (!known) throw Error("scene bytes hold an unknown kind {}", index);
  }
};

/// The layout, for Writer (const objects) and Reader alike.
void visit_mesh(auto& io, auto& mesh) {
  io.array(mesh.name);
  io.array(mesh.positions);
  io.array(mesh.triangles);
  io.plain(mesh.casts);
  io.plain(mesh.receives);
  io.plain(mesh.albedo);
  io.plain(mesh.facts);
  bool has_shape = mesh.shape.has_value();
  io.plain(has_shape);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(mesh)>>) {
    if (has_shape) mesh.shape.emplace();
  }
  if (has_shape) io.variant(*mesh.shape);
}

void visit_light(auto& io, auto& light) {
  io.array(light.name);
  io.plain(light.intensity);
  io.variant(light.kind);
}

void visit_view(auto& io, auto& view) {
  io.array(view.name);
  io.plain(view.eye);
  io.plain(view.target);
  io.plain(view.up);
  io.plain(view.fov_y_degrees);
}

void visit_path(auto& io, auto& path) {
  io.array(path.name);
  io.plain(path.moves);
  io.array(path.positions);
  io.plain(path.frame_count);
}

void visit_scene(auto& io, auto& scene) {
  io.array(scene.name);
  io.plain(scene.ambient);
  io.list(scene.meshes, [](auto& sub, auto& item) { visit_mesh(sub, item); });
  io.list(scene.lights, [](auto& sub, auto& item) { visit_light(sub, item); });
  io.list(scene.views, [](auto& sub, auto& item) { visit_view(sub, item); });
  io.list(scene.notes, [](auto& sub, auto& item) { sub.array(item); });
  // Paths came later: a scene without any keeps the bytes, and so the hash, that older records know it by.
  if (io.has_more(scene.paths)) io.list(scene.paths, [](auto& sub, auto& item) { visit_path(sub, item); });
}

std::string hash_hex(const void* data, std::size_t size) {
  const XXH128_hash_t hash = XXH3_128bits(data, size);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string content_hash(std::span<const std::byte> bytes) { return hash_hex(bytes.data(), bytes.size()); }
std::string content_hash(const std::string& text) { return hash_hex(text.data(), text.size()); }

std::vector<std::byte> scene_bytes(const Scene& scene) {
  Writer writer;
  writer.plain(layout_version);
  visit_scene(writer, scene);
  return std::move(writer.bytes);
}

Scene scene_from_bytes(std::span<const std::byte> bytes) {
  Reader reader{bytes};
  std::uint32_t version = 0;
  reader.plain(version);
  if (version != layout_version) throw Error("scene bytes have layout {}; this program reads {}", version, layout_version);
  Scene scene;
  visit_scene(reader, scene);
  return scene;
}

std::shared_ptr<const MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file < 0 || fstat(file, &status) != 0) {
    const int code = errno;
    if (file >= 0) close(file);
    throw Error("{} cannot be read: {}", path.string(), std::strerror(code));
  }
  auto mapped = std::make_shared<MappedFile>();
  if (status.st_size > 0) {
    void* address = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, file, 0);
    if (address == MAP_FAILED) {
      const int code = errno;
      close(file);
      throw Error("{} cannot be mapped: {}", path.string(), std::strerror(code));
    }
    mapped->bytes_ = {static_cast<const std::byte*>(address), static_cast<std::size_t>(status.st_size)};
  }
  close(file);
  return mapped;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durable durable) {
  std::error_code code;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), code);
  if (code) throw Error("folder {} cannot be made: {}", path.parent_path().string(), code.message());
  const std::string temporary = fmt::format("{}.{}.part", path.string(), getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) throw Error("{} cannot be written: {}", path.string(), std::strerror(errno));
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written >= 0)
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      failure = errno;
  }
  if (failure == 0 && durable == Durable::yes && fsync(file) != 0) failure = errno;
  if (close(file) != 0 && failure == 0) failure = errno;
  if (failure == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) failure = errno;
  if (failure != 0) {
    unlink(temporary.c_str());
    throw Error("{} cannot be written: {}", path.string(), std::strerror(failure));
  }
  if (durable == Durable::yes) sync_folder_of(path);
}

void write_file(const std::filesystem::path& path, const std::string& text, Durable durable) {
  write_file(path, std::as_bytes(std::span(text.data(), text.size())), durable);
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace gnomon
