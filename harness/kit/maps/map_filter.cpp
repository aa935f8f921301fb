#include <gnomon/kit/maps/map_filter.h>

#include <numbers>

namespace gnomon {

int MapFilter::margin() const {
  switch (kind) {
    case Kind::nearest:
      return 0;
    case Kind::pcf:
      return radius;
    case Kind::bilinear:
      return 1;
    case Kind::bicubic:
      return 2;
    case Kind::disc:
    case Kind::optimized:
    case Kind::rotated:
      return radius + 1;
    case Kind::revectorized:
      return search + 1;
  }
  return 0;
}

// The point is up to half a texel from the middle of its own, along both axes; that of a disc is its center.
double MapFilter::reach() const {
  switch (kind) {
    case Kind::nearest:
      return 1;
    case Kind::pcf:
      return 2 * radius + 1;
    case Kind::disc:
      return (radius + 0.5) * std::numbers::sqrt2;
    case Kind::bilinear:
      return 2;
    case Kind::optimized:
      return 2 * (radius + 1);
    case Kind::bicubic:
      return 4;
    case Kind::rotated:
      return (radius + 0.5) * std::numbers::sqrt2 + 1;
    case Kind::revectorized:  // the texel beside: along an edge the receiver's plane is compared with
      return 3;
  }
  return 1;
}

// Castano 2013: 3, 5 and 7 texels, moved with the point by bilinear weights.
std::span<const float> MapFilter::kernel(int radius) {
  static constexpr float kernels[][most_optimized + 1] = {{1, 2}, {1, 3, 4}, {1, 5, 12, 16}};
  return std::span(kernels[radius - 1]).first(static_cast<std::size_t>(radius) + 1);
}

// Vogel 1979: each place is turned by the golden angle against the one before, and has as much of the disc to itself.
glm::dvec2 MapFilter::spiral(int k) const {
  const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0)), r = (radius + 0.5) * std::sqrt((k + 0.5) / taps);
  return {r * std::cos(angle), r * std::sin(angle)};
}

namespace {

/// Jimenez 2014: interleaved gradient noise, 0 .. 1, of a frame, in float32 as the shader.
float gradient_noise(const glm::ivec2& pixel, int frame) {
  const glm::vec2 p = glm::vec2(pixel) + 5.588238f * static_cast<float>(frame);
  return glm::fract(52.9829189f * glm::fract(0.06711056f * p.x + 0.00583715f * p.y));
}

/// Of a texel k after the first one along an axis, where the point is a share of a texel behind its corner.
double moved_kernel(std::span<const float> kernel, int k, double share) {
  const auto at = [&](int i) {
    const int last = 2 * static_cast<int>(kernel.size()) - 2, mirrored = std::min(i, last - i);
    return mirrored < 0 ? 0.0 : double(kernel[static_cast<std::size_t>(mirrored)]);
  };
  return glm::mix(at(k), at(k - 1), share);
}

/// The same of the cubic B-spline.
double cubic(int k, double share) {
  const double t = std::abs(share + 1 - k);
  return t < 1 ? (4 - 6 * t * t + 3 * t * t * t) / 6 : (2 - t) * (2 - t) * (2 - t) / 6;
}

}  // namespace

int MapFilter::first_step() const {
  if (kind == Kind::bicubic) return 1;
  const bool is_round = kind == Kind::disc || kind == Kind::rotated;
  return is_round ? static_cast<int>(std::lround(radius * std::numbers::sqrt2 / 2)) : radius;
}

std::vector<WeightedTexel> MapFilter::first_texels(const glm::dvec2& place) const {
  const glm::ivec2 own(glm::floor(place));
  const int step = first_step();
  std::vector<WeightedTexel> texels{{own, 0.2}};
  for (int k = 0; k < 4; ++k) texels.push_back({own + step * glm::ivec2(k % 2 * 2 - 1, k / 2 * 2 - 1), 0.2});
  return texels;
}

