#include <gnomon/kit/maps/prefilter.h>

#include <bit>

namespace gnomon {

namespace {

// With V from the eye to the point, s the share of V where a pixel's ray meets the point's plane, and d what the ray changes by
// from pixel to pixel where V goes 1 along the axis of the view: the point moves by s (d - V (N.d) / (N.V)).
constexpr std::string_view footprint_body = R"(
mat2 pixel_on_image(vec3 place, vec3 position, vec3 normal) {
  vec3 ray = position - view_eye.xyz;
  float along = dot(ray, vec3(view_eye.w, view_right.w, view_down.w)), height = dot(normal, ray);
  vec3 right = along * (view_right.xyz - ray * (dot(normal, view_right.xyz) / height));
  vec3 down = along * (view_down.xyz - ray * (dot(normal, view_down.xyz) / height));
  right = along_image(right), down = along_image(down);
#if PROJECTION == 0
  return mat2(right.xy, down.xy);
#else
  return mat2(right.xy - place.xy * right.z, down.xy - place.xy * down.z) / place.z;
#endif
}
)";

constexpr std::string_view blur_body = R"(
vec4 mean_at(vec3 place, vec3 position, vec3 normal) {
  return textureLod(light_map, vec3(place.xy / vec2(textureSize(light_map, 0).xy), light_facts.x), 0);
}
)";

// A ray along the plane has a footprint that is no number: it is the widest.
constexpr std::string_view mips_body = R"(
vec4 mean_at(vec3 place, vec3 position, vec3 normal) {
  mat2 pixel = pixel_on_image(place, position, normal);
  float squares = dot(pixel[0], pixel[0]) + dot(pixel[1], pixel[1]), area = determinant(pixel);
  float way = 0.5 * (squares + sqrt(max(squares * squares - 4 * area * area, 0))), widest = widths.y * widths.y;
  float level = 0.5 * log2(max(way < widest ? way : widest, widths.x * widths.x));
  return textureLod(light_map, vec3(place.xy / vec2(textureSize(light_map, 0).xy), light_facts.x), level);
}
)";

// Sums wrap around, differences are exact. The box has a border column, whole columns and another border column, and rows
// likewise: nine sums.
constexpr std::string_view table_body = R"(
layout(binding = 4) uniform usampler2DArray light_sums;
uvec4 sum_before(int x, int y) {
  uvec4 sum = texelFetch(light_sums, ivec3(max(x - 1, 0), max(y - 1, 0), int(light_facts.x)), 0);
  return x > 0 && y > 0 ? sum : uvec4(0);
}
vec4 mean_at(vec3 place, vec3 position, vec3 normal) {
  mat2 pixel = pixel_on_image(place, position, normal);
  vec2 size = vec2(textureSize(light_sums, 0).xy), at = clamp(place.xy, vec2(0), size), way = abs(pixel[0]) + abs(pixel[1]);
  way.x = way.x < widths.y ? way.x : widths.y;
  way.y = way.y < widths.y ? way.y : widths.y;
  way = 0.5 * max(way, widths.xx);
  vec2 low = max(at - way, vec2(0)), high = min(at + way, size);
  ivec2 first = ivec2(low), last = max(ivec2(ceil(high)) - 1, first);
  ivec4 columns = ivec4(first.x, first.x + 1, max(last.x, first.x + 1), last.x + 1);
  ivec4 rows = ivec4(first.y, first.y + 1, max(last.y, first.y + 1), last.y + 1);
  vec3 column_share = vec3(min(float(columns.y), high.x) - low.x, 1, high.x - float(last.x));
  vec3 row_share = vec3(min(float(rows.y), high.y) - low.y, 1, high.y - float(last.y));
  uvec4 above[3] = uvec4[3](uvec4(0), uvec4(0), uvec4(0));
  vec4 sum = vec4(0);
  for (int j = 0; j < 4; ++j) {
    uvec4 before = sum_before(columns[0], rows[j]);
    for (int i = 0; i < 3; ++i) {
      uvec4 next = sum_before(columns[i + 1], rows[j]), below = next - before;
      if (j > 0) sum += column_share[i] * row_share[j - 1] * vec4(below - above[i]);
      above[i] = below;
      before = next;
    }
  }
  return sum * table_unit / ((high.x - low.x) * (high.y - low.y));
}
)";

