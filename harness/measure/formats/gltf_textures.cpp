// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), 3.8 and 3.9; KHR_texture_transform; KHR_materials_transmission;
// EXT_texture_webp.
#include "measure/formats/gltf_textures.h"

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

GltfTextures::Sampled GltfTextures::sampled(const Json& texture, const std::string& where, Use use) {
  Sampled sampled;
  const auto index = file_.index(texture, where, "index");
  if (!index) throw Error("{}: {}: its texture has no index", file_.name(), where);
  const std::string place = fmt::format("texture {}", *index);
  const Json& item = file_.item("textures", *index);
  sampled.image = image(item, place, use);
  if (const auto sampler = file_.index(item, place, "sampler")) {
    const std::string sampler_place = fmt::format("sampler {}", *sampler);
    sampled.wrap_u = wrap(file_, file_.item("samplers", *sampler), sampler_place, "wrapS");
    sampled.wrap_v = wrap(file_, file_.item("samplers", *sampler), sampler_place, "wrapT");
  }
  return sampled;
}

ImportedMask GltfTextures::mask(const Json& material, const std::string& where, const GltfColor& color) {
  const Sampled alpha = sampled(*color.texture, where, for_mask);
  return {.image = alpha.image,
          .factor = static_cast<float>(color.factor.a),
          .cutoff = static_cast<float>(file_.number(material, where, "alphaCutoff", 0.5)),
          .wrap_u = alpha.wrap_u,
          .wrap_v = alpha.wrap_v};
}

/// Alpha counts where the material blends; a solid part of a mask and an opaque material have the alpha 1.
ImportedTransmission GltfTextures::transmission(const Json& material, const std::string& where, const GltfColor& color,
                                                const Json*& places) {
  ImportedTransmission result;
  const bool is_blended = file_.text(material, "alphaMode") == "BLEND", is_masked = places;
  const Json* const extension = file_.extension_of(material, "KHR_materials_transmission");
  if (extension) result.transmission = file_.number(*extension, where, "transmissionFactor", 0);
  if (is_blended) result.alpha = color.factor.a;

  bool is_first = true;
  const auto take = [&](std::uint32_t& image, const Json* texture) {
    if (!texture) return;
    const Sampled texels = sampled(*texture, where, for_transmission);
    if (texels.image == ImportedMask::no_image) return;
    if (!places) places = texture;
    const bool is_elsewhere = GltfTextureMap(file_, where, texture) != GltfTextureMap(file_, where, places);
    if (is_elsewhere || (!is_first && (texels.wrap_u != result.wrap_u || texels.wrap_v != result.wrap_v)))
      return void(elsewhere_.insert(texture));
    image = texels.image;
    result.wrap_u = texels.wrap_u;
    result.wrap_v = texels.wrap_v;
    is_first = false;
  };
  if (is_blended) take(result.alpha_image, color.texture);
  if (result.transmission == 0) {
    if (is_blended && color.texture && !result.is_there()) without_alpha_.insert(&material);
    return result;
  }

  const Json* const metal = object_in(material, "pbrMetallicRoughness");
  const bool is_glossy = file_.extension_of(material, "KHR_materials_pbrSpecularGlossiness");  // which has no metal
  if (!is_glossy) result.metallic = metal ? file_.number(*metal, where, "metallicFactor", 1) : 1;
  result.color = color.factor;
  take(result.color_image, color.texture);
  take(result.transmission_image, object_in(*extension, "transmissionTexture"));
  if (metal && result.metallic != 0) take(result.metallic_image, object_in(*metal, "metallicRoughnessTexture"));
  if (result.metallic == 1 && result.metallic_image == ImportedMask::no_image) of_metal_.insert(&material);
  for (const std::uint32_t image : {result.color_image, result.transmission_image, result.metallic_image})
    if (image != ImportedMask::no_image) answer_.mask_images[image].wants_colors = true;
  const Json* const volume = file_.extension_of(material, "KHR_materials_volume");
  if (volume && file_.number(*volume, where, "thicknessFactor", 0) != 0) with_volume_.insert(&material);
  if (is_masked) with_mask_.insert(&material);
  return result;
}

/// The image of PNG or JPEG, else that of WebP; other kinds are not read.
std::uint32_t GltfTextures::image(const Json& texture, const std::string& where, Use use) {
  auto source = file_.index(texture, where, "source");
  if (const Json* webp = file_.extension_of(texture, "EXT_texture_webp"); webp && !source)
    source = file_.index(*webp, where, "source");
  if (!source) {
    ++without_source_[use];
    return ImportedMask::no_image;
  }
  if (const auto known = known_.find(*source); known != known_.end()) return known->second;
  return known_[*source] = read_image(*source, use);
}

std::uint32_t GltfTextures::read_image(std::size_t index, Use use) {
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
  if (missing_[use]++ == 0) first_missing_[use] = uri.empty() ? where : path.filename().string();
  return ImportedMask::no_image;
}

void GltfTextures::note() {
  constexpr std::string_view images[] = {"masks", "transmission"},
                             without[] = {"the cards are solid", "the factors of their materials alone count"};
  for (const Use use : {for_mask, for_transmission}) {
    answer_.note(missing_[use], fmt::format("image{{s}} of {} {{is|are}} not there", images[use]),
                 fmt::format(" ('{}' is one); {}", first_missing_[use], without[use]));
    answer_.note(without_source_[use],
                 fmt::format("texture{{s}} of {} {{has|have}} no image of a kind that is read; {}", images[use], without[use]));
  }
  answer_.note(elsewhere_.size(),
               "texture{s} of transmission {has|have} other places or another wrap than the color's; "
               "{its factor alone counts|their factors alone count}");
  answer_.note(without_alpha_.size(),
               "material{s} of alphaMode BLEND {has|have} an alpha of 1 without the image; {it is|they are} opaque");
  answer_.note(
      of_metal_.size(),
      "material{s} {has|have} KHR_materials_transmission and a metallicFactor of 1, the format's default: metal transmits no "
      "light; glass has metallicFactor 0");
  answer_.note(with_mask_.size(), "material{s} {has|have} a mask and KHR_materials_transmission; what is solid transmits");
  answer_.note(
      with_volume_.size(),
      "material{s} {has|have} a volume (KHR_materials_volume) and {is read as a thin surface|are read as thin surfaces}");
}

}  // namespace gnomon::importing
