// What a composition has to show, and what its colors mean.
#include <algorithm>
#include <cmath>
#include <functional>

#include "app/viewer/compose.h"
#include "measure/cause/own_causes.h"
#include "measure/picture/signed_color.h"
#include "measure/score/error_picture.h"

namespace gnomon::viewer {

namespace {

bool is_whole(const ReferenceState& reference) {
  if (!reference.frame) return false;
  const std::size_t size = reference.frame->gbuffer.size();
  return reference.mask.size() == size && reference.classes.size() == size;
}

constexpr std::string_view of_tested = "of tested pixels", of_all = "of all pixels";

std::optional<double> share_of(std::size_t count, std::size_t all) {
  if (all == 0) return std::nullopt;
  return static_cast<double>(count) / static_cast<double>(all);
}

bool is_soft_frame(const Composition& composition, int side) {
  const auto& frame = composition.sides[side].frame;
  return frame && frame->has_shares();
}

/// Where masks have values between there is a bar instead.
std::vector<LegendEntry> mask_legend(const Composition& composition, int side) {
  if (is_soft_frame(composition, side)) return {};
  return {{{255, 255, 255}, "lit", {}, {}}, {{0, 0, 0}, "umbra", {}, {}}};
}

/// Tested pixels that differ by more than half of the full scale: at full scale 1, those where one would be wrong if the other
/// were the reference.
std::vector<LegendEntry> difference_legend(const Composition& composition, int side) {
  const ComposeSide& here = composition.sides[side];
  const bool is_reference = composition.difference.against == Against::reference;
  const ComposeSide there = is_reference ? reference_side(composition, side) : composition.sides[1 - side];
  const double full = composition.difference.full;
  LegendEntry darker{signed_color(-1, 1), "darker", {}, of_tested}, lighter{signed_color(1, 1), "lighter", {}, of_tested};
  const ReferenceState* const reference = reference_of(composition, side);
  if (reference && has_full_mask(here) && has_full_mask(there) && is_same(here.frame, there.frame)) {
    std::size_t tested = 0, darker_count = 0, lighter_count = 0;
    for (std::size_t i = 0; i < here.mask.size(); ++i) {
      if (reference->classes[i] != PixelClass::T) continue;
      ++tested;
      const float difference = here.mask[i] - there.mask[i];
      if (std::abs(difference) > full / 2) ++(difference < 0 ? darker_count : lighter_count);
    }
    darker.share = share_of(darker_count, tested);
    lighter.share = share_of(lighter_count, tested);
  }
  return {darker, lighter};
}

/// Largest first, equal ones in their order, as error pictures have them.
void sort_by_share(std::vector<LegendEntry>& entries) {
  std::ranges::stable_sort(entries, std::greater<>(), [](const LegendEntry& entry) { return entry.share.value_or(0); });
}

/// Under a light with area: of each kind that is drawn its part of the error.
std::vector<LegendEntry> soft_errors_legend(const Evidence& evidence) {
  const std::vector<ErrorKind> kinds = error_kinds(evidence, true);
  std::vector<double> errors(kinds.size(), 0);
  std::vector<bool> is_drawn(kinds.size(), false);
  double all = 0;
  for (std::size_t i = 0; i < evidence.mask.size(); ++i) {
    if (evidence.classes[i] != PixelClass::T) continue;
    const double error = std::abs(static_cast<double>(evidence.mask[i]) - evidence.reference[i]);
    all += error;
    if (const int kind = kind_of(evidence, i); kind >= 0) errors[kind] += error;
    if (const ErrorMark mark = error_mark(evidence, i, true); mark.kind >= 0) is_drawn[mark.kind] = true;
  }
  std::vector<LegendEntry> entries;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (is_drawn[k]) entries.push_back({kinds[k].color, kinds[k].label, errors[k] / all, "of the error"});
  sort_by_share(entries);
  return entries;
}

std::vector<LegendEntry> errors_legend(const Composition& composition, int side, bool with_causes) {
  const Verdict* const verdict = verdict_of(composition.sides[side]);
  if (!verdict) return {};
  if (const std::optional<Evidence> evidence = evidence_of(composition, side, with_causes); evidence && is_soft(*evidence))
    return soft_errors_legend(*evidence);
  std::vector<LegendEntry> entries;
  const std::vector<ErrorKind> kinds = error_kinds(with_causes, false, verdict->own_causes);
  const std::vector<CauseInfo> causes = with_common(verdict->own_causes);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    std::size_t count = k == 0 ? verdict->errors.false_dark : verdict->errors.false_lit;
    if (with_causes) {
      const auto found = verdict->cause_counts.find(std::string(causes[k].name));
      count = found == verdict->cause_counts.end() ? 0 : found->second;
    }
    if (count > 0) entries.push_back({kinds[k].color, kinds[k].label, share_of(count, verdict->errors.tested), of_tested});
  }
  sort_by_share(entries);
  return entries;
}

std::vector<LegendEntry> classes_legend(const Composition& composition, int side) {
  const ReferenceState* const reference = reference_of(composition, side);
  if (!reference) return {};
  std::vector<LegendEntry> entries;
  const std::array<std::size_t, 6> counts = count_classes(reference->classes);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const ClassInfo& row = class_infos()[k];
    entries.push_back(
        {row.color, fmt::format("{} {}", row.letter, row.word), share_of(counts[k], reference->classes.size()), of_all});
  }
  return entries;
}

}  // namespace

