#pragma once
// JSON for all files. nlohmann/json.hpp is included here alone, without its literals: they make each file that includes it
// compile the whole parser, 0.4 s of processor time, whether it uses them or not.
#include <initializer_list>
#include <string>
#include <string_view>

// The name of the literal operator becomes a declaration, and its body that of a template which nobody calls.
#define _json                                 \
  _unused(const char*, std::size_t) = delete; \
  template <class>                            \
  nlohmann::json unused_literal
#define JSON_USE_GLOBAL_UDLS 0
#include <nlohmann/json.hpp>
#undef _json

namespace gnomon {

/// Keeps its keys in the order in which they were added.
using Json = nlohmann::ordered_json;
/// As text: on one line, or indented by that many spaces. Bytes that are no UTF-8 are replaced.
std::string json_text(const Json& json, int indent = -1);
/// A text as it is, without quotes; anything else as json_text.
std::string plain_text(const Json& json);
/// Throws Json::exception, also where brackets nest deeper than any of ours do: values are copied value within value.
Json parse_json(const std::string& text);
/// The same without the members of this key, at any depth.
Json parse_json(const std::string& text, std::string_view unwanted_key);
/// The same, but what is no JSON is discarded: see Json::is_discarded.
Json parse_if_json(std::string_view text);

/// The problem in words, without the library's own numbers.
std::string complaint(const Json::exception& problem);

struct JsonField {
  const char* key;
  Json value;
};
/// An object of these fields in their order. Json{{"key", value}} is the same, but compiled anew for each length of a key, and
/// Json::object() as the default of a member in each file that includes the header.
Json json_object(std::initializer_list<JsonField> fields = {});

}  // namespace gnomon
