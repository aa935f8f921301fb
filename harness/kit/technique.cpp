#include <gnomon/technique.h>

namespace gnomon {

std::string_view name(Support::Kind kind) {
  static constexpr std::string_view names[] = {"full", "approximate", "unsupported"};
  return names[static_cast<int>(kind)];
}

std::optional<Explanation> Technique::explain(std::size_t) const { return std::nullopt; }

std::vector<float> Technique::draw_debug(std::string_view layer) const {
  std::vector<std::string> layers;
  for (const DebugLayer& known : debug_layers()) layers.push_back(known.name);
  if (layers.empty()) throw Error("{} has no debug layer {}; it has none at all", id(), layer);
  throw Error("{} has no debug layer {}; it has: {}", id(), layer, joined(layers, ", "));
}

}  // namespace gnomon
