#include <gnomon/kit/gl/gl.h>

namespace gnomon {

namespace {

// Comes before the pass's own vertex shader; its end after it, where `position` is declared.
constexpr std::string_view mask_vertex_head = R"(
layout(location = 2) in vec2 uv;
layout(location = 3) in int mask;
out vec2 mask_uv;
flat out int mask_number;
#ifdef HASHED
out vec3 mask_point;
#endif
void hand_on_mask();
)";
constexpr std::string_view mask_vertex_end = R"(
void hand_on_mask() {
  mask_uv = uv;
  mask_number = mask;
#ifdef HASHED
  mask_point = position;
#endif
}
)";

constexpr std::string_view wrapped_texel = R"(
in vec2 mask_uv;
int wrapped_texel(int place, int size, uint wrap) {
  if (wrap == 2u) return clamp(place, 0, size - 1);
  int period = wrap == 1u ? 2 * size : size;
  // What % gives for a negative number is undefined.
  int rest = place < 0 ? period - 1 - (-1 - place) % period : place % period;
  return rest < size ? rest : period - 1 - rest;
}
)";

// Each mask has eight words of facts. The first four are width, height and the wraps along both axes.
constexpr std::string_view mask_head = R"(
flat in int mask_number;
layout(std430, binding = 7) readonly buffer AlphaMasks { uint mask_words[]; };
)";

// The others are words of a row, first word of its bits, two unused.
constexpr std::string_view texel_rule = R"(
bool in_hole() {
  if (mask_number < 0) return false;
  uint facts = 8u * uint(mask_number);
  ivec2 size = ivec2(mask_words[facts], mask_words[facts + 1u]);
  ivec2 place = ivec2(floor(mask_uv * vec2(size)));
  uint column = uint(wrapped_texel(place.x, size.x, mask_words[facts + 2u]));
  uint row = uint(wrapped_texel(place.y, size.y, mask_words[facts + 3u]));
  uint word = mask_words[mask_words[facts + 5u] + row * mask_words[facts + 4u] + (column >> 5u)];
  return (word >> (column & 31u) & 1u) == 0u;
}
)";

// The others are factor, cutoff, the number of the last level, and the place of a list: the first word of each level.
// Derivatives are taken where all fragments of a triangle are.
constexpr std::string_view alpha_head = R"(
float alpha_of(uint facts, int level, ivec2 size, ivec2 place) {
  uint column = uint(wrapped_texel(place.x, size.x, mask_words[facts + 2u]));
  uint row = uint(wrapped_texel(place.y, size.y, mask_words[facts + 3u]));
  uint first = mask_words[mask_words[facts + 7u] + uint(level)];
  return uintBitsToFloat(mask_words[first + row * uint(size.x) + column]);
}
)";

// As GL_LINEAR_MIPMAP_LINEAR has it, with the level of detail of OpenGL 4.5, section 8.14.1. Between equal alphas there is the
// same one, to the bit: levels that keep their share have many texels that just pass the cutoff.
constexpr std::string_view mips_rule = R"(
float between(float a, float b, float share) {
  precise float value = a + share * (b - a);
  return value;
}
float bilinear_alpha(uint facts, int level) {
  ivec2 size = max(ivec2(mask_words[facts], mask_words[facts + 1u]) >> level, ivec2(1));
  vec2 place = mask_uv * vec2(size) - 0.5, low = floor(place), share = place - low;
  ivec2 texel = ivec2(low);
  float left_top = alpha_of(facts, level, size, texel), right_top = alpha_of(facts, level, size, texel + ivec2(1, 0));
  float left = alpha_of(facts, level, size, texel + ivec2(0, 1)), right = alpha_of(facts, level, size, texel + ivec2(1, 1));
  return between(between(left_top, right_top, share.x), between(left, right, share.x), share.y);
}
bool in_hole() {
  vec2 step_x = dFdx(mask_uv), step_y = dFdy(mask_uv);
  if (mask_number < 0) return false;
  uint facts = 8u * uint(mask_number);
  vec2 size = vec2(ivec2(mask_words[facts], mask_words[facts + 1u]));
  step_x *= size;
  step_y *= size;
  float texels = max(max(dot(step_x, step_x), dot(step_y, step_y)), 1e-30);  // squared, of a fragment
  int last = int(mask_words[facts + 6u]);
  float level = clamp(0.5 * log2(texels), 0.0, float(last));
  int finer = int(level), coarser = min(finer + 1, last);
  float alpha = between(bilinear_alpha(facts, finer), bilinear_alpha(facts, coarser), level - float(finer));
  return !(uintBitsToFloat(mask_words[facts + 4u]) * alpha >= uintBitsToFloat(mask_words[facts + 5u]));
}
)";

