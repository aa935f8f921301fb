#include "measure/json.h"

#include <fmt/format.h>

namespace gnomon {

std::string json_text(const Json& json, int indent) { return json.dump(indent, ' ', false, Json::error_handler_t::replace); }

std::string plain_text(const Json& json) { return json.is_string() ? json.get<std::string>() : json_text(json); }

namespace {

constexpr std::size_t most_depth = 200;

bool is_too_deep(std::string_view text) {
  std::size_t depth = 0;
  bool is_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_text && c == '\\')
      ++i;
    else if (c == '"')
      is_text = !is_text;
    else if (!is_text && (c == '[' || c == '{') && ++depth > most_depth)
      return true;
    else if (!is_text && (c == ']' || c == '}') && depth > 0)
      --depth;
  }
  return false;
}

}  // namespace

Json parse_json(const std::string& text) {
  if (is_too_deep(text)) throw Json::other_error::create(500, fmt::format("brackets nest deeper than {}", most_depth), nullptr);
  return Json::parse(text);
}

Json parse_json(const std::string& text, std::string_view unwanted_key) {
  if (is_too_deep(text)) return parse_json(text);  // which refuses it
  return Json::parse(text, [&](int, Json::parse_event_t event, Json& value) {
    return event != Json::parse_event_t::key || value.get_ref<const std::string&>() != unwanted_key;
  });
}

Json parse_if_json(std::string_view text) {
  return is_too_deep(text) ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
}

std::string complaint(const Json::exception& problem) {
  const std::string text = problem.what();
  const std::size_t end = text.find("] ");
  return text.starts_with("[json.exception") && end != std::string::npos ? text.substr(end + 2) : text;
}

Json json_object(std::initializer_list<JsonField> fields) {
  Json object = Json::object();
  for (const JsonField& field : fields) object[field.key] = field.value;
  return object;
}

}  // namespace gnomon
