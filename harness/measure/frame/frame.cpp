#include "measure/frame/frame.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "measure/frame/light_rays.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Raised when `find_snapping` answers otherwise. It names files of references and no version of the frames: masks and causes
/// stand as they did.
constexpr int snapping_version = 1;

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> items) {
  const auto view = std::as_bytes(items);
  bytes.insert(bytes.end(), view.begin(), view.end());
}

/// Bytes of a pixel in the cache: six floats and two ids; a float, a mesh, a class and a flag.
constexpr std::size_t gbuffer_pixel = 32, reference_pixel = 10;

/// Whether a file of the cache is whole. One that is not (a disk that filled up, a power cut) is made again.
bool is_whole(const fs::path& file, std::size_t size) {
  std::error_code code;
  return fs::file_size(file, code) == size && !code;
}

std::size_t pixel_count(const FrameKey& key) { return static_cast<std::size_t>(key.width) * key.height; }

template <class T>
std::span<const T> slice(const MappedFile& file, std::size_t& offset, std::size_t count) {
  if (offset + count * sizeof(T) > file.bytes().size()) throw Error("a file of the frame cache is too short");
  const auto* begin = reinterpret_cast<const T*>(file.bytes().data() + offset);
  offset += count * sizeof(T);
  return {begin, count};
}

}  // namespace

int frame_version() { return 5; }

FrameStore::FrameStore(const Scene& scene, fs::path folder)
    : scene_(scene), folder_(std::move(folder)), scene_bytes_(scene_bytes(scene)), scene_hash_(content_hash(scene_bytes_)) {}

fs::path FrameStore::scene_file() const {
  const fs::path file = folder_ / (scene_hash_ + ".scene");
  if (!is_whole(file, scene_bytes_.size())) write_file(file, scene_bytes_);
  return file;
}

std::string FrameStore::hash(const FrameKey& key, const Light* light) const {
  Scene fingerprint;
  fingerprint.name = fmt::format("{} {} {} {} {}", frame_version(), scene_hash_, key.width, key.height, name(key.truth));
  fingerprint.views = {key.view};
  if (light) {
    fingerprint.name += fmt::format(" {}", snapping_version);
    fingerprint.lights = {*light};
  }
  return content_hash(scene_bytes(fingerprint));
}

fs::path FrameStore::gbuffer_file(const FrameKey& key) {
  const fs::path file = folder_ / (hash(key, nullptr) + ".gbuffer");
  if (is_whole(file, pixel_count(key) * gbuffer_pixel)) return file;
  write_gbuffer(file, make_gbuffer(scene_, everything(key.truth), key.view, key.width, key.height, key.truth));
  return file;
}

GBuffer FrameStore::gbuffer(const FrameKey& key) { return map_gbuffer(gbuffer_file(key), key); }

void write_gbuffer(const fs::path& file, const GBuffer& g) {
  std::vector<std::byte> bytes;
  bytes.reserve(g.size() * gbuffer_pixel);
  for (const auto& floats : {g.px, g.py, g.pz, g.nx, g.ny, g.nz}) append(bytes, floats);
  for (const auto& ids : {g.mesh, g.triangle}) append(bytes, ids);
  write_file(file, bytes);
}

GBuffer map_gbuffer(const fs::path& path, const FrameKey& key) {
  const auto file = MappedFile::open(path);
  const std::size_t n = pixel_count(key);
  std::size_t offset = 0;
  GBuffer g{key.view, key.truth, key.width, key.height, {}, {}, {}, {}, {}, {}, {}, {}, file};
  for (auto* floats : {&g.px, &g.py, &g.pz, &g.nx, &g.ny, &g.nz}) *floats = slice<float>(*file, offset, n);
  for (auto* ids : {&g.mesh, &g.triangle}) *ids = slice<std::uint32_t>(*file, offset, n);
  return g;
}

const RayScene& FrameStore::rays(Truth truth, RayScene::Which which) {
  if (!scene_.has_curved_shapes()) truth = Truth::mesh;
  if (std::ranges::all_of(scene_.meshes, &Mesh::casts)) which = RayScene::Which::casters;
  auto found = rays_.find({truth, which});
  if (found == rays_.end()) found = rays_.emplace(std::pair(truth, which), RayScene(scene_, truth, which)).first;
  return found->second;
}

const RayScene& FrameStore::casters(Truth truth) { return rays(truth, RayScene::Which::casters); }

const RayScene& FrameStore::everything(Truth truth) { return rays(truth, RayScene::Which::all); }

Reference FrameStore::reference(const FrameKey& key, const Light& light) {
  require_reference(scene_, light, key.view);
  const fs::path path = folder_ / (hash(key, &light) + ".reference");
  if (!is_whole(path, pixel_count(key) * reference_pixel)) {
    const GBuffer g = gbuffer(key);
    std::vector<float> mask(g.size());
    trace_shadows(casters(key.truth), scene_, g, light, mask);
    const std::vector<PixelClass> classes = classify(scene_, casters(key.truth), g, light, mask);
    std::vector<std::byte> bytes;
    append(bytes, std::span<const float>(mask));
    append(bytes, std::span<const std::uint32_t>(find_nearest_casters(scene_, casters(key.truth), g, light, mask)));
    append(bytes, std::span<const PixelClass>(classes));
    append(bytes, std::span<const std::uint8_t>(
                      find_snapping(scene_, everything(key.truth), casters(key.truth), g, light, mask, classes)));
    write_file(path, bytes);
  }
  const auto file = MappedFile::open(path);
  const std::size_t n = pixel_count(key);
  std::size_t offset = 0;
  Reference reference;
  reference.mask = slice<float>(*file, offset, n);
  reference.nearest_caster = slice<std::uint32_t>(*file, offset, n);
  reference.classes = slice<PixelClass>(*file, offset, n);
  reference.snapping = slice<std::uint8_t>(*file, offset, n);
  reference.storage = file;
  return reference;
}

Support reference_support(const Scene& scene, const Light& light, const View& view) {
  const Support support = registry().reference().make()->supports(scene, light, view);
  return support ? support : Support::unsupported(fmt::format("the reference has no answer: {}", support.why()));
}

void require_reference(const Scene& scene, const Light& light, const View& view) {
  if (const Support support = reference_support(scene, light, view); !support)
    throw Error("scene {}, light {}: {}", scene.name, light.name, support.why());
}

}  // namespace gnomon
