#include "app/viewer/compose.h"

#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>

#include "app/viewer/contours.h"
#include "app/viewer/packed_color.h"
#include "measure/score/error_picture.h"

namespace gnomon::viewer {

namespace {

constexpr Color divider_light{238, 240, 244}, divider_dark{12, 13, 15};

std::vector<int> nearest_cells(int many, int few) {
  std::vector<int> cells(many);
  for (int k = 0; k < many; ++k) cells[k] = nearest_cell(k, many, few);
  return cells;
}

/// A color as dark as the dimmed scene is, of which half is left at least, so that colors stay what they are.
Color shadowed(const Color& color, std::uint8_t gray) {
  constexpr int brightest = 172;  // of the dimmed scene
  Color result;
  for (std::size_t c = 0; c < result.size(); ++c)
    result[c] = static_cast<std::uint8_t>(color[c] * (brightest + std::min<int>(gray, brightest)) / (2 * brightest));
  return result;
}

/// What a thread reuses from row to row.
struct Scratch {
  std::vector<std::uint32_t> colors;
  std::vector<float> visibility[2];
  int frame_row = -1;  ///< of the colors
};

/// The paint of one side in pixels of its frame.
class SidePainter {
 public:
  SidePainter(const SidePainter&) = delete;
  SidePainter& operator=(const SidePainter&) = delete;
  SidePainter(const Composition& composition, int side)
      : side_(composition.sides[side]),
        other_(composition.sides[1 - side]),
        truth_(reference_side(composition, side)),
        scale_(composition.difference),
        gbuffer_(side_.frame->gbuffer) {
    assert(side_.frame->received.size() == gbuffer_.size());
    if (composition.shows_contours) {
      if (has_mask(truth_)) contours_.emplace_back(truth_, reference_ink, true);
      // The side may be the reference itself.
      if (has_mask(side_) && side_.mask.data() != truth_.mask.data())
        contours_.emplace_back(side_, technique_inks[side], false);
    }
    const ReferenceState* const reference = reference_of(composition, side);
    if (reference) classes_ = reference->classes;
    const Paint paint = composition.paint;
    if (paint == Paint::shaded && has_mask(side_)) shown_ = Content::shaded;
    if (paint == Paint::mask && has_mask(side_)) shown_ = Content::mask;
    if (paint == Paint::classes && !classes_.empty()) shown_ = Content::classes;
    if (paint == Paint::difference && has_mask(side_) && has_mask(compared()) && is_same(side_.frame, compared().frame))
      shown_ = Content::difference;
    if (paint != Paint::kinds && paint != Paint::causes) return;
    const std::optional<Evidence> evidence = evidence_of(composition, side, paint == Paint::causes);
    if (!evidence) return;
    evidence_ = *evidence;
    is_soft_ = is_soft(evidence_);
    shown_ = Content::errors;
    for (const ErrorKind& kind : error_kinds(*evidence, false)) kind_colors_.push_back(kind.color);
  }

  /// Row y of the frame from column `first` up to `last`, to where these columns are in the scratch's colors.
  void paint(int y, int first, int last, Scratch& scratch) const {
    scratch.colors.resize(gbuffer_.width);
    paint_row(y, first, last, scratch);
    for (const Contours& contours : contours_) contours.paint(y, first, last, scratch.colors);
  }

 private:
  enum class Content { dimmed, shaded, mask, difference, errors, classes };

