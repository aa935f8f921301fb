// How the window calls the two sides, so that they can be told apart.
#include "app/viewer/side_names.h"

#include <algorithm>

namespace gnomon::viewer {

std::string told_settings(const Parametrized& side, const Parametrized& other) {
  std::string told;
  const bool is_same = side.id() == other.id();
  const std::vector<Parameter*> others = is_same ? other.parameters() : std::vector<Parameter*>();
  for (const Parameter* const row : side.parameters()) {
    const auto there = std::ranges::find(others, row->name(), [](const Parameter* p) { return p->name(); });
    // A row of another inner object is not there at all.
    const bool differs = is_same && (there == others.end() || (*there)->text() != row->text());
    if (!differs && row->text() == row->default_text()) continue;
    told += fmt::format("{}{}={}", told.empty() ? "" : ", ", row->name(), row->text());
  }
  return told;
}

std::string technique_title(const Session& session, int side) {
  return std::string(registry().technique(session.technique(side).id()).about.title);
}

std::string title_of(const Session& session, int side) {
  const std::string settings = told_settings(session.technique(side), session.technique(1 - side));
  return technique_title(session, side) + (settings.empty() ? "" : ", " + settings);
}

}  // namespace gnomon::viewer
