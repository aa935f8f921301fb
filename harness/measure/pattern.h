#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace gnomon {

/// The regular expression of an option --filter. std::regex costs every file that includes it two seconds of compilation.
class Pattern {
 public:
  /// Throws Error "--filter TEXT COMPLAINT: why" where the text is no regular expression.
  Pattern(const std::string& filter, std::string_view complaint);
  /// Whether it matches a part of the text.
  bool is_in(const std::string& text) const;

 private:
  std::shared_ptr<const void> expression_;
};

}  // namespace gnomon
