// Contact march: from every visible point some way toward the light, over the picture, against the surfaces that it shows; what
// this darkens is taken from the mask of another technique.
//
// The picture is the G-buffer, on the processor: a pass over it in OpenGL would read the same numbers.
#include <gnomon/kit/bases/inner_technique.h>
#include <gnomon/kit/bases/light_objects.h>
#include <gnomon/kit/counts.h>
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/rays/ray_casters.h>

#include <algorithm>
#include <cmath>

#include "contact_march/caster.h"
#include "contact_march/picture.h"

namespace {
using namespace gnomon;
using namespace gnomon::contact_march;

/// Of the march, in the order of `MarchCause`; then that of a partner's causes, and those of maps, which pass by their names.
constexpr OwnCause causes[] = {
    {"out_of_range", "The nearest caster is farther away than the march goes.", {40, 200, 40}},
    {"off_screen", "The nearest caster is out of the picture.", {160, 255, 200}},
    {"hidden_caster", "Where the nearest caster is in the picture, a nearer surface hides it.", {0, 0, 80}},
    {"missed_step", "The picture shows the nearest caster, and the march's steps did not find it.", {0, 32, 48}},
    {"thickness", "The ray passes behind a surface, which is thinner than the march takes it for.", {84, 0, 196}},
    {"partner", "The partner decided, and names a cause that only its own rows have.", {152, 0, 72}},
    map_causes[0],
    map_causes[1],
    map_causes[2]};
enum MarchCause : std::size_t { out_of_range, off_screen, hidden_caster, missed_step, thickness_cause, partner_cause };
static_assert(std::size(causes) == partner_cause + 1 + std::size(map_causes));

constexpr About about{
    .title = "Contact march",
    .summary =
        "A short march toward the light over the picture, which finds the casters close to a point that a shadow map's bias "
        "skips; the mask is the darker one of the march and of a partner.",
    .source =
        "McGuire and Mara 2014 (a ray along pixels, with a thickness); Ritschel, Grosch and Seidel 2009 (casters from the "
        "picture). As contact shadows beside a map it is folklore of engines, without a first source.",
    .error =
        "That of the partner, less what the march finds. The march is dark too often where a ray passes behind a thin surface, "
        "by less than the thickness, and misses casters out of the picture, behind others, and farther away than its length.",
    .fails =
        "Fences and wires in front of a lit ground: the picture has no backs, and every depth behind a wire within the "
        "thickness counts as in it. Casters behind the eye.",
    .device = Device::opengl,  // many partners draw
    .floor = Floor::fetch,
    .handles = with_alpha_masks,
    .causes = causes,
    .named_only = true};

std::string cannot_be_partner(const TechniqueEntry& entry) {
  if (entry.id == "contact_march") return "it is no partner of itself";
  if (entry.about.remembers) return fmt::format("{} remembers frames", entry.id);
  return has_no_hard_shadow(entry);
}

// The partner is an object of the registry, unchanged. Objects for further lights share its setup and build where it can share
// them; where it cannot, they share nothing here either.
class ContactMarch final : public Technique {
  InnerTechnique partner = InnerTechnique(
      this, "partner", "shadow_map", Stage::setup,
      "The technique whose mask the march darkens, one of those that support lights without area; unshadowed leaves the march "
      "alone. Its own parameters follow, as partner.NAME.",
      cannot_be_partner);
  Number<double> length = Number<double>(
      this, "length", 0.01, {.min = 0.0001, .max = 1, .log = true}, Stage::resolve,
      "How far the march goes, as a share of the diagonal of the scene's box; to the light where that is nearer.");
  Number<int> steps = Number<int>(this, "steps", 64, {.min = 1, .max = 4096, .log = true}, Stage::resolve,
                                  "Most steps of a march: one a pixel where these suffice, else all of them are longer.");
  Number<double> thickness =
      Number<double>(this, "thickness", 0.25, {.min = 0.001, .max = 100, .log = true}, Stage::resolve,
                     "How far behind a surface of the picture a ray still is in its body, in lengths of the march.");

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (has_area(light)) return Support::unsupported("the light has an area: the march goes to one point");
    const Support other = support_of(partner.entry().about, partner.technique(), scene, light, view);
    if (!other) return Support::unsupported(fmt::format("{}: {}", partner.text(), other.why()));
    if (is_alone()) return Support::approximate("it sees only what the picture shows, to its length");
    if (other.kind() == Support::Kind::full) return other;
    return Support::approximate(fmt::format("{}: {}", partner.text(), other.why()));
  }
  void setup() override {
    made_->partner.emplace(partner.entry(), partner.technique().settings());
    ++made_->setup_count;
    with_settings().setup();
  }
  void build(const Scene& scene) override {
    take(scene);
    made_->numbers = TriangleNumbers(scene);
    with_settings().build(scene);
  }
  void update(const Scene& scene, const Changes& changes) override {
    take(scene);
    with_settings().update(scene, changes);
  }
  void relight(const Light& light) override {
    light_ = light;
    with_settings().relight(light);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    if (!partner_mask_ || partner_mask_->width() != gbuffer.width || partner_mask_->height() != gbuffer.height)
      partner_mask_.emplace(gbuffer.width, gbuffer.height);
    with_settings().resolve(gbuffer, *partner_mask_);
    seen_ = partner_mask_->read();
    picture_.take(*made_->scene, made_->numbers, gbuffer);
    const std::span<float> out = mask.pixels();
    constexpr std::size_t block = 4096;
    block_steps_.assign((out.size() + block - 1) / block, 0);
    for_blocks(out.size(), block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        out[i] = 1;
        if (!faces_light(*made_->scene, gbuffer, light_, i)) continue;
        out[i] = seen_[i];
        if (!(seen_[i] >= 0 && seen_[i] <= 1))
          throw Error("mask value {} of {} at pixel {} is outside 0 .. 1", seen_[i], partner.text(), i);
        if (seen_[i] == 0) continue;
        const March march = marched(i);
        block_steps_[begin / block] += static_cast<std::uint64_t>(march.steps);
        if (march.is_dark()) out[i] = 0;
      }
    });
  }
  Counts counts() const override {
    Counts all = objects().counts();
    std::uint64_t step_count = 0;
    for (const std::uint64_t steps_of_block : block_steps_) step_count += steps_of_block;
    const double mask_bytes = static_cast<double>(seen_.size()) * (draws(partner.entry().about) ? 8 : 4);
    const double own = static_cast<double>(picture_.bytes() + bytes_of(block_steps_)) + mask_bytes +
                       made_.own(static_cast<double>(made_->numbers.bytes()));
    const auto bytes = std::ranges::find(all, "bytes", &Count::name);
    if (bytes != all.end())
      bytes->value += own;
    else
      all.push_back({"bytes", own, "byte"});
    all.push_back(count_of("march_steps", step_count));
    return all;
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return partner.technique().for_another_light() ? another(*this, &ContactMarch::made_) : nullptr;
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return std::nullopt;
    // A visibility of one half is dark.
    if (seen_[index] > 0.5f && marched(index).is_dark()) return of(causes[thickness_cause].id);
    if (is_alone()) return of(false_lit_cause(index));
    std::optional<Explanation> why = objects()[0].explain(index);
    const auto is_declared = [&](const OwnCause& cause) { return cause.id == why->cause; };
    if (why && !why->cause.empty() && std::ranges::none_of(causes, is_declared)) why->cause = causes[partner_cause].id;
    return why;
  }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<Swatch> ends;
    for (std::size_t k = 0; k < std::size(end_names); ++k) ends.push_back({std::string(end_names[k]), end_colors[k]});
    return {
        heat_debug_layer("steps", "Steps that the march took from a pixel, also where the partner is dark"),
        {"stops",
         "What ended the march of a pixel: a surface of the picture, which makes it dark; its length; the light; the border "
         "of the picture. Gray where nothing faces the light.",
         ends}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "steps" && layer != "stops") return Technique::draw_debug(layer);
    const GBuffer& g = *gbuffer_;
    std::vector<float> taken(g.size(), 0);
    std::vector<int> ends(g.size(), -1);
    for_blocks(g.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!faces_light(*made_->scene, g, light_, i)) continue;
        const March march = marched(i);
        taken[i] = static_cast<float>(march.steps);
        ends[i] = static_cast<int>(march.end);
      }
    });
    if (layer == "steps") return heat_layer(g, taken);
    std::vector<float> picture = heat_layer(g, std::vector<float>(g.size(), 0));
    for (std::size_t i = 0; i < g.size(); ++i)
      for (int c = 0; ends[i] >= 0 && c < 3; ++c) picture[3 * i + c] = static_cast<float>(end_colors[ends[i]][c]);
    return picture;
  }

 private:
  struct Made {
    std::optional<LightObjects> partner;  // one object: that of the first light
    std::size_t setup_count = 0;          // objects of further lights are of the same setup
    const Scene* scene = nullptr;
    double diagonal = 0;  // meters
    TriangleNumbers numbers;
    std::optional<RayCasters> casters;  // made by the first `explain` that traces
  };

  /// In the order of `End`, linear RGB: orange, gray blue, yellow, violet.
  static constexpr glm::dvec3 end_colors[] = {{0.75, 0.22, 0.02}, {0.12, 0.2, 0.3}, {0.8, 0.7, 0.1}, {0.4, 0.08, 0.6}};

  bool is_alone() const { return partner.text() == "unshadowed"; }
  void take(const Scene& scene) {
    made_->scene = &scene;
    made_->diagonal = diagonal_of(scene);
    made_->casters.reset();
  }
  LightObjects& objects() const { return made_.is_guest() ? *guest_ : *made_->partner; }
  /// The partner's object for this light, with the present settings.
  Technique& with_settings() {
    const std::string settings = partner.technique().settings();
    if (made_.is_guest() && (!guest_ || guest_setup_ != made_->setup_count)) {
      guest_.emplace(partner.entry(), settings, (*made_->partner)[0]);
      guest_->hold(1);
      guest_setup_ = made_->setup_count;
    }
    objects().set(settings);
    return objects()[0];
  }
  March marched(std::size_t pixel) const {
    const double meters = length * made_->diagonal;
    return picture_.march(pixel, homogeneous(light_), {.length = meters, .thickness = thickness * meters, .most_steps = steps});
  }
  static Explanation of(std::string_view cause) {
    Explanation why;
    why.cause = cause;
    return why;
  }
  /// Why the march found no caster of a pixel; empty where it has none.
  std::string_view false_lit_cause(std::size_t pixel) const {
    if (!made_->casters) made_->casters.emplace().build(*made_->scene);
    const Caster caster = nearest_caster(made_->casters->under(gbuffer_->truth), *gbuffer_, homogeneous(light_), pixel);
    if (caster.mesh == no_mesh) return {};
    if (caster.distance > length * made_->diagonal) return causes[out_of_range].id;
    const std::optional<std::size_t> seen_at = picture_.pixel_of(caster.point);
    if (!seen_at) return causes[off_screen].id;
    const Receiver shown = receiver_at(*made_->scene, *gbuffer_, *seen_at);
    const bool is_shown = shown.mesh == caster.mesh && shown.is_own(caster.mesh, caster.triangle);
    if (!is_shown && picture_.shown_before(caster.point) < picture_.z(caster.point)) return causes[hidden_caster].id;
    return causes[missed_step].id;
  }

  Shared<Made> made_;
  mutable std::optional<LightObjects> guest_;
  std::size_t guest_setup_ = 0;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;  // of the last resolve
  std::optional<VisibilityMask> partner_mask_;
  std::span<const float> seen_;  // of that mask
  Picture picture_;
  std::vector<std::uint64_t> block_steps_;
};

}  // namespace

GNOMON_TECHNIQUE(contact_march, ContactMarch, about)
