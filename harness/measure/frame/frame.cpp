#include "measure/frame/frame.h"

#include <gnomon/error.h>
#include <gnomon/kit/area/path_light.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "measure/frame/light_rays.h"

namespace gnomon {

namespace fs = std::filesystem;

AnswerKind answer_kind(const Light& light) { return has_area(light) ? AnswerKind::fraction : AnswerKind::binary; }

bool has_radiance(const Light& light) { return has_area(light); }

namespace {

/// Raised when `find_snapping` answers otherwise. It names files of references and no version of the frames: masks and causes
/// stand as they did.
constexpr int snapping_version = 1;

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> items) {
  const auto view = std::as_bytes(items);
  bytes.insert(bytes.end(), view.begin(), view.end());
}

/// Bytes of a pixel in the cache: six floats and two ids; a float, a mesh, a class and a flag, and of a light with area six
/// floats and a number more.
constexpr std::size_t gbuffer_pixel = 32, hard_pixel = 10, soft_pixel = 38;
std::size_t reference_pixel(const Light& light) { return answer_kind(light) == AnswerKind::fraction ? soft_pixel : hard_pixel; }

/// Raised when trace_soft answers otherwise.
constexpr int soft_version = 4;

/// Raised when trace_paths answers otherwise.
constexpr int global_version = 1;

/// Of the paths of a GlobalReference: no technique has it, so that none is compared with its own paths.
constexpr std::uint64_t global_seed = 0x7fffffff;

/// Raised when what files hold for the same frame changes. It names them, so that builds before and after keep their own.
constexpr int file_layout = 2;

std::size_t pixel_count(const FrameKey& key) { return static_cast<std::size_t>(key.width) * key.height; }

/// Bytes of a GlobalReference: of a pixel two floats a channel, then the number of rays.
std::size_t global_size(const FrameKey& key) { return pixel_count(key) * 6 * sizeof(float) + sizeof(std::uint64_t); }

std::size_t size_of(const MissingFrame& missing) {
  if (missing.global_samples > 0) return global_size(missing.key);
  return pixel_count(missing.key) * (missing.light ? reference_pixel(*missing.light) : gbuffer_pixel);
}

std::vector<std::byte> gbuffer_bytes(const GBuffer& g) {
  std::vector<std::byte> bytes;
  bytes.reserve(g.size() * gbuffer_pixel + hash_size);
  for (const auto& floats : {g.px, g.py, g.pz, g.nx, g.ny, g.nz}) append(bytes, floats);
  for (const auto& ids : {g.mesh, g.triangle}) append(bytes, ids);
  return bytes;
}

template <class T>
std::span<const T> slice(const MappedFile& file, std::size_t& offset, std::size_t count) {
  if (offset + count * sizeof(T) > file.bytes().size()) throw Error("a file of the frame cache is too short");
  const auto* begin = reinterpret_cast<const T*>(file.bytes().data() + offset);
  offset += count * sizeof(T);
  return {begin, count};
}

}  // namespace

int frame_version() { return 8; }

FrameStore::FrameStore(const Scene& scene, fs::path folder, std::unique_ptr<FrameMaker> maker)
    : scene_(scene),
      files_(std::move(folder)),
      scene_bytes_(scene_bytes(scene)),
      scene_hash_(content_hash(scene_bytes_)),
      tracer_(scene),
      maker_(std::move(maker)) {}

const std::string& FrameStore::scene_hash(const std::vector<std::string>& lights) {
  const auto [found, is_new] = hash_by_lights_.try_emplace(lights);
  if (is_new) found->second = gnomon::scene_hash(scene_, lights);
  return found->second;
}

fs::path FrameStore::find(const std::string& name, std::size_t size) {
  return files_.find(name, size + hash_size, ends_with_own_hash);
}

fs::path FrameStore::make(const std::string& name, const MissingFrame& missing) {
  std::vector<std::byte> bytes = maker_ ? maker_->make(missing) : tracer_.make(missing);
  const std::size_t size = size_of(missing);
  if (bytes.size() != size) throw Error("a frame was made with {} bytes; {} are wanted", bytes.size(), size);
  append_hash(bytes);
  return files_.put(name, bytes);
}

fs::path FrameStore::scene_file() {
  const std::string name = scene_hash_ + ".scene";
  const fs::path file = files_.find(name, scene_bytes_.size(),
                                    [&](std::span<const std::byte> bytes) { return std::ranges::equal(bytes, scene_bytes_); });
  return file.empty() ? files_.put(name, scene_bytes_) : file;
}

