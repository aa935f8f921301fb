// Pictures in any format but PNG and EXR: the only file that uses OpenImageIO.
#include <OpenImageIO/imageio.h>

#include "measure/images/module/image_formats.h"

namespace gnomon::image_module {
namespace {

class OtherReader final : public ImageReader {
 public:
  explicit OtherReader(const std::string& path) {
    // Alone: its threads would still be ending when a program that has read a picture ends.
    OIIO::attribute("threads", 1);
    OIIO::ImageSpec as_it_is;
    as_it_is.attribute("oiio:UnassociatedAlpha", 1);
    input_ = OIIO::ImageInput::open(path, &as_it_is);
    if (!input_) throw Error("{}", OIIO::geterror());
    width = input_->spec().width;
    height = input_->spec().height;
    channels = input_->spec().channelnames;
  }

  std::vector<float> read(std::size_t channel) override {
    const OIIO::ImageSpec& spec = input_->spec();
    const int index = static_cast<int>(channel);
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
      const bool is_read = spec.tile_width > 0 ? input_->read_tiles(0, 0, x0, x0 + width, y0 + y, y0 + end, spec.z, spec.z + 1,
                                                                    index, index + 1, OIIO::TypeDesc::FLOAT, into)
                                               : input_->read_scanlines(0, 0, y0 + y, y0 + end, spec.z, index, index + 1,
                                                                        OIIO::TypeDesc::FLOAT, into);
      if (!is_read) throw Error("{}", input_->geterror());
    }
    return pixels;
  }

 private:
  std::unique_ptr<OIIO::ImageInput> input_;
};

}  // namespace
}  // namespace gnomon::image_module

gnomon::image_module::ImageReader* gnomon_open_other_image(const char* path) {
  return new gnomon::image_module::OtherReader(path);
}
