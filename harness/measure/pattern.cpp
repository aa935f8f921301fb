#include "measure/pattern.h"

#include <gnomon/error.h>

#include <regex>

namespace gnomon {

Pattern::Pattern(const std::string& filter, std::string_view complaint) {
  // The parser calls itself for each bracket.
  constexpr std::size_t most = 1000;
  if (filter.size() > most) throw Error("--filter of {} characters is longer than {}", filter.size(), most);
  // Numbers of repetitions are added up without a look at their size.
  constexpr std::size_t most_digits = 6;
  for (std::size_t at = 0; (at = filter.find_first_of("{,\\", at)) != filter.npos; ++at)
    if (filter.substr(at + 1, most_digits + 1).find_first_not_of("0123456789") == filter.npos &&
        filter.size() > at + 1 + most_digits)
      throw Error("--filter {} {}: a number of more than {} digits", filter, complaint, most_digits);
  try {
    // Polynomial: in steps that grow with the text times the expression, where the usual search may double with each letter.
    expression_ = std::make_shared<const std::regex>(filter, std::regex::ECMAScript | std::regex_constants::__polynomial);
  } catch (const std::regex_error& error) {
    throw Error("--filter {} {}: {}", filter, complaint, error.what());
  }
}

bool Pattern::is_in(const std::string& text) const {
  return std::regex_search(text, *static_cast<const std::regex*>(expression_.get()));
}

}  // namespace gnomon
