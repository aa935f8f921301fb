#include "measure/score/error_picture.h"

#include <algorithm>
#include <array>

#include "measure/picture/legend.h"

namespace gnomon {

std::span<const ErrorKind> error_kinds(bool with_causes) {
  static const std::vector<ErrorKind> causes = [] {
    std::vector<ErrorKind> kinds;
    for (const CauseInfo& info : cause_infos()) {
      std::string label(info.name);
      std::ranges::replace(label, '_', ' ');
      kinds.push_back({info.color, label});
    }
    return kinds;
  }();
  static const std::array<ErrorKind, 2> sides = [] {
    const auto color = [](Cause cause) { return cause_infos()[static_cast<std::size_t>(cause) - 1].color; };
    return std::array<ErrorKind, 2>{{{color(Cause::acne), "false dark"}, {color(Cause::peter_panning), "false lit"}}};
  }();
  if (with_causes) return causes;
  return sides;
}

Picture draw_errors(const Evidence& evidence, const std::string& title) {
  const GBuffer& gbuffer = *evidence.gbuffer;
  const std::span<const ErrorKind> kinds = error_kinds(!evidence.causes.empty());
  std::vector<int> kind_of(gbuffer.size());
  std::vector<std::size_t> counts(kinds.size(), 0);
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    if (kind_of[i] = error_kind(evidence, i); kind_of[i] >= 0) ++counts[kind_of[i]];
  const auto tested = static_cast<double>(std::ranges::count(evidence.classes, PixelClass::T));
  PictureLegend legend(gbuffer.width);
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

}  // namespace gnomon
