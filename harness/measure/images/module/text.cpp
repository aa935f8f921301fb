// Words on pictures, by FreeType.
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cstdlib>
#include <mutex>

#include "measure/images/module/image_formats.h"

namespace gnomon::image_module {
namespace {

namespace fs = std::filesystem;

/// DejaVuSans.ttf, wherever fonts are; empty where it is not.
fs::path font_file() {
  constexpr const char* name = "DejaVuSans.ttf";
  const char* const home = std::getenv("HOME");
  const fs::path folders[] = {"/usr/share/fonts/truetype/dejavu", "/usr/share/fonts", "/usr/local/share/fonts",
                              fs::path(home ? home : "/") / ".local/share/fonts"};
  for (const fs::path& folder : folders) {
    std::error_code code;
    if (fs::exists(folder / name, code)) return folder / name;
    for (fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, code), end;
         !code && it != end; it.increment(code))
      if (it->path().filename() == name) return it->path();
  }
  return {};
}

/// Null where there is no font, which one note reports: pictures then have no words.
FT_Face load_font() {
  constexpr int size = 13;  // pixels
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  if (FT_Init_FreeType(&library) != 0 || FT_New_Face(library, font_file().c_str(), 0, &face) != 0 ||
      FT_Set_Pixel_Sizes(face, 0, size) != 0) {
    fmt::print(stderr, "note: pictures have no words: there is no font DejaVuSans.ttf (Debian: fonts-dejavu-core)\n");
    return nullptr;
  }
  return face;
}

/// The next character of a text in UTF-8; a byte that begins none is a character of its own.
FT_ULong next_character(const std::string& words, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return i < words.size() ? static_cast<unsigned char>(words[i]) : 0u; };
  const unsigned first = byte(at++);
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
  FT_ULong code = more == 0 ? first : first & (0x3fu >> more);
  for (int k = 0; k < more && (byte(at) & 0xc0u) == 0x80u; ++k) code = code << 6 | (byte(at++) & 0x3fu);
  return code;
}

}  // namespace

int draw_text(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words) {
  constexpr int ink = 26;
  static const FT_Face face = load_font();
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (!face) return 0;
  int pen = x;
  for (std::size_t at = 0; at < words.size();) {
    if (FT_Load_Char(face, next_character(words, at), FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = face->glyph;
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (int row = 0; !rgb.empty() && row < static_cast<int>(bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const int px = pen + glyph->bitmap_left + column, py = y - glyph->bitmap_top + row;
        if (px < 0 || px >= width || py < 0 || py >= height) continue;
        const int share = bitmap.buffer[row * bitmap.pitch + column];
        std::uint8_t* const pixel = &rgb[3 * (static_cast<std::size_t>(py) * width + px)];
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - share) + ink * share + 127) / 255);
      }
    pen += static_cast<int>(glyph->advance.x >> 6);
  }
  return pen - x;
}

}  // namespace gnomon::image_module
