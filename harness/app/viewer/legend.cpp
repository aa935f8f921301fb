
#include "app/viewer/compose_parts.h"
#include "measure/score/error_picture.h"

namespace gnomon::viewer {

namespace {

constexpr std::string_view of_tested = "of tested pixels", of_all = "of all pixels";

std::optional<double> share_of(std::size_t count, std::size_t all) {
  if (all == 0) return std::nullopt;
  return static_cast<double>(count) / static_cast<double>(all);
}

void add_mask(const Composition& composition, int side, std::vector<LegendEntry>& entries) {
  const auto& frame = composition.sides[side].frame;
  entries.push_back({{255, 255, 255}, "lit", {}, {}});
  if (frame && has_area(frame->light)) entries.push_back({{128, 128, 128}, "penumbra", {}, {}});
  entries.push_back({{0, 0, 0}, "umbra", {}, {}});
}

/// Tested pixels where one side would be wrong if the other were the reference.
void add_difference(const Composition& composition, int side, std::vector<LegendEntry>& entries) {
  const ComposeSide &here = composition.sides[side], &there = composition.sides[1 - side];
  const std::span<const ErrorKind> kinds = error_kinds(false);
  LegendEntry darker{kinds[0].color, "darker here", {}, of_tested}, lighter{kinds[1].color, "lighter here", {}, of_tested};
  const ReferenceState* const reference = reference_of(composition, side);
  if (reference && has_full_mask(here) && has_full_mask(there) && is_same(here.frame, there.frame)) {
    std::size_t tested = 0, darker_count = 0, lighter_count = 0;
    for (std::size_t i = 0; i < here.mask.size(); ++i) {
      if (reference->classes[i] != PixelClass::T) continue;
      ++tested;
      if (is_wrong(here.mask[i], there.mask[i])) ++(here.mask[i] < there.mask[i] ? darker_count : lighter_count);
    }
    darker.share = share_of(darker_count, tested);
    lighter.share = share_of(lighter_count, tested);
  }
  entries.insert(entries.end(), {darker, lighter});
}

void add_errors(const Composition& composition, int side, bool with_causes, std::vector<LegendEntry>& entries) {
  const Verdict* const verdict = verdict_of(composition.sides[side]);
  if (!verdict) return;
  const std::span<const ErrorKind> kinds = error_kinds(with_causes);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    std::size_t count = k == 0 ? verdict->errors.false_dark : verdict->errors.false_lit;
    if (with_causes) {
      const auto found = verdict->cause_counts.find(std::string(cause_infos()[k].name));
      count = found == verdict->cause_counts.end() ? 0 : found->second;
    }
    if (count > 0) entries.push_back({kinds[k].color, kinds[k].label, share_of(count, verdict->errors.tested), of_tested});
  }
}

void add_classes(const Composition& composition, int side, std::vector<LegendEntry>& entries) {
  const ReferenceState* const reference = reference_of(composition, side);
  if (!reference) return;
  const std::array<std::size_t, 6> counts = count_classes(reference->classes);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const ClassInfo& row = class_infos()[k];
    entries.push_back(
        {row.color, fmt::format("{} {}", row.letter, row.word), share_of(counts[k], reference->classes.size()), of_all});
  }
}

}  // namespace

std::vector<LegendEntry> legend(const Composition& composition, int side) {
  std::vector<LegendEntry> entries;
  switch (composition.paint) {
    case Paint::shaded:
      break;
    case Paint::mask:
      add_mask(composition, side, entries);
      break;
    case Paint::difference:
      add_difference(composition, side, entries);
      break;
    case Paint::kinds:
      add_errors(composition, side, false, entries);
      break;
    case Paint::causes:
      add_errors(composition, side, true, entries);
      break;
    case Paint::classes:
      add_classes(composition, side, entries);
      break;
  }
  return entries;
}

std::vector<LegendEntry> layer_legend(const LayerPicture& layer) {
  std::vector<LegendEntry> entries;
  for (const Swatch& s : layer.layer.legend)
    entries.push_back({{srgb(s.color.r), srgb(s.color.g), srgb(s.color.b)}, s.name, {}, {}});
  return entries;
}

std::string words(const LegendEntry& entry) {
  return entry.share ? fmt::format("{} {} {}", entry.name, percent(*entry.share), entry.of) : entry.name;
}

}  // namespace gnomon::viewer
