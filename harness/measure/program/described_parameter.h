#pragma once
#include <gnomon/param.h>

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

/// A parameter row by its description instead of a member of a class.
struct DescribedParameter {
  struct Whole {
    int value;
    Range<int> range;
  };
  struct Real {
    double value;
    Range<double> range;
  };
  struct Word {
    std::string value;
    std::vector<std::string> choices;
  };
  std::string name, unit, sentence;
  Stage stage = Stage::resolve;
  std::variant<Whole, Real, Word, bool> kind;
};

/// The row, whose description outlives it. Throws Error on a default that is not allowed.
std::unique_ptr<Parameter> made(const DescribedParameter& row, Parametrized* owner);

}  // namespace gnomon
