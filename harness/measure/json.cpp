#include "measure/json.h"

namespace gnomon {

std::string json_text(const Json& json, int indent) { return json.dump(indent, ' ', false, Json::error_handler_t::replace); }

std::string plain_text(const Json& json) { return json.is_string() ? json.get<std::string>() : json_text(json); }

Json parse_json(const std::string& text) { return Json::parse(text); }

Json parse_if_json(std::string_view text) { return Json::parse(text, nullptr, false); }

Json json_object(std::initializer_list<JsonField> fields) {
  Json object = Json::object();
  for (const JsonField& field : fields) object[field.key] = field.value;
  return object;
}

}  // namespace gnomon
