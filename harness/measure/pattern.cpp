#include "measure/pattern.h"

#include <gnomon/error.h>

#include <regex>

namespace gnomon {

Pattern::Pattern(const std::string& filter, std::string_view complaint) {
  try {
    expression_ = std::make_shared<const std::regex>(filter);
  } catch (const std::regex_error& error) {
    throw Error("--filter {} {}: {}", filter, complaint, error.what());
  }
}

bool Pattern::is_in(const std::string& text) const {
  return std::regex_search(text, *static_cast<const std::regex*>(expression_.get()));
}

}  // namespace gnomon
