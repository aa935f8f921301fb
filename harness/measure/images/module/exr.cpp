// OpenEXR, by its own library.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <algorithm>

#include "measure/images/module/image_formats.h"

namespace gnomon::image_module {
namespace {

std::string words(const Imath::Box2i& window) {
  return fmt::format("({}, {}) .. ({}, {})", window.min.x, window.min.y, window.max.x, window.max.y);
}

/// The place of a channel among those of its layer; EXR sorts them by the alphabet.
int rank(const std::string& name) {
  static constexpr std::string_view order = "RGBYA";
  const std::size_t dot = name.rfind('.');
  const std::string_view last = std::string_view(name).substr(dot == std::string::npos ? 0 : dot + 1);
  const std::size_t place = last.size() == 1 ? order.find(last[0]) : order.npos;
  return static_cast<int>(std::min(place, order.size()));
}

/// The picture is what the display window shows. What the file holds beside it is cut off.
class ExrReader final : public ImageReader {
 public:
  explicit ExrReader(const std::filesystem::path& path) : file_(path.c_str()) {
    const Imf::Header& header = file_.header();
    data_ = header.dataWindow();
    shown_ = header.displayWindow();
    if (!data_.intersects(shown_.min) || !data_.intersects(shown_.max))
      throw Error("its pixels are {}, which is not all of the display window {}", words(data_), words(shown_));
    // Differences of corners anywhere in an int.
    const auto side = [](int from, int to) {
      return static_cast<int>(std::min<std::int64_t>(std::int64_t{to} - from + 1, 1 << 30));
    };
    width = side(shown_.min.x, shown_.max.x);
    height = side(shown_.min.y, shown_.max.y);
    if (std::max(side(data_.min.x, data_.max.x), side(data_.min.y, data_.max.y)) > most_side &&
        std::max(width, height) <= most_side)
      throw Error("its pixels are {}; sides are 1 .. {} pixels", words(data_), most_side);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) channels.emplace_back(c.name());
    std::ranges::stable_sort(channels, [](const std::string& a, const std::string& b) {
      const std::string_view layer = std::string_view(a).substr(0, a.rfind('.') + 1);
      return layer == std::string_view(b).substr(0, b.rfind('.') + 1) && rank(a) < rank(b);
    });
  }

  std::vector<float> read(std::size_t channel) override {
    const Imf::Channel* const found = file_.header().channels().findChannel(channels[channel]);
    if (found->xSampling != 1 || found->ySampling != 1)
      throw Error("channel {} has a sample for each {} x {} pixels", channels[channel], found->xSampling, found->ySampling);
    constexpr int band = 256;  // the most rows that a compression takes together
    const auto data_width = static_cast<std::size_t>(std::int64_t{data_.max.x} - data_.min.x + 1);
    const auto left = static_cast<std::ptrdiff_t>(std::int64_t{shown_.min.x} - data_.min.x);
    std::vector<float> pixels, rows;
    for (int y = shown_.min.y; y <= shown_.max.y; y += band) {
      const int count = std::min(band, shown_.max.y - y + 1);
      rows.resize(data_width * static_cast<std::size_t>(count));
      Imf::FrameBuffer into;
      into.insert(channels[channel],
                  Imf::Slice::Make(Imf::FLOAT, rows.data(), Imath::V2i(data_.min.x, y), static_cast<std::int64_t>(data_width),
                                   count, sizeof(float), data_width * sizeof(float)));
      file_.setFrameBuffer(into);
      file_.readPixels(y, y + count - 1);
      for (int k = 0; k < count; ++k) {
        const auto first = rows.begin() + k * static_cast<std::ptrdiff_t>(data_width) + left;
        pixels.insert(pixels.end(), first, first + width);
      }
    }
    return pixels;
  }

 private:
  Imf::InputFile file_;
  Imath::Box2i data_, shown_;
};

}  // namespace

std::unique_ptr<ImageReader> open_exr(const std::filesystem::path& path) {
  Imf::Header::setMaxImageSize(1 << 20, 1 << 20);  // of a table of rows; ours says more
  return std::make_unique<ExrReader>(path);
}

void write_exr_file(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
                    std::span<const std::span<const float>> channels) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIPS_COMPRESSION;
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    pixels.insert(names[c], Imf::Slice::Make(Imf::FLOAT, channels[c].data(), Imath::V2i(0), width, height));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(pixels);
  file.writePixels(height);
}

}  // namespace gnomon::image_module
