#include "measure/scene/time_reference.h"

#include <gnomon/error.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "measure/scene/load.h"

namespace gnomon {

namespace {

/// A decimal number of 0 or more, the whole text.
std::optional<double> seconds_of(std::string_view text) {
  if (text.empty() || (text.front() != '.' && (text.front() < '0' || text.front() > '9'))) return std::nullopt;
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Where the time begins, its @ included; npos where the reference can have none.
std::size_t place_of_time(const std::string& reference) {
  const std::size_t at = reference.rfind('@');
  return at == reference.npos || reference.find('/', at) != reference.npos ? reference.npos : at;
}

std::optional<PoseTime> time_of(std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const std::string_view name = equals == text.npos ? "" : text.substr(0, equals);
  if (equals != text.npos && !is_plain_name(name)) return std::nullopt;
  const auto seconds = seconds_of(equals == text.npos ? text : text.substr(equals + 1));
  if (!seconds) return std::nullopt;
  return PoseTime{std::string(name), *seconds};
}

}  // namespace

TimedReference split_time(const std::string& reference) {
  const std::size_t place = place_of_time(reference);
  if (place == reference.npos) return {reference, std::nullopt};
  const std::string text = reference.substr(place + 1);
  const auto at = time_of(text);
  std::error_code ignored;
  if (!at && std::filesystem::is_regular_file(reference, ignored)) return {reference, std::nullopt};
  if (!at)
    throw Error(
        "scene {0}: '{1}' behind the @ is neither SECONDS nor ANIMATION=SECONDS, with a name of a..z, 0..9 and _ and a "
        "number of 0 or more; and {0} is no file",
        reference, text);
  return {reference.substr(0, place), at};
}

std::string without_time(const std::string& reference) {
  const std::size_t place = place_of_time(reference);
  if (place == reference.npos || !time_of(std::string_view(reference).substr(place + 1))) return reference;
  return reference.substr(0, place);
}

std::string with_time(const std::string& scene, const PoseTime& at) {
  const double seconds = at.seconds + 0.0;  // minus zero is zero
  return fmt::format("{}@{}{}{}", scene, at.animation, at.animation.empty() ? "" : "=", seconds);
}

std::vector<std::string> at_times(const std::vector<std::string>& scenes, const std::string& animation,
                                  const std::vector<double>& times) {
  if (!animation.empty() && !is_plain_name(animation))
    throw Error("animation = '{}' is not a name of a..z, 0..9 and _, at most 100 of them", animation);
  if (!animation.empty() && times.empty())
    throw Error("animation = {} needs a time: the seconds at which it is shown", animation);
  if (times.size() > most_times) throw Error("{} times are given; at most {} are taken", times.size(), most_times);
  for (const double seconds : times)
    if (!(seconds >= 0 && std::isfinite(seconds))) throw Error("time = {} is not a number of seconds, 0 or more", seconds);
  std::vector<std::string> references;
  for (const std::string& scene : scenes) {
    const TimedReference timed = split_time(scene);
    if (timed.at && !times.empty())
      throw Error("{} has a time already, and gets another: {}", scene_in_words(scene), times.front());
    if (times.empty()) references.push_back(timed.at ? with_time(timed.scene, *timed.at) : scene);
    for (const double seconds : times) references.push_back(with_time(scene, {animation, seconds}));
  }
  return references;
}

}  // namespace gnomon
