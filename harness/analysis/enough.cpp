#include "analysis/enough.h"

#include <algorithm>

#include "analysis/in_order.h"

namespace gnomon {

std::vector<Enough> find_enough(const Field& field, std::span<const double> budgets, std::string_view direction) {
  const std::vector<Candidate>& all = field.candidates;
  std::vector<std::string> techniques;
  for (const Candidate& one : all)
    if (one.role != Role::baseline) add_once(techniques, one.technique);
  std::vector<Enough> found;
  for (const double budget : budgets) {
    std::vector<Enough> here;
    for (const std::string& technique : techniques) {
      Enough enough{.technique = technique, .budget = budget, .setting = {}};
      std::optional<std::size_t> least;
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].technique != technique || all[i].role == Role::baseline) continue;
        if (!least || is_better(direction, all[i].error, all[*least].error)) least = i;
        const bool is_enough =
            all[i].cost && all[i].gain_over_constant.value_or(1) > 0 && !is_better(direction, budget, all[i].error);
        if (is_enough && (!enough.setting || all[i].cost->value < all[*enough.setting].cost->value)) enough.setting = i;
      }
      enough.least = *least;
      here.push_back(std::move(enough));
    }
    const auto order = [&](const Enough& one) {
      if (one.setting) return std::pair(0, all[*one.setting].cost->value);
      return std::pair(1, direction == "higher" ? -all[one.least].error : all[one.least].error);
    };
    std::ranges::stable_sort(here, {}, order);
    found.insert(found.end(), here.begin(), here.end());
  }
  return found;
}

}  // namespace gnomon
