#include "measure/scene/blob.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/fields.h"

namespace gnomon {

namespace {

/// Scenes without alpha masks keep the layout that they had before there were masks, and so their hashes. A program that reads
/// only that one refuses scenes with masks: it would take them for solid. The same is true of meshes that let light through or
/// are not seen: scenes without them keep the layouts that they had.
constexpr std::uint32_t solid_layout = 2, masked_layout = 3, glass_layout = 4;

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

/// A mesh with an alpha mask: both by their indices.
struct Masked {
  std::uint32_t mesh = 0, mask = 0;
  std::vector<glm::vec2> uv;
};
/// The alpha masks of a scene, each once, in the order of the meshes that have them.
struct Masks {
  std::vector<AlphaMask::Parts> masks;
  std::vector<Masked> meshes;
};

void visit_masks(auto& io, auto& all) {
  io.list(all.masks, [](auto& sub, auto& mask) {
    sub(mask.width, mask.height, mask.wrap_u, mask.wrap_v, mask.factor, mask.cutoff, mask.bits, mask.alpha);
  });
  io.list(all.meshes, [](auto& sub, auto& one) { sub(one.mesh, one.mask, one.uv); });
}

Masks masks_of(const Scene& scene) {
  Masks all;
  std::map<const AlphaMask*, std::uint32_t> known;  // never walked through: addresses have no order that repeats
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.alpha_mask) continue;
    const AlphaMask& mask = *mesh.alpha_mask;
    const auto [found, is_new] = known.try_emplace(&mask, static_cast<std::uint32_t>(all.masks.size()));
    if (is_new)
      all.masks.push_back({mask.width(),
                           mask.height(),
                           mask.wrap_u(),
                           mask.wrap_v(),
                           mask.factor(),
                           mask.cutoff(),
                           {mask.bits().begin(), mask.bits().end()},
                           {mask.alpha().begin(), mask.alpha().end()}});
    all.meshes.push_back({m, found->second, mesh.uv});
  }
  return all;
}

/// Throws Error unless each vertex of a mesh has a sound place in a picture.
void check_places(std::span<const glm::vec2> uv, std::uint32_t number, const Mesh& mesh) {
  if (uv.size() != mesh.positions.size())
    throw Error("scene bytes have {} uv for the {} vertices of mesh {} ({})", uv.size(), mesh.positions.size(), number,
                mesh.name);
  for (std::size_t v = 0; v < uv.size(); ++v)
    if (!is_sound_uv(uv[v]))
      throw Error("scene bytes have uv = ({}, {}), which is not within {} .. {}, for vertex {} of mesh {} ({})", uv[v].x,
                  uv[v].y, -largest_uv, largest_uv, v, number, mesh.name);
}

void put_masks(Masks all, Scene& scene) {
  std::vector<std::shared_ptr<const AlphaMask>> masks;
  for (AlphaMask::Parts& parts : all.masks) masks.push_back(std::make_shared<const AlphaMask>(std::move(parts)));
  for (Masked& one : all.meshes) {
    if (one.mesh >= scene.meshes.size())
      throw Error("scene bytes have an alpha mask for mesh {} of {}", one.mesh, scene.meshes.size());
    Mesh& mesh = scene.meshes[one.mesh];
    if (mesh.alpha_mask) throw Error("scene bytes have two alpha masks for mesh {} ({})", one.mesh, mesh.name);
    if (one.mask >= masks.size())
      throw Error("scene bytes have alpha mask {} of {} for mesh {} ({})", one.mask, masks.size(), one.mesh, mesh.name);
    check_places(one.uv, one.mesh, mesh);
    if (mesh.has_curved_shape())
      throw Error("scene bytes have an alpha mask for mesh {} ({}), whose shape is curved", one.mesh, mesh.name);
    mesh.alpha_mask = masks[one.mask];
    mesh.uv = std::move(one.uv);
  }
}

/// A transmission; Transmission itself has no empty state to read into.
struct TransmissionParts {
  std::int32_t width = 0, height = 0, channels = 0;
  AlphaMask::Wrap wrap_u = AlphaMask::Wrap::repeat, wrap_v = AlphaMask::Wrap::repeat;
  std::vector<float> values;
};
/// A mesh that lets light through: both by their indices. `uv` are with the alpha mask where it has one, too.
struct Transmitting {
  std::uint32_t mesh = 0, transmission = 0;
  std::vector<glm::vec2> uv;
};
/// The transmissions of a scene, each once, in the order of the meshes that have them, and the meshes that are not seen.
struct GlassParts {
  std::vector<TransmissionParts> transmissions;
  std::vector<Transmitting> meshes;
  std::vector<std::uint32_t> unseen;
  bool empty() const { return meshes.empty() && unseen.empty(); }
};

