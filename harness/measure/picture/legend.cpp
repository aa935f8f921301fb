#include "measure/picture/legend.h"

#include <algorithm>
#include <sstream>

namespace gnomon {

namespace {

constexpr int line_height = 20, swatch_width = 12, ramp_width = 200, gap = 6;  // pixels

int text_width(const std::string& words) { return image_files().draw_text({}, 0, 0, 0, 0, words); }

/// Lines of `width` pixels at most, unless a single word is wider. What does not fit into so many lines is cut off at a word,
/// which dots mark.
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
    entries_.push_back({{}, 0, line, margin, line_});
    x_ = width_;  // full
  }
}

int PictureLegend::place(int width) {
  if (x_ > margin && x_ + width + margin > width_) {
    x_ = margin;
    ++line_;
  }
  const int x = x_;
  x_ += width + 16;
  return x;
}

void PictureLegend::add(std::optional<Color> swatch, const std::string& words) {
  const int x = place((swatch ? swatch_width + gap : 0) + text_width(words));
  const std::vector<Color> colors(swatch ? 1 : 0, swatch.value_or(Color()));
  entries_.push_back({colors, swatch ? swatch_width : 0, words, x, line_});
}

void PictureLegend::add_ramp(const std::string& first, std::vector<Color> colors, const std::string& last) {
  const int before = text_width(first) + gap, after = gap + text_width(last);
  const int bar = std::clamp(width_ - 2 * margin - before - after, swatch_width, ramp_width);
  const int x = place(before + bar + after);
  entries_.push_back({{}, 0, first, x, line_});
  entries_.push_back({std::move(colors), bar, last, x + before, line_});
}

int PictureLegend::height() const { return 10 + line_height * (line_ + 1); }

void PictureLegend::draw(Picture& picture, int top) const {
  constexpr Color frame{110, 110, 110};
  for (const Entry& entry : entries_) {
    const int y = top + 9 + line_height * entry.line, end = entry.x + entry.bar_width;
    // The frame of a swatch is around it, that of a bar its rim.
    const int beside = entry.colors.size() == 1 ? 1 : 0, first = entry.x - beside, top_row = y - beside;
    const int bottom_row = y + swatch_width - 1 + beside, last = end - 1 + beside;
    for (int row = top_row; entry.bar_width > 0 && row <= bottom_row; ++row)
      for (int column = first; column <= std::min(last, picture.width - 1); ++column) {
        const bool is_edge = row == top_row || row == bottom_row || column == first || column == last;
        const std::size_t k = is_edge ? 0 : entry.colors.size() * (column - entry.x) / entry.bar_width;
        std::ranges::copy(is_edge ? frame : entry.colors[k],
                          &picture.rgb[3 * (static_cast<std::size_t>(row) * picture.width + column)]);
      }
    const int x = entry.bar_width > 0 ? end + gap : entry.x;
    image_files().draw_text(picture.rgb, picture.width, picture.height, x, y + 11, entry.words);
  }
}

}  // namespace gnomon
