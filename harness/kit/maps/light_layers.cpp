#include <gnomon/kit/maps/light_layers.h>
#include <gnomon/kit/maps/prefilter.h>
#include <gnomon/kit/parallel.h>

namespace gnomon {

namespace {

/// In the order of the faces: red, green, blue for x, y, z, paler on the negative side.
const std::array<Swatch, 6> cube_faces{{{"+x", {0.84, 0.05, 0.04}},
                                        {"-x", {0.87, 0.35, 0.31}},
                                        {"+y", {0.04, 0.49, 0.06}},
                                        {"-y", {0.38, 0.78, 0.33}},
                                        {"+z", {0.05, 0.16, 0.87}},
                                        {"-z", {0.36, 0.54, 0.93}}}};

/// How long a texel is, in pixels, up to `last`: blue where a pixel holds texels, red where a texel holds pixels.
struct TexelClass {
  Swatch swatch;
  double last;
};
const std::array<TexelClass, 7> texel_classes{{{{"to 1/2 pixel", {0.02, 0.06, 0.46}}, 0.5},
                                               {{"to 1", {0.10, 0.30, 0.79}}, 1},
                                               {{"to 2", {0.75, 0.75, 0.68}}, 2},
                                               {{"to 4", {0.96, 0.64, 0.10}}, 4},
                                               {{"to 8", {0.87, 0.26, 0.02}}, 8},
                                               {{"to 16", {0.66, 0.04, 0.02}}, 16},
                                               {{"more", {0.23, 0.01, 0.05}}, INFINITY}}};
const Swatch beside_map{"not in the map: lit", {0.075, 0.045, 0.11}};
const Swatch nothing_stored{"nothing stored", {0.61, 0.75, 0.91}};
const Swatch not_drawn{"not drawn: nothing casts", {0.045, 0.05, 0.06}};

/// A depth image on the sheet.
struct Placed {
  glm::dvec2 low{0}, size{1};    ///< of its rectangle, pixels
  glm::dvec2 right{0}, down{0};  ///< of the sheet, in texel axes: one is +-1 along x, the other along y

