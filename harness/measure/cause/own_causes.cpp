// Causes of a technique's own: rows behind the common ones, and what they must be like.
#include "measure/cause/own_causes.h"

#include <algorithm>
#include <cctype>

#include "measure/cause/color_vision.h"
#include "measure/scene/load.h"

namespace gnomon {

namespace {

using Color = std::array<std::uint8_t, 3>;

std::string hex(const Color& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

/// The common causes, and as rows of their own the grays that error pictures have between them: what other colors must stay
/// apart from.
std::vector<CauseInfo> common_colors() {
  std::vector<CauseInfo> taken = with_common({});
  for (std::uint8_t gray = 20; gray <= 172; ++gray)
    taken.push_back({Cause::none, "the pictures' gray", "", rgb(gray, gray, gray)});
  return taken;
}

/// The distance to the nearest of the colors for the people to whom it is smallest, and which one that is.
std::pair<double, const CauseInfo*> nearest(const Color& color, std::span<const CauseInfo> taken) {
  std::pair<double, const CauseInfo*> best{INFINITY, nullptr};
  for (const glm::dmat3& vision : color_vision::visions) {
    const glm::dvec3 own = color_vision::lab(color, vision);
    for (const CauseInfo& other : taken)
      if (const double d = glm::distance(own, color_vision::lab(other.color, vision)); d < best.first) best = {d, &other};
  }
  return best;
}

/// The free color that looks most like this one, among some 36000.
Color nearest_free(const Color& color, std::span<const CauseInfo> taken) {
  const glm::dvec3 lab = color_vision::lab(color, color_vision::visions[0]);
  std::vector<std::pair<double, Color>> candidates;
  const auto level = [](int k) { return static_cast<std::uint8_t>(std::min(8 * k, 255)); };
  for (int r = 0; r <= 32; ++r)
    for (int g = 0; g <= 32; ++g)
      for (int b = 0; b <= 32; ++b) {
        const Color candidate{level(r), level(g), level(b)};
        candidates.emplace_back(glm::distance(lab, color_vision::lab(candidate, color_vision::visions[0])), candidate);
      }
  std::ranges::sort(candidates);
  const auto free = std::ranges::find_if(
      candidates, [&](const auto& candidate) { return nearest(candidate.second, taken).first >= least_color_distance; });
  return free == candidates.end() ? color : free->second;
}

/// One technique alone.
void check(const TechniqueEntry& entry, std::vector<CauseInfo> taken) {
  const auto causes = entry.about.causes;
  if (causes.size() > most_own_causes)
    throw Error("technique {} declares {} causes; {} are allowed", entry.id, causes.size(), most_own_causes);
  for (std::size_t k = 0; k < causes.size(); ++k) {
    const OwnCause& cause = causes[k];
    const std::string what = fmt::format("cause {} of technique {}", cause.id, entry.id);
    if (!is_plain_name(cause.id) || !std::islower(static_cast<unsigned char>(cause.id.front())))
      throw Error("{}: the name is not plain; lowercase letters, digits and underscores are, with a letter first", what);
    if (cause.id == name(Cause::none) || std::ranges::find(cause_infos(), cause.id, &CauseInfo::name) != cause_infos().end())
      throw Error("{}: the name is taken by a common cause (`gnomon list causes`)", what);
    if (std::ranges::find(causes.first(k), cause.id, &OwnCause::id) != causes.begin() + static_cast<std::ptrdiff_t>(k))
      throw Error("{} is declared twice", what);
    if (cause.sentence.find_first_not_of(" \t\n") == std::string_view::npos)
      throw Error("{} has no sentence that says what it means", what);
    if (const auto [distance, other] = nearest(cause.color, taken); distance < least_color_distance)
      throw Error(
          "{}: its color {} is {:.1f} from that of {}, to people who tell the two apart least; {} in CIE Lab is the "
          "least that is allowed, which {} has",
          what, hex(cause.color), distance, other->name, least_color_distance, hex(nearest_free(cause.color, taken)));
    taken.push_back({Cause::none, cause.id, cause.sentence, cause.color});
  }
}

}  // namespace

std::vector<CauseInfo> own_causes(const About& about) {
  std::vector<CauseInfo> rows;
  for (const OwnCause& cause : about.causes) rows.push_back({own_cause(rows.size()), cause.id, cause.sentence, cause.color});
  return rows;
}

std::vector<CauseInfo> with_common(std::span<const CauseInfo> own) {
  std::vector<CauseInfo> all(cause_infos().begin(), cause_infos().end());
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

Cause own_cause_named(std::string_view name, std::span<const CauseInfo> own) {
  const auto found = std::ranges::find(own, name, &CauseInfo::name);
  if (found != own.end()) return found->cause;
  std::vector<std::string> names;
  for (const CauseInfo& info : own) names.emplace_back(info.name);
  throw Error("an explanation names the cause {}, which the technique does not declare; it declares {}", name,
              names.empty() ? "none" : joined(names));
}

void check_own_causes(std::span<const TechniqueEntry> techniques) {
  std::map<std::string_view, std::pair<const TechniqueEntry*, const OwnCause*>> declared;
  std::vector<CauseInfo> common;
  for (const TechniqueEntry& entry : techniques) {
    if (entry.about.causes.empty()) continue;
    if (common.empty()) common = common_colors();
    check(entry, common);
    for (const OwnCause& cause : entry.about.causes) {
      const auto [found, is_new] = declared.try_emplace(cause.id, &entry, &cause);
      const auto& [first, same] = found->second;
      if (!is_new && (same->sentence != cause.sentence || same->color != cause.color))
        throw Error("techniques {} and {} have a cause {} each with another sentence or color; one name means one thing",
                    first->id, entry.id, cause.id);
    }
  }
}

}  // namespace gnomon
