#include "measure/scene/blob.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/scene/fields.h"

namespace gnomon {

namespace {

constexpr std::uint32_t layout_version = 1;

/// The layout, for FieldWriter (const objects) and FieldReader alike.
void visit_scene(auto& io, auto& scene) {
  io(scene.name, scene.ambient);
  io.list(scene.meshes, [](auto& sub, auto& mesh) {
    sub(mesh.name, mesh.positions, mesh.triangles, mesh.casts, mesh.receives, mesh.albedo, mesh.facts, mesh.shape);
  });
  io.list(scene.lights, [](auto& sub, auto& light) { sub(light.name, light.intensity, light.kind); });
  io.list(scene.views, [](auto& sub, auto& view) { sub(view.name, view.eye, view.target, view.up, view.fov_y_degrees); });
  io.list(scene.notes, [](auto& sub, auto& note) { sub(note); });
  // Paths came later: a scene without any keeps the bytes, and so the hash, that older records know it by.
  if (io.has_more(scene.paths))
    io.list(scene.paths, [](auto& sub, auto& path) { sub(path.name, path.moves, path.positions, path.frame_count); });
}

}  // namespace

std::string content_hash(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}
std::string content_hash(const std::string& text) { return content_hash(std::as_bytes(std::span(text))); }

std::vector<std::byte> scene_bytes(const Scene& scene) {
  FieldWriter writer;
  writer(layout_version);
  visit_scene(writer, scene);
  return std::move(writer.bytes);
}

std::string scene_hash(const Scene& scene, std::span<const std::string> lights) {
  const auto is_other = [&](const Light& one) { return has_area(one) && std::ranges::find(lights, one.name) == lights.end(); };
  const auto has_dropped = [](const Mesh& mesh) { return mesh.facts.degenerate_count > 0; };
  if (scene.notes.empty() && std::ranges::none_of(scene.lights, is_other) && std::ranges::none_of(scene.meshes, has_dropped))
    return content_hash(scene_bytes(scene));
  Scene known = scene;
  std::erase_if(known.lights, is_other);
  known.notes.clear();
  for (Mesh& mesh : known.meshes) mesh.facts.degenerate_count = 0;
  return content_hash(scene_bytes(known));
}

Scene scene_from_bytes(std::span<const std::byte> bytes) {
  FieldReader reader(bytes, "scene bytes end too early");
  std::uint32_t version = 0;
  reader(version);
  if (version != layout_version) throw Error("scene bytes have layout {}; this program reads {}", version, layout_version);
  Scene scene;
  visit_scene(reader, scene);
  return scene;
}

std::shared_ptr<const MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe has nobody to wait for
  struct stat status {};
  const auto fail = [&](const char* what) {
    const int code = errno;
    if (file >= 0) close(file);
    throw Error("{} cannot be {}: {}", path.string(), what, std::strerror(code));
  };
  if (file < 0 || fstat(file, &status) != 0) fail("read");
  if (!S_ISREG(status.st_mode)) {
    close(file);
    throw Error("{} is not a file", path.string());
  }
  auto mapped = std::make_shared<MappedFile>();
  if (status.st_size > 0) {
    void* address = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, file, 0);
    if (address == MAP_FAILED) fail("mapped");
    mapped->bytes_ = {static_cast<const std::byte*>(address), static_cast<std::size_t>(status.st_size)};
  }
  close(file);
  return mapped;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durable durable) {
  if (path.has_parent_path()) make_folder(path.parent_path());
  const std::filesystem::path target = replaced_file(path), temporary = part_of(target);
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
  if (failure == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
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