std::string FrameStore::hash(const FrameKey& key, const Light* light, const AreaTarget& target, int subpixel_bits) const {
  Scene fingerprint;
  fingerprint.name =
      fmt::format("{} {} {} {} {} {}", file_layout, frame_version(), scene_hash_, key.width, key.height, name(key.truth));
  fingerprint.views = {key.view};
  if (light) {
    const bool is_soft = answer_kind(*light) == AnswerKind::fraction;
    fingerprint.name +=
        is_soft ? fmt::format(" soft {} {} {}", soft_version, target.error, target.cap) : fmt::format(" {}", snapping_version);
    if (!is_soft && subpixel_bits != usual_subpixel_bits) fingerprint.name += fmt::format(" {} bits", subpixel_bits);
    fingerprint.lights = {*light};
  }
  return content_hash(scene_bytes(fingerprint));
}

fs::path FrameStore::gbuffer_file(const FrameKey& key) {
  const std::string name = hash(key, nullptr) + ".gbuffer";
  if (const fs::path file = find(name, pixel_count(key) * gbuffer_pixel); !file.empty()) return file;
  return make(name, {.scene_file = scene_file(), .key = key, .light = {}, .gbuffer_file = {}, .target = {}});
}

GBuffer FrameStore::gbuffer(const FrameKey& key) { return copy_gbuffer(gbuffer_file(key), key); }

void write_gbuffer(const fs::path& file, const GBuffer& gbuffer) { write_file(file, gbuffer_bytes(gbuffer)); }

namespace {

GBuffer gbuffer_of(const std::shared_ptr<const MappedFile>& file, const fs::path& path, const FrameKey& key) {
  const std::size_t n = pixel_count(key);
  // A viewer's has no hash. Of another size, ids would be read from where coordinates lie.
  if (const std::size_t size = file->bytes().size(); size != n * gbuffer_pixel && size != n * gbuffer_pixel + hash_size)
    throw Error("{} has {} bytes, not those of {}x{} pixels", path.string(), size, key.width, key.height);
  std::size_t offset = 0;
  GBuffer g{key.view, key.truth, key.width, key.height, {}, {}, {}, {}, {}, {}, {}, {}, file};
  for (auto* floats : {&g.px, &g.py, &g.pz, &g.nx, &g.ny, &g.nz}) *floats = slice<float>(*file, offset, n);
  for (auto* ids : {&g.mesh, &g.triangle}) *ids = slice<std::uint32_t>(*file, offset, n);
  return g;
}

}  // namespace

GBuffer map_gbuffer(const fs::path& path, const FrameKey& key) { return gbuffer_of(MappedFile::open(path), path, key); }

GBuffer copy_gbuffer(const fs::path& path, const FrameKey& key) { return gbuffer_of(MappedFile::copy(path), path, key); }

const RayScene& FrameTracer::rays(Truth truth, RayScene::Which which) {
  if (!scene_.has_curved_shapes()) truth = Truth::mesh;
  if (std::ranges::all_of(scene_.meshes, &Mesh::casts)) which = RayScene::Which::casters;
  auto found = rays_.find({truth, which});
  if (found == rays_.end()) found = rays_.emplace(std::pair(truth, which), RayScene(scene_, truth, which)).first;
  return found->second;
}

std::vector<std::byte> FrameTracer::make(const MissingFrame& missing) {
  const FrameKey& key = missing.key;
  if (missing.light) {
    const GBuffer gbuffer = map_gbuffer(missing.gbuffer_file, key);
    if (missing.global_samples > 0) return global_reference(missing, gbuffer);
    return answer_kind(*missing.light) == AnswerKind::fraction ? soft_reference(missing, gbuffer) : reference(missing, gbuffer);
  }
  return gbuffer_bytes(make_gbuffer(scene_, everything(key.truth), key.view, key.width, key.height, key.truth));
}

std::span<const std::uint8_t> FrameTracer::silhouettes(const MissingFrame& missing, const GBuffer& g) {
  // A file's name is the hash of what it was made from.
  if (silhouettes_of_ != missing.gbuffer_file) {
    silhouettes_ = find_silhouettes(everything(missing.key.truth), g);
    silhouettes_of_ = missing.gbuffer_file;
  }
  return silhouettes_;
}

std::vector<std::byte> FrameTracer::reference(const MissingFrame& missing, const GBuffer& g) {
  const FrameKey& key = missing.key;
  const Light& light = *missing.light;
  std::vector<float> mask(g.size());
  trace_shadows(casters(key.truth), scene_, g, light, mask);
  const std::vector<PixelClass> classes = classify(scene_, casters(key.truth), g, light, mask, silhouettes(missing, g));
  std::vector<std::byte> bytes;
  append(bytes, std::span<const float>(mask));
  append(bytes, std::span<const std::uint32_t>(find_nearest_casters(scene_, casters(key.truth), g, light, mask)));
  append(bytes, std::span<const PixelClass>(classes));
  append(bytes, std::span<const std::uint8_t>(find_snapping(scene_, everything(key.truth), casters(key.truth), g, light, mask,
                                                            classes, missing.subpixel_bits)));
  return bytes;
}

