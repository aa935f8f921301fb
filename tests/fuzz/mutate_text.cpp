// Mutants of texts: words, numbers, texts in quotes and lines are moved, repeated, dropped and replaced.
#include <algorithm>
#include <cctype>

#include "fuzz.h"

namespace fuzz {
namespace {

constexpr std::size_t most_bytes = 1 << 16;

const std::vector<std::string> numbers = {"0",
                                          "-0",
                                          "1",
                                          "-1",
                                          "2",
                                          "3",
                                          "127",
                                          "128",
                                          "255",
                                          "256",
                                          "-128",
                                          "32767",
                                          "32768",
                                          "65535",
                                          "65536",
                                          "60000",
                                          "2147483647",
                                          "2147483648",
                                          "-2147483648",
                                          "-2147483649",
                                          "4294967295",
                                          "4294967296",
                                          "9007199254740993",
                                          "9223372036854775807",
                                          "9223372036854775808",
                                          "-9223372036854775808",
                                          "-9223372036854775809",
                                          "18446744073709551615",
                                          "18446744073709551616",
                                          "99999999999999999999999",
                                          "0.1",
                                          "-0.5",
                                          "1e-45",
                                          "1e-320",
                                          "1e-18",
                                          "1e17",
                                          "-1e17",
                                          "1.0001e17",
                                          "2e18",
                                          "1e30",
                                          "1e38",
                                          "3.5e38",
                                          "1e300",
                                          "1e307",
                                          "1.7976931348623157e308",
                                          "1e309",
                                          "-1e309",
                                          "nan",
                                          "inf",
                                          "-inf",
                                          "NaN",
                                          "0x7fffffff",
                                          "1_000",
                                          "+1",
                                          "1e",
                                          "1.",
                                          ".5",
                                          "00",
                                          "1e999999999"};

const std::vector<std::string> pieces = {"[",
                                         "]",
                                         "[[",
                                         "]]",
                                         "{",
                                         "}",
                                         "{a,b}",
                                         "{{",
                                         "}}",
                                         ",",
                                         ":",
                                         "=",
                                         ".",
                                         "..",
                                         "/",
                                         "../",
                                         "\"",
                                         "'",
                                         "\"\"\"",
                                         "'''",
                                         "\\",
                                         "\n",
                                         "\r\n",
                                         "\t",
                                         " ",
                                         "#",
                                         "*",
                                         "(",
                                         ")",
                                         "(.*)*",
                                         "[^",
                                         "|",
                                         "$",
                                         "\\u0000",
                                         "\\ud800",
                                         std::string(1, '\0'),
                                         "\x1b[31m",
                                         "\x7f",
                                         "\xff",
                                         "\xc3\x28",
                                         "\xef\xbb\xbf",
                                         "true",
                                         "false",
                                         "null",
                                         "none",
                                         "-",
                                         "--",
                                         "%s%n",
                                         "${HOME}",
                                         "`id`",
                                         "<script>",
                                         "&",
                                         "1979-05-27T07:32:00Z",
                                         "inf",
                                         "-nan"};

/// Words, numbers, texts in quotes, blanks and signs, one behind the other.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> tokens;
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '-' || c == '+';
  };
  for (std::size_t at = 0, end = 0; at < text.size(); at = end) {
    end = at + 1;
    if (is_word(text[at])) {
      while (end < text.size() && is_word(text[end])) ++end;
    } else if (text[at] == '"') {
      const std::size_t close = text.find_first_of("\"\n", end);
      if (close != text.npos && text[close] == '"') end = close + 1;
    } else if (text[at] == ' ' || text[at] == '\n') {
      while (end < text.size() && text[end] == text[at]) ++end;
    }
    tokens.push_back(text.substr(at, end - at));
  }
  return tokens;
}

bool is_number(const std::string& token) {
  return std::isdigit(static_cast<unsigned char>(token[0])) ||
         (token.size() > 1 && std::isdigit(static_cast<unsigned char>(token[1])));
}

