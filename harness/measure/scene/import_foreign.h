#pragma once
// Private to the importer: what its readers of foreign formats share. Importers fill what is missing with what they read last,
// and mend indices in silence, so both are looked for in the file itself.
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>

#include "measure/scene/import.h"

namespace gnomon::importing {

std::string read_bytes(const std::filesystem::path& file, std::size_t offset, std::size_t size);
/// Little-endian 32 bits at `offset`; 0 beyond the end.
std::uint32_t word_at(std::string_view bytes, std::size_t offset);
/// Throws Error when the file is shorter.
void need_length(const std::filesystem::path& file, std::uint64_t declared);

/// Throws Error, which opens with `where` ("FILE:LINE"), unless `index` is a whole number of 0 .. vertex_count - 1.
void need_vertex(const std::string& where, std::size_t face, double index, std::size_t vertex_count);
/// Throws Error when a face has more corners than can be split, or fewer than none.
void need_corners(const std::string& where, std::size_t face, double count);

/// The body of a text format: one line for each element, # opens a comment, lines without a word are none.
class BodyLines {
 public:
  /// `number`: of the lines that were read before.
  BodyLines(const std::filesystem::path& file, std::istream& in, long number) : file_(file), in_(in), number_(number) {}

  /// The next line is that of this element, counted from 0, of so many; throws Error when there is none.
  void begin(std::string_view element, std::size_t place, std::size_t count);
  /// The next word of the line; throws Error when there is none.
  std::string_view word();
  /// The next word as a number; throws Error when it is none.
  double number();
  /// Reads the corners of a face behind their count.
  void face(std::size_t place, std::size_t vertex_count);
  /// "FILE:LINE"
  std::string where() const;
  /// Lines that were read so far. The next line with a word in it; false when there is none.
  long line_count() const { return number_; }
  bool next(std::string& line);

 private:
  const std::filesystem::path& file_;
  std::istream& in_;
  long number_;
  std::string line_;
  std::size_t at_ = 0, words_ = 0, place_ = 0;
  std::string_view element_;
};

DeclaredCounts read_ply(const std::filesystem::path& file);
void check_obj(const std::filesystem::path& file);
void check_3ds(const std::filesystem::path& file);

}  // namespace gnomon::importing
