#include "measure/record/title.h"

#include <fmt/format.h>

#include "measure/record/record.h"

namespace gnomon {

std::string title_of_place(std::string_view scene, std::string_view light, std::string_view view, std::string_view path) {
  std::string title = fmt::format("{} {} ", scene, light);
  if (!view.empty() && view != "view" && view != "-") title += fmt::format("{} ", view);
  if (!path.empty()) title += fmt::format("{} ", path);
  return title;
}

std::string title(const Record& r) { return title_of_place(r.scene, r.light, r.view, r.path) + setting_key(r); }

}  // namespace gnomon
