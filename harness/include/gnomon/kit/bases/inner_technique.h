#pragma once
#include <gnomon/registry.h>

namespace gnomon {

/// A technique of the registry within another one, built in, of a plugin or a program: the row's value is its id.
///
///   InnerTechnique of{this, "of", "svbsp", Stage::setup, "Whose masks are averaged.", why_not};
///   averaged_hard:of=stencil_volume,of.count=zpass
///
/// `technique()` holds the settings and says what is supported. To run it, make objects of `entry()` with
/// `technique().settings()`. One that remembers frames is refused: who holds it resolves it as often as its own answers need.
class InnerTechnique final : public ObjectParameter {
 public:
  /// Why a technique is not allowed there; empty: it is.
  using WhyNot = std::string (*)(const TechniqueEntry&);
  InnerTechnique(Parametrized* owner, std::string_view name, std::string_view id, Stage spoils, std::string_view sentence,
                 WhyNot why_not)
      : ObjectParameter(owner, name, id, spoils, sentence), why_not_(why_not) {}

  const TechniqueEntry& entry() const { return registry().technique(text()); }
  const Technique& technique() const { return static_cast<const Technique&>(object()); }

 protected:
  std::vector<std::string> ids() const override;
  std::string objection(std::string_view id) const override;
  std::unique_ptr<Parametrized> made(std::string_view id) const override { return registry().technique(id).make(); }

 private:
  std::string why_not(const TechniqueEntry& entry) const;
  WhyNot why_not_;
};

/// Kinds of light that a technique supports: those of its data sheet, or, where that lists none, those supported over a ground.
std::vector<std::string_view> known_lights(const TechniqueEntry& entry);

/// Why a technique has no hard shadow: it answers for lights with area and for no other.
std::string has_no_hard_shadow(const TechniqueEntry& entry);

}  // namespace gnomon
