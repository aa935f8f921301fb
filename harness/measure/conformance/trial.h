#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "measure/conformance/rule.h"
#include "measure/conformance/world.h"
#include "measure/worker/technique_device.h"

namespace gnomon::conformance {

/// One technique before one rule: fresh objects of it, the worlds that it is checked in, and what was found.
class Trial {
 public:
  explicit Trial(const Rule& rule, const TechniqueEntry& entry, std::function<void(const Place&)> moves = {})
      : rule_(rule),
        entry_(entry),
        device_(rule.has_context ? device_of(entry.about) : std::make_unique<TechniqueDevice>()),
        moves_(std::move(moves)) {}

  const TechniqueEntry& entry() const { return entry_; }
  /// That it is called with; in a rule without a context the processor.
  TechniqueDevice& device() const { return *device_; }
  /// Under the sanitizers, where the rule leaves out a part.
  bool is_short() const { return is_sanitized && rule_.sanitized == Sanitized::part; }

  /// Of a generated scene.
  std::unique_ptr<World> world(const std::string& reference) const { return world(generated_scene(reference)); }
  /// Under the sanitizers, whose findings do not depend on the size, its pictures are half as wide and half as high.
  std::unique_ptr<World> world(Scene scene) const {
    return std::make_unique<World>(std::move(scene), entry_.about.sees, is_sanitized ? 2 : 1);
  }

  // Where the rule's pictures may be small, the settings of these are with_small_pictures.
  /// What a fresh object supports, queried before it runs.
  Support support(const Scene& scene, const Light& light, const std::string& settings = "") const;
  std::vector<Light> supported_lights(const Scene& scene, const std::string& settings = "") const;

  using CheckLight = std::function<void(World& world, const GBuffer& gbuffer, const Light& light)>;
  /// Calls `check` for the first view of a generated scene and each light of it that the technique supports.
  void under_each_light(const std::string& reference, const CheckLight& check) { under_each_light(enter(reference), check); }
  /// The same in a world that the trial has entered.
  void under_each_light(std::unique_ptr<World> world, const CheckLight& check);

  std::unique_ptr<Technique> set_up(const std::string& settings = "") const;
  /// The next resolve is the first of a sequence. All rules but those of sequences judge such answers alone.
  void begin(Technique& technique) const {
    if (entry_.about.remembers) technique.forget();
  }
  /// The first frame of a sequence. Starts from a mask of nonsense, in memory or in its texture, of which the technique must
  /// write every pixel.
  std::vector<float> resolve(Technique& technique, const GBuffer& gbuffer) const;
  /// The same of the next frame, without forgetting those before.
  std::vector<float> resolve_next(Technique& technique, const GBuffer& gbuffer) const;
  std::vector<float> answer(Technique& technique, const Scene& scene, const Light& light, const GBuffer& gbuffer) const;
  std::vector<float> fresh_answer(const Scene& scene, const Light& light, const GBuffer& gbuffer,
                                  const std::string& settings = "") const;

  /// The place of what is checked from here on.
  void at(std::string scene, std::string settings = "");
  /// The same for a generated scene; returns its world.
  std::unique_ptr<World> enter(const std::string& reference) {
    at(reference);
    return world(reference);
  }
  /// The same scene and settings under this light.
  void at(const Light& light);

  void found(std::string what) { add({std::move(what), place_, {}}); }
  void found(std::string what, std::size_t pixel, const GBuffer& gbuffer);
  void expect(bool holds, std::string_view what) {
    if (!holds) found(std::string(what));
  }
  /// Bit for bit, so that also a NaN equals itself. `when` begins the finding. Without a G-buffer: of anything else.
  void expect_same(const std::vector<float>& a, const std::vector<float>& b, std::string_view when,
                   const GBuffer* gbuffer = nullptr);
  /// Every value is a share of light, and 1 where there is nothing to decide (classes B and F).
  void expect_mask(const std::vector<float>& mask, const Scene& scene, const GBuffer& gbuffer, const Light& light);

  /// Ends nothing. Findings outweigh it.
  void does_not_apply(std::string why) { verdict_.why = std::move(why); }
  Verdict verdict() const;

 private:
  void add(Finding finding);
  std::unique_ptr<Technique> made(const std::string& settings) const;
  /// The settings with which it is checked in place of these. Found once: later the device may pretend that it can do less.
  const std::string& asked_with(const std::string& settings) const;

  const Rule& rule_;
  const TechniqueEntry& entry_;
  std::unique_ptr<TechniqueDevice> device_;
  std::function<void(const Place&)> moves_;
  mutable std::map<std::string, std::string> asked_with_;
  Place place_;
  Verdict verdict_;
};

/// The count that is named bytes; 0 without it.
double counted_bytes(const Counts& counts);
/// "" and "a=1" for every probe of every parameter for which `wanted` is true.
std::vector<std::string> settings_of(const TechniqueEntry& entry, const std::function<bool(const Parameter&)>& wanted = {});
/// The settings with 128 texels a side for a picture of the technique's own, such as a map of 1024, unless they set its size:
/// that is enough for pictures of 96 x 54 pixels, and drawn faster. With 256 or 512 texels, or unchanged, where the technique
/// would support less, or where `least` is more.
std::string with_small_pictures(const TechniqueEntry& entry, const std::string& settings, int least = 128);

// The rules of each file.
std::vector<Rule> about_rules(), answer_rules(), promise_rules(), cause_rules(), life_rules(), light_rules(), neighbor_rules(),
    limit_rules(), scale_rules(), memory_rules(), motion_rules(), combined_rules(), sequence_rules(), sequence_error_rules();

}  // namespace gnomon::conformance