// Space is divided into cubes with a side of a power of two, from 1 / sqrt(2) to sqrt(2) of the longer way from fragment to
// fragment; each has a threshold of its own, k / 2^24 with k = 1 .. 2^24. Cards often lie where coordinates are round: a third
// of a cube keeps them off the borders. Bits are mixed as by the last steps of MurmurHash3.
constexpr std::string_view hashed_rule = R"(
in vec3 mask_point;
uint mixed(uint bits) {
  bits ^= bits >> 16u;
  bits *= 0x85ebca6bu;
  bits ^= bits >> 13u;
  bits *= 0xc2b2ae35u;
  return bits ^ bits >> 16u;
}
bool in_hole() {
  vec3 step_x = dFdx(mask_point), step_y = dFdy(mask_point);
  if (mask_number < 0) return false;
  float way = sqrt(2.0 * max(dot(step_x, step_x), dot(step_y, step_y)));
  uint exponent = clamp(floatBitsToUint(way) >> 23u, 1u, 253u);  // of the side, plus 127
  vec3 cube = floor(mask_point * uintBitsToFloat((254u - exponent) << 23u) + 1.0 / 3.0);
  uvec3 bits = floatBitsToUint(cube);
  uint hash = mixed(bits.x ^ mixed(bits.y ^ mixed(bits.z ^ mixed(exponent))));
  float threshold = float((hash >> 8u) + 1u) * 5.9604644775390625e-8;
  uint facts = 8u * uint(mask_number);
  ivec2 size = ivec2(mask_words[facts], mask_words[facts + 1u]);
  float alpha = alpha_of(facts, 0, size, ivec2(floor(mask_uv * vec2(size))));
  return !(uintBitsToFloat(mask_words[facts + 4u]) * alpha >= threshold);
}
)";

std::string mask_fragment(AlphaRule rule) {
  if (rule == AlphaRule::texel) return fmt::format("{}{}{}", wrapped_texel, mask_head, texel_rule);
  return fmt::format("{}{}{}{}", wrapped_texel, mask_head, alpha_head, rule == AlphaRule::hashed ? hashed_rule : mips_rule);
}

}  // namespace

// A masked program has the places of its alpha mask.
const std::string_view transmission_vertex_snippet = R"(
layout(location = 4) in int transmission;
#ifndef MASKED
layout(location = 2) in vec2 uv;
out vec2 mask_uv;
#endif
flat out int transmission_number;
void hand_on_transmission() {
  mask_uv = uv;
  transmission_number = transmission;
}
)";

// Facts as those of masks; the fifth is channels, the sixth the first word of the floats.
const std::string transmission_fragment_snippet = fmt::format("#ifndef MASKED\n{}#endif\n", wrapped_texel) + R"(
layout(std430, binding = 6) readonly buffer Transmissions { uint transmission_words[]; };
flat in int transmission_number;
float transmission_here() {
  if (transmission_number < 0) return 0;
  uint facts = 8u * uint(transmission_number);
  ivec2 size = ivec2(transmission_words[facts], transmission_words[facts + 1u]);
  ivec2 place = ivec2(floor(mask_uv * vec2(size)));
  uint column = uint(wrapped_texel(place.x, size.x, transmission_words[facts + 2u]));
  uint row = uint(wrapped_texel(place.y, size.y, transmission_words[facts + 3u]));
  uint texel = (row * uint(size.x) + column) * transmission_words[facts + 4u];
  return uintBitsToFloat(transmission_words[transmission_words[facts + 5u] + texel]);
}
)";

const std::string depth_vertex = std::string(position_snippet) + R"(
uniform vec3 shift;
void main() {
  gl_Position = place(vec4(position - shift, 1));
#ifdef MASKED
  hand_on_mask();
#endif
}
)";
const std::string depth_fragment = R"(
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
}
)";

CasterPrograms::CasterPrograms(std::string_view title, std::string_view vertex, std::string_view fragment)
    : title_(title), vertex_(vertex), fragment_(fragment), solid_(title, vertex, fragment) {}

void CasterPrograms::fit(const Scene& scene, AlphaRule rule) {
  Program& masked = masked_[number_of(rule)];
  if (masked || !scene.has_alpha_masks()) return;
  const std::string_view define = rule == AlphaRule::hashed ? "#define MASKED\n#define HASHED\n" : "#define MASKED\n";
  masked = Program(title_ + ", holes left out", fmt::format("{}{}{}{}", define, mask_vertex_head, vertex_, mask_vertex_end),
                   fmt::format("{}{}{}", define, mask_fragment(rule), fragment_));
}

}  // namespace gnomon
