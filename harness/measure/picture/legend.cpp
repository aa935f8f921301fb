#include "measure/picture/legend.h"

#include <algorithm>
#include <sstream>

namespace gnomon {

namespace {

constexpr int line_height = 20, swatch_width = 12;  // pixels

int text_width(const std::string& words) { return image_files().draw_text({}, 0, 0, 0, 0, words); }

/// Lines of `width` pixels at most, unless a single word is wider. What does not fit into so many lines is cut off at a word,
/// which dots tell.
std::vector<std::string> break_lines(const std::string& text, int width, std::size_t most_lines) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    const std::string longer = line.empty() ? word : line + ' ' + word;
    if (line.empty() || text_width(longer) <= width) {
      line = longer;
    } else if (lines.size() < most_lines) {
      lines.push_back(word);
    } else {
      while (text_width(line + " ...") > width && line.find(' ') != std::string::npos) line.resize(line.rfind(' '));
      line += " ...";
      break;
    }
  }
  return lines;
}

}  // namespace

void PictureLegend::add_sentence(const std::string& sentence, std::size_t most_lines) {
  for (const std::string& line : break_lines(sentence, width_ - 2 * margin, most_lines)) {
    if (x_ > margin) ++line_;
    entries_.push_back({std::nullopt, line, margin, line_});
    x_ = width_;  // full
  }
}

void PictureLegend::add(std::optional<Color> swatch, const std::string& words) {
  const int width = (swatch ? swatch_width + 6 : 0) + text_width(words);
  if (x_ > margin && x_ + width + margin > width_) {
    x_ = margin;
    ++line_;
  }
  entries_.push_back({swatch, words, x_, line_});
  x_ += width + 16;
}

int PictureLegend::height() const { return 10 + line_height * (line_ + 1); }

void PictureLegend::draw(Picture& picture, int top) const {
  for (const Entry& entry : entries_) {
    const int y = top + 9 + line_height * entry.line;
    int x = entry.x;
    if (entry.swatch) {
      for (int row = y; row < y + swatch_width; ++row)
        for (int column = x; column < std::min(x + swatch_width, picture.width); ++column)
          std::ranges::copy(*entry.swatch, &picture.rgb[3 * (static_cast<std::size_t>(row) * picture.width + column)]);
      x += swatch_width + 6;
    }
    image_files().draw_text(picture.rgb, picture.width, picture.height, x, y + 11, entry.words);
  }
}

}  // namespace gnomon
