#include "measure/scene/import_transmission.h"

#include <algorithm>
#include <array>

#include "measure/counted.h"
#include "measure/scene/byte_shares.h"

namespace gnomon {

namespace fs = std::filesystem;
using namespace importing;

namespace {

/// One channel of an image on a grid that may be finer: nearest. 1 everywhere without an image.
struct ImageChannel {
  const std::vector<std::uint8_t>* bytes = nullptr;
  std::size_t width = 1, height = 1, stride = 1, channel = 0;
  const ByteShares* shares = nullptr;

  double at(std::size_t x, std::size_t y, const glm::ivec2& grid) const {
    if (!bytes) return 1;
    const std::size_t column = (2 * x + 1) * width / (2 * static_cast<std::size_t>(grid.x)),
                      row = (2 * y + 1) * height / (2 * static_cast<std::size_t>(grid.y));
    return (*shares)[(*bytes)[(row * width + column) * stride + channel]];
  }
};

/// Whether a factor times these bytes is the factor, so that they need not make a grid finer.
bool is_white(const std::vector<std::uint8_t>& bytes, std::size_t first, std::size_t stride) {
  for (std::size_t k = first; k < bytes.size(); k += stride)
    if (bytes[k] != 255) return false;
  return true;
}

/// Alpha; nothing of an image without alpha, which is solid.
ImageChannel alpha_channel(const MaskImage* image) {
  if (!image || is_white(image->alpha, 0, 1)) return {};
  return {&image->alpha, std::size_t(image->width), std::size_t(image->height), 1, 0, &linear_shares()};
}
ImageChannel color_channel(const MaskImage* image, std::size_t channel, const ByteShares& shares) {
  if (!image || is_white(image->colors, channel, 3)) return {};
  return {&image->colors, std::size_t(image->width), std::size_t(image->height), 3, channel, &shares};
}

bool is_everywhere(const Transmission& transmission, float share) {
  return transmission.is_constant() && transmission.at(0, 0) == glm::vec3(share);
}

/// One object for equal ones of a scene.
std::shared_ptr<const Transmission> shared(Transmission transmission, const Scene& scene) {
  const Transmission* last = nullptr;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.transmission || mesh.transmission.get() == last) continue;
    last = mesh.transmission.get();
    if (*last == transmission) return mesh.transmission;
  }
  return std::make_shared<const Transmission>(std::move(transmission));
}

/// Throws Error where a grid has more numbers than a transmission may have, before memory is taken.
void check_value_count(const glm::ivec2& size, std::size_t channels) {
  const std::size_t count = std::size_t(size.x) * std::size_t(size.y) * channels;
  if (count > Transmission::most_values)
    throw Error("a transmission of {} x {} texels has {} numbers; at most {} are allowed", size.x, size.y, count,
                Transmission::most_values);
}

}  // namespace

std::shared_ptr<const Transmission> read_transmission_image(const fs::path& file, const Scene& scene) {
  const MaskImage image = read_mask_image(file, true);
  try {
    const bool is_gray = [&] {
      for (std::size_t k = 0; k < image.colors.size(); k += 3)
        if (image.colors[k] != image.colors[k + 1] || image.colors[k] != image.colors[k + 2]) return false;
      return true;
    }();
    const std::size_t channels = is_gray ? 1 : 3, texels = image.colors.size() / 3;
    check_value_count({image.width, image.height}, channels);
    std::vector<float> values(channels * texels);
    for (std::size_t k = 0; k < texels; ++k)
      for (std::size_t c = 0; c < channels; ++c)
        values[k * channels + c] = static_cast<float>(linear_shares()[image.colors[3 * k + c]]);
    return shared(Transmission(image.width, image.height, static_cast<int>(channels), std::move(values)), scene);
  } catch (const Error& error) {
    throw Error("{}: {}", file.string(), error.what());
  }
}

FileTransmissions::FileTransmissions(const MeshFile& raw, const TransmissionChoice& choice, const Scene& scene)
    : raw_(raw), choice_(choice), scene_(scene) {
  if (choice.image)
    chosen_ = read_transmission_image(*choice.image, scene);
  else if (choice.everywhere)
    chosen_ = shared(Transmission(*choice.everywhere), scene);
}

