#pragma once
#include <gnomon/registry.h>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What every technique must do, wherever it lives: `gnomon check` and the conformance tests check the same rules.
namespace gnomon::conformance {

/// Where a technique was checked; empty where it does not matter.
struct Place {
  std::string scene;     ///< "box_city:count=12"
  std::string light;     ///< "sun (directional)"
  std::string settings;  ///< "resolution=64"
};

/// A pixel, counted from the upper left, and the size of its picture.
struct PlacedPixel {
  int x = 0, y = 0, width = 0, height = 0;
};

/// One violation of a rule.
struct Finding {
  std::string what;  ///< "resolve again: 12 pixels differ, the first is 0.5 and 1"
  Place place = {};
  std::optional<PlacedPixel> pixel = {};  ///< the first that it is about
};

/// "in box_city:count=12, light sun (directional), with resolution=64, pixel 12, 5 of 96 x 54"; "" for nowhere.
std::string place_text(const Finding& finding);

/// The result of a rule for a technique.
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

/// The techniques to which a rule applies, by their data sheets.
enum class AppliesTo { all, drawing, exact, sampled, remembering, not_remembering };
/// "techniques that draw with OpenGL", which `drawing` means.
std::string_view name(AppliesTo applies_to);

/// How much of a rule runs under the sanitizers (tests/conformance). Rules that compare answers with the truth run no code of a
/// technique that the others do not run, and drivers are not instrumented.
enum class Sanitized { whole, part, nothing };
/// Whether this program was built with the address sanitizer, which also multiplies memory.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

class Trial;

/// Which techniques a rule applies to, and how it is checked.
struct RuleTerms {
  AppliesTo applies_to = AppliesTo::all;
  bool has_context = true;  ///< false: techniques that draw are checked without OpenGL, too, as the harness queries them
  /// Masks are compared with each other alone: pictures of the technique's own, such as a map, may be small.
  bool has_small_pictures = false;
  Sanitized sanitized = Sanitized::whole;
};

struct Rule : RuleTerms {
  Rule(std::string_view id, void (*function)(Trial&), const RuleTerms& terms, std::string_view must, std::string_view mend,
       std::string_view mend_program = "")
      : RuleTerms(terms), name(id), check(function), sentence(must), advice(mend), program_advice(mend_program) {}

  std::string_view name;
  void (*check)(Trial&);
  std::string_view sentence;        ///< what a technique must do
  std::string_view advice;          ///< what its author does when it does not
  std::string_view program_advice;  ///< what the author of a program does instead (docs/protocol.md); empty: the same
};

/// All rules, the quick ones about words first.
std::span<const Rule> rules();
/// Throws Error with the nearest name and the list.
const Rule& rule(std::string_view name);
/// Why a rule does not apply to a technique of such a data sheet; "" when it does.
std::string_view why_not_applied(const Rule& rule, const About& about);
/// What the author of this technique does when it does not keep the rule: in C++, or in a program.
std::string_view advice_for(const Rule& rule, const TechniqueEntry& entry);

/// Checks one rule of one technique, here in this process, which a technique may take down. An exception of the technique is a
/// finding. `moves` is called with each place before the technique is checked there. Throws Error where the rule's scenes are
/// missing.
Verdict judge(const Rule& rule, const TechniqueEntry& entry, const std::function<void(const Place&)>& moves = {});

}  // namespace gnomon::conformance
