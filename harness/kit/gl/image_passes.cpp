#include <gnomon/kit/gl/image_passes.h>

#include <bit>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

// Images are read by imageLoad: in a compute program of llvmpipe it takes 0.6 of the time of texelFetch
// (docs/decisions/image_passes.md). Beyond an image it gives 0, and a store does nothing, so that the lanes of a group need no
// test for the border. Lanes lie along x of the group, and llvmpipe computes eight of them at once.
constexpr int group_lanes = 16;

/// A format as GLSL has it.
struct FormatFacts {
  GLenum format;
  int channels;
  const char* name;
  bool is_whole = false;  ///< uint
};
constexpr FormatFacts known_formats[] = {
    {GL_R32F, 1, "r32f"},         {GL_RG32F, 2, "rg32f"},         {GL_RGBA32F, 4, "rgba32f"},
    {GL_R16F, 1, "r16f"},         {GL_RG16F, 2, "rg16f"},         {GL_RGBA16F, 4, "rgba16f"},
    {GL_R16, 1, "r16"},           {GL_RG16, 2, "rg16"},           {GL_RGBA16, 4, "rgba16"},
    {GL_R32UI, 1, "r32ui", true}, {GL_RG32UI, 2, "rg32ui", true}, {GL_RGBA32UI, 4, "rgba32ui", true}};

const FormatFacts& facts_of(GLenum format) {
  const auto* const facts = std::ranges::find(known_formats, format, &FormatFacts::format);
  if (facts == std::end(known_formats))
    throw Error("image of format {:#x}: passes take one, two or four floats a texel", format);
  return *facts;
}

int channel_count(GLenum format) { return facts_of(format).channels; }

/// Throws Error where a pass that takes means is to take whole numbers.
void require_floats(const ImageKind& kind) {
  if (facts_of(kind.format).is_whole)
    throw Error("image of format {:#x}: a mean of whole numbers is none; summed-area tables take them", kind.format);
}

/// The beginning of every program: `Texel` with as many channels as the format has, `load` and `store`. Layers lie along z,
/// from the first one or from one that a program names.
std::string head(const ImageKind& kind, const std::string& layer = "gl_GlobalInvocationID.z") {
  const FormatFacts& facts = facts_of(kind.format);
  const auto text = [&](const char* of_one, const char* of_two, const char* of_four) {
    return facts.channels == 1 ? of_one : facts.channels == 2 ? of_two : of_four;
  };
  const char* const number = facts.is_whole ? "u" : "";
  return fmt::format(R"(
layout(local_size_x = {0}) in;
layout(binding = 0, {1}) readonly uniform {7}{2} from;
layout(binding = 1) writeonly uniform {7}{2} to;
#define Texel {3}
#define load(at) imageLoad(from, {4}).{5}
#define store(at, texel) imageStore(to, {4}, {7}{6})
)",
                     group_lanes, facts.name, kind.has_layers ? "image2DArray" : "image2D",
                     facts.is_whole ? text("uint", "uvec2", "uvec4") : text("float", "vec2", "vec4"),
                     kind.has_layers ? "ivec3(at, " + layer + ")" : "at", text("r", "rg", "rgba"),
                     text("vec4(texel, 0, 0, 0)", "vec4(texel, 0, 0)", "vec4(texel)"), number);
}

int groups(int count) { return (count + group_lanes - 1) / group_lanes; }

/// Binds a level of each with all its layers.
void bind(const Texture& from, int from_level, const Texture& to, int to_level) {
  const GLboolean all_layers = from.layers > 0;
  glBindImageTexture(0, from.name(), from_level, all_layers, 0, GL_READ_ONLY, from.format);
  glBindImageTexture(1, to.name(), to_level, all_layers, 0, GL_WRITE_ONLY, to.format);
}

/// What one pass wrote can be read, or written over, by the next.
void end_pass() { glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT); }

void end_passes() {
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT);
}