std::vector<WeightedTexel> MapFilter::texels(const glm::dvec2& place, const glm::ivec2& pixel) const {
  const glm::ivec2 own(glm::floor(place));
  std::vector<WeightedTexel> texels;
  double sum = 0;
  const auto add = [&](const glm::ivec2& texel, double weight) {
    texels.push_back({texel, weight});
    sum += weight;
  };
  if (kind == Kind::rotated) {
    for (int frame = first_frame; frame < first_frame + frames; ++frame) {
      const double turn = 2 * std::numbers::pi * gradient_noise(pixel, frame), c = std::cos(turn), s = std::sin(turn);
      for (int k = 0; k < taps; ++k) {
        const glm::dvec2 aside = spiral(k);
        add(glm::ivec2(glm::floor(place + glm::dvec2(c * aside.x - s * aside.y, s * aside.x + c * aside.y))), 1);
      }
    }
  } else if (kind == Kind::optimized || kind == Kind::bicubic) {
    const int before = kind == Kind::bicubic ? 1 : radius;
    const glm::dvec2 corner = glm::floor(place - 0.5), share = place - 0.5 - corner;
    const auto weight = [&](int k, double behind) {
      return kind == Kind::bicubic ? cubic(k, behind) : moved_kernel(kernel(radius), k, behind);
    };
    for (int y = 0; y < 2 * before + 2; ++y)
      for (int x = 0; x < 2 * before + 2; ++x)
        add(glm::ivec2(corner) + glm::ivec2(x - before, y - before), weight(x, share.x) * weight(y, share.y));
  } else if (kind == Kind::bilinear) {
    const glm::dvec2 corner = glm::floor(place - 0.5), share = place - 0.5 - corner;
    for (int k = 0; k < 4; ++k) {
      const glm::ivec2 aside(k % 2, k / 2);
      const glm::dvec2 near = glm::mix(1.0 - share, share, glm::dvec2(aside));
      add(glm::ivec2(corner) + aside, near.x * near.y);
    }
  } else {
    const int m = kind == Kind::revectorized ? 0 : margin();
    for (int y = -m; y <= m; ++y)
      for (int x = -m; x <= m; ++x) {
        const glm::ivec2 texel = own + glm::ivec2(x, y);
        const double distance = glm::distance(glm::dvec2(texel) + 0.5, place);
        add(texel, kind == Kind::disc ? glm::clamp(radius + 0.5 - distance, 0.0, 1.0) : 1);
      }
  }
  for (WeightedTexel& one : texels) one.weight /= sum;
  return texels;
}

// --- The same in the shader ------------------------------------------------------------------------------------------------

std::string filter_head(const MapFilter& filter) {
  return fmt::format("#define FILTER {}\n#define MOST_TAPS {}\n{}", static_cast<int>(filter.kind), MapFilter::most_taps,
                     filter.bails_early && filter.has_loop() ? "#define BAILS_EARLY\n" : "");
}

void set_filter(const Program& program, const MapFilter& filter) {
  program.set_if_used("radius", filter.radius);
  program.set_if_used("first_step", filter.first_step());
  program.set_if_used("edge_search", filter.search);
  if (filter.kind == MapFilter::Kind::rotated) {
    std::array<glm::vec4, MapFilter::most_taps> spiral{};
    for (int k = 0; k < filter.taps; ++k) spiral[static_cast<std::size_t>(k)] = glm::vec4(filter.spiral(k), 0, 0);
    program.set_if_used("spiral", std::span<const glm::vec4>(spiral));
    program.set_if_used("spiral_taps", filter.taps);
    program.set_if_used("noise_begin", filter.first_frame);
    program.set_if_used("noise_end", filter.first_frame + filter.frames);
  }
  if (filter.kind == MapFilter::Kind::optimized) {
    glm::vec4 kernel(0);
    const std::span<const float> half = MapFilter::kernel(filter.radius);
    for (std::size_t k = 0; k < half.size(); ++k) kernel[static_cast<int>(k)] = half[k];
    program.set_if_used("kernel", kernel);
  }
}

// Of a branch on a uniform both sides may be paid: the kind is the head's.
const std::string_view filter_snippet = R"(
#if FILTER == 1 || FILTER == 2 || FILTER == 4
uniform int radius;
#endif
#ifdef BAILS_EARLY
uniform int first_step;
#endif
#if FILTER == 4
uniform vec4 kernel;
#elif FILTER == 6
uniform vec4 spiral[MOST_TAPS];
uniform int spiral_taps, noise_begin, noise_end;
#elif FILTER == 7
uniform int edge_search;
vec2 decided_at;
#endif

#if FILTER == 4
float half_kernel(int k) {
  int mirrored = min(k, 2 * radius - k);
  return mirrored < 0 ? 0 : mirrored == 0 ? kernel.x : mirrored == 1 ? kernel.y : mirrored == 2 ? kernel.z : kernel.w;
}
float weight_along(int k, float share) { return mix(half_kernel(k), half_kernel(k - 1), share); }
#elif FILTER == 5
float weight_along(int k, float share) {
  float t = abs(share + 1 - float(k)), far = 2 - t;
  return t < 1 ? 4 + t * t * (3 * t - 6) : far * far * far;
}
#elif FILTER == 6
float gradient_noise(vec2 pixel) {
  precise float along = 0.06711056 * pixel.x + 0.00583715 * pixel.y, many = 52.9829189 * fract(along);
  return fract(many);
}
#endif

#if FILTER == 7
bool is_dark_at(ComparedPoint point, vec2 tap) { return lit_at(point, tap) == 0; }

