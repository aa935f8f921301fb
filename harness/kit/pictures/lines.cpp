#include <gnomon/kit/pictures/lines.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <limits>

namespace gnomon {

namespace {

/// Share of its distance that a point may lie beneath a surface and still count as on it. A circle of radius r in 64 segments
/// errs by 0.0012 r, which is less as soon as the eye is farther away than 1.2 r.
constexpr double beneath = 1e-3;
constexpr float hidden_share = 0.5f;
constexpr int dot_step = 4;  // pixels from one dot of a hidden part to the next; half of that is drawn

/// A point as the eye sees it: pixels times z, and z, meters along the view. Linear along a line of the world.
glm::dvec3 seen(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 v = point - camera.eye;
  const double z = glm::dot(v, camera.forward), aspect = static_cast<double>(camera.width) / camera.height;
  return {camera.width / 2.0 * (z + glm::dot(v, camera.right) / (camera.tan_y * aspect)),
          camera.height / 2.0 * (z - glm::dot(v, camera.up) / camera.tan_y), z};
}

/// Whether the surface that pixel i shows hides a point behind that pixel, `inverse_z` = 1 / its distance along the view.
bool hides(const GBuffer& gbuffer, std::size_t i, const glm::dvec3& point, double inverse_z) {
  return !gbuffer.is_background(i) &&
         glm::dot(glm::dvec3(gbuffer.normal(i)), point - glm::dvec3(gbuffer.position(i))) * inverse_z < -beneath;
}

/// What of a line is in the picture and before the eye: a point in pixels and 1 / z at either end.
std::optional<std::array<glm::dvec3, 2>> in_picture(const Camera& camera, const Line& line) {
  const glm::dvec3 from = seen(camera, line.from), to = seen(camera, line.to);
  double begin = 0, end = 1;
  // What is nearer to the eye than this has no place in the picture that double could tell.
  const double nearest = 1e-12 * std::max(std::abs(from.z), std::abs(to.z));
  const auto keep_positive = [&](double a, double b) {
    if (a < 0 && b < 0) end = -1;
    if (a < 0 && b >= 0) begin = std::max(begin, a / (a - b));
    if (a >= 0 && b < 0) end = std::min(end, a / (a - b));
  };
  keep_positive(from.x, to.x);
  keep_positive(from.y, to.y);
  keep_positive(camera.width * from.z - from.x, camera.width * to.z - to.x);
  keep_positive(camera.height * from.z - from.y, camera.height * to.z - to.y);
  keep_positive(from.z - nearest, to.z - nearest);
  if (!(begin <= end) || !(nearest > 0)) return std::nullopt;
  std::array<glm::dvec3, 2> ends{glm::mix(from, to, begin), glm::mix(from, to, end)};
  for (glm::dvec3& p : ends) {
    p = {p.x / p.z, p.y / p.z, 1 / p.z};
    if (!std::isfinite(p.x + p.y + p.z)) return std::nullopt;
  }
  return ends;
}

/// Calls put(pixel index, is it hidden, is it one of a dot) for the pixels of a line.
template <class Put>
void for_pixels(const Camera& camera, const Line& line, const GBuffer& gbuffer, Put&& put) {
  const auto ends = in_picture(camera, line);
  if (!ends) return;
  const auto& [from, to] = *ends;
  const glm::dvec2 way(to - from);
  const int along = std::abs(way.x) >= std::abs(way.y) ? 0 : 1, across = 1 - along;
  const glm::ivec2 size(gbuffer.width, gbuffer.height);
  // One place for every center that the line passes by along its longer way, the nearest center's where there is none.
  const double low = std::min(from[along], to[along]), high = std::max(from[along], to[along]);
  int first = static_cast<int>(std::ceil(low - 0.5)), last = static_cast<int>(std::floor(high - 0.5));
  const bool is_short = first > last;
  if (is_short) first = last = static_cast<int>(std::floor((low + high) / 2));
  for (int at = std::max(first, 0); at <= std::min(last, size[along] - 1); ++at) {
    const double share = is_short ? 0.5 : way[along] == 0 ? 0 : (at + 0.5 - from[along]) / way[along];
    const glm::dvec3 place = glm::mix(from, to, std::clamp(share, 0.0, 1.0));
    const glm::dvec3 point = camera.eye + camera.ray(place.x, place.y) / place.z;
    const int lower = static_cast<int>(std::floor(place[across] - 0.5)), nearest = static_cast<int>(std::floor(place[across]));
    for (int k = std::max(lower, 0); k <= std::min(lower + 1, size[across] - 1); ++k) {
      const glm::ivec2 pixel = along == 0 ? glm::ivec2(at, k) : glm::ivec2(k, at);
      const std::size_t i = static_cast<std::size_t>(pixel.y) * size.x + pixel.x;
      put(i, hides(gbuffer, i, point, place.z), k == nearest && at % dot_step < dot_step / 2);
    }
  }
}

/// The color of silhouette edges where up to `last` side quads start, and more than in the class before.
struct EdgeClass {
  Swatch swatch;
  int last;
};

/// sRGB 255, 225, 60; 255, 96, 208; 96, 232, 255.
const std::array<EdgeClass, 3> edge_classes{{{{"1 side quad", {1.0, 0.7529, 0.0452}}, 1},
                                             {{"2 side quads", {1.0, 0.1170, 0.6308}}, 2},
                                             {{"3 and more", {0.1170, 0.8069, 1.0}}, std::numeric_limits<int>::max()}}};

}  // namespace

void draw_lines(std::span<const Line> lines, const GBuffer& gbuffer, std::span<float> picture) {
  assert(picture.size() == 3 * gbuffer.size());
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  // A pixel that many lines cross is not made brighter by each.
  std::vector<glm::vec3> colors(gbuffer.size());
  std::vector<std::uint8_t> kinds(gbuffer.size(), 0);  // 1 hidden, 2 visible
  for (const Line& line : lines)
    for_pixels(camera, line, gbuffer, [&](std::size_t i, bool is_hidden, bool is_dot) {
      const std::uint8_t kind = !is_hidden ? 2 : is_dot ? 1 : 0;
      if (kind == 0 || kind < kinds[i]) return;
      kinds[i] = kind;
      colors[i] = line.color;
    });
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const float share = kinds[i] == 0 ? 0 : kinds[i] == 1 ? hidden_share : 1;
    for (int c = 0; c < 3; ++c) picture[3 * i + c] += share * (colors[i][c] - picture[3 * i + c]);
  }
}

