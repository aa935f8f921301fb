#include <algorithm>
#include <cmath>

#include "app/viewer/compose.h"
#include "measure/cause/own_causes.h"
#include "measure/score/error_picture.h"

namespace gnomon::viewer {

namespace {

constexpr std::size_t most_taps = 4;  ///< that are shown one by one

/// Without a sign before a zero.
std::string number(double x, int decimals) {
  std::string text = fmt::format("{:.{}f}", x, decimals);
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

/// Six digits of the largest coordinate: float32 has seven.
std::string point_words(const glm::dvec3& p) {
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), 1e-3});
  const int decimals = std::clamp(5 - static_cast<int>(std::floor(std::log10(largest))), 0, 8);
  return fmt::format("{}, {}, {} m", number(p.x, decimals), number(p.y, decimals), number(p.z, decimals));
}

/// Meters; what a texel or a bias measures may be far below a millimeter.
std::string meters(double d) { return std::isfinite(d) ? fmt::format("{:.4g} m", d) : std::string("nothing stored"); }

/// Distances along a light's ray are compared, so all have the decimals that a tenth of the texel needs, four digits at least.
std::string distance(double d, double texel) {
  if (!std::isfinite(d)) return "nothing";
  const double step =
      std::min(texel > 0 ? texel / 10 : INFINITY, std::pow(10.0, std::floor(std::log10(std::max(d, 1e-9))) - 3));
  return fmt::format("{:.{}f} m", d, std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 9));
}

std::string mask_words(const ComposeSide& side, const GBuffer& gbuffer, std::size_t i) {
  const int x = static_cast<int>(i % gbuffer.width), y = static_cast<int>(i / gbuffer.width);
  if (has_channels(side)) {
    const std::size_t k = mask_index(side, gbuffer, x, y);
    return fmt::format("red {:.4g}, green {:.4g}, blue {:.4g}", channel_at(side, 0, k), channel_at(side, 1, k),
                       channel_at(side, 2, k));
  }
  const float v = visibility_at(side, gbuffer, x, y);
  return fmt::format("{:.4g}{}", v, v == 1 ? " lit" : v == 0 ? " umbra" : "");
}

std::string light_text(const Light& light, const glm::dvec3& point) {
  const glm::dvec4 l = homogeneous_of_center(light);
  return l.w == 0 ? std::string("infinite") : fmt::format("{:.6g} m", glm::length(to_light(l, point)));
}

/// Which taps made the pixel dark: those whose stored surface is farthest before the point, by weight until the mask's
/// value is reached, as when causes are found. So no comparison of depths is repeated.
std::vector<bool> dark_taps(const std::vector<Tap>& taps, std::span<const double> measured, double visibility) {
  std::vector<std::size_t> order(taps.size());
  for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
  const auto margin = [&](std::size_t j) { return taps[j].stored - measured[j]; };
  std::ranges::stable_sort(order, {}, margin);
  std::vector<bool> dark(taps.size(), false);
  double weight = 1 - visibility;
  for (const std::size_t j : order) {
    if (!(weight > 1e-6)) break;  // masks are float32
    weight -= taps[j].weight;
    dark[j] = true;
  }
  return dark;
}

void add_taps(const Explanation& why, const glm::dvec3& point, double visibility, std::vector<PixelFact>& facts) {
  std::vector<double> measured;
  for (const Tap& tap : why.taps) measured.push_back(glm::dot(point - tap.origin, tap.direction));
  const std::vector<bool> dark = dark_taps(why.taps, measured, visibility);
  if (why.taps.size() <= most_taps) {
    for (std::size_t j = 0; j < why.taps.size(); ++j)
      facts.push_back({why.taps.size() == 1 ? std::string("tap") : fmt::format("tap {}", j + 1),
                       fmt::format("{}: stored {}, measured {}, weight {:.3g}", dark[j] ? "dark" : "lit",
                                   distance(why.taps[j].stored, why.texel_width), distance(measured[j], why.texel_width),
                                   why.taps[j].weight)});
    return;
  }
  const auto dark_count = std::ranges::count(dark, true);
  facts.push_back({"taps", fmt::format("{}: {} dark, {} lit", why.taps.size(), dark_count, why.taps.size() - dark_count)});
  const auto [nearest, farthest] = std::ranges::minmax(why.taps, {}, &Tap::stored);
  facts.push_back({"stored", fmt::format("{} to {}", distance(nearest.stored, why.texel_width),
                                         distance(farthest.stored, why.texel_width))});
  const auto [least, most] = std::ranges::minmax(measured);
  facts.push_back({"measured", fmt::format("{} to {}", distance(least, why.texel_width), distance(most, why.texel_width))});
}

void add_samples(std::span<const LightSample> samples, std::vector<PixelFact>& facts) {
  const auto seen = std::ranges::count_if(samples, [](const LightSample& sample) { return sample.visibility > 0.5; });
  if (samples.size() == 1)
    facts.push_back({"sample", fmt::format("{} place of the light", seen == 1 ? "seen" : "hidden")});
  else
    facts.push_back({"samples", fmt::format("{} places of the light: {} seen, {} hidden", samples.size(), seen,
                                            static_cast<std::ptrdiff_t>(samples.size()) - seen)});
}

