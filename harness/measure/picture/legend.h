#pragma once
#include "measure/picture/picture.h"
#include "measure/picture/shading.h"

namespace gnomon {

/// Words and swatches below a picture, in lines as full as the width allows: entries are added first, then all are drawn.
class PictureLegend {
 public:
  explicit PictureLegend(int width) : width_(width) {}
  /// A sentence in lines of its own, `most_lines` at most; what does not fit is cut off at a word and ends in dots.
  void add_sentence(const std::string& sentence, std::size_t most_lines);
  /// Words after a swatch of this color, in a thin gray frame so that white is seen, too; or words alone.
  void add(std::optional<Color> swatch, const std::string& words);
  /// A framed bar that runs through the colors, one at least, and at its ends words; it is 200 pixels wide, or what a line has.
  void add_ramp(const std::string& first, std::vector<Color> colors, const std::string& last);
  /// Of all lines so far, pixels.
  int height() const;
  /// Draws everything from row `top` down; the picture is high enough.
  void draw(Picture& picture, int top) const;

 private:
  struct Entry {
    std::vector<Color> colors;  ///< of a swatch one, of a bar all, of words none
    int bar_width = 0;
    std::string words;  ///< after the bar
    int x, line;
  };
  /// Makes room in this line or the next one, and says where.
  int place(int width);
  static constexpr int margin = 8;
  int width_, x_ = margin, line_ = 0;
  std::vector<Entry> entries_;
};

/// The picture with the legend below it, on white.
Picture with_legend(Picture picture, const PictureLegend& legend);

}  // namespace gnomon
