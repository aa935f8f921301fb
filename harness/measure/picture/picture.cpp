#include "measure/picture/picture.h"

#include <gnomon/error.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "measure/picture/image_files.h"
#include "measure/picture/shading.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

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

/// Words and swatches below a picture, in lines as full as the width allows.
class Legend {
 public:
  explicit Legend(int width) : width_(width) {}
  /// A sentence in lines of its own, so many at most.
  void add_sentence(const std::string& sentence, std::size_t most_lines) {
    for (const std::string& line : break_lines(sentence, width_ - 2 * margin, most_lines)) {
      if (x_ > margin) ++line_;
      entries_.push_back({std::nullopt, line, margin, line_});
      x_ = width_;  // full
    }
  }
  /// An entry of a swatch (none for plain words) and words.
  void add(std::optional<Color> swatch, const std::string& words) {
    const int wide = (swatch ? swatch_width + 6 : 0) + text_width(words);
    if (x_ > margin && x_ + wide + margin > width_) x_ = margin, ++line_;
    entries_.push_back({swatch, words, x_, line_});
    x_ += wide + 16;
  }
  int height() const { return 10 + line_height * (line_ + 1); }
  void draw(Picture& picture, int top) const {
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

 private:
  static constexpr int margin = 8, line_height = 20, swatch_width = 12;
  struct Entry {
    std::optional<Color> swatch;
    std::string words;
    int x, line;
  };
  int width_, x_ = margin, line_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace

Picture shade(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> visibility) {
  Picture picture{gbuffer.width, gbuffer.height, std::vector<std::uint8_t>(gbuffer.size() * 3)};
  const std::vector<double> received = received_light(gbuffer, light);
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    Color color = background_srgb;
    if (!gbuffer.is_background(i))
      color = shaded_srgb(steps, scene.meshes[gbuffer.mesh[i]].albedo, scene.ambient + received[i] * visibility[i]);
    std::ranges::copy(color, &picture.rgb[3 * i]);
  }
  return picture;
}

Picture draw_errors(const Evidence& evidence, const std::string& title) {
  const GBuffer& gbuffer = *evidence.gbuffer;
  const std::span<const ErrorKind> kinds = error_kinds(!evidence.causes.empty());
  std::vector<int> kind_of(gbuffer.size());
  std::vector<std::size_t> counts(kinds.size(), 0);
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    if (kind_of[i] = error_kind(evidence, i); kind_of[i] >= 0) ++counts[kind_of[i]];
  const auto tested = static_cast<double>(std::ranges::count(evidence.classes, PixelClass::T));
  Legend legend(gbuffer.width);
  if (!title.empty()) legend.add(std::nullopt, title);
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (counts[k] > 0) legend.add(kinds[k].color, kinds[k].label + " " + percent(static_cast<double>(counts[k]) / tested));
  if (std::ranges::all_of(counts, [](std::size_t count) { return count == 0; }))
    legend.add(std::nullopt, "no tested pixel is wrong");

  const std::vector<float> lit(gbuffer.size(), 1.0f);
  const Picture shaded = shade(*evidence.scene, gbuffer, *evidence.light, lit);
  Picture picture{gbuffer.width, gbuffer.height + legend.height(), {}};
  picture.rgb.resize(static_cast<std::size_t>(picture.width) * picture.height * 3, 255);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const std::uint8_t* s = &shaded.rgb[3 * i];
    const std::uint8_t level = dimmed({s[0], s[1], s[2]}, evidence.classes[i] == PixelClass::T);
    const Color color = kind_of[i] >= 0 ? kinds[kind_of[i]].color : Color{level, level, level};
    std::ranges::copy(color, &picture.rgb[3 * i]);
  }
  legend.draw(picture, gbuffer.height);
  return picture;
}

Picture draw_mask(std::span<const float> visibility, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(visibility.size() * 3)};
  for (std::size_t i = 0; i < visibility.size(); ++i)
    for (int c = 0; c < 3; ++c) picture.rgb[3 * i + c] = mask_gray(visibility[i]);
  return picture;
}

Picture draw_layer(const fs::path& raw, int width, int height, const DebugLayer& layer) {
  const auto file = MappedFile::open(raw);
  const std::size_t size = static_cast<std::size_t>(width) * height * 3;
  if (file->bytes().size() != size * sizeof(float))
    throw Error("debug layer has {} bytes; {} are wanted", file->bytes().size(), size * sizeof(float));
  const auto* linear = reinterpret_cast<const float*>(file->bytes().data());
  Legend legend(width);
  legend.add_sentence(layer.sentence, 3);
  for (const Swatch& s : layer.legend) legend.add(Color{srgb(s.color.r), srgb(s.color.g), srgb(s.color.b)}, s.name);
  Picture picture{width, height + legend.height(), {}};
  picture.rgb.resize(static_cast<std::size_t>(width) * picture.height * 3, 255);
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t k = 0; k < size; ++k) picture.rgb[k] = srgb_fast(steps, linear[k]);
  legend.draw(picture, height);
  return picture;
}

void write_png(const fs::path& path, const Picture& picture) {
  image_files().write_png(path, picture.width, picture.height, picture.rgb);
}

void write_exr(const fs::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels) {
  image_files().write_exr(path, width, height, names, channels);
}

std::vector<float> read_exr(const fs::path& path, const std::string& channel, int width, int height) {
  return image_files().read_exr(path, channel, width, height);
}

}  // namespace gnomon
