#include "report/listing.h"

#include "measure/program/description.h"
#include "report/pages.h"
#include "report/table/text_table.h"

namespace gnomon {

namespace {

Json about_json(const TechniqueEntry& entry) {
  const About& about = entry.about;
  Json json = {{"id", entry.id},
               {"title", about.title},
               {"role", name(about.role)},
               {"promise", name(about.promise)},
               {"sees", name(about.sees)},
               {"handles", handled(about)},
               {"device", name(about.device)},
               {"remembers", about.remembers},
               {"summary", about.summary},
               {"named_only", about.named_only}};
  if (const auto stages = described_stages(entry); !stages.empty()) json["stages"] = stages;
  return json;
}

std::string hex(const std::array<std::uint8_t, 3>& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

/// Choices and flags give no unit; a metric without one is a share of 1.
std::string unit_of(const MetricInfo& metric) { return metric.unit.empty() ? "share" : std::string(metric.unit); }

}  // namespace

std::vector<std::string> handled(const About& about) {
  std::vector<std::string> names;
  for (const Feature feature : about.handles) names.emplace_back(name(feature));
  return names;
}

std::string list_text(std::span<const TechniqueEntry> entries, std::size_t width) {
  TextTable table({{"id", ""},
                   {"title", ""},
                   {"role", "", Align::left, 1},
                   {"promise", "", Align::left, 2},
                   {"sees", "", Align::left, 3},
                   {"summary", ""}});
  for (const TechniqueEntry& entry : entries) {
    const About& about = entry.about;
    table.add_row({entry.id, std::string(about.title), std::string(name(about.role)), std::string(name(about.promise)),
                   std::string(name(about.sees)), std::string(about.summary)});
  }
  return table.text(width);
}

Json list_json(std::span<const TechniqueEntry> entries) {
  Json list = Json::array();
  for (const TechniqueEntry& entry : entries) list.push_back(about_json(entry));
  return list;
}

std::string list_text(std::span<const MetricInfo> metrics, std::size_t width) {
  TextTable table({{"metric", ""}, {"unit", ""}, {"better", "", Align::left, 1}, {"meaning", ""}});
  for (const MetricInfo& metric : metrics)
    table.add_row({std::string(metric.name), unit_of(metric), metric.better.empty() ? "-" : std::string(metric.better),
                   std::string(metric.sentence)});
  return table.text(width);
}

Json list_json(std::span<const MetricInfo> metrics) {
  Json list = Json::array();
  for (const MetricInfo& metric : metrics)
    list.push_back({{"name", metric.name},
                    {"unit", metric.unit},
                    {"better", metric.better},
                    {"version", metric.version},
                    {"sentence", metric.sentence}});
  return list;
}

std::string list_text(std::span<const CauseInfo> causes, std::span<const TechniqueEntry> entries, std::size_t width) {
  TextTable table({{"cause", ""}, {"of", ""}, {"meaning", ""}});
  for (const CauseInfo& cause : causes) table.add_row({std::string(cause.name), "all", std::string(cause.sentence)});
  for (const TechniqueEntry& entry : entries)
    for (const OwnCause& cause : entry.about.causes)
      table.add_row({std::string(cause.id), entry.id, std::string(cause.sentence)});
  return table.text(width);
}

Json list_json(std::span<const CauseInfo> causes, std::span<const TechniqueEntry> entries) {
  Json list = Json::array();
  for (const CauseInfo& cause : causes)
    list.push_back({{"name", cause.name}, {"sentence", cause.sentence}, {"color", hex(cause.color)}, {"technique", nullptr}});
  for (const TechniqueEntry& entry : entries)
    for (const OwnCause& cause : entry.about.causes)
      list.push_back({{"name", cause.id}, {"sentence", cause.sentence}, {"color", hex(cause.color)}, {"technique", entry.id}});
  return list;
}

std::string parameters_text(const Parametrized& object, std::size_t width) {
  if (object.parameters().empty()) return "no parameters\n";
  TextTable table({{"parameter", ""}, {"default", ""}, {"range", ""}, {"spoils", "", Align::left, 1}, {"meaning", ""}});
  for (const Parameter* parameter : object.parameters())
    table.add_row({std::string(parameter->name()), parameter->default_text(), parameter->allowed(),
                   std::string(name(parameter->spoils())), std::string(parameter->sentence())});
  return table.text(width);
}

Json parameters_json(const Parametrized& object) {
  Json list = Json::array();
  for (const Parameter* parameter : object.parameters())
    list.push_back({{"name", parameter->name()},
                    {"default", parameter->default_text()},
                    {"allowed", parameter->allowed()},
                    {"unit", parameter->unit()},
                    {"spoils", name(parameter->spoils())},
                    {"sentence", parameter->sentence()}});
  return list;
}

std::string describe_text(const TechniqueEntry& entry, std::size_t width, std::string_view settings) {
  const About& about = entry.about;
  TextTable facts({{entry.id, ""}, {std::string(about.title), ""}});
  const auto add = [&facts](std::string_view topic, std::string_view text) {
    facts.add_row({std::string(topic), text.empty() ? "-" : std::string(text)});
  };
  if (!entry.broken.empty()) add("broken", fmt::format("it {}", entry.broken));
  add("summary", about.summary);
  add("source", about.source);
  add("error", about.error);
  add("fails", about.fails);
  add("promise", name(about.promise));
  add("sees", name(about.sees));
  add("handles", joined(handled(about), ", "));
  if (about.remembers) add("remembers frames", "yes: a mask depends on the pictures before it");
  if (const auto stages = described_stages(entry); !stages.empty()) add("stages", joined(stages, ", "));
  add("role", name(about.role));
  add("device", name(about.device));
  if (about.floor != Floor::none) add("bare pass", name(about.floor));
  const auto technique = entry.make();
  technique->apply(settings);
  add("surface detail", technique->surface_detail() ? "yes: render --detail FILE.obj writes it" : "no");
  std::string text = facts.text(width) + '\n' + parameters_text(*technique, width);
  if (const std::vector<DebugLayer> layers = technique->debug_layers(); !layers.empty()) {
    TextTable table({{"debug layer", ""}, {"what it shows", ""}});
    for (const DebugLayer& layer : layers) table.add_row({layer.name, layer.sentence});
    text += '\n' + table.text(width);
  }
  if (!about.causes.empty()) {
    TextTable table({{"own cause", ""}, {"meaning", ""}});
    for (const OwnCause& cause : about.causes) table.add_row({std::string(cause.id), std::string(cause.sentence)});
    text += '\n' + table.text(width);
  }
  return text;
}

Json describe_json(const TechniqueEntry& entry, std::string_view settings) {
  Json json = about_json(entry);
  json["source"] = entry.about.source;
  json["error"] = entry.about.error;
  json["fails"] = entry.about.fails;
  const auto technique = entry.make();
  technique->apply(settings);
  json["parameters"] = parameters_json(*technique);
  json["surface_detail"] = technique->surface_detail().has_value();
  json["debug_layers"] = Json::array();
  for (const DebugLayer& layer : technique->debug_layers())
    json["debug_layers"].push_back({{"name", layer.name}, {"sentence", layer.sentence}});
  json["causes"] = Json::array();
  for (const OwnCause& cause : entry.about.causes)
    json["causes"].push_back({{"name", cause.id}, {"sentence", cause.sentence}, {"color", hex(cause.color)}});
  return json;
}

}  // namespace gnomon