const MaskImage* FileTransmissions::image(const std::string& where, std::uint32_t number) const {
  if (number == ImportedTransmission::no_image) return nullptr;
  if (number >= raw_.mask_images.size()) throw Error("{}: names image {} of {}", where, number, raw_.mask_images.size());
  const MaskImage& image = raw_.mask_images[number];
  if (!image.failure.empty()) throw Error("{}: its transmission: {}{}", where, image.failure, choice_.hint);
  const std::size_t texels = std::size_t(std::max(image.width, 0)) * std::size_t(std::max(image.height, 0));
  if (texels == 0 || (!image.alpha.empty() && image.alpha.size() != texels) ||
      (!image.colors.empty() && image.colors.size() != 3 * texels))
    throw Error("{}: image {} of {} x {} texels has {} bytes of alpha and {} of colors", where, number, image.width,
                image.height, image.alpha.size(), image.colors.size());
  return &image;
}

Transmission FileTransmissions::made(const std::string& where, const ImportedTransmission& material) const {
  const auto check = [&](double share, const char* what) {
    if (!(share >= 0 && share <= 1)) throw Error("{}: its {} of {} is not within 0 .. 1{}", where, what, share, choice_.hint);
  };
  check(material.alpha, "alpha");
  check(material.transmission, "transmission");
  check(material.metallic, "metallic factor");
  if (material.transmission > 0)
    for (int c = 0; c < 3; ++c) check(material.color[c], "color");
  if (material.wrap_u > AlphaMask::Wrap::clamp || material.wrap_v > AlphaMask::Wrap::clamp)
    throw Error("{}: its transmission wraps in no known way", where);

  const MaskImage* const color = image(where, material.color_image);
  const ImageChannel alpha = alpha_channel(image(where, material.alpha_image)),
                     share = color_channel(image(where, material.transmission_image), 0, linear_shares()),
                     metallic = color_channel(image(where, material.metallic_image), 2, linear_shares());
  const ImageChannel colors[] = {color_channel(color, 0, srgb_shares()), color_channel(color, 1, srgb_shares()),
                                 color_channel(color, 2, srgb_shares())};
  glm::ivec2 size(1);
  for (const ImageChannel* layer : {&alpha, &share, &metallic, &colors[0], &colors[1], &colors[2]})
    size = glm::max(size, glm::ivec2(static_cast<int>(layer->width), static_cast<int>(layer->height)));
  const bool is_colored = material.transmission > 0 && (color || material.color != glm::dvec3(material.color.x));
  const int channels = is_colored ? 3 : 1;
  try {
    check_value_count(size, static_cast<std::size_t>(channels));
    std::vector<float> values;
    values.reserve(std::size_t(size.x) * size.y * channels);
    for (std::size_t y = 0; y < std::size_t(size.y); ++y)
      for (std::size_t x = 0; x < std::size_t(size.x); ++x) {
        const double a = material.alpha * alpha.at(x, y, size),
                     through = material.transmission * share.at(x, y, size) * (1 - material.metallic * metallic.at(x, y, size));
        for (int c = 0; c < channels; ++c)
          values.push_back(static_cast<float>(1 - a + a * (through * (material.color[c] * colors[c].at(x, y, size)))));
      }
    return Transmission(size.x, size.y, channels, std::move(values), material.wrap_u, material.wrap_v);
  } catch (const Error& error) {
    throw Error("{}: {}{}", where, error.what(), choice_.hint);
  }
}

std::shared_ptr<const Transmission> FileTransmissions::transmission(const std::string& where, const ImportedMesh& mesh) {
  if (!counts(mesh)) return nullptr;
  std::shared_ptr<const Transmission> result = chosen_;
  if (!chosen_) {
    const std::string key(reinterpret_cast<const char*>(&mesh.transmission), sizeof(mesh.transmission));
    const auto known = known_.find(key);
    result = known != known_.end() ? known->second : shared(made(where, mesh.transmission), scene_);
    known_.emplace(key, result);
  }
  if (is_everywhere(*result, 0)) {
    ++opaque_;
    return nullptr;
  }
  ++transmitting_;
  empty_ += is_everywhere(*result, 1);
  return result;
}

void FileTransmissions::finish(const std::string& file, const std::string& name, Scene& scene) const {
  if (transmitting_ == 0 && choice_.seen)
    throw Error("{}: has no mesh that lets light through; whether it is seen is said of such alone", file);
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{}: {}", name, counted(count, what)));
  };
  if (!chosen_)
    note(opaque_, "mesh{es} {is|are} of transparent material of which no texel lets light through; {it is|they are} opaque");
  note(empty_, "mesh{es} {lets|let} all light through; {it stops|they stop} none");
}

}  // namespace gnomon
