// Averaged hard shadows: the mean of the masks that a hard technique gives for a number of points of the light.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/bases/inner_technique.h>
#include <gnomon/kit/bases/light_objects.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/kept_masks.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>

#include <algorithm>
#include <cmath>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Averaged hard shadows",
    .summary = "The mean of the hard shadows from a number of points of the light, by any technique for lights without area.",
    .source = "Brotman and Badler 1984; places of the light as for area_rays.",
    .error =
        "That of the hard technique, and banding: all pixels share the points (in pattern interleaved every sixteenth), so "
        "that behind opaque casters n of them tell n + 1 shares apart. The error falls with n as n^-0.5 where they are random "
        "and as about n^-0.75 where they are spread evenly. It estimates the share of the light's area.",
    .fails =
        "A wide penumbra of few points shows as many edges as there are points. Memory and relight grow with their number. "
        "Casters within a sphere of light hide points of its surface; other techniques sample the disc that is seen of it.",
    .device = Device::opengl,
    .floor = Floor::copy,                // many hard techniques draw
    .handles = with_gray_transmission};  // of these what the hard technique handles: see `supports`

constexpr double MiB = 1 << 20;

/// Objects of all points: four times as many as samples may be, so that pattern interleaved has up to 256.
constexpr int most_objects = 4096;

std::string cannot_be_averaged(const TechniqueEntry& entry) {
  if (entry.id == "averaged_hard") return "it does not average itself";
  return has_no_hard_shadow(entry);
}

