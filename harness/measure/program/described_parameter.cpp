#include "measure/program/described_parameter.h"

#include <gnomon/registry.h>

#include <algorithm>

namespace gnomon {

namespace {

/// An object of the registry among the rows, of those that the description allows.
class DescribedObject final : public ObjectParameter {
 public:
  DescribedObject(Parametrized* owner, const DescribedParameter& row, const DescribedParameter::Word& word)
      : ObjectParameter(owner, row.name, word.value, row.stage, row.sentence), ids_(word.choices) {}

 private:
  std::vector<std::string> ids() const override { return ids_; }
  std::string objection(std::string_view id) const override {
    if (std::ranges::find(ids_, id) != ids_.end()) return "";
    return fmt::format("did you mean {}?", nearest_word(id, ids_));
  }
  std::unique_ptr<Parametrized> made(std::string_view id) const override { return registry().technique(id).make(); }

  std::vector<std::string> ids_;
};

std::unique_ptr<Parameter> described_row(const DescribedParameter& row, Parametrized* owner) {
  const auto of_kind = [&](const auto& kind) -> std::unique_ptr<Parameter> {
    using Kind = std::decay_t<decltype(kind)>;
    if constexpr (std::is_same_v<Kind, bool>) {
      return std::make_unique<Flag>(owner, row.name, kind, row.stage, row.sentence);
    } else if constexpr (std::is_same_v<Kind, DescribedParameter::Word>) {
      if (kind.is_object) return std::make_unique<DescribedObject>(owner, row, kind);
      const std::vector<std::string_view> choices(kind.choices.begin(), kind.choices.end());
      return std::make_unique<Choice>(owner, row.name, kind.value, choices, row.stage, row.sentence);
    } else {
      auto range = kind.range;
      range.unit = row.unit;
      return std::make_unique<Number<decltype(kind.value)>>(owner, row.name, kind.value, range, row.stage, row.sentence);
    }
  };
  return std::visit(of_kind, row.kind);
}

}  // namespace

std::string spoilable_stage_names() {
  std::vector<std::string> names;
  for (const Stage stage : spoilable_stages) names.emplace_back(name(stage));
  return joined(names, ", ");
}

void check_spoils(std::string_view parameter, Stage stage) {
  if (std::ranges::find(spoilable_stages, stage) == std::end(spoilable_stages))
    throw Error("parameter {} spoils {}; a parameter spoils one of {}", parameter, name(stage), spoilable_stage_names());
}

std::vector<std::unique_ptr<Parameter>> described_rows(std::span<const DescribedParameter> descriptions, Parametrized* owner) {
  std::vector<std::unique_ptr<Parameter>> rows;
  for (const DescribedParameter& description : descriptions) {
    check_spoils(description.name, description.stage);
    rows.push_back(described_row(description, owner));
  }
  return rows;
}

}  // namespace gnomon
