#pragma once
#include <optional>
#include <string>
#include <vector>

#include "measure/picture/picture.h"
#include "measure/picture/shading.h"

namespace gnomon {

/// Words and swatches below a picture, in lines as full as the width allows: entries are added first, then all are drawn.
class PictureLegend {
 public:
  explicit PictureLegend(int width) : width_(width) {}
  /// A sentence in lines of its own, `most_lines` at most; what does not fit is cut off at a word and ends in dots.
  void add_sentence(const std::string& sentence, std::size_t most_lines);
  /// Words after a swatch of this color, or words alone.
  void add(std::optional<Color> swatch, const std::string& words);
  /// Of all lines so far, pixels.
  int height() const;
  /// Draws everything from row `top` down; the picture is high enough.
  void draw(Picture& picture, int top) const;

 private:
  struct Entry {
    std::optional<Color> swatch;
    std::string words;
    int x, line;
  };
  static constexpr int margin = 8;
  int width_, x_ = margin, line_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace gnomon
