// PNG, by libpng. It jumps out of its functions on an error: what is called under `guarded` has nothing to destroy.
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "measure/images/module/image_formats.h"

namespace gnomon::image_module {
namespace {

struct Closes {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closes>;

File open_file(const std::filesystem::path& path, const char* mode) {
  File file(std::fopen(path.c_str(), mode));
  if (!file) throw Error("{}", std::strerror(errno));
  return file;
}

using Reason = char[128];

[[noreturn]] void keep_reason(png_structp png, png_const_charp words) {
  std::snprintf(static_cast<char*>(png_get_error_ptr(png)), sizeof(Reason), "%s", words);
  png_longjmp(png, 1);
}
void ignore(png_structp, png_const_charp) {}

template <class Function>
bool guarded(png_structp png, Function&& function) {
  if (setjmp(png_jmpbuf(png))) return false;
  function();
  return true;
}

/// libpng's two structs, which live as long as what reads with them, or as its constructor.
struct Reading {
  png_structp png = nullptr;
  png_infop info = nullptr;
  explicit Reading(char* reason) : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, reason, keep_reason, ignore)) {
    if (png) info = png_create_info_struct(png);
  }
  Reading(const Reading&) = delete;
  ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }
};

class PngReader final : public ImageReader {
 public:
  explicit PngReader(const std::filesystem::path& path) : file_(open_file(path, "rb")) {
    if (!info_) throw Error("there is no memory for it");
    demand([this] { read_size(); });
    if (std::max(width, height) > most_side) return;  // libpng would make room for a row
    demand([this] { read_layout(); });
    const int type = png_get_color_type(png_, info_);
    channels = type & PNG_COLOR_MASK_COLOR ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
    if (type & PNG_COLOR_MASK_ALPHA) channels.emplace_back("A");
    png_textp texts = nullptr;
    const int count = png_get_text(png_, info_, &texts, nullptr);
    for (int i = 0; i < count; ++i)
      if (std::strcmp(texts[i].key, image_module::legend_rows) == 0) legend_rows = texts[i].text;
  }

  std::vector<float> read(std::size_t channel) override {
    const std::size_t row_bytes = png_get_rowbytes(png_, info_), row = static_cast<std::size_t>(width);
    const bool is_wide = png_get_bit_depth(png_, info_) == 16;
    std::vector<float> pixels;
    pixels.reserve(row * static_cast<std::size_t>(height));
    const auto append = [&](const png_byte* bytes) {
      for (std::size_t k = channel; k < row * channels.size(); k += channels.size())
        pixels.push_back(is_wide ? static_cast<float>(bytes[2 * k] << 8 | bytes[2 * k + 1]) / 65535.0f
                                 : static_cast<float>(bytes[k]) / 255.0f);
    };
    const bool is_interlaced = passes_ > 1;
    // Pages that no row is read into are never touched.
    const std::unique_ptr<png_byte, decltype(&std::free)> rows(
        static_cast<png_byte*>(std::calloc(is_interlaced ? static_cast<std::size_t>(height) : 1, row_bytes)), std::free);
    if (!rows) throw Error("there is no memory for it");
    for (int pass = 0; pass < passes_; ++pass)
      for (int y = 0; y < height; ++y) {
        png_byte* const into = rows.get() + (is_interlaced ? static_cast<std::size_t>(y) * row_bytes : 0);
        demand([&] { png_read_row(png_, into, nullptr); });
        if (pass + 1 == passes_) append(into);
      }
    return pixels;
  }

 private:
  void read_size() {
    png_init_io(png_, file_.get());
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // ours say more
    png_read_info(png_, info_);
    width = static_cast<int>(png_get_image_width(png_, info_));
    height = static_cast<int>(png_get_image_height(png_, info_));
  }
  void read_layout() {
    png_set_expand(png_);  // colors of a palette, 8 bits at least, transparency as alpha
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }
  template <class Function>
  void demand(Function&& function) {
    if (!guarded(png_, function)) throw Error("{}", reason_);
  }

  Reason reason_{};
  File file_;
  Reading reading_{reason_};
  png_structp const png_ = reading_.png;
  png_infop const info_ = reading_.info;
  int passes_ = 1;
};

/// What a file shall hold, 8 bits a channel.
struct Pixels {
  int width = 0, height = 0, color_type = PNG_COLOR_TYPE_RGB;
  std::span<const std::uint8_t> bytes;
};

void write_rows(png_structp png, png_infop info, std::FILE* file, const Pixels& pixels, const char* rows_of_legend) {
  png_init_io(png, file);
  png_set_compression_level(png, 3);
  png_set_IHDR(png, info, static_cast<png_uint_32>(pixels.width), static_cast<png_uint_32>(pixels.height), 8, pixels.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (pixels.color_type == PNG_COLOR_TYPE_RGB) png_set_sRGB(png, info, PNG_sRGB_INTENT_ABSOLUTE);
  if (*rows_of_legend) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<png_charp>(legend_rows);
    text.text = const_cast<png_charp>(rows_of_legend);
    png_set_text(png, info, &text, 1);
  }
  png_write_info(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  for (int y = 0; y < pixels.height; ++y) png_write_row(png, pixels.bytes.data() + static_cast<std::size_t>(y) * row_bytes);
  png_write_end(png, info);
}

void write_pixels(const std::filesystem::path& path, const Pixels& pixels, const std::string& rows_of_legend) {
  File file = open_file(path, "wb");
  Reason reason{};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, reason, keep_reason, ignore);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool is_written = info && guarded(png, [&] { write_rows(png, info, file.get(), pixels, rows_of_legend.c_str()); });
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw Error("{}", *reason ? reason : "there is no memory for it");
  if (std::fclose(file.release()) != 0) throw Error("{}", std::strerror(errno));
}

}  // namespace

std::unique_ptr<ImageReader> open_png(const std::filesystem::path& path) { return std::make_unique<PngReader>(path); }

void write_png_file(const std::filesystem::path& path, const Picture& picture) {
  write_pixels(path, {.width = picture.width, .height = picture.height, .bytes = picture.rgb},
               picture.legend_height > 0 ? std::to_string(picture.legend_height) : "");
}

void write_gray_png_file(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> values,
                         bool has_alpha) {
  write_pixels(path, {width, height, has_alpha ? PNG_COLOR_TYPE_GRAY_ALPHA : PNG_COLOR_TYPE_GRAY, values}, "");
}

}  // namespace gnomon::image_module