const Verdict* verdict_of(const ComposeSide& side) {
  const Verdict* const v = side.verdict;
  if (!v || !v->answer || !v->reference || !has_full_mask(side)) return nullptr;
  if (!is_same(v->answer->frame, side.frame) || !is_same(v->reference->frame, side.frame)) return nullptr;
  return is_whole(*v->reference) ? v : nullptr;
}

const ReferenceState* reference_of(const Composition& composition, int side) {
  const auto& frame = composition.sides[side].frame;
  if (const Verdict* const own = verdict_of(composition.sides[side])) return own->reference.get();
  if (composition.reference && is_same(composition.reference->frame, frame) && is_whole(*composition.reference))
    return composition.reference;
  const Verdict* const other = verdict_of(composition.sides[1 - side]);
  return other && is_same(other->reference->frame, frame) ? other->reference.get() : nullptr;
}

namespace {

/// The reference of the side's frame, also one without classes yet; null where there is none.
const ReferenceState* truth_of(const Composition& composition, int side) {
  if (const ReferenceState* const whole = reference_of(composition, side)) return whole;
  const ReferenceState* const newest = composition.reference;
  return newest && is_same(newest->frame, composition.sides[side].frame) ? newest : nullptr;
}

LightShareKind estimates_of(const ComposeSide& side) {
  const Verdict* const verdict = verdict_of(side);
  return verdict ? verdict->estimates : LightShareKind::area;
}

}  // namespace

ComposeSide reference_side(const Composition& composition, int side) {
  const ComposeSide& own = composition.sides[side];
  const ReferenceState* const truth = truth_of(composition, side);
  if (!truth) return {};
  const std::span<const float> mask = share_of(*truth, estimates_of(own));
  const bool has_channels = mask.data() == truth->mask.data();
  return {.frame = own.frame,
          .mask = mask,
          .mask_width = truth->width,
          .mask_height = truth->height,
          .channels = has_channels ? spans_of(truth->channels) : ChannelSpans()};
}

std::span<const float> reference_error(const Composition& composition, int side) {
  const ReferenceState* const truth = truth_of(composition, side);
  if (!truth) return {};
  return estimates_of(composition.sides[side]) == LightShareKind::irradiance ? truth->irradiance_error : truth->error;
}

std::optional<Evidence> evidence_of(const Composition& composition, int side, bool with_causes) {
  const ComposeSide& s = composition.sides[side];
  const ReferenceState* const reference = reference_of(composition, side);
  if (!reference || !has_full_mask(s)) return std::nullopt;
  const Verdict* const verdict = verdict_of(s);
  if (s.frame->is_together()) {
    // Where a light is not tested its reference counts, so that the mask alone is not enough.
    if (!verdict || !verdict->together || (with_causes && !verdict->has_causes)) return std::nullopt;
    Evidence whole = verdict->together->evidence();
    if (!with_causes) whole.causes = {};
    return whole;
  }
  Evidence evidence =
      evidence_of(s.mask_width, s.mask_height, s.mask, *reference, verdict ? verdict->estimates : LightShareKind::area);
  if (!with_causes || (verdict && verdict->has_causes && verdict->causes.empty())) return evidence;  // none were sought
  if (!verdict || verdict->causes.size() != s.mask.size()) return std::nullopt;
  evidence.causes = verdict->causes;
  evidence.own_causes = verdict->own_causes;
  return evidence;
}

