// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), 3.8 and 3.9; KHR_texture_transform; EXT_texture_webp.
#include "measure/formats/gltf_mask.h"

#include <cmath>

#include "measure/formats/readers.h"

namespace gnomon::importing {

namespace fs = std::filesystem;

GltfTextureMap::GltfTextureMap(const GltfFile& file, const std::string& where, const Json* texture) {
  if (!texture) return;
  set_ = file.index(*texture, where, "texCoord").value_or(0);
  const Json* transform = file.extension_of(*texture, "KHR_texture_transform");
  if (!transform) return;
  set_ = file.index(*transform, where, "texCoord").value_or(set_);
  rotation_ = file.number(*transform, where, "rotation", 0);
  if (const auto offset = file.numbers(*transform, where, "offset", 2); !offset.empty()) offset_ = {offset[0], offset[1]};
  if (const auto scale = file.numbers(*transform, where, "scale", 2); !scale.empty()) scale_ = {scale[0], scale[1]};
}

/// Scaled, then turned counter-clockwise as seen with v downwards, then moved. The extension's first example fixes the
/// direction: offset (0, 1), a quarter turn and scale 1/2 give the lower left quarter of the image.
std::vector<glm::vec2> GltfTextureMap::uv(const Numbers& numbers) const {
  const double c = std::cos(rotation_), s = std::sin(rotation_);
  std::vector<glm::vec2> places(numbers.count);
  for (std::size_t i = 0; i < numbers.count; ++i) {
    const double u = scale_.x * numbers.at(i, 0), v = scale_.y * numbers.at(i, 1);
    places[i] = rotation_ == 0 ? glm::dvec2(u, v) + offset_ : glm::dvec2(c * u + s * v, c * v - s * u) + offset_;
  }
  return places;
}

namespace {

AlphaMask::Wrap wrap(const GltfFile& file, const Json& sampler, const std::string& where, const char* key) {
  constexpr std::size_t repeat = 10497, mirrored = 33648, clamped = 33071;
  const std::size_t mode = file.index(sampler, where, key).value_or(repeat);
  if (mode == repeat) return AlphaMask::Wrap::repeat;
  if (mode == mirrored) return AlphaMask::Wrap::mirror;
  if (mode == clamped) return AlphaMask::Wrap::clamp;
  throw Error("{}: {}: {} = {} is none of {}, {}, {}", file.name(), where, key, mode, repeat, mirrored, clamped);
}

}  // namespace

ImportedMask GltfMasks::mask(const Json& material, const std::string& where, const Json& texture, double factor) {
  ImportedMask mask;
  const auto index = file_.index(texture, where, "index");
  if (!index) throw Error("{}: {}: its texture has no index", file_.name(), where);
  const std::string place = fmt::format("texture {}", *index);
  const Json& item = file_.item("textures", *index);
  mask.image = image(item, place);
  mask.factor = static_cast<float>(factor);
  mask.cutoff = static_cast<float>(file_.number(material, where, "alphaCutoff", 0.5));
  if (const auto sampler = file_.index(item, place, "sampler")) {
    const std::string sampler_place = fmt::format("sampler {}", *sampler);
    mask.wrap_u = wrap(file_, file_.item("samplers", *sampler), sampler_place, "wrapS");
    mask.wrap_v = wrap(file_, file_.item("samplers", *sampler), sampler_place, "wrapT");
  }
  return mask;
}

/// The image of PNG or JPEG, else that of WebP; other kinds are not read.
std::uint32_t GltfMasks::image(const Json& texture, const std::string& where) {
  auto source = file_.index(texture, where, "source");
  if (const Json* webp = file_.extension_of(texture, "EXT_texture_webp"); webp && !source)
    source = file_.index(*webp, where, "source");
  if (!source) {
    ++without_source_;
    return ImportedMask::no_image;
  }
  if (const auto known = known_.find(*source); known != known_.end()) return known->second;
  return known_[*source] = read_image(*source);
}

ImportedMask GltfMasks::broken(const std::string& where, const std::string& why) {
  MaskImage& image = answer_.mask_images.emplace_back();
  image.name = where;
  image.failure = why;
  ImportedMask mask;
  mask.image = static_cast<std::uint32_t>(answer_.mask_images.size() - 1);
  return mask;
}

std::uint32_t GltfMasks::read_image(std::size_t index) {
  const std::string where = fmt::format("image {}", index), name = fmt::format("{}: {}", file_.name(), where);
  const Json& image = file_.item("images", index);
  const std::string uri = file_.text(image, "uri");
  std::optional<std::string> bytes = bytes_in_address(name, uri);
  if (const auto view = file_.index(image, where, "bufferView"); view && !bytes) bytes = std::string(file_.bytes(*view));
  if (bytes) {
    MaskImage& image_inside = answer_.mask_images.emplace_back();
    image_inside.name = name;
    image_inside.bytes = std::move(*bytes);
    return static_cast<std::uint32_t>(answer_.mask_images.size() - 1);
  }
  const fs::path path = file_beside(file_.name(), uri);
  std::error_code code;
  if (!uri.empty() && fs::exists(path, code)) return add_image_file(answer_, path, read_, false);
  if (missing_++ == 0) first_missing_ = uri.empty() ? where : path.filename().string();
  return ImportedMask::no_image;
}

void GltfMasks::note() {
  answer_.note(missing_, fmt::format("images of masks are not there ('{}' is one); the cards are solid", first_missing_));
  answer_.note(without_source_, "textures of masks have no image of a kind that is read; the cards are solid");
}

}  // namespace gnomon::importing