/// Along one axis, what texel `first + k` counts.
struct Run {
  int first = 0;
  std::vector<double> weights;
};

/// Between two neighbors, each the middle of a blur.
Run blur_run(const Prefilter& filter, double place) {
  const int r = filter.radius, corner = static_cast<int>(std::floor(place - 0.5));
  const double share = place - 0.5 - corner;
  std::vector<float> each{1};
  if (r > 0) each = blur_weights(filter.weights, r);
  const auto of = [&](int d) { return std::abs(d) <= r ? double(each[std::abs(d)]) : 0; };
  Run run{corner - r, {}};
  for (int k = -r; k <= r + 1; ++k) run.weights.push_back((1 - share) * of(k) + share * of(k - 1));
  return run;
}

/// Between two neighbors of a level, each the mean of 2^level. Beside the image the last one counts.
Run level_run(int level, double place, int resolution) {
  const int texels = 1 << level, last = (resolution >> level) - 1;
  const double at = place / texels - 0.5;
  const int corner = static_cast<int>(std::floor(at)), low = std::clamp(corner, 0, last),
            high = std::clamp(corner + 1, 0, last);
  Run run{low * texels, std::vector<double>(std::size_t(high - low + 1) * texels)};
  for (int k = 0; k < texels; ++k) {
    run.weights[k] += (1 - (at - corner)) / texels;
    run.weights[(high - low) * texels + k] += (at - corner) / texels;
  }
  return run;
}

/// A box, each texel by the share that it holds.
Run box_run(double place, double way, int resolution) {
  const double low = std::max(place - way / 2, 0.0), high = std::min(place + way / 2, double(resolution));
  Run run{static_cast<int>(std::floor(low)), {}};
  for (int k = run.first; k < high; ++k)
    run.weights.push_back((std::min(k + 1.0, high) - std::max(double(k), low)) / (high - low));
  return run;
}

void add(std::vector<WeightedTexel>& texels, const Run& columns, const Run& rows, double share) {
  for (std::size_t y = 0; y < rows.weights.size(); ++y)
    for (std::size_t x = 0; x < columns.weights.size(); ++x)
      if (const double weight = share * columns.weights[x] * rows.weights[y]; weight > 0)
        texels.push_back({{columns.first + int(x), rows.first + int(y)}, weight});
}

}  // namespace

double Prefilter::narrowest() const {
  const double box = 2 * radius + 1;
  return kind == Kind::mips ? std::max(box / std::numbers::sqrt3, 1.0) : box;
}

int Prefilter::widest() const { return std::max(2 * radius + 1, kind == Kind::blur ? 1 : widest_footprint); }

int Prefilter::last_level() const { return static_cast<int>(std::bit_width(static_cast<unsigned>(widest() - 1))); }

int Prefilter::margin() const {
  if (kind == Kind::blur) return radius + 2;  // one for the four texels of a look-up, one for rounding
  return kind == Kind::table ? widest() / 2 + 2 : (3 << last_level()) / 2 + 2;
}

int Prefilter::stores() const { return 1 + (kind == Kind::mips ? last_level() : radius > 0 ? 2 : 0); }

double Prefilter::whole() const {
  const double side = widest() + 2;              // a box may begin and end within a texel
  return std::floor(0x1.ffp31 / (side * side));  // less than 2^32: float32 rounds, too
}

StoredRounding Prefilter::rounding(GLenum format) const {
  if (kind == Kind::table) return {.absolute = 0.5 / whole()};
  const StoredRounding each = stored_rounding(format);
  return {.absolute = stores() * each.absolute, .share = stores() * each.share};
}

Support Prefilter::supports(const Light& light, int resolution) const {
  if (kind == Kind::table && looks_through_cube(light))
    return Support::unsupported("a summed-area table ends at the edge of a face: prefilter=table takes no lights with six");
  if (kind == Kind::mips && resolution % (1 << last_level()) != 0)
    return Support::unsupported(fmt::format("{} levels of halves need a resolution that {} divides: {} is none", last_level(),
                                            1 << last_level(), resolution));
  return Support::full();
}