  void paint_row(int y, int first, int last, Scratch& scratch) const {
    const std::size_t row = static_cast<std::size_t>(y) * gbuffer_.width;
    const auto fill = [&](auto&& color_of) {
      for (int x = first; x < last; ++x) scratch.colors[x] = color_of(x, row + x);
    };
    // The gray of each channel of the mask.
    const auto in_color = [&](auto&& gray_of) {
      fill([&](int x, std::size_t i) {
        const std::size_t k = mask_index(side_, gbuffer_, x, y);
        Color color;
        for (std::size_t c = 0; c < color.size(); ++c) color[c] = gray_of(i, c, channel_at(side_, c, k));
        return pack(color);
      });
    };
    switch (shown_) {
      case Content::dimmed:
        return fill([&](int, std::size_t i) { return pack_gray(dimmed_at(i)); });
      case Content::shaded: {
        if (is_colored_)
          return in_color([&](std::size_t i, std::size_t c, float v) {
            return gbuffer_.is_background(i) ? background_srgb[c] : srgb_fast(steps_, albedo_at(i)[c] * light_at(i, v));
          });
        const float* const v = visibility(side_, y, first, last, scratch.visibility[0]);
        static const std::uint32_t background = pack(background_srgb);
        return fill([&](int x, std::size_t i) { return gbuffer_.is_background(i) ? background : pack(shaded_at(i, v[x])); });
      }
      case Content::mask: {
        if (is_colored_) return in_color([](std::size_t, std::size_t, float v) { return mask_gray(v); });
        const float* const v = visibility(side_, y, first, last, scratch.visibility[0]);
        return fill([&](int x, std::size_t) { return pack_gray(mask_gray(v[x])); });
      }
      case Content::difference: {
        const float* const here = visibility(side_, y, first, last, scratch.visibility[0]);
        const float* const there = visibility(compared(), y, first, last, scratch.visibility[1]);
        return fill([&](int x, std::size_t i) {
          if (gbuffer_.is_background(i)) return pack_gray(dimmed_at(i));
          const Color color = signed_color(here[x] - there[x], scale_.full);
          return pack(scale_.is_plain ? color : shadowed(color, dimmed_at(i)));
        });
      }
      case Content::errors:
        return fill([&](int, std::size_t i) {
          const ErrorMark mark = error_mark(evidence_, i, is_soft_);
          const std::uint8_t gray = mark.kind < 0 || mark.weight < 1 ? dimmed_at(i) : 0;
          return mark.kind >= 0 ? pack(marked(gray, kind_colors_[mark.kind], mark.weight)) : pack_gray(gray);
        });
      case Content::classes:
        return fill([&](int, std::size_t i) { return pack(class_infos()[static_cast<std::size_t>(classes_[i])].color); });
    }
  }

  /// What the paint `difference` compares the side with.
  const ComposeSide& compared() const { return scale_.against == Against::reference ? truth_ : other_; }

  const glm::vec3& albedo_at(std::size_t i) const { return meshes_[gbuffer_.mesh[i]].albedo; }
  double light_at(std::size_t i, float visibility) const { return ambient_ + exposure_ * received_[i] * visibility; }
  Color shaded_at(std::size_t i, float visibility) const { return shaded_srgb(steps_, albedo_at(i), light_at(i, visibility)); }
  std::uint8_t dimmed_at(std::size_t i) const {
    if (gbuffer_.is_background(i)) return dimmed(background_srgb, false);
    return dimmed(shaded_at(i, 1), classes_.empty() || classes_[i] == PixelClass::T);
  }
  /// A row of a side's mask in pixels of this frame.
  const float* visibility(const ComposeSide& side, int y, int first, int last, std::vector<float>& room) const {
    if (has_full_mask(side)) return side.mask.data() + static_cast<std::size_t>(y) * gbuffer_.width;
    room.resize(gbuffer_.width);
    for (int x = first; x < last; ++x) room[x] = visibility_at(side, gbuffer_, x, y);
    return room.data();
  }

  const ComposeSide &side_, &other_;
  const ComposeSide truth_;
  const DifferenceScale scale_;
  std::vector<Contours> contours_;  // in the order of drawing; one refers to `truth_`
  const GBuffer& gbuffer_;
  const SrgbSteps& steps_ = srgb_steps();
  const double* received_ = side_.frame->received.data();
  const Mesh* meshes_ = side_.frame->scene().meshes.data();
  double ambient_ = side_.frame->scene().ambient, exposure_ = side_.frame->exposure;
  Content shown_ = Content::dimmed;
  bool is_colored_ = has_channels(side_);
  std::span<const PixelClass> classes_;  // empty until they are computed
  Evidence evidence_;
  bool is_soft_ = false;  ///< the evidence's light has an area
  std::vector<Color> kind_colors_;
};

/// A side's debug layer over picture rows.
class LayerPainter {
 public:
  LayerPainter(const Composition& composition, const LayerPicture& layer)
      : gbuffer_(layer.frame->gbuffer),
        rgb_(layer.rgb.data()),
        weight_(weight_of(composition.layer_opacity)),
        columns_(nearest_cells(composition.width, gbuffer_.width)) {}

  static bool is_shown(const Composition& composition, const LayerPicture* layer) {
    return layer && layer->frame && layer->rgb.size() == 3 * layer->frame->gbuffer.size() && layer->frame->gbuffer.size() > 0 &&
           weight_of(composition.layer_opacity) > 0;
  }

