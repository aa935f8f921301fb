#include "measure/scene/import_foreign.h"

#include <charconv>
#include <cmath>
#include <fstream>

namespace gnomon::importing {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& file, std::size_t offset, std::size_t size) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  std::string bytes(std::min(size, fs::file_size(file)), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return bytes;
}

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4 && offset + i < bytes.size(); ++i)
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return word;
}

void need_length(const fs::path& file, std::uint64_t declared) {
  if (fs::file_size(file) < declared)
    throw Error("{}: is {} bytes long but declares {}; it is truncated", file.string(), fs::file_size(file), declared);
}

void need_vertex(const std::string& where, std::size_t face, double index, std::size_t vertex_count) {
  if (!(index >= 0 && index < static_cast<double>(vertex_count) && index == std::floor(index)))
    throw Error("{}: face {} names vertex {:.16g}, out of range: allowed are 0 .. {}", where, face, index,
                static_cast<std::int64_t>(vertex_count) - 1);
}

void need_corners(const std::string& where, std::size_t face, double count) {
  if (!(count >= 0 && count <= most_corners))
    throw Error("{}: face {} has {:.16g} corners; at most {} are taken", where, face, count, most_corners);
}

bool BodyLines::next(std::string& line) {
  do {
    if (!std::getline(in_, line)) return false;
    ++number_;
    line.resize(std::min(line.find('#'), line.size()));
  } while (line.find_first_not_of(" \t\r") == std::string::npos);
  return true;
}

void BodyLines::begin(std::string_view element, std::size_t place, std::size_t count) {
  if (!next(line_)) throw Error("{}: holds {} of {} {} lines; it is truncated", file_.string(), place, count, element);
  element_ = element;
  place_ = place;
  at_ = words_ = 0;
}

std::string BodyLines::where() const { return fmt::format("{}:{}", file_.string(), number_); }

std::string_view BodyLines::word() {
  constexpr std::string_view blanks = " \t\r\v\f";
  const std::size_t begin = line_.find_first_not_of(blanks, at_);
  if (begin == std::string::npos)
    throw Error("{}: {} {} ends after {} numbers; it is truncated", where(), element_, place_, words_);
  at_ = std::min(line_.find_first_of(blanks, begin), line_.size());
  ++words_;
  return std::string_view(line_).substr(begin, at_ - begin);
}

double BodyLines::number() {
  std::string_view text = word();
  const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code != std::errc{} || end != digits.data() + digits.size())
    throw Error("{}: '{}' of {} {} is not a number", where(), text, element_, place_);
  return value;
}

void BodyLines::face(std::size_t place, std::size_t vertex_count) {
  const double count = number();
  need_corners(where(), place, count);
  for (double c = 0; c < count; ++c) need_vertex(where(), place, number(), vertex_count);
}

}  // namespace gnomon::importing