[[maybe_unused]] bool is_of(const ImageKind& kind, const Texture& texture) {
  return texture.format == kind.format && (texture.layers > 0) == kind.has_layers;
}

void fit_size(Texture& to, const Texture& from) {
  const bool is_fit =
      to.format == from.format && to.width == from.width && to.height == from.height && to.layers == from.layers;
  if (!is_fit) to.fit(from.format, from.width, from.height, from.layers);
}

int layer_count(const Texture& texture) { return std::max(texture.layers, 1); }

/// How many neighbors one invocation of a blur computes: what it loads for one serves the others. More take longer, since their
/// sums are more than there are registers.
int strip_length(GLenum format) { return channel_count(format) == 4 ? 4 : 8; }

/// One pass of a blur, every load and product written out.
std::string blur_source(const ImageKind& kind, std::span<const float> weights, bool along_x) {
  const int radius = static_cast<int>(weights.size()) - 1, strip = strip_length(kind.format);
  std::string text = head(kind, "int(gl_GlobalInvocationID.z) + first_layer");
  text += "uniform int first_x, first_y, first_layer;\nvoid main() {\n";
  text += fmt::format("  ivec2 at = ivec2(gl_GlobalInvocationID.xy) * ivec2({}, {}) + ivec2(first_x, first_y);\n",
                      along_x ? strip : 1, along_x ? 1 : strip);
  text += fmt::format("  int last = imageSize(from).{} - 1;\n  Texel texel;\n", along_x ? "x" : "y");
  for (int k = 0; k < strip; ++k) text += fmt::format("  Texel sum{} = Texel(0);\n", k);
  for (int d = -radius; d < strip + radius; ++d) {
    const std::string along = fmt::format("clamp(at.{} + {}, 0, last)", along_x ? "x" : "y", d);
    text += "  texel = load(ivec2(" + (along_x ? along + ", at.y" : "at.x, " + along) + "));\n";
    for (int k = 0; k < strip; ++k)
      if (std::abs(d - k) <= radius) text += fmt::format("  sum{} += {:.9e} * texel;\n", k, weights[std::abs(d - k)]);
  }
  for (int k = 0; k < strip; ++k)
    text += fmt::format("  store(at + ivec2({}, {}), sum{});\n", along_x ? k : 0, along_x ? 0 : k, k);
  return text + "}\n";
}

constexpr std::string_view body_source = R"(
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), above = 2 * at;
  Texel sum = (load(above) + load(above + ivec2(1, 0))) + (load(above + ivec2(0, 1)) + load(above + ivec2(1, 1)));
  store(at, 0.25 * sum);
}
)";

/// For texels that are the mean of other than two by two, from the one at first_x, first_y on.
constexpr std::string_view edge_source = R"(
uniform int first_x, first_y;
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(first_x, first_y), above = 2 * at, size = imageSize(from).xy;
  ivec2 last = max(size / 2, 1) - 1;
  ivec2 count = ivec2(at.x == last.x ? size.x - above.x : 2, at.y == last.y ? size.y - above.y : 2);
  Texel sum = Texel(0);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) sum += x < count.x && y < count.y ? load(above + ivec2(x, y)) : Texel(0);
  store(at, sum / float(count.x * count.y));
}
)";

