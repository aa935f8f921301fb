#include "run_words.h"

#ifndef GNOMON_WITHOUT_PROGRAM
#include "app/app.h"
#endif

namespace fuzz {

Outcome run_words([[maybe_unused]] std::vector<std::string> words) {
#ifdef GNOMON_WITHOUT_PROGRAM
  return Outcome::accepted;
#else
  words.insert(words.begin(), "gnomon");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int status = gnomon::app::run_program(static_cast<int>(words.size()), argv.data());
  if (status == 1) throw Problem{"ended with 1: an exception that is no complaint"};
  return status == 0 ? Outcome::accepted : Outcome::refused;
#endif
}

}  // namespace fuzz
