#include <gnomon/kit/bases/light_objects.h>

#include <algorithm>

namespace gnomon {

LightObjects::LightObjects(const TechniqueEntry& entry, const std::string& settings) : entry_(entry), settings_(settings) {
  objects_.push_back({.technique = fresh()});
}

LightObjects::LightObjects(const TechniqueEntry& entry, const std::string& settings, const Technique& elsewhere)
    : entry_(entry), settings_(settings), elsewhere_(&elsewhere) {}

std::unique_ptr<Technique> LightObjects::fresh() const {
  auto technique = entry_.make();
  technique->apply(settings_);
  return technique;
}

bool LightObjects::hold_by_scene(const std::vector<std::size_t>& scenes) {
  // Objects share with earlier ones: those before the first difference stay.
  std::size_t kept = 0;
  while (kept < std::min(count(), scenes.size()) && objects_[kept].scene == scenes[kept]) ++kept;
  objects_.resize(kept);
  bool has_whole = false;
  for (std::size_t k = kept; k < scenes.size(); ++k) {
    const auto first = std::ranges::find(objects_, scenes[k], &Object::scene);
    const Technique* const source = elsewhere_ ? elsewhere_ : first != objects_.end() ? first->technique.get() : nullptr;
    Object object{.technique = source ? source->for_another_light() : nullptr, .scene = scenes[k], .is_first = !source};
    object.shares = object.technique != nullptr;
    if (!object.shares) object.technique = fresh();
    has_whole = has_whole || !object.shares;
    objects_.push_back(std::move(object));
  }
  return has_whole;
}

std::optional<bool> LightObjects::shares() const {
  const auto further = std::ranges::find(objects_, false, &Object::is_first);
  return further == objects_.end() ? std::nullopt : std::optional(further->shares);
}

std::optional<Stage> LightObjects::set(const std::string& settings) {
  settings_ = settings;
  const auto wanted = fresh();
  std::optional<Stage> spoiled;
  for (const Parameter* row : wanted->parameters())
    for (std::size_t k = 0; k < count(); ++k) {
      Parameter& live = (*this)[k].parameter(row->name());
      if (live.text() == row->text()) continue;
      live.set(row->text());
      spoiled = std::min(spoiled.value_or(row->spoils()), row->spoils());
    }
  return spoiled;
}

void LightObjects::forget() {
  for (const Object& object : objects_) object.technique->forget();
}

Counts LightObjects::counts() const {
  Counts sum;
  std::vector<double> times;  // how many objects gave it
  for (const Object& object : objects_)
    for (Count& count : object.technique->counts()) {
      const auto known = std::ranges::find(sum, count.name, &Count::name);
      if (known == sum.end()) {
        sum.push_back(std::move(count));
        times.push_back(1);
        continue;
      }
      ++times[static_cast<std::size_t>(known - sum.begin())];
      known->value =
          count.together == Count::Together::largest ? std::max(known->value, count.value) : known->value + count.value;
    }
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (sum[k].together == Count::Together::mean) sum[k].value /= times[k];
  return sum;
}

Support support_together(const std::vector<Light>& lights, const std::vector<Support>& supports) {
  if (supports.size() == 1) return supports.front();
  constexpr std::size_t most_names = 4;
  /// "no shadows of lamp, window: a shadow map has one center", for each reason of supports of this kind.
  const auto reasons = [&](Support::Kind kind, const char* words) {
    std::vector<std::string> texts, whys;
    for (const Support& support : supports)
      if (support.kind() == kind && std::ranges::find(whys, support.why()) == whys.end()) whys.push_back(support.why());
    for (const std::string& why : whys) {
      std::vector<std::string> names;
      std::size_t more = 0;
      for (std::size_t k = 0; k < lights.size(); ++k)
        if (supports[k].kind() == kind && supports[k].why() == why)
          names.size() < most_names ? names.push_back(lights[k].name) : void(++more);
      texts.push_back(
          fmt::format("{}{}{}: {}", words, joined(names, ", "), more ? fmt::format(" and {} more", more) : "", why));
    }
    return joined(texts, "; ");
  };
  const auto are = [&](Support::Kind kind) { return std::ranges::count(supports, kind, &Support::kind); };
  const auto refused = are(Support::Kind::unsupported);
  if (refused == std::ssize(supports)) return Support::unsupported(reasons(Support::Kind::unsupported, ""));
  const std::string without = reasons(Support::Kind::unsupported, "no shadows of "),
                    roughly = reasons(Support::Kind::approximate, "");
  if (without.empty() && roughly.empty()) return Support::full();
  return Support::approximate(without + (without.empty() || roughly.empty() ? "" : "; ") + roughly);
}

}  // namespace gnomon