/// Running sums with compensation (Kahan 1965): `lost` is what the last addition rounded off. An invocation sums up `wide`
/// neighboring rows or columns and takes `step` texels of each at a time; it loads them all before it stores one, so that a
/// line of the cache is used up before others drive it out.
std::string scan_source(const ImageKind& kind, bool along_x) {
  const bool is_long = channel_count(kind.format) == 4, is_whole = facts_of(kind.format).is_whole;
  const int wide = along_x ? 1 : is_long ? 4 : 2, step = along_x || !is_long ? 4 : 2;
  std::string text = head(kind) + "uniform vec4 offset;\n";
  text += along_x ? "#define place(i, k) ivec2(i, first + k)\n" : "#define place(i, k) ivec2(first + k, i)\n";
  text += along_x && !is_whole ? "#define moved(texel) (texel - Texel(offset))\n" : "#define moved(texel) texel\n";
  text += fmt::format("void main() {{\n  int first = {} * int(gl_GlobalInvocationID.x);\n  precise Texel term, next;\n", wide);
  const auto each = [&](const auto& line) {
    for (int i = 0; i < step; ++i)
      for (int k = 0; k < wide; ++k) text += line(i, k);
  };
  for (int k = 0; k < wide; ++k) text += fmt::format("  precise Texel sum{0} = Texel(0), lost{0} = Texel(0);\n", k);
  text += fmt::format("  for (int i = 0; i < imageSize(from).{}; i += {}) {{\n", along_x ? "x" : "y", step);
  each([&](int i, int k) { return fmt::format("    precise Texel texel{0}_{1} = load(place(i + {0}, {1}));\n", i, k); });
  each([&](int i, int k) {
    if (is_whole) return fmt::format("    sum{1} += texel{0}_{1}; texel{0}_{1} = sum{1};\n", i, k);
    return fmt::format(
        "    term = moved(texel{0}_{1}) - lost{1}; next = sum{1} + term; lost{1} = (next - sum{1}) - term;\n"
        "    sum{1} = texel{0}_{1} = next;\n",
        i, k);
  });
  each([&](int i, int k) { return fmt::format("    store(place(i + {0}, {1}), texel{0}_{1});\n", i, k); });
  return text + "  }\n}\n";
}

}  // namespace

StoredRounding stored_rounding(GLenum format) {
  const std::string_view name = facts_of(format).name;
  if (name.ends_with("16f")) return {.absolute = 0x1p-24, .share = 0x1p-10};
  return {.absolute = name.ends_with("16") ? 0x1p-16 : 0};
}

std::vector<float> blur_weights(Blur::Weights weights, int radius) {
  const double deviation = radius / 2.0;
  std::vector<double> exact(static_cast<std::size_t>(radius) + 1, 1.0);
  double sum = 1;
  for (int d = 1; d <= radius; ++d) {
    if (weights == Blur::Weights::gaussian) exact[d] = std::exp(-d * d / (2 * deviation * deviation));
    sum += 2 * exact[d];
  }
  std::vector<float> rounded;
  for (const double weight : exact) rounded.push_back(static_cast<float>(weight / sum));
  return rounded;
}

void Blur::setup(const ImageKind& kind, Weights weights, int radius) {
  if (radius < 1 || radius > most_radius) throw Error("blur radius = {} is outside 1 .. {} texel", radius, most_radius);
  require_floats(kind);
  kind_ = kind;
  radius_ = radius;
  const std::vector<float> each = blur_weights(weights, radius);
  rows_ = Program::compute("blur of rows", blur_source(kind, each, true));
  columns_ = Program::compute("blur of columns", blur_source(kind, each, false));
}

// Groups of lanes begin where a tile does and end within it or at its end, so that none computes texels of another tile.
static_assert(Blur::tile_width % (8 * group_lanes) == 0 && Blur::tile_height % 8 == 0);

void Blur::run_along(bool x, const Texture& from, const Texture& to, const LayerRectangle& first, int layers) const {
  const int strip = strip_length(kind_.format);
  const auto strips = [&](int count) { return (count + strip - 1) / strip; };
  const PixelRectangle& texels = first.texels;
  const int width = texels.right - texels.left, height = texels.bottom - texels.top;
  const Program& program = x ? rows_ : columns_;
  program.set("first_x", texels.left);
  program.set("first_y", texels.top);
  program.set_if_used("first_layer", first.layer);
  glUseProgram(program.name());
  bind(from, 0, to, 0);
  glDispatchCompute(groups(x ? strips(width) : width), x ? height : strips(height), layers);
}

