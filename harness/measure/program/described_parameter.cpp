#include "measure/program/described_parameter.h"

namespace gnomon {

std::unique_ptr<Parameter> made(const DescribedParameter& row, Parametrized* owner) {
  return std::visit(
      [&](const auto& kind) -> std::unique_ptr<Parameter> {
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, DescribedParameter::Whole> || std::is_same_v<Kind, DescribedParameter::Real>) {
          auto range = kind.range;
          range.unit = row.unit;
          return std::make_unique<Number<std::decay_t<decltype(kind.value)>>>(owner, row.name, kind.value, range, row.stage,
                                                                              row.sentence);
        } else if constexpr (std::is_same_v<Kind, DescribedParameter::Word>) {
          const std::vector<std::string_view> choices(kind.choices.begin(), kind.choices.end());
          return std::make_unique<Choice>(owner, row.name, kind.value, choices, row.stage, row.sentence);
        } else {
          return std::make_unique<Flag>(owner, row.name, kind, row.stage, row.sentence);
        }
      },
      row.kind);
}

}  // namespace gnomon
