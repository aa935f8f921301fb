#include "measure/scene/import_masks.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "measure/counted.h"
#include "measure/scene/base_scene.h"

namespace gnomon {

namespace fs = std::filesystem;
using namespace importing;

namespace {

bool is_equal(const AlphaMask& a, const AlphaMask& b) {
  return a.width() == b.width() && a.height() == b.height() && a.wrap_u() == b.wrap_u() && a.wrap_v() == b.wrap_v() &&
         a.factor() == b.factor() && a.cutoff() == b.cutoff() && std::ranges::equal(a.bits(), b.bits()) &&
         std::ranges::equal(a.alpha(), b.alpha());
}

/// One object for equal masks of a scene.
std::shared_ptr<const AlphaMask> shared(AlphaMask mask, const Scene& scene) {
  const AlphaMask* last = nullptr;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.alpha_mask || mesh.alpha_mask.get() == last) continue;
    last = mesh.alpha_mask.get();
    if (is_equal(*last, mask)) return mesh.alpha_mask;
  }
  return std::make_shared<const AlphaMask>(std::move(mask));
}

}  // namespace

std::shared_ptr<const AlphaMask> read_alpha_mask(const fs::path& file, double cutoff, int scale, const Scene& scene) {
  const MaskImage image = read_mask_image(file);
  try {
    return shared(AlphaMask(image.width, image.height, image.alpha, 1, static_cast<float>(cutoff), AlphaMask::Wrap::repeat,
                            AlphaMask::Wrap::repeat, scale),
                  scene);
  } catch (const Error& error) {
    throw Error("{}: {}", file.string(), error.what());
  }
}

void importing::check_readable(const fs::path& file, std::string_view what) {
  const std::string name = file.string();
  if (!fs::exists(file)) throw Error("{}: does not exist", name);
  if (fs::is_directory(file)) throw Error("{}: is a directory, not {}", name, what);
  if (!fs::is_regular_file(file)) throw Error("{}: is not a regular file", name);
  if (!std::ifstream(file)) throw Error("{}: cannot be read (permissions)", name);
  if (fs::file_size(file) == 0) throw Error("{}: is empty", name);
}

MaskImage importing::read_mask_image(const fs::path& file, bool with_colors) {
  check_readable(file, "an image");
  if (has_mesh_format(file)) throw Error("{}: is a mesh file, not an image", file.string());
  const std::vector<std::byte> answer = answer_of_child(file, with_colors);
  FieldReader reader(answer, file.string() + ": the importer's answer breaks off");
  MeshFile raw;
  visit_file(reader, raw);
  if (!raw.failure.empty()) throw Error("{}", raw.failure);
  if (raw.mask_images.size() != 1) throw Error("{}: the importer gave {} images, not 1", file.string(), raw.mask_images.size());
  MaskImage& image = raw.mask_images.front();
  if (!image.failure.empty()) throw Error("{}", image.failure);
  return std::move(image);
}

FileMasks::FileMasks(const fs::path& file, const MeshFile& raw, const MaskChoice& choice, const Scene& scene)
    : file_(file.string()), raw_(raw), choice_(choice), scene_(scene) {
  if (choice.are_used && choice.image) chosen_ = read_mask_image(*choice.image);
}

std::shared_ptr<const AlphaMask> FileMasks::made(const MaskImage& image, const ImportedMask& mask) const {
  return shared(
      AlphaMask(image.width, image.height, image.alpha, mask.factor, mask.cutoff, mask.wrap_u, mask.wrap_v, choice_.scale),
      scene_);
}

std::shared_ptr<const AlphaMask> FileMasks::mask(const std::string& where, const ImportedMesh& mesh) {
  if (!choice_.are_used || (!chosen_ && !mesh.mask.has_image())) return nullptr;
  ImportedMask settings = chosen_ ? ImportedMask{} : mesh.mask;
  if (choice_.cutoff) settings.cutoff = static_cast<float>(*choice_.cutoff);
  if (!chosen_ && settings.image >= raw_.mask_images.size())
    throw Error("{}: names image {} of {}", where, settings.image, raw_.mask_images.size());
  const MaskImage& image = chosen_ ? *chosen_ : raw_.mask_images[settings.image];
  if (!image.failure.empty()) throw Error("{}: its mask: {}{}", where, image.failure, choice_.hint);
  if (settings.wrap_u > AlphaMask::Wrap::clamp || settings.wrap_v > AlphaMask::Wrap::clamp)
    throw Error("{}: its mask wraps in no known way", where);
  if (image.alpha.empty()) {
    ++without_alpha_;
    return nullptr;
  }
  const Settings key{settings.image, settings.factor, settings.cutoff, settings.wrap_u, settings.wrap_v};
  auto known = known_.find(key);
  try {
    if (known == known_.end()) {
      const std::shared_ptr<const AlphaMask> mask = made(image, settings);
      known = known_.emplace(key, MadeMask{mask, mask->coverage()}).first;
    }
  } catch (const Error& error) {
    throw Error("{}: {} ({})", where, error.what(), image.name);
  }
  ++masked_;
  const auto& [mask, coverage] = known->second;
  without_solid_ += coverage == 0;
  if (coverage < 1) return mask;
  ++without_hole_;
  return nullptr;
}

