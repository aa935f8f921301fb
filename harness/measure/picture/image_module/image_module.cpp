// The image module: the only file that knows OpenImageIO. See ImageFiles.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <gnomon/error.h>
#include <unistd.h>

#include "measure/picture/picture.h"

namespace gnomon::image_module {

namespace fs = std::filesystem;

/// An image file under a temporary name that becomes the real one only when it is whole.
void write_image(const fs::path& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
  std::error_code code;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), code);
  if (code) throw Error("folder {} cannot be made: {}", path.parent_path().string(), code.message());
  if (fs::exists(path, code) && !fs::is_regular_file(path, code))
    throw Error("{} cannot be written: it is there and no regular file", path.string());
  const fs::path temporary = path.parent_path() / fmt::format(".{}.part{}", getpid(), path.extension().string());
  const auto output = OIIO::ImageOutput::create(temporary.string());
  if (!output) throw Error("{} cannot be written: {}", path.string(), OIIO::geterror());
  const bool whole = output->open(temporary.string(), spec) && output->write_image(type, pixels) && output->close();
  std::string why = whole ? "" : output->geterror();
  if (whole) {
    fs::rename(temporary, path, code);
    if (!code) return;
    why = code.message();
  }
  fs::remove(temporary, code);
  throw Error("{} cannot be written: {}", path.string(), why);
}

/// What a PNG says of itself when rows at its bottom hold a legend.
constexpr const char* legend_rows = "gnomon legend rows";

void write_png(const fs::path& path, const Picture& picture) {
  OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
  if (picture.legend_height > 0) spec.attribute(legend_rows, std::to_string(picture.legend_height));
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", 3);
  write_image(path, spec, OIIO::TypeDesc::UINT8, picture.rgb.data());
}

void write_exr(const fs::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels) {
  const std::size_t n = static_cast<std::size_t>(width) * height, count = channels.size();
  std::vector<float> interleaved(n * count);
  for (std::size_t c = 0; c < count; ++c)
    for (std::size_t i = 0; i < n; ++i) interleaved[i * count + c] = channels[c][i];
  OIIO::ImageSpec spec(width, height, static_cast<int>(count), OIIO::TypeDesc::FLOAT);
  spec.channelnames.assign(names.begin(), names.end());
  spec.attribute("compression", "zips");
  write_image(path, spec, OIIO::TypeDesc::FLOAT, interleaved.data());
}

/// A picture from outside, of a size that can be scored, and of which there are bytes enough that it may be whole.
std::unique_ptr<OIIO::ImageInput> open_image(const fs::path& path) {
  constexpr int most_side = 16384;
  constexpr std::uint64_t most_pixels_per_byte = 100'000;  // of one color throughout, compressed by the best that there is
  if (!fs::exists(path)) throw Error("{} cannot be read: there is no such file", path.string());
  if (!fs::is_regular_file(path)) throw Error("{} cannot be read: it is not a file", path.string());
  auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw Error("{} cannot be read: {}", path.string(), OIIO::geterror());
  const int width = input->spec().width, height = input->spec().height;
  if (std::min(width, height) < 1 || std::max(width, height) > most_side)
    throw Error("{} is {}x{}; sides are 1 .. {} pixels", path.string(), width, height, most_side);
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > most_pixels_per_byte * fs::file_size(path))
    throw Error("{} declares {}x{} pixels in {} bytes; it is truncated", path.string(), width, height, fs::file_size(path));
  return input;
}

std::vector<float> read_exr(const fs::path& path, const std::string& channel, int width, int height) {
  const auto input = open_image(path);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width != width || spec.height != height)
    throw Error("{} is {}x{}; {}x{} is wanted", path.string(), spec.width, spec.height, width, height);
  const int index = spec.channelindex(channel);
  if (index < 0) throw Error("{} has no channel {}; it has: {}", path.string(), channel, joined(spec.channelnames, ", "));
  // Band by band: a picture may declare more than it holds, and memory is taken for what is there.
  const auto row = static_cast<std::size_t>(width);
  const int band = spec.tile_width > 0 ? spec.tile_height : 64;
  std::vector<float> pixels;
  pixels.reserve(row * static_cast<std::size_t>(height));
  for (int y = 0; y < height; y += band) {
    const int end = std::min(y + band, height);
    pixels.resize(row * static_cast<std::size_t>(end));
    float* const into = &pixels[row * static_cast<std::size_t>(y)];
    const int x0 = spec.x, y0 = spec.y;
    const bool is_read = spec.tile_width > 0 ? input->read_tiles(0, 0, x0, x0 + width, y0 + y, y0 + end, spec.z, spec.z + 1,
                                                                 index, index + 1, OIIO::TypeDesc::FLOAT, into)
                                             : input->read_scanlines(0, 0, y0 + y, y0 + end, spec.z, index, index + 1,
                                                                     OIIO::TypeDesc::FLOAT, into);
    if (!is_read) throw Error("{} cannot be read: {}", path.string(), input->geterror());
  }
  return pixels;
}

std::vector<std::string> exr_channels(const fs::path& path) { return open_image(path)->spec().channelnames; }

std::pair<int, int> exr_size(const fs::path& path) {
  const auto input = open_image(path);
  const OIIO::ImageSpec& spec = input->spec();
  if (const std::string rows = spec.get_string_attribute(legend_rows); !rows.empty())
    throw Error("{} is a picture with a legend of {} rows below it; a mask without one is wanted, as in mask.exr",
                path.string(), rows);
  return {spec.width, spec.height};
}

int draw_text(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words) {
  constexpr int size = 13;
  constexpr const char* font = "DejaVuSans";
  if (!rgb.empty()) {
    OIIO::ImageBuf canvas(OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::UINT8), rgb.data());
    const float ink[] = {0.1f, 0.1f, 0.1f};
    OIIO::ImageBufAlgo::render_text(canvas, x, y, words, size, font, ink);
  }
  return OIIO::ImageBufAlgo::text_size(words, size, font).xend;
}

}  // namespace gnomon::image_module

extern "C" const gnomon::ImageFiles gnomon_image_files;
namespace images = gnomon::image_module;
const gnomon::ImageFiles gnomon_image_files{images::write_png,    images::write_exr, images::read_exr,
                                            images::exr_channels, images::exr_size,  images::draw_text};