bool SeenPoints::operator()(const glm::dvec3& point) const {
  const glm::dvec3 p = seen(camera_, point);
  if (!(p.z > 0 && p.x >= 0 && p.y >= 0 && p.x < camera_.width * p.z && p.y < camera_.height * p.z)) return false;
  const int x = static_cast<int>(p.x / p.z), y = static_cast<int>(p.y / p.z);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, camera_.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, camera_.width - 1); ++u)
      if (!hides(gbuffer_, static_cast<std::size_t>(v) * camera_.width + u, point, 1 / p.z)) return true;
  return false;
}

std::vector<Line> silhouette_lines(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
  std::vector<Line> lines;
  lines.reserve(silhouette.edges.size());
  for (const SilhouetteEdge& edge : silhouette.edges)
    lines.push_back(
        {adjacency.positions()[edge.low], adjacency.positions()[edge.high], silhouette_color(std::abs(edge.count))});
  return lines;
}

glm::vec3 silhouette_color(int count) {
  return std::ranges::find_if(edge_classes, [count](const EdgeClass& c) { return count <= c.last; })->swatch.color;
}

DebugLayer silhouette_layer() {
  DebugLayer layer{.name = "silhouette",
                   .sentence =
                       "Silhouette edges over the shaded picture, colored by the side quads that start at each: one "
                       "around a closed body and where a surface ends, two where an open surface folds; what a surface "
                       "hides from the eye is dotted."};
  for (const EdgeClass& c : edge_classes) layer.legend.push_back(c.swatch);
  return layer;
}

}  // namespace gnomon
