// The value of a track between its keys. Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), Appendix C.
#include <gnomon/error.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "measure/scene/pose.h"

namespace gnomon {
namespace {

using Values = std::span<const double>;

/// The numbers of one key; tangents only of a cubic one, per second.
struct TrackKey {
  Values in, value, out;
};

TrackKey key_of(const Track& track, std::size_t k) {
  const std::size_t width = track.width();
  const Values values(track.values);
  if (track.interpolation != Track::Interpolation::cubic) return {{}, values.subspan(k * width, width), {}};
  const Values three = values.subspan(3 * k * width, 3 * width);
  return {three.first(width), three.subspan(width, width), three.last(width)};
}

/// A sum with the first value outside of the products: two equal keys hold their value to the bit.
std::vector<double> lerped(Values a, Values b, double share) {
  std::vector<double> value(a.begin(), a.end());
  for (std::size_t i = 0; i < value.size(); ++i) value[i] += share * (b[i] - a[i]);
  return value;
}

/// `seconds` lie between the keys. The weight of the first value, 1 - (3t2 - 2t3), is taken apart as in `lerped`.
std::vector<double> cubic_between(const TrackKey& a, const TrackKey& b, double seconds, double share) {
  const double t2 = share * share, t3 = t2 * share;
  const double end = 3 * t2 - 2 * t3, leave = seconds * (t3 - 2 * t2 + share), arrive = seconds * (t3 - t2);
  std::vector<double> value(a.value.begin(), a.value.end());
  for (std::size_t i = 0; i < value.size(); ++i)
    value[i] += end * (b.value[i] - a.value[i]) + leave * a.out[i] + arrive * b.in[i];
  return value;
}

glm::dvec4 turn_of(Values q) { return {q[0], q[1], q[2], q[3]}; }
std::vector<double> numbers_of(const glm::dvec4& q) { return {q.x, q.y, q.z, q.w}; }

/// The short way from one unit quaternion to the other: q and -q are the same turn.
std::vector<double> slerped(Values a, Values b, double share) {
  if (std::ranges::equal(a, b)) return {a.begin(), a.end()};
  const glm::dvec4 from = turn_of(a), to = turn_of(b);
  const double cosine = glm::dot(from, to), side = cosine < 0 ? -1 : 1;
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  constexpr double least_angle = 1e-6;  // below, quotients of sines are those of their angles within 2e-13
  if (angle < least_angle) return numbers_of(glm::normalize((1 - share) * from + share * side * to));
  const double sine = std::sin(angle);
  return numbers_of(std::sin((1 - share) * angle) / sine * from + side * std::sin(share * angle) / sine * to);
}

}  // namespace

std::vector<double> sampled(const Track& track, double seconds) {
  assert(!track.times.empty());
  // Of keys at one time the last one counts.
  const auto after = std::ranges::upper_bound(track.times, seconds);
  const std::size_t next = after - track.times.begin(), last = next - (next > 0);
  const TrackKey a = key_of(track, last);
  const bool is_between = next > 0 && next < track.times.size() && track.times[last] < seconds;
  if (!is_between || track.interpolation == Track::Interpolation::step) return {a.value.begin(), a.value.end()};
  const TrackKey b = key_of(track, next);
  const double between = track.times[next] - track.times[last], share = (seconds - track.times[last]) / between;
  const bool turns = track.property == Track::Property::rotation;
  if (track.interpolation == Track::Interpolation::linear)
    return turns ? slerped(a.value, b.value, share) : lerped(a.value, b.value, share);
  const std::vector<double> value = cubic_between(a, b, between, share);
  if (!turns) return value;
  if (!(glm::length(turn_of(value)) > 0))
    throw Error("the rotation of node {} is no turn at {} s: its cubic curve passes (0, 0, 0, 0)", track.node, seconds);
  return numbers_of(glm::normalize(turn_of(value)));
}

}  // namespace gnomon
