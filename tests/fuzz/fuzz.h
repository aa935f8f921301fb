#pragma once
// What the parts of the fuzzer share. One input is the bytes of one file; its kind says who reads it.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace fuzz {

/// The same numbers from the same seed on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits() { return engine_(); }
  /// 0 .. count - 1
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  bool chance(double share) { return static_cast<double>(engine_() >> 11) * 0x1p-53 < share; }
  template <class Items>
  auto& pick(Items& items) {
    return items[below(std::size(items))];
  }

 private:
  std::mt19937_64 engine_;
};

struct Input {
  std::size_t kind = 0;
  std::string name;  ///< with the ending that tells readers the format
  std::string bytes;
  bool is_seed = false;  ///< as it was written; nothing is mutated
};

enum class Outcome { accepted, refused };

/// What went wrong in an input that brought nothing down: a bound, or a complaint that is none.
struct Problem {
  std::string what;
};

struct Answer {
  Answer(Outcome is, std::string words = {}) : outcome(is), complaint(std::move(words)) {}
  Outcome outcome;
  std::string complaint;  ///< why it was refused, where the reader said so
};

/// Who reads inputs of one kind.
struct Kind {
  std::string name;   ///< also the folder of its seeds
  std::size_t share;  ///< of the inputs, beside the other kinds' shares
  bool is_text;
  /// Reads the file, which holds the bytes. Throws what the reader throws.
  std::function<Answer(const std::filesystem::path& file, const std::string& bytes)> read;
  std::vector<Input> seeds = {};
};

/// All kinds with their seeds: files of tests/data/fuzz/KIND, what the tree has of the kind, and what the program writes
/// itself. `scratch` is a folder where they may put what their inputs name.
std::vector<Kind> all_kinds(const std::filesystem::path& scratch);

// One for each row of `all_kinds`, by room.
Outcome read_described_scene(const std::filesystem::path& file, const std::string& bytes);
Outcome read_suite_file(const std::filesystem::path& file, const std::string& bytes);
Outcome read_mesh(const std::filesystem::path& file, const std::string& bytes);
Outcome read_answer_of_importer(const std::filesystem::path& file, const std::string& bytes);
Outcome read_records_of_run(const std::filesystem::path& file, const std::string& bytes);
Outcome read_mask(const std::filesystem::path& file, const std::string& bytes);
Outcome read_words(const std::filesystem::path& file, const std::string& bytes);
Outcome read_settings(const std::filesystem::path& file, const std::string& bytes);
Answer read_requests(const std::filesystem::path& file, const std::string& bytes);
Outcome read_replies(const std::filesystem::path& file, const std::string& bytes);
Outcome read_blob(const std::filesystem::path& file, const std::string& bytes);
/// The worker that `read_replies` starts: says what the file holds that the environment names.
int say_replies(int socket);
/// Seeds that the program itself writes: scenes as bytes, explanations, details, answers of the importer, masks.
std::vector<Input> written_seeds(const std::string& kind, const std::filesystem::path& scratch);

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A mutant of a seed, of the same format.
std::string mutate_text(Random& random, const std::string& seed, const std::string& other);
std::string mutate_binary(Random& random, const std::string& seed, const std::string& other);
/// Lengths and checksums that a mutant needs to be looked into: GLB, PNG. Others stay as they are.
std::string mend(const std::string& name, std::string bytes);

struct Options {
  std::uint64_t seed = 1;
  double minutes = 1;  ///< 0: the seeds alone, as they are
  std::string replay;  ///< a folder of KIND/FILE, each read once as it is; nothing is mutated then
  std::string only;    ///< names of kinds with commas between; all when empty
  std::filesystem::path findings = "fuzz-findings";
};
/// A file, or what a recipe (.repeat) stands for: lines of `COUNT TEXT`, where \n and {k} are replaced.
Input read_input(const std::filesystem::path& file, std::size_t kind);

}  // namespace fuzz