// The hard technique comes from the registry, unchanged: one object for each point of the light. They share what
// setup and build make where it can share that (Technique::for_another_light); else each has a setup, a build and updates of
// its own. An object for a further light with area holds points of its own, which share with the first object's.
class AveragedHard final : public Technique {
  InnerTechnique of = InnerTechnique(
      this, "of", "svbsp", Stage::setup,
      "The hard technique, one of those that support lights without area; its own parameters follow, as of.NAME.",
      cannot_be_averaged);
  Number<int> samples{
      this, "samples", 8, {"point", 1, 1024, true}, Stage::relight, "Points of the light that a pixel averages."};
  Choice pattern =
      Choice(this, "pattern", "low_discrepancy", pattern_names(), Stage::relight,
             "Where they lie: anywhere; one in each of as many cells; a sequence that fills the light evenly; sixteen such "
             "sequences, one for every fourth pixel along x and y, which takes sixteen times the objects.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::relight, "Other random numbers."};
  Number<int> memory = Number<int>(this, "memory", 4096, {"MiB", 256, 1 << 20, true}, Stage::relight,
                                   "Most that the objects of all points may hold; a relight that needs more is refused.");

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (!has_area(light))
      return Support::unsupported(fmt::format("the light has no area: its shadows are hard, see {}", of.text()));
    if (object_count() > most_objects)
      return Support::unsupported(fmt::format("pattern {} of {} points needs {} objects of {}; at most {}: {} points",
                                              pattern.text(), samples.value(), object_count(), of.text(), most_objects,
                                              most_objects / set_count()));
    // Only some of the points are tested: one test may take as long as a stage.
    constexpr std::size_t most_asked = 16;
    const std::vector<glm::vec3> points = points_of(light);
    const std::size_t asked = std::min(points.size(), most_asked);
    struct Answer {
      std::size_t count = 0;
      std::string why;  // of the first one
    };
    Answer refused, approximate;
    for (std::size_t k = 0; k < asked; ++k) {
      const Light point{.name = light.name, .kind = PointLight{points[k * points.size() / asked]}};
      const Support support = support_of(of.entry().about, of.technique(), scene, point, view);
      if (support.kind() == Support::Kind::full) continue;
      auto& answer = support ? approximate : refused;
      ++answer.count;
      if (answer.why.empty()) answer.why = support.why();
    }
    const auto reason = [&](const auto& answer) {
      return fmt::format(
          "{} from {}: {}", of.text(),
          answer.count == asked ? "points of the light" : fmt::format("{} of {} points asked", answer.count, asked),
          answer.why);
    };
    if (refused.count > 0) return Support::unsupported(reason(refused));
    return approximate.count > 0 ? Support::approximate(reason(approximate)) : Support::full();
  }
  void setup() override {
    made_->objects.emplace(of.entry(), of.technique().settings());
    ++made_->setup_count;
    objects_for(Stage::setup).each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
  }
  void build(const Scene& scene) override {
    made_->scene = &scene;
    objects_for(Stage::build).each(Stage::build, [&](Technique& object, std::size_t) { object.build(scene); });
  }
  void update(const Scene& scene, const Changes& changes) override {
    const std::size_t built = objects().count();  // those that are new are built on what has moved already
    objects_for(Stage::update).each(Stage::update, [&](Technique& object, std::size_t k) {
      if (k < built) object.update(scene, changes);
    });
  }
  void relight(const Light& light) override {
    light_ = light;
    sets_ = set_count();
    points_.clear();
    for (const glm::vec3& point : points_of(light)) points_.push_back({.name = light.name, .kind = PointLight{point}});
    double held = 0;
    LightObjects& all = objects_for(Stage::relight);
    all.each(Stage::relight, [&](Technique& object, std::size_t k) {
      object.relight(points_[k]);
      for (const Count& count : object.counts())
        if (count.name == "bytes") held += count.value;
      if (held > memory * MiB)
        throw Error("{}.memory = {} MiB is not enough for {} objects of {}: {} of them hold {:.0f} MiB", id(), memory.value(),
                    all.count(), of.text(), k + 1, held / MiB);
    });
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    kept_.clear();
    objects().set(of.technique().settings());
    sums_.assign(gbuffer.size(), 0);
    weights_.assign(gbuffer.size(), 0);
    std::vector<PointWeights> weights;
    weights.reserve(gbuffer.size());
    for (std::size_t i = 0; i < gbuffer.size(); ++i) weights.emplace_back(light_, gbuffer.position(i), gbuffer.normal(i));
    const std::size_t in_set = points_.size() / static_cast<std::size_t>(sets_);
    each_mask([&](std::size_t k, std::span<const float> seen) {
      const glm::vec3 point = std::get<PointLight>(points_[k].kind).position;
      for_blocks(gbuffer.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (!(seen[i] >= 0 && seen[i] <= 1))
            throw Error("mask value {} of {} at pixel {} is outside 0 .. 1, from point {} of the light", seen[i], of.text(), i,
                        k + 1);
          if (sets_ > 1 && set_of(i) != k / in_set) continue;
          const float weight = weights[i].at(point);
          sums_[i] += weight * seen[i];
          weights_[i] += weight;
        }
      });
    });
    const std::span<float> pixels = mask.pixels();
    // No sum is above that of the weights, since rounding keeps the order of its terms; where every point is seen the two are
    // the same numbers added up in the same order, and their ratio is 1.
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = weights_[i] > 0 ? sums_[i] / weights_[i] : 1.0f;
  }
  Counts counts() const override {
    Counts all = objects().counts();
    const double mask_bytes = static_cast<double>(weights_.size()) * (draws(of.entry().about) ? 8 : 4);
    const double own = static_cast<double>(bytes_of(sums_, weights_, points_)) + mask_bytes;
    const auto bytes = std::ranges::find(all, "bytes", &Count::name);
    if (bytes != all.end())
      bytes->value += own;
    else
      all.push_back({"bytes", own, "byte"});
    all.push_back({"light_points", static_cast<double>(points_.size()), ""});
    return all;
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return of.technique().for_another_light() ? another(*this, &AveragedHard::made_) : nullptr;
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    const GBuffer& g = *gbuffer_;
    if (!faces_light(*made_->scene, g, light_, index)) return why;
    keep_masks();
    const PointWeights weights(light_, g.position(index), g.normal(index));
    const std::size_t in_set = points_.size() / static_cast<std::size_t>(sets_), first = set_of(index) * in_set;
    // What the hard technique leaves out, it leaves out from all points.
    if (const auto hard = objects()[first].explain(index); hard && !hard->covered) {
      why.covered = false;
      return why;
    }
    double sum = 0;
    for (std::size_t k = first; k < first + in_set; ++k) {
      const glm::vec3 point = std::get<PointLight>(points_[k].kind).position;
      const float weight = weights.at(point);
      if (weight > 0) why.samples.push_back({.place = point, .weight = weight, .visibility = kept_.at(k, index)});
      sum += weight;
    }
    for (LightSample& sample : why.samples) sample.weight /= sum;
    return why;
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {{"hard", "The scene with the hard shadows of the first point of the light."},
            {"edges",
             "Points of the light whose hard shadows have an edge beside a pixel: none where the picture is left gray, else "
             "colors as in the legend. Bands of gray between them are what too few points leave of a penumbra.",
             heat_legend()}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    const GBuffer& g = *gbuffer_;
    if (layer == "hard") {
      objects()[0].resolve(g, *mask_);
      return shaded_layer(*made_->scene, g, points_[0], mask_->read());
    }
    if (layer != "edges") return Technique::draw_debug(layer);
    keep_masks();
    std::vector<float> values(g.size());
    for (std::size_t i = 0; i < g.size(); ++i) values[i] = edge_count(i);
    return heat_layer(g, values);
  }

 private:
  struct Made {
    std::optional<LightObjects> objects;  // of the first light
    const Scene* scene = nullptr;
    std::size_t setup_count = 0;  // objects of further lights are of the same setup
  };

  int set_count() const { return pattern.is("interleaved") ? 16 : 1; }
  int object_count() const { return samples * set_count(); }
  /// Of set after set.
  std::vector<glm::vec3> points_of(const Light& light) const {
    std::vector<glm::vec3> all;
    for (int set = 0; set < set_count(); ++set) {
      const std::vector<glm::vec3> some =
          light_points(light, pattern.value(), samples, places_seed(seed, static_cast<std::uint64_t>(set)));
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }
  /// As many objects as there are points, with the present settings; what is new and whole is brought up to a stage.
  LightObjects& objects_for(Stage stage) {
    const std::string settings = of.technique().settings();
    if (made_.is_guest() && (!guests_ || guests_setup_ != made_->setup_count)) {
      guests_.emplace(of.entry(), settings, (*made_->objects)[0]);
      guests_setup_ = made_->setup_count;
    }
    LightObjects& all = objects();
    all.set(settings);
    const std::size_t before = all.count();
    if (all.hold(static_cast<std::size_t>(object_count())))
      for (std::size_t k = before; k < all.count(); ++k) {
        if (stage > Stage::setup) all[k].setup();
        if (stage > Stage::build) all[k].build(*made_->scene);
      }
    return all;
  }
  LightObjects& objects() const { return made_.is_guest() ? *guests_ : *made_->objects; }
  std::uint32_t set_of(std::size_t pixel) const {
    if (sets_ == 1) return 0;
    const std::size_t width = static_cast<std::size_t>(gbuffer_->width);
    return interleaved_set(pixel % width, pixel / width);
  }
  /// Resolves every object: use(number of the point, its mask).
  template <class Use>
  void each_mask(const Use& use) const {
    if (!mask_ || mask_->width() != gbuffer_->width || mask_->height() != gbuffer_->height)
      mask_.emplace(gbuffer_->width, gbuffer_->height);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      objects()[k].resolve(*gbuffer_, *mask_);
      use(k, mask_->read());
    }
  }
  void keep_masks() const {
    if (kept_.empty()) each_mask([&](std::size_t, std::span<const float> seen) { kept_.add(seen); });
  }
  /// Points of the light whose masks tell a pixel from the one right of it or below it.
  float edge_count(std::size_t pixel) const {
    const GBuffer& g = *gbuffer_;
    const std::size_t width = static_cast<std::size_t>(g.width), right = pixel + 1, below = pixel + width;
    const auto is_asked = [&](std::size_t i) { return faces_light(*made_->scene, g, light_, i); };
    const auto is_beside = [&](std::size_t i) { return is_asked(i) && g.mesh[i] == g.mesh[pixel]; };
    if (!is_asked(pixel)) return 0;
    const bool has_right = right % width != 0 && is_beside(right), has_below = below < g.size() && is_beside(below);
    const std::size_t in_set = points_.size() / static_cast<std::size_t>(sets_), first = set_of(pixel) * in_set;
    const double edge = made_->scene->has_transmission() ? 1.0 / 20 : 0.5;
    float count = 0;
    for (std::size_t k = first; k < first + in_set; ++k) {
      const auto differs = [&](std::size_t i) { return std::abs(kept_.at(k, i) - kept_.at(k, pixel)) > edge; };
      count += (has_right && differs(right)) || (has_below && differs(below)) ? 1.0f : 0.0f;
    }
    return count;
  }

  Shared<Made> made_;
  mutable std::optional<LightObjects> guests_;
  std::size_t guests_setup_ = 0;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  std::vector<Light> points_;  // lights without area
  int sets_ = 1;
  mutable std::optional<VisibilityMask> mask_;  // of one point
  std::vector<float> sums_, weights_;           // of each pixel
  mutable KeptMasks kept_;                      // made by the first `explain`
};

}  // namespace

GNOMON_TECHNIQUE(averaged_hard, AveragedHard, about)
