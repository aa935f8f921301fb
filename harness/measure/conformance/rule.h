#pragma once
#include <gnomon/registry.h>

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What every technique must do, wherever it lives: `gnomon check` and the conformance tests ask the same rules.
namespace gnomon::conformance {

/// Where a technique was asked; empty where it does not matter.
struct Place {
  std::string scene;     ///< "box_city:count=12"
  std::string light;     ///< "sun (directional)"
  std::string settings;  ///< "resolution=64"
};

/// A pixel, counted from the upper left, and the size of its picture.
struct PlacedPixel {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Something that does not hold.
struct Finding {
  std::string what;  ///< "resolve again: 12 pixels differ, the first is 0.5 and 1"
  Place place = {};
  std::optional<PlacedPixel> pixel = {};  ///< the first that it is about
};

/// "in box_city:count=12, light sun (directional), with resolution=64, pixel 12, 5 of 96 x 54"; "" for nowhere.
std::string place_text(const Finding& finding);

/// What a rule says of a technique.
struct Verdict {
  enum class Kind { holds, does_not_apply, fails };
  Kind kind = Kind::holds;
  std::string why = {};                ///< it does not apply
  std::vector<Finding> findings = {};  ///< where it fails, the first `most_findings`
  std::size_t finding_count = 0;
};
inline constexpr std::size_t most_findings = 40;
/// "holds", "does not apply", "fails".
std::string_view name(Verdict::Kind kind);

/// The techniques that a rule is for, by their data sheets.
enum class AppliesTo { all, drawing, exact, sampled };
/// "techniques that draw".
std::string_view name(AppliesTo applies_to);

/// How much of a rule the sanitizers see (tests/conformance). What judges answers against the truth runs no code of a technique
/// that others do not run, and drivers are not instrumented.
enum class Sanitized { whole, part, nothing };
/// Whether this program was built with the address sanitizer, which also multiplies memory.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

class Trial;

struct Rule {
  std::string_view name;
  std::string_view sentence;  ///< what a technique must do
  std::string_view advice;    ///< what its author does when it does not
  void (*check)(Trial&);
  AppliesTo applies_to = AppliesTo::all;
  bool has_context = true;  ///< false: those that draw are asked without OpenGL, too, as the harness asks
  /// Masks are compared with each other alone: pictures of the technique's own, such as a map, may be small.
  bool has_small_pictures = false;
  Sanitized sanitized = Sanitized::whole;
};

/// All rules, the quick ones about words first.
std::span<const Rule> rules();
/// Throws Error with the nearest name and the list.
const Rule& rule(std::string_view name);
/// Why a rule does not apply to a technique of such a data sheet; "" when it does.
std::string_view why_not_applied(const Rule& rule, const About& about);

/// Asks one technique one rule, here in this process, which a technique may take down. An exception of the technique is a
/// finding. `moves` hears where it is asked, before it is. Throws Error where the rule's scenes are missing.
Verdict judge(const Rule& rule, const TechniqueEntry& entry, const std::function<void(const Place&)>& moves = {});

}  // namespace gnomon::conformance
