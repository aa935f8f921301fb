#include "measure/frame/frame.h"

#include <gnomon/kit/area/path_light.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "measure/frame/light_rays.h"

namespace gnomon {

namespace fs = std::filesystem;

bool has_radiance(const Light& light) { return has_area(light); }

namespace {

/// Raised when `find_snapping` answers otherwise. It names files of references and no version of the frames: masks and causes
/// stay as they were.
constexpr int snapping_version = 1;

/// Appends the arrays one after the other.
template <class... Array>
void append(std::vector<std::byte>& bytes, const Array&... arrays) {
  for (const std::span<const std::byte> view : {std::span<const std::byte>(std::as_bytes(std::span(arrays)))...})
    bytes.insert(bytes.end(), view.begin(), view.end());
}

/// Bytes of a pixel in the cache: six floats and two ids; a float, a mesh, a class and a flag, behind transmission a count
/// more, and of a light with area six floats and a number more.
constexpr std::size_t gbuffer_pixel = 32, hard_pixel = 10, transmitted_pixel = 11, soft_pixel = 38;
std::size_t reference_pixel(AnswerKind kind) {
  return kind == AnswerKind::fraction ? soft_pixel : kind == AnswerKind::transmitted ? transmitted_pixel : hard_pixel;
}

/// Raised when references of scenes with transmission hold other things.
constexpr int glass_version = 3;

/// Raised when trace_soft answers otherwise.
constexpr int soft_version = 4;

/// Raised when trace_paths answers otherwise.
constexpr int global_version = 1;

/// Raised when trace_pixels answers otherwise.
constexpr int pixel_version = 1;

/// Of the paths of a GlobalReference: no technique has it, so that none is compared with its own paths.
constexpr std::uint64_t global_seed = 0x7fffffff;

/// Raised when what files hold for the same frame changes. It names them, so that builds before and after keep their own.
constexpr int file_layout = 2;

std::size_t pixel_count(const FrameKey& key) { return static_cast<std::size_t>(key.width) * key.height; }

/// Bytes of a GlobalReference: of a pixel two floats a channel, then the number of rays.
std::size_t global_size(const FrameKey& key) { return pixel_count(key) * 6 * sizeof(float) + sizeof(std::uint64_t); }

/// Bytes of a pixel of a PixelTruth: three floats and a count.
constexpr std::size_t pixel_truth_pixel = 13;

std::size_t size_of(const Scene& scene, const MissingFrame& missing) {
  if (missing.global_samples > 0) return global_size(missing.key);
  if (missing.pixel_rays > 0) return pixel_count(missing.key) * pixel_truth_pixel;
  return pixel_count(missing.key) * (missing.light ? reference_pixel(answer_kind(scene, *missing.light)) : gbuffer_pixel);
}

std::vector<std::byte> gbuffer_bytes(const GBuffer& g) {
  std::vector<std::byte> bytes;
  bytes.reserve(g.size() * gbuffer_pixel + hash_size);
  append(bytes, g.px, g.py, g.pz, g.nx, g.ny, g.nz, g.mesh, g.triangle);
  return bytes;
}

/// The inverse: arrays of a file, one after the other.
struct Slices {
  std::span<const std::byte> left;

  /// The next ones, of `count` items each.
  template <class... T>
  void operator()(std::size_t count, std::span<const T>&... arrays) {
    (take(count, arrays), ...);
  }