void add_explanation(const Explanation& why, const glm::dvec3& point, std::optional<double> visibility,
                     std::vector<PixelFact>& facts) {
  facts.push_back({"covered", why.covered ? "yes" : "no: the technique does not answer for this point"});
  if (!why.taps.empty()) {
    if (visibility) add_taps(why, point, *visibility, facts);
    facts.push_back({"bias", why.texel_width > 0
                                 ? fmt::format("{}, {:.3g} texels", meters(why.bias), why.bias / why.texel_width)
                                 : meters(why.bias)});
    facts.push_back({"texel width", meters(why.texel_width)});
  }
  if (!why.samples.empty()) add_samples(why.samples, facts);
  if (why.shifted) facts.push_back({"look-up point", fmt::format("moved by {}", meters(glm::distance(*why.shifted, point)))});
  if (why.element) facts.push_back({"element", fmt::format("{}", *why.element)});
  if (why.outline_error > 0) facts.push_back({"outline error", meters(why.outline_error)});
  if (why.formula_differs) facts.push_back({"formula", "the technique's own exact one answers otherwise"});
  if (!why.cause.empty()) facts.push_back({"own cause", why.cause});
}

/// Whether the pixel is wrong, or under a light with area how far it is off, and why.
void add_error(const Evidence& evidence, const std::optional<Evidence>& with_causes, std::size_t i,
               std::vector<PixelFact>& facts) {
  if (evidence.classes[i] != PixelClass::T) return;
  const bool soft = is_soft(evidence);
  const int kind = error_mark(evidence, i, soft).kind;
  std::string words = kind >= 0 ? error_kinds(false, soft)[kind].label : soft ? "too little to be drawn" : "none";
  if (soft) words = fmt::format("{:+.4f}, {}", evidence.mask[i] - evidence.reference[i], words);
  if (soft && !evidence.reference_error.empty())
    words += fmt::format("; the reference's own {:.4f}", evidence.reference_error[i]);
  facts.push_back({"error", words});
  if (!with_causes || with_causes->causes.empty()) return;
  if (const int cause = error_mark(*with_causes, i, soft).kind; cause >= 0)
    facts.push_back({"cause", fmt::format("{}. {}", error_kinds(*with_causes, soft)[cause].label,
                                          with_common(with_causes->own_causes)[cause].sentence)});
}

}  // namespace

std::vector<PixelFact> pixel_facts(const Composition& composition, int side, int x, int y, const ReferenceState* reference,
                                   const Explanation* explanation) {
  std::vector<PixelFact> facts;
  const std::optional<std::size_t> pixel = frame_pixel(composition, side, x, y);
  if (!pixel) return facts;
  const ComposeSide& own = composition.sides[side];
  const Frame& frame = *own.frame;
  const GBuffer& g = frame.gbuffer;
  const std::size_t i = *pixel;
  if (g.width != composition.width || g.height != composition.height)
    facts.push_back({"frame pixel", fmt::format("{} {} of {} x {}", i % g.width, i / g.width, g.width, g.height)});

  Composition asked = composition;
  if (reference) asked.reference = reference;
  if (const ReferenceState* const known = reference_of(asked, side)) {
    const ClassInfo& row = class_infos()[static_cast<std::size_t>(known->classes[i])];
    facts.push_back({"class", fmt::format("{}, {}. {}", row.letter, row.word, row.sentence)});
  }
  if (const std::optional<Evidence> evidence = evidence_of(asked, side, false))
    add_error(*evidence, evidence_of(asked, side, true), i, facts);
  if (g.is_background(i)) return facts;

  for (int s = 0; s < 2; ++s)
    if (has_mask(composition.sides[s]) && is_same(composition.sides[s].frame, own.frame))
      facts.push_back({fmt::format("mask {}", side_name(s)), mask_words(composition.sides[s], g, i)});
  if (const ComposeSide truth = reference_side(asked, side); has_mask(truth))
    facts.push_back({"reference", mask_words(truth, g, i)});

  const Mesh& mesh = frame.scene().meshes[g.mesh[i]];
  facts.push_back({"mesh", mesh.name.empty() ? fmt::format("number {}", g.mesh[i]) : mesh.name});
  facts.push_back({"triangle", g.truth == Truth::shape && mesh.has_curved_shape()
                                   ? fmt::format("none: exact {}", kind_name(*mesh.shape))
                                   : fmt::format("{}", g.triangle[i])});
  const glm::dvec3 point = g.position(i), normal = g.normal(i);
  facts.push_back({"position", point_words(point)});
  facts.push_back({"normal", fmt::format("{}, {}, {}", number(normal.x, 4), number(normal.y, 4), number(normal.z, 4))});
  if (frame.is_together())
    facts.push_back({"light", fmt::format("{}, one of {} together", frame.light.name, frame.lights.size())});
  const glm::dvec3 to = to_light(homogeneous_of_center(frame.light), point);
  const double cosine = glm::dot(normal, to) / std::max(glm::length(to), 1e-300);
  facts.push_back({"cosine", fmt::format("{}, {:.1f} degrees off the normal", number(cosine, 4),
                                         glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))))});
  facts.push_back({"to the light", light_text(frame.light, point)});
  if (explanation) {
    std::optional<double> visibility;
    if (has_mask(own)) visibility = visibility_at(own, g, static_cast<int>(i % g.width), static_cast<int>(i / g.width));
    add_explanation(*explanation, point, visibility, facts);
  }
  return facts;
}

}  // namespace gnomon::viewer
