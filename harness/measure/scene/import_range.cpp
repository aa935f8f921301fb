#include <charconv>
#include <fstream>
#include <sstream>

#include "measure/scene/import.h"

namespace gnomon::importing {

namespace {

/// Vertex index that a face's corner starts with ("7", "7/1", "-2//3"); nothing when it is no number.
std::optional<long> leading_index(const std::string& word) {
  long index = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (code != std::errc{} || end == word.data()) return std::nullopt;
  return index;
}

/// Faces count from 1, or back from the last vertex so far; vertices may follow the faces that name them.
void check_obj(std::ifstream& in, const std::string& name) {
  long total = 0;
  std::string line, word;
  while (std::getline(in, line)) total += line.starts_with("v ");
  in.clear();
  in.seekg(0);
  long number = 0, so_far = 0;
  while (std::getline(in, line)) {
    ++number;
    so_far += line.starts_with("v ");
    if (!line.starts_with("f ")) continue;
    std::istringstream words(line.substr(2));
    while (words >> word)
      if (const auto index = leading_index(word); index && (*index == 0 || *index > total || -*index > so_far))
        throw Error("{}:{}: face names vertex {}, out of range: allowed are 1 .. {}, or -1 .. -{} counted back", name, number,
                    *index, total, so_far);
  }
}

/// After the word OFF: counts, vertices, then faces "n i1 .. in", which count from 0. Comments and empty lines do not count.
void check_off(std::ifstream& in, const std::string& name) {
  std::string line;
  long number = 0;
  const auto next = [&](std::istringstream& words) {
    do {
      if (!std::getline(in, line)) return false;
      ++number;
      line = line.substr(0, line.find('#'));
    } while (line.find_first_not_of(" \t\r") == std::string::npos);
    words = std::istringstream(line);
    return true;
  };
  std::istringstream words;
  long vertices = 0, faces = 0, corners = 0, index = 0;
  if (!next(words) || !next(words) || !(words >> vertices >> faces)) return;
  for (long v = 0; v < vertices; ++v)
    if (!next(words)) return;
  for (long f = 0; f < faces && next(words); ++f) {
    words >> corners;
    for (long c = 0; c < corners && words >> index; ++c)
      if (index < 0 || index >= vertices)
        throw Error("{}:{}: face {} names vertex {}, out of range: allowed are 0 .. {}", name, number, f, index, vertices - 1);
  }
}

}  // namespace

void blame_index(const std::filesystem::path& file) {
  std::ifstream in(file);
  const std::string extension = lower_extension(file);
  if (extension == ".obj") check_obj(in, file.string());
  if (extension == ".off") check_off(in, file.string());
}

}  // namespace gnomon::importing