std::optional<LegendBar> legend_bar(const Composition& composition, int side) {
  constexpr int steps = 128;
  LegendBar bar;
  if (composition.paint == Paint::mask && is_soft_frame(composition, side)) {
    for (int k = 0; k <= steps; ++k) {
      const std::uint8_t gray = mask_gray(static_cast<float>(k) / steps);
      bar.colors.push_back({gray, gray, gray});
    }
    bar.marks = {{0, "0 umbra"}, {0.5, "penumbra"}, {1, "1 lit"}};
    return bar;
  }
  if (composition.paint != Paint::difference) return std::nullopt;
  const double full = composition.difference.full;
  for (int k = 0; k <= steps; ++k) bar.colors.push_back(signed_color(2.0 * k / steps - 1, 1));
  for (int k = -2; k <= 2; ++k) bar.marks.push_back({(k + 2) / 4.0, k == 0 ? "0" : fmt::format("{:+.3g}", k * full / 2)});
  return bar;
}

std::vector<LegendEntry> legend(const Composition& composition, int side) {
  const Paint paint = composition.paint;
  if (paint == Paint::mask) return mask_legend(composition, side);
  if (paint == Paint::difference) return difference_legend(composition, side);
  if (paint == Paint::kinds || paint == Paint::causes) return errors_legend(composition, side, paint == Paint::causes);
  return paint == Paint::classes ? classes_legend(composition, side) : std::vector<LegendEntry>{};
}

std::span<const Tally> tallies(const Frame* frame) {
  static constexpr auto percent_of = [](double part, std::size_t whole) {
    return whole ? fmt::format("{:.4f} %", 100 * part / static_cast<double>(whole)) : std::string();
  };
  static constexpr auto percent_or_none = [](const std::optional<double>& share) {
    return share ? fmt::format("{:.4f} %", 100 * *share) : std::string();
  };
  static constexpr Tally tested{"tested", "Pixels of class T: those whose answer is beyond doubt.",
                                [](const Verdict& v) { return fmt::format("{}", v.errors.tested); }};
  static constexpr Tally wrong{"wrong", "Share of the tested pixels that are off by more than one half.", [](const Verdict& v) {
                                 return percent_of(static_cast<double>(v.errors.wrong), v.errors.tested);
                               }};
  static constexpr Tally error{"error", "Mean difference from the reference over the tested pixels.",
                               [](const Verdict& v) { return percent_of(v.errors.error_sum, v.errors.tested); }};
  static constexpr Tally own{"floor", "Error that the reference's own noise alone makes: no smaller one can be told from 0.",
                             [](const Verdict& v) { return percent_or_none(v.error_floor); }};
  static constexpr Tally received{
      "light error", "Root mean square error of the light that tested pixels receive of all lights, as a share of that light.",
      [](const Verdict& v) { return percent_or_none(v.received_error); }};
  static constexpr Tally constant{
      "constant", "Error of the best mask of one value: a mask that does not beat it says nothing of the shadow.",
      [](const Verdict& v) { return percent_or_none(v.constant_error); }};
  static constexpr Tally false_dark{"false dark", "Tested pixels that are dark where the reference is lit.",
                                    [](const Verdict& v) { return fmt::format("{}", v.errors.false_dark); }};
  static constexpr Tally false_lit{"false lit", "Tested pixels that are lit where the reference is dark.",
                                   [](const Verdict& v) { return fmt::format("{}", v.errors.false_lit); }};
  static constexpr Tally hard[] = {error, constant, wrong, false_dark, false_lit, tested};
  static constexpr Tally soft[] = {error, constant, own, wrong, tested};
  static constexpr Tally several[] = {error, constant, own, received, tested};
  if (frame && frame->is_together()) return several;
  return frame && frame->has_shares() ? std::span<const Tally>(soft) : hard;
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
