#include "measure/program/program_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "measure/exchange/gltf.h"
#include "measure/picture/picture.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view mask_words[] = {"float32", "exr", "png"}, mask_names[] = {"mask.f32", "mask.exr", "mask.png"};

ScratchFolder fresh_folder() {
  const char* const named = std::getenv(program_folder_variable);
  if (named && *named) return ScratchFolder::in(fs::absolute(named), "program");  // the program runs in a folder of its own
  const fs::path memory = "/dev/shm";
  return access(memory.c_str(), W_OK) == 0 ? ScratchFolder::in(memory, "gnomon-program")
                                           : ScratchFolder::temporary("gnomon-program");
}

}  // namespace

ArrayHashes::ArrayHashes(const Arrays& arrays) {
  for (const auto& [name, array] : arrays) {
    const std::uint64_t hash = hash_of(array);
    by_name.emplace(name, hash);
    of_all = std::rotl(of_all, 1) ^ hash;
  }
}

Json ArrayFiles::write(const fs::path& folder, const std::string& what, const Arrays& arrays, const ArrayHashes& hashes) {
  Json json = json_object();
  for (const auto& [name, array] : arrays) {
    const std::uint64_t hash = hashes.by_name.at(name);
    const auto known = written_.find(name);
    if (known == written_.end() || known->second.hash != hash) {
      written_.erase(name);  // until it is written
      written_[name] = {hash, write_array(folder / fmt::format("{}_{}.npy", what, name), array)};
    }
    json[name] = written_[name].facts;
  }
  return json;
}

ProgramInputs::ProgramInputs(const ProgramDescription& description) : description_(description), folder_(fresh_folder()) {}

Json ProgramInputs::scene(const Scene& scene) {
  const SceneArrays all(scene);
  const Arrays arrays = all.arrays();
  Json facts = scene_facts_json(scene);
  const ArrayHashes hashes(arrays);
  const std::uint64_t hash = hashes.of_all ^ std::hash<std::string>()(json_text(facts));
  Json request = json_object({{"file", (folder() / "scene.json").string()}});
  if (description_.wants_gltf) request["gltf"] = (folder() / "scene.gltf").string();
  if (scene_hash_ == hash) return request;
  scene_hash_.reset();  // until all of it is written
  if (description_.wants_scene_arrays) facts["arrays"] = scene_files_.write(folder(), "scene", arrays, hashes);
  if (description_.wants_gltf) write_gltf(folder() / "scene.gltf", scene);
  if (std::string text = json_text(facts, 1) + "\n"; text != scene_text_) {
    scene_text_.clear();
    write_file(folder() / "scene.json", text);
    scene_text_ = std::move(text);
  }
  scene_hash_ = hash;
  return request;
}

Json ProgramInputs::gbuffer(const GBuffer& gbuffer) {
  const Arrays arrays = gbuffer_arrays(gbuffer);
  const ArrayHashes hashes(arrays);
  if (gbuffer_hash_ != hashes.of_all) {
    gbuffer_hash_.reset();
    gbuffer_ = json_object({{"width", gbuffer.width}, {"height", gbuffer.height}});
    if (description_.wants_gbuffer_arrays) gbuffer_["arrays"] = gbuffer_files_.write(folder(), "gbuffer", arrays, hashes);
    if (description_.wants_gbuffer_exr) {
      write_gbuffer_exr(folder() / "gbuffer.exr", gbuffer);
      gbuffer_["exr"] = (folder() / "gbuffer.exr").string();
    }
    gbuffer_hash_ = hashes.of_all;
  }
  gbuffer_["truth"] = name(gbuffer.truth);
  return gbuffer_;
}

ProgramMaskFile::ProgramMaskFile(ProgramMask kind, const fs::path& folder)
    : kind_(kind), file_(folder / mask_names[static_cast<int>(kind)]) {}

Json ProgramMaskFile::fresh(int width, int height) const {
  const std::size_t bytes = 4 * static_cast<std::size_t>(width) * height;
  Json request =
      json_object({{"file", file_.string()}, {"format", mask_words[static_cast<int>(kind_)]}, {"shape", {height, width}}});
  if (kind_ != ProgramMask::float32) {
    fs::remove(file_);
    return request;
  }
  const std::vector<std::byte> nothing(bytes, std::byte{0xff});
  const int descriptor = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const bool is_written = descriptor >= 0 && ftruncate(descriptor, static_cast<off_t>(bytes)) == 0 &&
                          pwrite(descriptor, nothing.data(), bytes, 0) == static_cast<ssize_t>(bytes);
  const int code = errno;
  if (descriptor >= 0) close(descriptor);
  if (!is_written) throw Error("{} cannot be written: {}", file_.string(), std::strerror(code));
  return request;
}

void ProgramMaskFile::read(VisibilityMask& mask) const {
  const std::span<float> pixels = mask.pixels();
  if (kind_ == ProgramMask::float32)
    read_numbers(pixels);
  else
    read_image(mask);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i] >= 0 && pixels[i] <= 1) continue;
    const bool is_left_out = std::bit_cast<std::uint32_t>(pixels[i]) == 0xffffffffu;
    throw Error("the mask's pixel ({}, {}) {}", i % static_cast<std::size_t>(mask.width()),
                i / static_cast<std::size_t>(mask.width()),
                is_left_out ? "was not written" : fmt::format("is {}, outside 0 .. 1", pixels[i]));
  }
}

void ProgramMaskFile::read_numbers(std::span<float> pixels) const {
  const int descriptor = open(file_.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat facts {};
  const bool is_there = descriptor >= 0 && fstat(descriptor, &facts) == 0;
  const auto size = is_there ? static_cast<std::size_t>(facts.st_size) : 0;
  const bool is_read = size == pixels.size_bytes() && pread(descriptor, pixels.data(), size, 0) == static_cast<ssize_t>(size);
  if (descriptor >= 0) close(descriptor);
  if (!is_there) throw Error("the mask {} is gone", file_.string());
  if (!is_read) throw Error("the mask has {} bytes; {} are wanted, four a pixel", size, pixels.size_bytes());
}

void ProgramMaskFile::read_image(VisibilityMask& mask) const {
  if (!fs::exists(file_)) throw Error("no mask was written to {}", file_.string());
  const auto [width, height] = image_files().exr_size(file_);
  if (width != mask.width() || height != mask.height())
    throw Error("the mask is {} x {}; {} x {} is required", width, height, mask.width(), mask.height());
  const std::vector<std::string> channels = image_files().exr_channels(file_);
  const std::vector<float> read = read_exr(file_, channels.at(0), width, height);
  std::ranges::copy(read, mask.pixels().begin());
}

}  // namespace gnomon