std::vector<WeightedTexel> Prefilter::texels(const glm::dvec2& place, const glm::dmat2& pixel, int resolution) const {
  std::vector<WeightedTexel> all;
  if (kind == Kind::blur) {
    add(all, blur_run(*this, place.x), blur_run(*this, place.y), 1);
  } else if (kind == Kind::mips) {
    const double way = std::sqrt(squared_ways(pixel).x), wide = way < widest() ? way : widest();
    const double level = std::log2(std::max(wide, narrowest()));
    const int k = static_cast<int>(level);
    for (int i = 0; i < 2; ++i)
      if (const double share = i == 0 ? 1 - (level - k) : level - k; share > 0)
        add(all, level_run(k + i, place.x, resolution), level_run(k + i, place.y, resolution), share);
  } else {
    const auto way = [&](int axis) {
      const double footprint = std::abs(pixel[0][axis]) + std::abs(pixel[1][axis]);
      return std::max(footprint < widest() ? footprint : double(widest()), narrowest());
    };
    add(all, box_run(place.x, way(0), resolution), box_run(place.y, way(1), resolution), 1);
  }
  return all;
}

glm::dmat2 pixel_on_image(const LightImage& image, const Camera& camera, const glm::dvec3& point, const glm::dvec3& normal) {
  const glm::dvec3 ray = point - camera.eye, q = image.seen(point), origin = camera.ray(0, 0);
  const double along = glm::dot(ray, camera.forward), height = glm::dot(normal, ray);
  const auto texels = [&](const glm::dvec3& d) {
    const glm::dvec3 s = image.turned(along * (d - ray * (glm::dot(normal, d) / height)));
    const glm::dvec2 window = image.place(q);
    return image.texel_step(window, image.is_perspective ? (glm::dvec2(s) - window * s.z) / q.z : glm::dvec2(s));
  };
  return {texels(camera.ray(1, 0) - origin), texels(camera.ray(0, 1) - origin)};
}

glm::dvec2 squared_ways(const glm::dmat2& pixel) {
  const double area = glm::determinant(pixel), squares = glm::dot(pixel[0], pixel[0]) + glm::dot(pixel[1], pixel[1]);
  const double large = (squares + std::sqrt(std::max(0.0, squares * squares - 4 * area * area))) / 2;
  return {large, area * area / large};
}

std::string prefilter_snippet(Prefilter::Kind kind) {
  if (kind == Prefilter::Kind::blur) return std::string(blur_body);
  return std::string(footprint_body) + std::string(kind == Prefilter::Kind::mips ? mips_body : table_body);
}

std::string prefilter_constants(Prefilter::Kind kind) {
  if (kind == Prefilter::Kind::blur) return "";
  return std::string("vec4 view_eye; vec4 view_right; vec4 view_down; vec2 widths;") +
         (kind == Prefilter::Kind::table ? "vec4 table_unit;" : "");
}

int prefilter_constant_count(Prefilter::Kind kind) {
  return kind == Prefilter::Kind::blur ? 0 : kind == Prefilter::Kind::mips ? 4 : 5;
}

void set_prefilter(const Program& program, const Prefilter& prefilter, const View& view, int width, int height,
                   const glm::vec4& one) {
  if (prefilter.kind == Prefilter::Kind::blur) return;
  const Camera camera(view, width, height);
  const glm::dvec3 origin = camera.ray(0, 0);
  program.set_if_used("view_eye", glm::vec4(camera.eye, camera.forward.x));
  program.set_if_used("view_right", glm::vec4(camera.ray(1, 0) - origin, camera.forward.y));
  program.set_if_used("view_down", glm::vec4(camera.ray(0, 1) - origin, camera.forward.z));
  program.set_if_used("widths", glm::vec2(prefilter.narrowest(), prefilter.widest()));
  program.set_if_used("table_unit", 1.0f / (one * static_cast<float>(prefilter.whole())));
}

}  // namespace gnomon
