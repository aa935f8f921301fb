#include "measure/counted.h"

#include <fmt/format.h>

namespace gnomon {

std::string counted(std::size_t count, std::string_view words) {
  std::string text = fmt::format("{} ", count);
  for (std::size_t open = words.find('{'); open != words.npos; open = words.find('{')) {
    const std::size_t close = words.find('}', open);
    const std::string_view choice = words.substr(open + 1, close - open - 1);
    const std::size_t bar = choice.find('|');
    text += words.substr(0, open);
    if (count != 1)
      text += bar == choice.npos ? choice : choice.substr(bar + 1);
    else if (bar != choice.npos)
      text += choice.substr(0, bar);
    words.remove_prefix(close + 1);
  }
  return text.append(words);
}

}  // namespace gnomon