  /// Place of a pixel, in shares of the image, inside 0 .. 1; row 0 of texels is 0.
  glm::dvec2 share(const glm::dvec2& pixel) const {
    const glm::dvec2 at = (pixel - low) / size - 0.5;
    return 0.5 + at.x * right + at.y * down;
  }
};

/// Into a cell of the sheet: turned by the multiple of a right angle, and mirrored as needed, that shows what the light sees
/// with +y up (-z where it looks up or down), as large as its proportions allow.
Placed place(const LightImage& face, bool is_drawn, const glm::dvec2& cell_low, const glm::dvec2& cell_size) {
  Placed placed;
  const glm::dvec3 axes[] = {face.axis(0), face.axis(1), face.axis(2)};  // right, down, axis
  const glm::dvec3 up(0, 1, -1e-3);
  const double along_right = glm::dot(axes[0], up), along_down = glm::dot(axes[1], up);
  const bool is_turned = std::abs(along_right) > std::abs(along_down);
  const double sign = (is_turned ? along_right : along_down) > 0 ? -1 : 1;
  const glm::dvec3 down = sign * axes[is_turned ? 0 : 1], right = glm::cross(down, axes[2]);
  placed.down[is_turned ? 0 : 1] = sign;
  placed.right[is_turned ? 1 : 0] = glm::dot(right, axes[is_turned ? 1 : 0]) > 0 ? 1 : -1;
  glm::dvec2 extent = is_drawn ? 1.0 / face.scale : glm::dvec2(1);
  if (is_turned) std::swap(extent.x, extent.y);
  placed.size = extent * std::min(cell_size.x / extent.x, cell_size.y / extent.y);
  placed.low = cell_low + (cell_size - placed.size) / 2.0;
  return placed;
}

/// Paints one image. `depths` are its texels; empty where it is not drawn.
void paint_face(const LightImage& face, std::span<const float> depths, int resolution, const Placed& placed, int width,
                int height, std::span<float> picture) {
  const auto depth_of = [&](std::size_t texel) {
    const double row = static_cast<double>(texel / resolution) + 0.5;
    return depths[texel] * face.divisor(face.window_of({0, row}));
  };
  double least = INFINITY, most = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i] > 0) least = std::min(least, depth_of(i));
    most = std::max(most, depth_of(i));
  }
  // Used only where something is stored.
  const double near = face.axis_distance(most), far = most > 0 ? face.axis_distance(least) : -INFINITY;
  // Texels from one pixel to the next: as far apart are the neighbors that tell a jump of depth from a slope.
  const int step = std::max(1, static_cast<int>(std::ceil(resolution / std::max(1.0, std::min(placed.size.x, placed.size.y)))));
  constexpr double jump = 0.015;  // of the range
  const auto depth_at = [&](const glm::ivec2& texel) -> double {
    const glm::ivec2 t = glm::clamp(texel, glm::ivec2(0), glm::ivec2(resolution - 1));
    return depth_of(static_cast<std::size_t>(t.y) * resolution + t.x);
  };
  const auto color_at = [&](const glm::dvec2& share) -> glm::dvec3 {
    if (depths.empty()) return not_drawn.color;
    const glm::ivec2 texel(share * static_cast<double>(resolution));
    const double depth = depth_at(texel);
    if (depth == 0) return nothing_stored.color;
    const double z = face.axis_distance(depth), range = far - near;
    double gray = 0.2 + 0.62 * (range > 0 ? std::clamp((z - near) / range, 0.0, 1.0) : 0.5);  // of sRGB
    // Depth as it is stored is linear over a plane.
    for (const glm::ivec2 way : {glm::ivec2(step, 0), glm::ivec2(0, step)}) {
      const double before = depth_at(texel - way), after = depth_at(texel + way), expected = (before + after) / 2;
      if (before > 0 && after > 0 && std::abs(face.axis_distance(expected) - z) > jump * range) gray *= 0.5;
    }
    return glm::dvec3(std::pow(gray, 2.2));
  };
  for (int y = std::max(0, static_cast<int>(placed.low.y)); y < height; ++y)
    for (int x = std::max(0, static_cast<int>(placed.low.x)); x < width; ++x) {
      const glm::dvec2 share = placed.share({x + 0.5, y + 0.5});
      if (share.x < 0 || share.y < 0 || share.x >= 1 || share.y >= 1) continue;
      const glm::dvec3 color = color_at(share);
      for (int c = 0; c < 3; ++c) picture[3 * (static_cast<std::size_t>(y) * width + x) + c] = static_cast<float>(color[c]);
    }
}

}  // namespace

std::vector<DebugLayer> map_layers(LightImages images) {
  constexpr std::string_view which[] = {"; around a point light six, framed by the way they look",
                                        "; one for each slice of the picture, from near to far, framed in its color", ""};
  DebugLayer map{.name = "map",
                 .sentence = fmt::format(
                     "The depth images as the light sees them, upright and in their proportions, each from its nearest "
                     "stored depth (dark) to its farthest (light), with lines where depth jumps{}.",
                     which[static_cast<int>(images)]),
                 .legend = {nothing_stored, not_drawn}};
  DebugLayer texels{.name = "texels",
                    .sentence =
                        "Texels on the surfaces that they decide, checkered where a pixel can show it, dimmed where the "
                        "map answers dark: the color is a texel's length in pixels, along its longer way. Where two "
                        "images meet, each has a rim in the color of its frame in the layer map."};
  for (const TexelClass& c : texel_classes) texels.legend.push_back(c.swatch);
  texels.legend.push_back(beside_map);
  const int frames = images == LightImages::faces ? 6 : images == LightImages::slices ? ViewSlices::most : 0;
  for (int i = 0; i < frames; ++i) {
    Swatch frame = cube_faces[i];
    if (images == LightImages::slices) frame.name = fmt::format("slice {}", i + 1);
    map.legend.push_back(frame);
    texels.legend.push_back(frame);
  }
  return {map, texels};
}

