// Why a pixel has its answer: where it was looked up, and what is stored there.
#include <gnomon/kit/maps/compared_map.h>
#include <gnomon/kit/maps/light_layers.h>

namespace gnomon {

namespace {

/// Two look-ups of a pixel as one: where it was looked up is said by the one with the larger share, and how far a bias and a
/// texel reach by the longer of both.
Explanation blended(Explanation one, const Explanation& other, double share) {
  for (Tap& tap : one.taps) tap.weight *= 1 - share;
  for (const Tap& tap : other.taps) {
    one.taps.push_back(tap);
    one.taps.back().weight *= share;
  }
  std::erase_if(one.taps, [](const Tap& tap) { return tap.weight == 0; });
  one.bias = std::max(one.bias, other.bias);
  one.texel_width = std::max(one.texel_width, other.texel_width);
  if (share <= 0.5) return one;
  one.covered = other.covered;
  one.shifted = other.shifted;
  return one;
}

}  // namespace

void ComparedMap::start_questions() const {
  if (made_->read_of == this) return;
  made_->read_of = this;
  made_->read_depths.clear();
  made_->read_look_ups = {};
  made_->alpha_difference.reset();
}

const std::vector<float>& ComparedMap::depths() const {
  start_questions();
  if (!made_->read_depths.empty()) return made_->read_depths;
  made_->read_depths = read_texels<float>(map(depths_), GL_DEPTH_COMPONENT);
  if (order() == DepthOrder::forward)
    for (float& depth : made_->read_depths) depth = 1 - depth;  // as the shader does
  return made_->read_depths;
}

// By the very shader: next to a border of texels, or of images, float32 decides.
ComparedMap::Place ComparedMap::looked_up(std::size_t index, LookUpOf which) const {
  start_questions();
  std::vector<glm::vec4>& look_ups = made_->read_look_ups[int(which)];
  if (look_ups.empty()) {
    const StateGuard guard;
    auto& program = made_->explain_programs[int(which)][int(projection())];
    if (!program) program = resolve_program(projection(), which == LookUpOf::first ? Purpose::explain : Purpose::explain_again);
    const Texture texels(GL_RGBA32F, gbuffer_->width, gbuffer_->height);
    look_up(*program, MaskPass::fragment, depths_, texels.name());
    look_ups = read_texels<glm::vec4>(texels, GL_RGBA);
  }
  const glm::vec4 found = look_ups[index];
  const int coded = static_cast<int>(found.z);
  const auto image = std::ranges::find(camera_.images, coded % decided_early, &LightImage::layer);
  const bool is_drawn = image != camera_.images.end() && found.x > -1e5;  // see set_light_camera
  return {is_drawn ? &*image : nullptr, glm::dvec2(found.x, found.y), found.w, coded >= decided_early};
}

std::vector<float> ComparedMap::noted() const {
  std::vector<float> numbers(gbuffer_->size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (faces_light(*made_->scene, *gbuffer_, light_, i)) numbers[i] = looked_up(i).noted;
  return numbers;
}

/// The mask of the last resolve, once more, of these images of its camera.
std::vector<float> ComparedMap::answer(const Depths& depths) const {
  return read_mask(*gbuffer_,
                   [&](unsigned target) { look_up(made_->resolve_programs[int(projection())], mask_pass(), depths, target); });
}

std::string_view ComparedMap::alpha_cause(std::size_t index) const {
  const AlphaRule rule = made_->depth_images.hole_test().rule;
  if (rule == AlphaRule::texel) return "";
  start_questions();
  const auto draw_by_texel = [&](Depths& by_texel) { draw(by_texel, {}); };
  return AlphaDifference::cause(made_->alpha_difference, rule, made_->glass_difference.has_glass(), index, depths_,
                                draw_by_texel, [&](const Depths& one) { return answer(one); });
}

Explanation ComparedMap::explain_place(std::size_t index, const Place& place) const {
  const glm::dvec3 point = gbuffer_->position(index);
  if (place.image)
    return explain_comparison({camera_, *place.image, depths()}, comparison(light_),
                              {.position = point,
                               .normal = gbuffer_->normal(index),
                               .place = place.texel,
                               .pixel = {static_cast<int>(index) % gbuffer_->width, static_cast<int>(index) / gbuffer_->width},
                               .is_decided_early = place.is_decided_early});
  const LightImage& any = camera_.images.front();
  Explanation lit;
  lit.taps = {any.tap(any.texel_of(any.place_of(point)), INFINITY, 1)};
  return lit;
}

std::optional<Explanation> ComparedMap::explain(std::size_t index) const {
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return Explanation();
  Explanation why;
  const Place first = looked_up(index);
  const double share = looks_twice() ? first.noted : 0;
  const Place second = share > 0 ? looked_up(index, LookUpOf::second) : Place();
  if (first.image || second.image) {
    why = explain_place(index, first);
    if (share > 0) why = blended(std::move(why), explain_place(index, second), share);
    why.cause = alpha_cause(index);
    explain_decision(first.noted, why);
  }
  made_->glass_difference.explain(why, *gbuffer_, light_, index);
  return why;
}

std::vector<std::uint32_t> ComparedMap::image_parts() const { return parts_of(camera_, *made_->scene, *gbuffer_, light_); }

std::vector<DebugLayer> ComparedMap::debug_layers() const { return map_layers(images()); }

std::vector<float> ComparedMap::draw_debug(std::string_view layer) const {
  if (layer == "map")
    return paint_map(camera_, gbuffer_->width, gbuffer_->height,
                     [&](std::size_t image) { return camera_.texels_of(camera_.images[image], depths()); });
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<LookUp> look_ups(gbuffer_->size());
  for (std::size_t i = 0; i < look_ups.size(); ++i) {
    if (!faces_light(*made_->scene, *gbuffer_, light_, i)) continue;
    const Place place = looked_up(i);
    const LightImage* const image = place.image;
    const int number = image ? static_cast<int>(image - camera_.images.data()) : camera_.image_of(gbuffer_->position(i));
    look_ups[i] = {number, image ? glm::ivec2(glm::floor(place.texel)) : glm::ivec2(-1)};
  }
  return paint_texels(camera_, *made_->scene, *gbuffer_, light_, look_ups, answer(depths_));
}

}  // namespace gnomon
