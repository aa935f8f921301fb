#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "measure/conformance/rule.h"
#include "measure/conformance/world.h"

namespace gnomon::conformance {

/// One technique before one rule: fresh objects of it, the worlds that it is asked in, and what was found.
class Trial {
 public:
  explicit Trial(const Rule& rule, const TechniqueEntry& entry, std::function<void(const Place&)> moves = {})
      : rule_(rule), entry_(entry), moves_(std::move(moves)) {}

  const TechniqueEntry& entry() const { return entry_; }
  bool uses_gl() const { return entry_.about.needs_gl; }
  /// Under the sanitizers, where the rule leaves out a part.
  bool is_short() const { return is_sanitized && rule_.sanitized == Sanitized::part; }

  std::unique_ptr<World> world(const std::string& reference) const;
  /// Under the sanitizers its pictures are half as wide and half as high: what they look for is in every pixel.
  std::unique_ptr<World> world(Scene scene) const {
    return std::make_unique<World>(std::move(scene), entry_.about.sees, is_sanitized ? 2 : 1);
  }

  // Where the rule's pictures may be small, the settings of these are with_small_pictures.
  /// The answer of a fresh object, as everything else asks: before it runs.
  Support support(const Scene& scene, const Light& light, const std::string& settings = "") const;
  std::vector<Light> supported_lights(const Scene& scene, const std::string& settings = "") const;

  /// Calls `check` for the first view of a generated scene and each light of it that the technique supports.
  void under_each_light(const std::string& reference,
                        const std::function<void(const World& world, const GBuffer& gbuffer, const Light& light)>& check);

  std::unique_ptr<Technique> set_up(const std::string& settings = "") const;
  /// In a mask that holds nonsense until the technique has written every pixel of it, in memory or in its texture.
  std::vector<float> resolve(Technique& technique, const GBuffer& gbuffer) const;
  std::vector<float> answer(Technique& technique, const Scene& scene, const Light& light, const GBuffer& gbuffer) const;
  std::vector<float> fresh_answer(const Scene& scene, const Light& light, const GBuffer& gbuffer,
                                  const std::string& settings = "") const;

  /// From here on it is asked there.
  void at(std::string scene, std::string settings = "");
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

  /// Ends nothing; counts where nothing was found.
  void does_not_apply(std::string why) { verdict_.why = std::move(why); }
  Verdict verdict() const;

 private:
  void add(Finding finding);
  std::unique_ptr<Technique> made(const std::string& settings) const;
  /// The settings that it is asked with for these. Found once: later the device may pretend that it can do less.
  const std::string& asked_with(const std::string& settings) const;

  const Rule& rule_;
  const TechniqueEntry& entry_;
  std::function<void(const Place&)> moves_;
  mutable std::map<std::string, std::string> asked_with_;
  Place place_;
  Verdict verdict_;
};

/// "" and "a=1" for every probe of every parameter that is wanted.
std::vector<std::string> settings_of(const TechniqueEntry& entry, const std::function<bool(const Parameter&)>& wanted = {});
/// The same with 128 texels a side for a picture of the technique's own, such as a map of 1024, unless its size is among what
/// is set: as good for what the light does to pictures of 96 x 54 pixels, and drawn soon. With 256 or 512, or as it is, where
/// it would support less.
std::string with_small_pictures(const TechniqueEntry& entry, const std::string& settings);

// The rules of each file.
std::vector<Rule> about_rules();
std::vector<Rule> answer_rules();
std::vector<Rule> life_rules();
std::vector<Rule> light_rules();
std::vector<Rule> neighbor_rules();
std::vector<Rule> limit_rules();
std::vector<Rule> memory_rules();
std::vector<Rule> cause_rules();
std::vector<Rule> promise_rules();
std::vector<Rule> scale_rules();

}  // namespace gnomon::conformance
