#pragma once
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace gnomon::site {

/// Names of files for texts that may hold anything: small letters, digits, `_` and `-`, at most 60 of them and one at least.
/// Another text has another name; the same texts in the same order have the same names.
class Slugs {
 public:
  const std::string& of(const std::string& text);

 private:
  std::map<std::string, std::string> names_;
  std::set<std::string> taken_;
};

/// The name without what makes it another than those of other texts.
std::string plain_slug(std::string_view text);

}  // namespace gnomon::site
