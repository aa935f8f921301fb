#include "measure/run/worker_words.h"

#include <algorithm>

namespace gnomon {

Json support_json(const Support& support) { return json_object({{"support", name(support.kind())}, {"why", support.why()}}); }

Support support_from(const Json& json) {
  const std::string kind = json.at("support"), why = json.at("why");
  for (const Support& support : {Support::full(), Support::approximate(why), Support::unsupported(why)})
    if (kind == name(support.kind())) return support;
  throw Error("there is no support {}", kind);
}

int stage_named(const std::string& name) {
  const auto* const found = std::ranges::find(stage_names, name);
  if (found == std::end(stage_names)) throw Error("there is no stage {}", name);
  return static_cast<int>(found - stage_names);
}

}  // namespace gnomon