 private:
  template <class T>
  void take(std::size_t count, std::span<const T>& array) {
    if (count * sizeof(T) > left.size()) throw Error("a file of the frame cache is too short");
    array = {reinterpret_cast<const T*>(left.data()), count};
    left = left.subspan(array.size_bytes());
  }
};

}  // namespace

int frame_version() { return 8; }

FrameStore::FrameStore(const Scene& scene, fs::path folder, std::unique_ptr<FrameMaker> maker)
    : scene_(scene), files_(std::move(folder)), maker_(std::move(maker)) {}

const std::string& FrameStore::scene_hash(const std::vector<std::string>& lights, WithMotion with_motion) {
  const auto [found, is_new] = hashes_.try_emplace({lights, with_motion});
  if (!is_new) return found->second;
  found->second = scene_.motion ? gnomon::scene_hash(scene_from_bytes(scene_bytes_), lights, with_motion)
                                : gnomon::scene_hash(scene_, lights);
  return found->second;
}

void FrameStore::require_pose(const FrameKey& key) {
  if (!key.pose && (!scene_.motion || scene_.pose_number == rest_number_)) return;
  if (hash_now_.empty() || hashed_number_ != scene_.pose_number) {
    hash_now_ = pose_hash(scene_);
    hashed_number_ = scene_.pose_number;
  }
  const std::string& wanted = key.pose ? key.pose->hash : rest_hash_;
  if (hash_now_ == wanted) return;
  const std::string at =
      key.pose ? fmt::format("at {} s of animation {}", key.pose->at.seconds, key.pose->at.animation) : "at rest";
  throw Error("a frame of scene {} {} is wanted while its meshes are elsewhere: their positions have the hash {}, {} is wanted",
              scene_.name, at, hash_now_, wanted);
}

fs::path FrameStore::find_or_make(const std::string& name, MissingFrame missing) {
  require_pose(missing.key);
  const std::size_t size = size_of(scene_, missing);
  if (const fs::path file = files_.find(name, size + hash_size, ends_with_own_hash); !file.empty()) return file;
  if (missing.light) missing.gbuffer_file = gbuffer_file(missing.key);
  missing.scene_file = scene_file();
  std::vector<std::byte> bytes = maker_ ? maker_->make(missing) : tracer_.make(missing);
  if (bytes.size() != size) throw Error("a frame was made with {} bytes; {} are required", bytes.size(), size);
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
  // By positions alone: where two animations meet, they share a frame. Which exact shapes are left, positions do not tell.
  if (key.pose) fingerprint.name += fmt::format(" pose {}", key.pose->hash);
  if (key.pose && scene_.has_curved_shapes()) fingerprint.name += fmt::format(" of {}", key.pose->at.animation);
  if (light) {
    const bool is_soft = has_area(*light);
    fingerprint.name +=
        is_soft ? fmt::format(" soft {} {} {}", soft_version, target.error, target.cap) : fmt::format(" {}", snapping_version);
    if (scene_.has_transmission()) fingerprint.name += fmt::format(" glass {}", glass_version);
    if (!is_soft && subpixel_bits != usual_subpixel_bits) fingerprint.name += fmt::format(" {} bits", subpixel_bits);
    fingerprint.lights = {*light};
  }
  return content_hash(scene_bytes(fingerprint));
}

fs::path FrameStore::gbuffer_file(const FrameKey& key) { return find_or_make(hash(key, nullptr) + ".gbuffer", {.key = key}); }

GBuffer FrameStore::gbuffer(const FrameKey& key) { return copy_gbuffer(gbuffer_file(key), key); }

void write_gbuffer(const fs::path& file, const GBuffer& gbuffer) { write_file(file, gbuffer_bytes(gbuffer)); }

namespace {

GBuffer gbuffer_of(const std::shared_ptr<const MappedFile>& file, const fs::path& path, const FrameKey& key) {
  const std::size_t n = pixel_count(key);
  // A viewer's has no hash. Of another size, ids would be read from where coordinates lie.
  if (const std::size_t size = file->bytes().size(); size != n * gbuffer_pixel && size != n * gbuffer_pixel + hash_size)
    throw Error("{} has {} bytes, not those of {}x{} pixels", path.string(), size, key.width, key.height);
  GBuffer g{key.view, key.truth, key.width, key.height, {}, {}, {}, {}, {}, {}, {}, {}, file};
  Slices{file->bytes()}(n, g.px, g.py, g.pz, g.nx, g.ny, g.nz, g.mesh, g.triangle);
  return g;
}

}  // namespace

GBuffer map_gbuffer(const fs::path& path, const FrameKey& key) { return gbuffer_of(MappedFile::open(path), path, key); }

GBuffer copy_gbuffer(const fs::path& path, const FrameKey& key) { return gbuffer_of(MappedFile::copy(path), path, key); }

void FrameTracer::follow_pose() {
  std::vector<bool> is_curved;
  for (const Mesh& mesh : scene_.meshes) is_curved.push_back(mesh.has_curved_shape());
  if (pose_number_ == scene_.pose_number && is_curved_ == is_curved) return;
  rays_.clear();
  silhouettes_of_.clear();
  pose_number_ = scene_.pose_number;
  is_curved_ = std::move(is_curved);
}

const RayScene& FrameTracer::rays(Truth truth, RayScene::Which which) {
  follow_pose();
  if (!scene_.has_curved_shapes()) truth = Truth::mesh;
  const auto does_both = [](const Mesh& mesh) { return mesh.casts && mesh.seen; };
  if (std::ranges::all_of(scene_.meshes, does_both)) which = RayScene::Which::casters;
  auto found = rays_.find({truth, which});
  if (found == rays_.end()) found = rays_.emplace(std::pair(truth, which), RayScene(scene_, truth, which)).first;
  return found->second;
}

FrameTracer& FrameTracer::of(const Light& light) {
  const Scene& found = scene(light);
  if (&found == &scene_) return *this;
  std::unique_ptr<FrameTracer>& tracer = tracers_[&found];
  if (!tracer) tracer = std::make_unique<FrameTracer>(found);
  return *tracer;
}

std::vector<std::byte> FrameTracer::make(const MissingFrame& missing) {
  const FrameKey& key = missing.key;
  if (missing.light) {
    if (FrameTracer& tracer = of(*missing.light); &tracer != this) return tracer.make(missing);
    const GBuffer gbuffer = map_gbuffer(missing.gbuffer_file, key);
    if (missing.global_samples > 0) return global_reference(missing, gbuffer);
    if (missing.pixel_rays > 0) return pixel_truth(missing, gbuffer);
    return has_area(*missing.light) ? soft_reference(missing, gbuffer) : reference(missing, gbuffer);
  }
  return gbuffer_bytes(make_gbuffer(scene_, everything(key.truth), key.view, key.width, key.height, key.truth));
}

std::span<const std::uint8_t> FrameTracer::silhouettes(const MissingFrame& missing, const GBuffer& g) {
  follow_pose();
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
  std::vector<std::uint8_t> surfaces(answer_kind(scene_, light) == AnswerKind::transmitted ? g.size() : 0);
  trace_shadows(casters(key.truth), scene_, g, light, mask, surfaces);
  const std::vector<PixelClass> classes = classify(scene_, casters(key.truth), g, light, mask, silhouettes(missing, g));
  std::vector<std::byte> bytes;
  append(bytes, mask, find_nearest_casters(scene_, casters(key.truth), g, light, mask), classes,
         find_snapping(scene_, everything(key.truth), casters(key.truth), g, light, mask, classes, missing.subpixel_bits),
         surfaces);
  return bytes;
}

std::vector<std::byte> FrameTracer::soft_reference(const MissingFrame& missing, const GBuffer& g) {
  const Light& light = *missing.light;
  const RayScene& all_casters = casters(missing.key.truth);
  const SoftReference soft = trace_soft(scene_, all_casters, g, light, silhouettes(missing, g), missing.target, missing.done);
  std::vector<std::byte> bytes;
  append(bytes, soft.area, find_nearest_casters(scene_, all_casters, g, light, soft.area), soft.irradiance, soft.area_error,
         soft.irradiance_error, soft.area_half, soft.irradiance_half, soft.caster_distance, soft.rays, soft.classes);
  bytes.resize(bytes.size() + g.size());  // snapping belongs to hard edges
  return bytes;
}

std::vector<std::byte> FrameTracer::global_reference(const MissingFrame& missing, const GBuffer& g) {
  if (const auto why = untraceable_light(scene_)) throw Error("{}", *why);
  if (!has_area(*missing.light) || missing.global_samples < ray_lanes)
    throw Error("all light of {} samples a pixel; {} or more of a light with area are required", missing.global_samples,
                ray_lanes);
  const LightSurfaces surfaces{scene_, everything(missing.key.truth), casters(missing.key.truth)};
  const PathOptions options{.samples = missing.global_samples, .seed = global_seed};
  const PathPicture picture = trace_paths(surfaces, g, *missing.light, options, missing.done);
  std::vector<std::byte> bytes;
  append(bytes, picture.radiance, picture.error, std::array<std::uint64_t, 1>{picture.rays});
  return bytes;
}

std::vector<std::byte> FrameTracer::pixel_truth(const MissingFrame& missing, const GBuffer& g) {
  if (has_area(*missing.light) || missing.pixel_rays != pixel_rays)
    throw Error("the truth over the pixel by {} eye rays; {} under a light without area are required", missing.pixel_rays,
                pixel_rays);
  const Truth truth = missing.key.truth;
  const PixelShares shares = trace_pixels(scene_, everything(truth), casters(truth), g, *missing.light, missing.done);
  std::vector<std::byte> bytes;
  append(bytes, shares.mean, shares.error, shares.half, shares.kept);
  return bytes;
}

PixelTruth FrameStore::pixel_truth(const FrameKey& key, const Light& light) {
  require_reference(scene(light), light, key.view);
  const std::string request = fmt::format("{} pixel {} {}", hash(key, &light), pixel_version, pixel_rays);
  const MissingFrame frame{.key = key, .light = light, .pixel_rays = pixel_rays};
  const auto file = MappedFile::copy(find_or_make(content_hash(request) + ".reference", frame));
  Slices slices{file->bytes()};
  PixelTruth truth{.storage = file};
  const std::size_t n = pixel_count(key);
  slices(n, truth.mean, truth.error, truth.half);
  slices(n, truth.kept);
  return truth;
}

GlobalReference FrameStore::global_reference(const FrameKey& key, const Light& light, int samples) {
  const std::string request = fmt::format("{} global {} {}", hash(key, &light), global_version, samples);
  const MissingFrame frame{.key = key, .light = light, .global_samples = samples};
  const auto file = MappedFile::copy(find_or_make(content_hash(request) + ".reference", frame));
  Slices slices{file->bytes()};
  GlobalReference reference{.storage = file};
  slices(3 * pixel_count(key), reference.radiance, reference.error);
  std::span<const std::uint64_t> rays;
  slices(1, rays);
  reference.rays = rays.front();
  return reference;
}

Reference FrameStore::reference(const FrameKey& key, const Light& light, const AreaTarget& target, int subpixel_bits) {
  require_reference(scene(light), light, key.view);
  const std::string name = hash(key, &light, target, subpixel_bits) + ".reference";
  const MissingFrame frame{.key = key, .light = light, .target = target, .subpixel_bits = subpixel_bits};
  const auto file = MappedFile::copy(find_or_make(name, frame));
  const std::size_t n = pixel_count(key);
  Slices slices{file->bytes()};
  Reference r{.storage = file, .subpixel_bits = subpixel_bits, .kind = answer_kind(scene_, light)};
  slices(n, r.mask, r.nearest_caster);
  if (r.kind == AnswerKind::fraction)
    slices(n, r.irradiance, r.error, r.irradiance_error, r.half, r.irradiance_half, r.caster_distance, r.rays);
  slices(n, r.classes);
  if (r.kind != AnswerKind::fraction) slices(n, r.snapping);
  if (r.kind == AnswerKind::transmitted) slices(n, r.surfaces);
  return r;
}

Support reference_support(const Scene& scene, const Light& light, const View& view) {
  const Support support = support_of(registry().reference().about, *registry().reference().make(), scene, light, view);
  return support ? support : Support::unsupported(fmt::format("the reference has no answer: {}", support.why()));
}

void require_reference(const Scene& scene, const Light& light, const View& view) {
  if (const Support support = reference_support(scene, light, view); !support)
    throw Error("scene {}, light {}: {}", scene.name, light.name, support.why());
}

}  // namespace gnomon