void visit_glass(auto& io, auto& all) {
  io.list(all.transmissions,
          [](auto& sub, auto& one) { sub(one.width, one.height, one.channels, one.wrap_u, one.wrap_v, one.values); });
  io.list(all.meshes, [](auto& sub, auto& one) { sub(one.mesh, one.transmission, one.uv); });
  io(all.unseen);
}

GlassParts glass_of(const Scene& scene) {
  GlassParts all;
  std::map<const Transmission*, std::uint32_t> known;  // never walked through, as above
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.seen) all.unseen.push_back(m);
    if (!mesh.transmission) continue;
    const Transmission& one = *mesh.transmission;
    const auto [found, is_new] = known.try_emplace(&one, static_cast<std::uint32_t>(all.transmissions.size()));
    if (is_new)
      all.transmissions.push_back(
          {one.width(), one.height(), one.channels(), one.wrap_u(), one.wrap_v(), {one.values().begin(), one.values().end()}});
    all.meshes.push_back({m, found->second, mesh.alpha_mask ? std::vector<glm::vec2>() : mesh.uv});
  }
  return all;
}

void put_glass(GlassParts all, Scene& scene) {
  std::vector<std::shared_ptr<const Transmission>> transmissions;
  for (TransmissionParts& one : all.transmissions)
    transmissions.push_back(std::make_shared<const Transmission>(one.width, one.height, one.channels, std::move(one.values),
                                                                 one.wrap_u, one.wrap_v));
  for (Transmitting& one : all.meshes) {
    if (one.mesh >= scene.meshes.size())
      throw Error("scene bytes have a transmission for mesh {} of {}", one.mesh, scene.meshes.size());
    Mesh& mesh = scene.meshes[one.mesh];
    if (mesh.transmission) throw Error("scene bytes have two transmissions for mesh {} ({})", one.mesh, mesh.name);
    if (one.transmission >= transmissions.size())
      throw Error("scene bytes have transmission {} of {} for mesh {} ({})", one.transmission, transmissions.size(), one.mesh,
                  mesh.name);
    if (mesh.has_curved_shape())
      throw Error("scene bytes have a transmission for mesh {} ({}), whose shape is curved", one.mesh, mesh.name);
    if (mesh.alpha_mask && !one.uv.empty())
      throw Error("scene bytes have uv for both mask and transmission of mesh {} ({})", one.mesh, mesh.name);
    mesh.transmission = transmissions[one.transmission];
    if (mesh.alpha_mask) continue;
    if (mesh.needs_uv() || !one.uv.empty()) check_places(one.uv, one.mesh, mesh);
    mesh.uv = std::move(one.uv);
  }
  for (const std::uint32_t m : all.unseen) {
    if (m >= scene.meshes.size()) throw Error("scene bytes say that mesh {} of {} is not seen", m, scene.meshes.size());
    if (!scene.meshes[m].seen) throw Error("scene bytes say twice that mesh {} ({}) is not seen", m, scene.meshes[m].name);
    scene.meshes[m].seen = false;
  }
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
  const std::uint32_t layout = !glass.empty() ? glass_layout : !masks.meshes.empty() ? masked_layout : solid_layout;
  writer(layout);
  visit_solid(writer, scene);
  if (layout >= masked_layout || writer.has_more(scene.paths)) visit_paths(writer, scene.paths);
  if (layout >= masked_layout) visit_masks(writer, masks);
  if (layout >= glass_layout) visit_glass(writer, glass);
  return std::move(writer.bytes);
}

std::string scene_hash(const Scene& scene, std::span<const std::string> lights) {
  const auto is_other = [&](const Light& one) { return has_area(one) && std::ranges::find(lights, one.name) == lights.end(); };
  const auto has_dropped = [](const Mesh& mesh) { return mesh.facts.degenerate_count > 0; };
  if (scene.notes.empty() && std::ranges::none_of(scene.lights, is_other) && std::ranges::none_of(scene.meshes, has_dropped))
    return content_hash(scene_bytes(scene));
  Scene hashed = scene;
  std::erase_if(hashed.lights, is_other);
  hashed.notes.clear();
  for (Mesh& mesh : hashed.meshes) mesh.facts.degenerate_count = 0;
  return content_hash(scene_bytes(hashed));
}

Scene scene_from_bytes(std::span<const std::byte> bytes) {
  FieldReader reader(bytes, "scene bytes end too early");
  std::uint32_t layout = 0;
  reader(layout);
  if (layout < solid_layout || layout > glass_layout)
    throw Error("scene bytes have layout {}; this program reads {} .. {}", layout, solid_layout, glass_layout);
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
