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

/// Builds a value without the members of one key. The library's callback could leave them out, too, but looks through all that
/// an array holds at the end of each of its elements.
struct Without {
  using Text = Json::string_t;

  Json root;

  explicit Without(std::string_view key) : unwanted_(key) {}
  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(Json::number_integer_t value) { return put(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return put(value); }
  bool number_float(Json::number_float_t value, const Text&) { return put(value); }
  bool string(Text& value) { return put(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }
  bool start_object(std::size_t) { return start(Json::value_t::object); }
  bool start_array(std::size_t) { return start(Json::value_t::array); }
  bool end_object() { return end(); }
  bool end_array() { return end(); }
  bool key(Text& name) {
    if (left_out_ == 0) member_ = name == unwanted_ ? nullptr : &(*open_.back())[name];
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) { return false; }

 private:
  /// Where the next value goes; null where it is left out.
  Json* place() {
    if (left_out_ > 0) return nullptr;
    if (open_.empty()) return &root;
    return open_.back()->is_array() ? &open_.back()->emplace_back() : member_;
  }
  template <class Value>
  bool put(Value&& value) {
    if (Json* const at = place()) *at = std::forward<Value>(value);
    return true;
  }
  bool start(Json::value_t type) {
    if (Json* const at = place())
      open_.push_back(&(*at = Json(type)));
    else
      ++left_out_;
    return true;
  }
  bool end() {
    if (left_out_ > 0)
      --left_out_;
    else
      open_.pop_back();
    return true;
  }

  std::string_view unwanted_;
  std::vector<Json*> open_;
  Json* member_ = nullptr;    ///< of the object that is open
  std::size_t left_out_ = 0;  ///< brackets that are open within what is left out
};

}  // namespace

Json parse_json(const std::string& text) {
  if (is_too_deep(text)) throw Json::other_error::create(500, fmt::format("brackets nest deeper than {}", most_depth), nullptr);
  return Json::parse(text);
}

Json parse_json(const std::string& text, std::string_view unwanted_key) {
  if (is_too_deep(text)) return parse_json(text);  // which refuses it
  Without builder(unwanted_key);
  return Json::sax_parse(text, &builder) ? std::move(builder.root) : Json::parse(text);  // which says what is wrong
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