std::vector<std::byte> FrameTracer::soft_reference(const MissingFrame& missing, const GBuffer& g) {
  const Light& light = *missing.light;
  const RayScene& all_casters = casters(missing.key.truth);
  const SoftReference soft = trace_soft(scene_, all_casters, g, light, silhouettes(missing, g), missing.target, missing.done);
  std::vector<std::byte> bytes;
  append(bytes, std::span<const float>(soft.area));
  append(bytes, std::span<const std::uint32_t>(find_nearest_casters(scene_, all_casters, g, light, soft.area)));
  for (const auto* floats : {&soft.irradiance, &soft.area_error, &soft.irradiance_error, &soft.area_half, &soft.irradiance_half,
                             &soft.caster_distance})
    append(bytes, std::span<const float>(*floats));
  append(bytes, std::span<const std::uint32_t>(soft.rays));
  append(bytes, std::span<const PixelClass>(soft.classes));
  bytes.resize(bytes.size() + g.size());  // snapping belongs to hard edges
  return bytes;
}

std::vector<std::byte> FrameTracer::global_reference(const MissingFrame& missing, const GBuffer& g) {
  if (const auto why = endless_bounces(scene_)) throw Error("{}", *why);
  if (!has_area(*missing.light) || missing.global_samples < ray_lanes)
    throw Error("all light of {} samples a pixel; {} or more of a light with area are wanted", missing.global_samples,
                ray_lanes);
  const LightSurfaces surfaces{scene_, everything(missing.key.truth), casters(missing.key.truth)};
  const PathOptions options{.samples = missing.global_samples, .seed = global_seed};
  const PathPicture picture = trace_paths(surfaces, g, *missing.light, options, missing.done);
  const std::uint64_t rays = picture.rays;
  std::vector<std::byte> bytes;
  for (const auto* floats : {&picture.radiance, &picture.error}) append(bytes, std::span<const float>(*floats));
  append(bytes, std::span<const std::uint64_t>(&rays, 1));
  return bytes;
}

GlobalReference FrameStore::global_reference(const FrameKey& key, const Light& light, int samples) {
  const std::string asked = fmt::format("{} global {} {}", hash(key, &light), global_version, samples);
  const std::string name = content_hash(asked) + ".reference";
  fs::path path = find(name, global_size(key));
  if (path.empty()) {
    const fs::path seen = gbuffer_file(key);
    path =
        make(name, {.scene_file = scene_file(), .key = key, .light = light, .gbuffer_file = seen, .global_samples = samples});
  }
  const auto file = MappedFile::copy(path);
  std::size_t offset = 0;
  GlobalReference reference;
  for (auto* floats : {&reference.radiance, &reference.error}) *floats = slice<float>(*file, offset, 3 * pixel_count(key));
  reference.rays = slice<std::uint64_t>(*file, offset, 1).front();
  reference.storage = file;
  return reference;
}

Reference FrameStore::reference(const FrameKey& key, const Light& light, const AreaTarget& target, int subpixel_bits) {
  require_reference(scene_, light, key.view);
  const std::string name = hash(key, &light, target, subpixel_bits) + ".reference";
  fs::path path = find(name, pixel_count(key) * reference_pixel(light));
  if (path.empty()) {
    const fs::path seen = gbuffer_file(key);
    path = make(name, {.scene_file = scene_file(),
                       .key = key,
                       .light = light,
                       .gbuffer_file = seen,
                       .target = target,
                       .subpixel_bits = subpixel_bits});
  }
  const auto file = MappedFile::copy(path);
  const std::size_t n = pixel_count(key);
  std::size_t offset = 0;
  Reference reference;
  reference.subpixel_bits = subpixel_bits;
  reference.kind = answer_kind(light);
  reference.mask = slice<float>(*file, offset, n);
  reference.nearest_caster = slice<std::uint32_t>(*file, offset, n);
  if (reference.kind == AnswerKind::fraction) {
    for (auto* floats : {&reference.irradiance, &reference.error, &reference.irradiance_error, &reference.half,
                         &reference.irradiance_half, &reference.caster_distance})
      *floats = slice<float>(*file, offset, n);
    reference.rays = slice<std::uint32_t>(*file, offset, n);
  }
  reference.classes = slice<PixelClass>(*file, offset, n);
  if (reference.kind == AnswerKind::binary) reference.snapping = slice<std::uint8_t>(*file, offset, n);
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