/// How many texels after this one have the edge to the dark texels on that side, and whether a dark one ends it.
float edge_ahead(ComparedPoint point, vec2 texel, vec2 side, vec2 ahead, out bool is_dark_end) {
  is_dark_end = false;
  for (int k = 1; k <= edge_search; ++k) {
    texel += ahead;
    is_dark_end = is_dark_at(point, texel);
    if (is_dark_end || !is_dark_at(point, texel + side)) return float(k - 1);
  }
  return float(edge_search);
}

/// What part of the texel is dark next to that side: up to a line which rises from nothing to a whole texel at a dark end.
float height_of_edge(ComparedPoint point, vec2 texel, vec2 side, vec2 share) {
  vec2 along = abs(side.yx);
  bool is_dark_before, is_dark_behind;
  float before = edge_ahead(point, texel, side, -along, is_dark_before);
  float behind = edge_ahead(point, texel, side, along, is_dark_behind);
  float part = (before + dot(along, share)) / (before + 1 + behind);
  return is_dark_before && is_dark_behind ? abs(2 * part - 1) : is_dark_before ? 1 - part : is_dark_behind ? part : 0;
}
#endif

#ifdef BAILS_EARLY
bool is_decided_early;
#else
const bool is_decided_early = false;
#endif

float compared(ComparedPoint point) {
  vec2 position = point.position;
#ifdef BAILS_EARLY
  float five = 0;
  for (int k = 0; k < 5; ++k)
    five += lit_at(point, floor(position) + (k == 4 ? vec2(0) : float(first_step) * vec2(k % 2 * 2 - 1, k / 2 * 2 - 1)));
  is_decided_early = five == 0 || five == 5;
#endif
  // Loops end at once where no pixel beside has anything to do; of a branch both sides may be paid.
  bool is_done = !point.is_compared || is_decided_early;
#if FILTER == 0
  float lit = lit_at(point, floor(position));
#elif FILTER == 3
  vec2 corner = floor(position - 0.5), share = position - 0.5 - corner;
  float upper = lit_at(point, corner), upper_right = lit_at(point, corner + vec2(1, 0));
  float lower = lit_at(point, corner + vec2(0, 1)), lower_right = lit_at(point, corner + vec2(1, 1));
  // Differences: four of one kind give that exactly.
  upper += share.x * (upper_right - upper), lower += share.x * (lower_right - lower);
  float lit = upper + share.y * (lower - upper);
#elif FILTER == 6
  float lit = 0, sum = 0;
  for (int frame = noise_begin; frame < noise_end && !is_done; ++frame) {
    float turn = 6.2831853 * gradient_noise(pixel_here() + 5.588238 * float(frame)), c = cos(turn), s = sin(turn);
    for (int k = 0; k < spiral_taps; ++k)
      lit += lit_at(point, floor(position + mat2(c, s, -s, c) * spiral[k].xy)), sum += 1;
  }
#elif FILTER == 7
  vec2 texel = floor(position), share = position - texel;
  float lit = lit_at(point, texel);
  decided_at = position;
  for (int k = 0; k < 4 && !is_done && lit == 1; ++k) {
    vec2 side = float(k % 2 * 2 - 1) * (k < 2 ? vec2(1, 0) : vec2(0, 1));
    float from_side = abs(dot(side, share) - float(k % 2));
    if (!is_dark_at(point, texel + side) || from_side >= height_of_edge(point, texel, side, share)) continue;
    lit = 0;
    decided_at = texel + side + 0.5;
  }
#elif FILTER >= 4
  float lit = 0, sum = 0;
  vec2 corner = floor(position - 0.5), share = position - 0.5 - corner;
#if FILTER == 5
  const int radius = 1;
#endif
  for (int y = 0; y < 2 * radius + 2 && !is_done; ++y)
    for (int x = 0; x < 2 * radius + 2; ++x) {
      precise float weight = weight_along(x, share.x) * weight_along(y, share.y);  // one number in both sums
      lit += weight * lit_at(point, corner + vec2(x - radius, y - radius)), sum += weight;
    }
#else
  float lit = 0, sum = 0;
  vec2 center = floor(position);
  int reach = radius + FILTER - 1;
  for (int y = -reach; y <= reach && !is_done; ++y)
    for (int x = -reach; x <= reach; ++x) {
      vec2 tap = center + vec2(x, y);
      float weight = FILTER == 1 ? 1 : clamp(float(radius) + 0.5 - distance(tap + 0.5, position), 0, 1);
      lit += weight * lit_at(point, tap), sum += weight;
    }
#endif
#if FILTER != 0 && FILTER != 3 && FILTER != 7
#ifdef BAILS_EARLY
  if (is_decided_early) lit = five, sum = 5;
#endif
  lit = lit < sum ? min(lit / sum, 1) : 1;  // x / x may be another number: division is right to 2.5 units in the last place
#endif
  return point.is_compared ? lit : 1;
}
)";

}  // namespace gnomon
