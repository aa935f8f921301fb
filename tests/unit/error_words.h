#pragma once
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace gnomon::error_words {

/// What an action throws; empty where it does not.
template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << '"' << word << "\" in: " << text;
}

/// Whether a note of a scene or a mesh file holds these words.
bool has_note(const auto& noted, const std::string& words) {
  for (const std::string& note : noted.notes)
    if (note.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace gnomon::error_words
