#pragma once
#include <gnomon/param.h>

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

/// The stages that a parameter may spoil. Update is none of them: it follows what moves, and no still row has it.
inline constexpr Stage spoilable_stages[] = {Stage::setup, Stage::build, Stage::relight, Stage::resolve};
/// "setup, build, relight, resolve", for messages.
std::string spoilable_stage_names();
/// Throws Error where a parameter spoils another stage.
void check_spoils(std::string_view parameter, Stage stage);

/// A parameter row by its description instead of a member of a class.
struct DescribedParameter {
  template <class Value>
  struct Ranged {
    Value value;
    Range<Value> range;
  };
  using Whole = Ranged<int>;
  using Real = Ranged<double>;
  struct Word {
    std::string value;
    std::vector<std::string> choices;
    bool is_object = false;  ///< the choices are ids of techniques, whose rows follow
  };
  std::string name, unit, sentence;
  Stage stage = Stage::resolve;
  std::variant<Whole, Real, Word, bool> kind;
};

/// The rows, whose descriptions outlive them. Throws Error on a default and on a stage that is not allowed.
std::vector<std::unique_ptr<Parameter>> described_rows(std::span<const DescribedParameter> descriptions, Parametrized* owner);

}  // namespace gnomon