void Blur::run(const Texture& from, Texture& to) {
  assert(is_of(kind_, from));
  const StateGuard guard;
  between_.fit(from.format, from.width, from.height, from.layers);
  fit_size(to, from);
  const LayerRectangle all{0, {0, 0, from.width, from.height}};
  run_along(true, from, between_, all, layer_count(from));
  end_pass();
  run_along(false, between_, to, all, layer_count(from));
  end_passes();
}

void Blur::run(const Texture& from, const Texture& to, std::span<const LayerRectangle> within) {
  assert(is_of(kind_, from) && is_of(kind_, to) && from.name() != to.name());
  const StateGuard guard;
  between_.fit(from.format, from.width, from.height, from.layers);
  // Rectangles may be neighbors: rows that both need are computed twice, alike.
  for (LayerRectangle rows : within) {
    rows.texels.top = std::max(rows.texels.top - radius_, 0);
    rows.texels.bottom = std::min(rows.texels.bottom + radius_, from.height);
    run_along(true, from, between_, rows, 1);
  }
  end_pass();
  for (const LayerRectangle& texels : within) run_along(false, between_, to, texels, 1);
  end_passes();
}

int level_count(int width, int height) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

void MipChain::setup(const ImageKind& kind) {
  require_floats(kind);
  kind_ = kind;
  body_ = Program::compute("mean of two by two", head(kind) + std::string(body_source));
  edge_ = Program::compute("mean at the edge", head(kind) + std::string(edge_source));
}

void MipChain::make_level(const Texture& texture, int level) const {
  const int above_width = level_size(texture.width, level - 1), above_height = level_size(texture.height, level - 1);
  const int width = level_size(texture.width, level), height = level_size(texture.height, level);
  bind(texture, level - 1, texture, level);
  const auto edge = [&](int x, int y, int columns, int rows) {
    glUseProgram(edge_.name());
    edge_.set("first_x", x);
    edge_.set("first_y", y);
    glDispatchCompute(groups(columns), rows, layer_count(texture));
  };
  if (above_width == 1 || above_height == 1) return edge(0, 0, width, height);
  glUseProgram(body_.name());
  glDispatchCompute(groups(width), height, layer_count(texture));
  if (above_width % 2 == 0 && above_height % 2 == 0) return;
  end_pass();
  if (above_width % 2) edge(width - 1, 0, 1, height);
  if (above_height % 2) edge(0, height - 1, width, 1);
}

void MipChain::run(const Texture& texture) const {
  assert(is_of(kind_, texture));
  const StateGuard guard;
  for (int level = 1; level < texture.levels; ++level) {
    make_level(texture, level);
    end_pass();
  }
  end_passes();
}

void SummedAreaTable::setup(const ImageKind& kind) {
  if (const FormatFacts& facts = facts_of(kind.format); !facts.is_whole && !std::string_view(facts.name).ends_with("32f"))
    throw Error("image of format {:#x}: sums need 32 bits a channel", kind.format);
  kind_ = kind;
  rows_ = Program::compute("sums of rows", scan_source(kind, true));
  columns_ = Program::compute("sums of columns", scan_source(kind, false));
}

void SummedAreaTable::run(const Texture& from, Texture& to, const glm::vec4& offset) const {
  assert(is_of(kind_, from));
  const StateGuard guard;
  fit_size(to, from);
  const int together = channel_count(kind_.format) == 4 ? 4 : 2;  // columns of an invocation
  rows_.set_if_used("offset", offset);
  glUseProgram(rows_.name());
  bind(from, 0, to, 0);
  glDispatchCompute(groups(from.height), 1, layer_count(from));
  end_pass();
  glUseProgram(columns_.name());
  bind(to, 0, to, 0);
  glDispatchCompute(groups((from.width + together - 1) / together), 1, layer_count(from));
  end_passes();
}

}  // namespace gnomon