std::vector<float> paint_map(const LightCamera& light_camera, int width, int height,
                             const std::function<std::span<const float>(std::size_t image)>& depths) {
  std::vector<float> picture(static_cast<std::size_t>(width) * height * 3);
  const auto fill = [&](const glm::dvec2& low, const glm::dvec2& high, const glm::dvec3& color) {
    const glm::ivec2 from = glm::max(glm::ivec2(glm::round(low)), glm::ivec2(0)),
                     to = glm::min(glm::ivec2(glm::round(high)), glm::ivec2(width, height));
    for (int y = from.y; y < to.y; ++y)
      for (int x = from.x; x < to.x; ++x)
        for (int c = 0; c < 3; ++c) picture[3 * (static_cast<std::size_t>(y) * width + x) + c] = static_cast<float>(color[c]);
  };
  fill({0, 0}, {width, height}, background_color());
  const std::size_t count = light_camera.images.size();
  const glm::ivec2 cells = count == 1 ? glm::ivec2(1) : count > 4 ? glm::ivec2(3, 2) : glm::ivec2(2, 2);
  const glm::dvec2 cell = glm::dvec2(width, height) / glm::dvec2(cells);
  const double frame = count == 1 ? 0 : std::max(1.0, std::round(0.012 * cell.y)), gap = 2 * frame;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec2 low = cell * glm::dvec2(i % cells.x, i / cells.x);
    const std::span<const float> texels = depths(i);
    const Placed placed = place(light_camera.images[i], !texels.empty(), low + gap, glm::max(cell - 2 * gap, glm::dvec2(1)));
    if (frame > 0) fill(placed.low - frame, placed.low + placed.size + frame, cube_faces[i].color);
    paint_face(light_camera.images[i], texels, light_camera.resolution, placed, width, height, picture);
  }
  return picture;
}

std::vector<float> paint_texels(const LightCamera& light_camera, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                std::span<const LookUp> look_ups, std::span<const float> mask) {
  std::vector<float> picture = shaded_layer(scene, gbuffer, light, mask);
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const int width = gbuffer.width, height = gbuffer.height;
  const auto is_on_rim = [&](std::size_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    for (const glm::ivec2 way : {glm::ivec2(2, 0), glm::ivec2(-2, 0), glm::ivec2(0, 2), glm::ivec2(0, -2)}) {
      const glm::ivec2 at = glm::ivec2(x, y) + way;
      if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) continue;
      const std::size_t j = static_cast<std::size_t>(at.y) * width + at.x;
      if (look_ups[j].image >= 0 && look_ups[j].image != look_ups[i].image && gbuffer.mesh[j] == gbuffer.mesh[i]) return true;
    }
    return false;
  };
  for_blocks(gbuffer.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [image, texel] = look_ups[i];
      if (image < 0) continue;
      const glm::dvec3 to_eye = glm::normalize(camera.eye - glm::dvec3(gbuffer.position(i)));
      double brightness = (0.65 + 0.35 * std::abs(glm::dot(glm::dvec3(gbuffer.normal(i)), to_eye))) * (0.35 + 0.65 * mask[i]);
      glm::dvec3 color = beside_map.color;
      if (light_camera.holds(texel)) {
        const glm::dmat2 pixel = pixel_on_image(light_camera.images[image], camera, gbuffer.position(i), gbuffer.normal(i));
        // A texel's shorter and longer way across the surface, in pixels.
        const glm::dvec2 size = 1.0 / glm::sqrt(squared_ways(pixel));
        const auto is_in = [&](const TexelClass& c) { return !(size.y > c.last); };
        color = std::ranges::find_if(texel_classes, is_in)->swatch.color;
        // A pattern finer than two pixels would be noise.
        if ((texel.x + texel.y) % 2 != 0) brightness *= 1 - 0.4 * std::clamp(size.x - 1, 0.0, 1.0);
      }
      if (light_camera.images.size() > 1 && is_on_rim(i)) color = cube_faces[image].color;
      for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(brightness * color[c]);
    }
  });
  return picture;
}

}  // namespace gnomon