void FileMasks::finish(const std::string& name, Scene& scene) const {
  if (masked_ == 0 && (choice_.cutoff || choice_.scale != 1))
    throw Error("{}: has no mesh with a mask; a cutoff and a scale are of masks", file_);
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{}: {}", name, counted(count, what)));
  };
  note(without_alpha_, "mesh{es} {has|have} a mask whose image has no alpha; {it is|they are} solid");
  note(without_hole_, "mesh{es} {has|have} a mask without a hole; {it is|they are} solid");
  note(without_solid_, "mesh{es} {has|have} a mask without a solid texel; {it stops|they stop} no light");
  note(masked_duplicates_,
       "triangle{s} of masked meshes {is an exact duplicate of another and is|are exact duplicates of others and are} merged");
  note(other_duplicates_,
       "triangle{s} of meshes that let light through {is an exact duplicate of another and is|are exact duplicates of others "
       "and are} merged");
}

/// The same three vertices in any order: winding never decides.
std::vector<bool> importing::find_duplicates(std::span<const glm::uvec3> triangles) {
  const std::size_t count = triangles.size();
  std::vector<glm::uvec3> sorted(triangles.begin(), triangles.end());
  for (glm::uvec3& t : sorted) std::sort(&t.x, &t.x + 3);
  const auto less = [&](std::size_t a, std::size_t b) {
    const glm::uvec3 &s = sorted[a], &t = sorted[b];
    return std::tie(s.x, s.y, s.z, a) < std::tie(t.x, t.y, t.z, b);
  };
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, less);
  std::vector<bool> is_again(count);
  for (std::size_t k = 1; k < count; ++k) {
    const glm::uvec3& t = sorted[order[k]];
    is_again[order[k]] = t == sorted[order[k - 1]] && t.x != t.y && t.y != t.z;
  }
  return is_again;
}

void FileMasks::drop_duplicates(Mesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<bool> is_again = find_duplicates(mesh.triangles);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!is_again[i]) mesh.triangles[kept++] = mesh.triangles[i];
  (mesh.alpha_mask ? masked_duplicates_ : other_duplicates_) += count - kept;
  mesh.triangles.resize(kept);
}

void importing::check_uv(const std::string& where, const ImportedMesh& mesh, std::span<const std::uint8_t> used, bool is_masked,
                         std::string_view hint) {
  const auto refuse = [&](std::size_t v, const std::string& problem) {
    throw Error("{}, vertex {}: {}; a mesh with a {} needs them within {}{}", where, v, problem,
                is_masked ? "mask" : "transmission of an image", uv_range, hint);
  };
  if (!mesh.uv.empty() && mesh.uv.size() != mesh.positions.size())
    throw Error("{}: {} vertices have {} texture coordinates", where, mesh.positions.size(), mesh.uv.size());
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    if (mesh.uv.empty() || (std::isnan(mesh.uv[v].x) && std::isnan(mesh.uv[v].y))) refuse(v, "has no texture coordinates");
    if (!is_sound_uv(mesh.uv[v])) refuse(v, fmt::format("uv = ({}, {})", mesh.uv[v].x, mesh.uv[v].y));
  }
}

std::vector<std::uint32_t> importing::weld_places(std::span<const std::uint32_t> welded, std::span<const glm::vec2> uv,
                                                  std::span<const std::uint8_t> used) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < welded.size(); ++v)
    if (used[v]) order.push_back(v);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(welded[a], uv[a].x, uv[a].y, a) < std::tie(welded[b], uv[b].x, uv[b].y, b);
  };
  std::ranges::sort(order, less);
  std::vector<std::uint32_t> first(welded.begin(), welded.end());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::uint32_t v = order[k], before = k > 0 ? order[k - 1] : v;
    first[v] = k > 0 && welded[v] == welded[before] && uv[v] == uv[before] ? first[before] : v;
  }
  return first;
}

}  // namespace gnomon
