#include "report/site/slug.h"

#include <fmt/format.h>

namespace gnomon::site {

std::string plain_slug(std::string_view text) {
  constexpr std::size_t most = 60;
  std::string slug;
  for (const char c : text) {
    const bool is_capital = c >= 'A' && c <= 'Z';
    const bool is_kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    if (is_capital || is_kept)
      slug += is_capital ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!slug.empty() && slug.back() != '-')
      slug += '-';
    if (slug.size() == most) break;
  }
  while (slug.ends_with('-')) slug.pop_back();
  return slug.empty() ? "x" : slug;
}

const std::string& Slugs::of(const std::string& text) {
  const auto [found, is_new] = names_.try_emplace(text);
  if (!is_new) return found->second;
  const std::string plain = plain_slug(text);
  std::string name = plain == "index" ? "index-1" : plain;  // index.html lists the others
  for (int k = 2; !taken_.insert(name).second; ++k) name = fmt::format("{}-{}", plain, k);
  return found->second = name;
}

}  // namespace gnomon::site
