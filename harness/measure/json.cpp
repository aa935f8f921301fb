#include "measure/json.h"

namespace gnomon {

std::string json_text(const Json& json, int indent) { return json.dump(indent, ' ', false, Json::error_handler_t::replace); }

std::string plain_text(const Json& json) { return json.is_string() ? json.get<std::string>() : json_text(json); }

Json parse_json(const std::string& text) { return Json::parse(text); }

Json empty_object() { return Json::object(); }

}  // namespace gnomon
