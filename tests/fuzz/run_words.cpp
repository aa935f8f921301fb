#include "run_words.h"

#ifndef GNOMON_WITHOUT_PROGRAM
#include "app/app.h"
#endif

namespace fuzz {

#ifdef GNOMON_WITHOUT_PROGRAM
const bool has_program = false;

Outcome run_words(std::vector<std::string>) { return Outcome::refused; }
#else
const bool has_program = true;

Outcome run_words(std::vector<std::string> words) {
  words.insert(words.begin(), "gnomon");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int status = gnomon::app::run_program(static_cast<int>(words.size()), argv.data());
  if (status == 1) throw Problem{"ended with 1: an exception that is no complaint"};
  return status == 0 ? Outcome::accepted : Outcome::refused;
}
#endif

}  // namespace fuzz