  /// Over row y of a picture of that height, from column `first` up to `last`.
  void paint(int y, int height, int first, int last, std::uint32_t* row) const {
    const std::size_t begin = static_cast<std::size_t>(nearest_cell(y, height, gbuffer_.height)) * gbuffer_.width;
    for (int x = first; x < last; ++x) {
      const std::size_t i = begin + columns_[x];
      const float* const over = rgb_ + 3 * i;
      if (gbuffer_.is_background(i) && glm::vec3(over[0], over[1], over[2]) == nothing_) continue;
      const Color color{srgb_fast(steps_, over[0]), srgb_fast(steps_, over[1]), srgb_fast(steps_, over[2])};
      row[x] = mixed(row[x], pack(color), weight_);
    }
  }

 private:
  const GBuffer& gbuffer_;
  const float* rgb_;
  std::uint32_t weight_;
  std::vector<int> columns_;
  const SrgbSteps& steps_ = srgb_steps();
  glm::vec3 nothing_ = background_color();
};

/// The columns of the picture that show one side.
class Part {
 public:
  Part(const Composition& composition, int side, int first, int last)
      : height_(composition.height), first_(first), last_(last), frame_(composition.sides[side].frame) {
    const LayerPicture* const layer = composition.sides[side].layer;
    if (LayerPainter::is_shown(composition, layer)) layer_.emplace(composition, *layer);
    if (!frame_ || frame_->gbuffer.size() == 0) return;
    painter_.emplace(composition, side);
    columns_ = nearest_cells(composition.width, frame_->gbuffer.width);
  }

  void paint(int y, std::uint32_t* row, Scratch& scratch) const {
    if (!painter_) {
      std::fill(row + first_, row + last_, pack(background_srgb));
    } else {
      if (const int frame_row = nearest_cell(y, height_, frame_->gbuffer.height); frame_row != scratch.frame_row) {
        painter_->paint(frame_row, columns_[first_], columns_[last_ - 1] + 1, scratch);
        scratch.frame_row = frame_row;
      }
      if (columns_.size() == scratch.colors.size())
        std::copy(scratch.colors.begin() + first_, scratch.colors.begin() + last_, row + first_);
      else
        for (int x = first_; x < last_; ++x) row[x] = scratch.colors[columns_[x]];
    }
    if (layer_) layer_->paint(y, height_, first_, last_, row);
  }

 private:
  int height_, first_, last_;
  std::shared_ptr<const Frame> frame_;
  std::optional<SidePainter> painter_;
  std::optional<LayerPainter> layer_;
  std::vector<int> columns_;  // of the frame, by column of the picture
};

/// Columns left of this one are the left side's in layout split.
int divider_column(const Composition& c) {
  return c.divider > 0 ? static_cast<int>(std::lround(std::min(c.divider, 1.0) * c.width)) : 0;
}

}  // namespace

int side_at(const Composition& composition, double x) {
  if (composition.layout == Layout::split) return x < divider_column(composition) ? 0 : 1;
  return composition.layout == Layout::right || (composition.layout == Layout::flicker && composition.flicker_is_right) ? 1 : 0;
}

std::optional<std::size_t> frame_pixel(const Composition& composition, int side, int x, int y) {
  const auto& frame = composition.sides[side].frame;
  if (!frame || x < 0 || y < 0 || x >= composition.width || y >= composition.height || frame->gbuffer.size() == 0)
    return std::nullopt;
  const GBuffer& g = frame->gbuffer;
  return static_cast<std::size_t>(nearest_cell(y, composition.height, g.height)) * g.width +
         nearest_cell(x, composition.width, g.width);
}

void compose(const Composition& composition, std::span<std::uint32_t> rgba) {
  const int width = composition.width, height = composition.height;
  if (width <= 0 || height <= 0) return;
  assert(rgba.size() == static_cast<std::size_t>(width) * height);
  const bool is_split = composition.layout == Layout::split;
  const int divider = divider_column(composition);
  std::deque<Part> parts;  // they stay where they are
  if (!is_split) parts.emplace_back(composition, side_at(composition, 0), 0, width);
  if (is_split && divider > 0) parts.emplace_back(composition, 0, 0, divider);
  if (is_split && divider < width) parts.emplace_back(composition, 1, divider, width);
  for_blocks(height, 16, [&](std::size_t begin, std::size_t end) {
    Scratch scratch[2];
    for (std::size_t y = begin; y < end; ++y) {
      std::uint32_t* const row = rgba.data() + y * width;
      for (std::size_t k = 0; k < parts.size(); ++k) parts[k].paint(static_cast<int>(y), row, scratch[k]);
      if (!is_split) continue;
      for (int x = std::max(divider - 2, 0); x < std::min(divider + 2, width); ++x)
        row[x] = pack(x == divider - 1 || x == divider ? divider_light : divider_dark);
    }
  });
}

}  // namespace gnomon::viewer