std::string joined(const std::vector<std::string>& tokens) {
  std::string text;
  for (const std::string& token : tokens) text += token;
  return text;
}

/// Begin and end of a line that is drawn.
std::pair<std::size_t, std::size_t> any_line(Random& random, const std::string& text) {
  if (text.empty()) return {0, 0};
  const std::size_t at = random.below(text.size()), before = at == 0 ? text.npos : text.rfind('\n', at - 1);
  const std::size_t end = text.find('\n', at);
  return {before == text.npos ? 0 : before + 1, end == text.npos ? text.size() : end + 1};
}

/// 1, mostly, but now and then thousands.
std::size_t repetitions(Random& random, std::size_t size) {
  const std::size_t count = random.chance(0.9) ? 1 + random.below(4) : std::size_t{1} << random.below(14);
  return std::min(count, 1 + most_bytes / (size + 1));
}

void mutate_lines(Random& random, std::string& text, const std::string& other) {
  const auto [begin, end] = any_line(random, text);
  const std::string line = text.substr(begin, end - begin);
  switch (random.below(5)) {
    case 0:
      text.erase(begin, end - begin);
      break;
    case 1:
      for (std::size_t k = repetitions(random, line.size()); k > 0; --k) text.insert(begin, line);
      break;
    case 2: {
      text.erase(begin, end - begin);
      text.insert(any_line(random, text).first, line);
      break;
    }
    case 3: {
      const auto [from, to] = any_line(random, other);
      text.insert(begin, other.substr(from, to - from));
      break;
    }
    default:
      text.resize(begin + random.below(line.size() + 1));
  }
}

void mutate_tokens(Random& random, std::string& text, const std::string& other) {
  std::vector<std::string> tokens = split(text);
  if (tokens.empty()) return;
  // Blanks are drawn less often than what they part.
  std::size_t at = random.below(tokens.size());
  for (int again = 0; again < 2 && (tokens[at][0] == ' ' || tokens[at][0] == '\n'); ++again) at = random.below(tokens.size());
  const auto place = tokens.begin() + static_cast<std::ptrdiff_t>(at);
  switch (random.below(8)) {
    case 0:
      tokens.erase(place);
      break;
    case 1:
      tokens.insert(place, repetitions(random, tokens[at].size()), std::string(tokens[at]));
      break;
    case 2:
      std::swap(tokens[at], random.pick(tokens));
      break;
    case 3: {
      const std::vector<std::string> others = split(other);
      if (!others.empty()) tokens[at] = random.pick(others);
      break;
    }
    case 4:
      tokens.insert(place, random.pick(pieces));
      break;
    case 5: {
      const std::string piece = random.pick(pieces);
      std::string many;
      for (std::size_t k = repetitions(random, piece.size()); k > 0; --k) many += piece;
      tokens[at] = random.chance(0.5) ? many : many + tokens[at];
      break;
    }
    case 6:
      tokens[at].insert(random.below(tokens[at].size() + 1), 1, static_cast<char>(random.below(256)));
      break;
    default:
      tokens[at] = tokens[random.below(tokens.size())];
  }
  text = joined(tokens);
}

void mutate_numbers(Random& random, std::string& text) {
  std::vector<std::string> tokens = split(text);
  std::vector<std::string*> found;
  for (std::string& token : tokens)
    if (is_number(token)) found.push_back(&token);
  if (!found.empty()) *random.pick(found) = random.pick(numbers);
  text = joined(tokens);
}

}  // namespace

std::string mutate_text(Random& random, const std::string& seed, const std::string& other) {
  std::string text = seed;
  do {
    const std::size_t which = random.below(10);
    if (which < 4)
      mutate_numbers(random, text);
    else if (which < 8)
      mutate_tokens(random, text, other);
    else
      mutate_lines(random, text, other);
  } while (random.chance(0.4) && text.size() < most_bytes);
  return text;
}

}  // namespace fuzz
