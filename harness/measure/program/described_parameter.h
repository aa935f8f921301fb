#pragma once
#include <gnomon/param.h>

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

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

/// The rows, whose descriptions outlive them. Throws Error on a default that is not allowed.
std::vector<std::unique_ptr<Parameter>> described_rows(std::span<const DescribedParameter> descriptions, Parametrized* owner);

}  // namespace gnomon
