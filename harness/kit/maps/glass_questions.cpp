// What a glass map answers about single pixels: causes and debug layers.
#include <gnomon/kit/maps/glass_map.h>
#include <gnomon/kit/maps/light_layers.h>
#include <gnomon/kit/parallel.h>

namespace gnomon {

double GlassMap::Reading::exact_share() const {
  double sum = 0;
  for (const GlassTexel& texel : texels) sum += texel.weight * texel.share;
  return sum;
}

double GlassMap::Reading::exact_absorbance_share() const {
  double log = 0;
  for (const GlassTexel& texel : texels) log += texel.weight * std::log(texel.share);
  return std::exp(log);
}

std::string_view GlassMap::glass_cause(const Reading& reading) const {
  if (!reading.is_right(reading.exact_share())) return "";
  if (filters_absorbance() && !reading.is_right(reading.exact_absorbance_share())) return "filtered_absorbance";
  return "curve";
}

void GlassMap::start_questions() const {
  if (made_->read_of == this) return;
  made_->read_of = this;
  made_->read_depths.clear();
  made_->read_look_ups.clear();
}

const std::vector<float>& GlassMap::depths() const {
  start_questions();
  if (made_->read_depths.empty()) made_->read_depths = read_texels<float>(depths_, GL_DEPTH_COMPONENT);
  return made_->read_depths;
}

// By the very shader: next to a border of texels, or of images, float32 decides.
GlassMap::Place GlassMap::looked_up(std::size_t index) const {
  start_questions();
  if (made_->read_look_ups.empty()) {
    const StateGuard guard;
    auto& program = made_->explain_programs[made_->has_glass][int(projection())];
    if (!program) program = look_up_program(projection(), made_->has_glass, Purpose::explain);
    const Texture texels(GL_RGBA32F, gbuffer_->width, gbuffer_->height);
    look_up(*program, texels.name());
    made_->read_look_ups = read_texels<glm::vec4>(texels, GL_RGBA);
  }
  const glm::dvec4 found = made_->read_look_ups[index];
  const int layer = static_cast<int>(found.w / 8);
  const auto image = std::ranges::find(camera_.images, layer, &LightImage::layer);
  const bool is_drawn = image != camera_.images.end() && found.x > -1e5;  // see set_light_camera
  return {is_drawn ? &*image : nullptr, glm::dvec2(found), (found.w - 8 * layer) / 7, found.z};
}

std::vector<GlassTexel> GlassMap::texels_of(const Place& place) const {
  std::vector<GlassTexel> texels;
  for (const auto& [texel, weight] : comparison().filter.texels(place.texel))
    if (weight > 0)
      texels.push_back({{glm::clamp(texel, glm::ivec2(0), glm::ivec2(camera_.resolution - 1)), place.image->layer}, weight, 1});
  return texels;
}

std::vector<GlassCrossing> GlassMap::glass_along(const Tap& ray) const {
  std::vector<GlassCrossing> list = made_->lists->along(ray.origin, ray.direction);
  std::erase_if(list, [](const GlassCrossing& one) { return one.transmission == 0; });
  return list;
}

/// With the exact lists of the rays through the texels' centers, down to where the point was looked up.
std::vector<GlassTexel> GlassMap::texels_at(const Place& place, const glm::dvec3& point, double bias) const {
  std::vector<GlassTexel> texels = texels_of(place);
  const double z = depth_at(*place.image, point, bias);
  for (GlassTexel& texel : texels) {
    const Tap ray = place.image->tap(glm::dvec2(texel.texel) + 0.5, z, texel.weight);
    texel.share = share_before(glass_along(ray), ray.stored);
  }
  return texels;
}

Explanation GlassMap::why_at(const Place& place, std::size_t index) const {
  return explain_comparison({camera_, *place.image, depths()}, comparison(),
                            {.position = gbuffer_->position(index), .normal = gbuffer_->normal(index), .place = place.texel});
}

void GlassMap::prepare_lists() const {
  if (!made_->lists) made_->lists = std::make_unique<GlassLists>(*made_->scene);
  if (!made_->exact) made_->exact = std::make_unique<ExactScene>(*made_->scene);
}

std::optional<Explanation> GlassMap::explain(std::size_t index) const {
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return Explanation();
  const Place place = looked_up(index);
  if (!place.image) return Explanation();
  Explanation why = why_at(place, index);
  if (!made_->has_glass || !why.covered) return why;
  prepare_lists();
  ExactTally tally;
  const Receiver receiver = receiver_at(*made_->scene, *gbuffer_, index);
  const Reading reading{.truth = made_->exact->transmitted(receiver, homogeneous(light_), tally).light.share.x,
                        .opaque = place.opaque,
                        .share = place.share,
                        .texels = texels_at(place, gbuffer_->position(index), why.bias)};
  if (!reading.is_right(reading.share)) why.cause = glass_cause(reading);
  return why;
}

std::vector<std::uint32_t> GlassMap::image_parts() const { return parts_of(camera_, *made_->scene, *gbuffer_, light_); }

std::vector<DebugLayer> GlassMap::debug_layers() const {
  std::vector<DebugLayer> layers = map_layers();
  layers.push_back(heat_debug_layer("curve",
                                    "By how many per cent of the light the share that glass lets through, as the texels "
                                    "hold it, differs from that of exact lists on the rays of the same texels"));
  return layers;
}

std::vector<float> GlassMap::draw_debug(std::string_view layer) const {
  if (layer == "map")
    return paint_map(camera_, gbuffer_->width, gbuffer_->height,
                     [&](std::size_t image) { return camera_.texels_of(camera_.images[image], depths()); });
  if (layer == "curve") return draw_curve_errors();
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<LookUp> look_ups(gbuffer_->size());
  for (std::size_t i = 0; i < look_ups.size(); ++i) {
    if (!faces_light(*made_->scene, *gbuffer_, light_, i)) continue;
    const Place place = looked_up(i);
    const int number =
        place.image ? static_cast<int>(place.image - camera_.images.data()) : camera_.image_of(gbuffer_->position(i));
    look_ups[i] = {number, place.image ? glm::ivec2(glm::floor(place.texel)) : glm::ivec2(-1)};
  }
  const auto& program = made_->resolve_programs[made_->has_glass][int(projection())];
  const std::vector<float> mask = read_mask(*gbuffer_, [&](unsigned target) { look_up(program, target); });
  return paint_texels(camera_, *made_->scene, *gbuffer_, light_, look_ups, mask);
}

void GlassMap::each_looked_up(const std::function<void(std::size_t, const Place&)>& visit) const {
  looked_up(0);  // reads back what the threads use
  depths();
  for_blocks(gbuffer_->size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!faces_light(*made_->scene, *gbuffer_, light_, i)) continue;
      const Place place = looked_up(i);
      if (place.image && camera_.holds(glm::ivec2(glm::floor(place.texel)))) visit(i, place);
    }
  });
}

std::vector<float> GlassMap::heat_of_texels(const std::function<float(const glm::ivec3& texel)>& value) const {
  std::vector<float> values(gbuffer_->size(), 0);
  each_looked_up([&](std::size_t i, const Place& place) {
    values[i] = value({glm::ivec2(glm::floor(place.texel)), place.image->layer});
  });
  return heat_layer(*gbuffer_, values);
}

std::vector<float> GlassMap::draw_curve_errors() const {
  std::vector<float> per_cent(gbuffer_->size(), 0);
  if (!made_->has_glass) return heat_layer(*gbuffer_, per_cent);
  prepare_lists();
  each_looked_up([&](std::size_t i, const Place& place) {
    const std::vector<GlassTexel> texels = texels_at(place, gbuffer_->position(i), why_at(place, i).bias);
    const Reading reading{.truth = 0, .opaque = 1, .share = place.share, .texels = texels};
    const double exact = filters_absorbance() ? reading.exact_absorbance_share() : reading.exact_share();
    const auto off = static_cast<float>(100 * std::abs(place.share - exact));
    per_cent[i] = off < 0.5f ? 0 : off;
  });
  return heat_layer(*gbuffer_, per_cent);
}

}  // namespace gnomon
