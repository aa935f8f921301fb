#include "measure/scene/blob.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "measure/formats/motion_fields.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/scene/blob_parts.h"
#include "measure/scene/fields.h"
#include "measure/scene/motion_data.h"

namespace gnomon {

namespace {

using namespace scene_parts;

/// Scenes without alpha masks keep the layout that they had before there were masks, and so their hashes. A program that reads
/// only that one refuses scenes with masks: it would take them for solid. The same is true of meshes that let light through or
/// are not seen, and of scenes that move: scenes without them keep the layouts that they had.
constexpr std::uint32_t solid_layout = 2, masked_layout = 3, glass_layout = 4, moving_layout = 5;

/// The layout up to the paths, for FieldWriter (const objects) and FieldReader alike.
void visit_solid(auto& io, auto& scene) {
  io(scene.name, scene.ambient);
  io.list(scene.meshes, [](auto& sub, auto& mesh) {
    sub(mesh.name, mesh.positions, mesh.triangles, mesh.casts, mesh.receives, mesh.albedo, mesh.facts, mesh.shape);
  });
  io.list(scene.lights, [](auto& sub, auto& light) { sub(light.name, light.intensity, light.kind); });
  io.list(scene.views,
          [](auto& sub, auto& view) { sub(view.name, view.eye, view.target, view.up, view.fov_y_degrees, view.exposure); });
  io.list(scene.notes, [](auto& sub, auto& note) { sub(note); });
}

void visit_paths(auto& io, auto& paths) {
  io.list(paths, [](auto& sub, auto& path) { sub(path.name, path.moves, path.positions, path.frame_count); });
}

/// Throws Error on a path that no loader makes: it moves neither camera nor light, or has no way or no frames.
void check_path(const Path& path) {
  if (path.moves != Path::Moves::camera && path.moves != Path::Moves::light)
    throw Error("scene bytes have a path '{}' that moves {}, neither the camera (0) nor a light (1)", path.name,
                static_cast<int>(path.moves));
  if (path.positions.size() < 2) throw Error("scene bytes have a path '{}' of {} positions", path.name, path.positions.size());
  if (path.frame_count < 1) throw Error("scene bytes have a path '{}' of {} frames", path.name, path.frame_count);
}

/// A regular file that is open for reading, and its size; closed at the end of the scope. Opening does not wait for a pipe's
/// writer.
struct OpenFile {
  const std::filesystem::path& path;
  int descriptor;
  std::size_t size = 0;
  explicit OpenFile(const std::filesystem::path& name)
      : path(name), descriptor(::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (descriptor < 0 || fstat(descriptor, &status) != 0) fail("read");
    if (!S_ISREG(status.st_mode)) {
      close(descriptor);
      throw Error("{} is not a file", path.string());
    }
    size = static_cast<std::size_t>(status.st_size);
  }
  ~OpenFile() {
    if (descriptor >= 0) close(descriptor);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[noreturn]] void fail(const char* what) const {
    const int code = errno;
    throw Error("{} cannot be {}: {}", path.string(), what, std::strerror(code));
  }
};

}  // namespace

std::string content_hash(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}
std::string content_hash(const std::string& text) { return content_hash(std::as_bytes(std::span(text))); }

std::vector<std::byte> scene_bytes(const Scene& scene) {
  FieldWriter writer;
  const Masks masks = masks_of(scene);
  const GlassParts glass = glass_of(scene);
  const std::uint32_t layout = scene.motion            ? moving_layout
                               : !glass.empty()        ? glass_layout
                               : !masks.meshes.empty() ? masked_layout
                                                       : solid_layout;
  writer(layout);
  visit_solid(writer, scene);
  if (layout >= masked_layout || writer.has_more(scene.paths)) visit_paths(writer, scene.paths);
  if (layout >= masked_layout) visit_masks(writer, masks);
  if (layout >= glass_layout) visit_glass(writer, glass);
  if (layout >= moving_layout) visit_motion(writer, *scene.motion);
  return std::move(writer.bytes);
}

std::string scene_hash(const Scene& scene, std::span<const std::string> lights, WithMotion with_motion) {
  const auto is_other = [&](const Light& one) { return has_area(one) && std::ranges::find(lights, one.name) == lights.end(); };
  const auto has_dropped = [](const Mesh& mesh) { return mesh.facts.degenerate_count > 0; };
  const bool leaves_motion_out = scene.motion && with_motion == WithMotion::no;
  if (scene.notes.empty() && std::ranges::none_of(scene.lights, is_other) && std::ranges::none_of(scene.meshes, has_dropped) &&
      !leaves_motion_out)
    return content_hash(scene_bytes(scene));
  Scene hashed = scene;
  if (leaves_motion_out) hashed.motion = nullptr;
  std::erase_if(hashed.lights, is_other);
  hashed.notes.clear();
  for (Mesh& mesh : hashed.meshes) mesh.facts.degenerate_count = 0;
  return content_hash(scene_bytes(hashed));
}

Scene scene_from_bytes(std::span<const std::byte> bytes) {
  FieldReader reader(bytes, "scene bytes end too early");
  std::uint32_t layout = 0;
  reader(layout);
  if (layout < solid_layout || layout > moving_layout)
    throw Error("scene bytes have layout {}; this program reads {} .. {}", layout, solid_layout, moving_layout);
  Scene scene;
  visit_solid(reader, scene);
  if (layout >= masked_layout || reader.has_more(scene.paths)) visit_paths(reader, scene.paths);
  if (layout >= masked_layout) {
    Masks masks;
    visit_masks(reader, masks);
    put_masks(std::move(masks), scene);
  }
  if (layout >= glass_layout) {
    GlassParts glass;
    visit_glass(reader, glass);
    put_glass(std::move(glass), scene);
  }
  for (const Path& path : scene.paths) check_path(path);
  if (layout >= moving_layout) {
    const auto motion = std::make_shared<Motion>();
    visit_motion(reader, *motion);
    scene.motion = motion;
    check_motion(scene, "scene bytes");
  }
  return scene;
}

std::shared_ptr<const MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const OpenFile file(path);
  auto mapped = std::make_shared<MappedFile>();
  if (file.size == 0) return mapped;
  void* address = mmap(nullptr, file.size, PROT_READ, MAP_SHARED, file.descriptor, 0);
  if (address == MAP_FAILED) file.fail("mapped");
  mapped->bytes_ = {static_cast<const std::byte*>(address), file.size};
  return mapped;
}

std::shared_ptr<const MappedFile> MappedFile::copy(const std::filesystem::path& path) {
  const OpenFile file(path);
  auto copied = std::make_shared<MappedFile>();
  if (file.size == 0) return copied;
  void* address = mmap(nullptr, file.size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (address == MAP_FAILED) file.fail("kept in memory");
  copied->bytes_ = {static_cast<const std::byte*>(address), file.size};
  for (std::size_t have = 0; have < file.size;) {
    const ssize_t count = ::read(file.descriptor, static_cast<char*>(address) + have, file.size - have);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) file.fail("read");
    if (count == 0) throw Error("{} was shortened while it was read", path.string());
    have += static_cast<std::size_t>(count);
  }
  return copied;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durable durable) {
  if (path.has_parent_path()) make_folder(path.parent_path());
  make_way(path);
  const std::filesystem::path temporary = part_of(path);
  unlink(temporary.c_str());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
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
  write_file(path, std::as_bytes(std::span(text)), durable);
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace gnomon
