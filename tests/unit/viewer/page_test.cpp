// The tables of docs/viewer.md are those that the program itself goes by.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "app/viewer/compose.h"
#include "app/viewer/keys.h"
#include "app/viewer/mouse.h"
#include "places.h"

namespace gnomon::viewer::page_test {

std::string page() {
  std::ifstream file(tree_file("docs/viewer.md"));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void expect_on_page(const std::string& table) {
  EXPECT_NE(page().find("\n\n" + table + "\n"), std::string::npos) << "docs/viewer.md does not hold this table:\n" << table;
}

TEST(viewer_page, lists_every_key_as_the_help_does) { expect_on_page(key_table().markdown()); }

TEST(viewer_page, says_what_the_window_opens_with) {
  const std::string words = fmt::format("the four objects of `{}`, {} beside the reference", registry().default_scene().id,
                                        registry().default_technique().id);
  EXPECT_NE(page().find(words), std::string::npos) << words;
}

TEST(viewer_page, lists_every_use_of_the_mouse_as_the_help_does) {
  std::string table = "| mouse | what it does |\n| --- | --- |\n";
  for (const MouseRow& row : mouse_rows) table += fmt::format("| {} | {} |\n", row.name, row.sentence);
  expect_on_page(table);
}

TEST(viewer_page, names_every_paint_and_says_what_the_buttons_say) {
  std::string text = page();
  for (const ModeRow& row : paint_rows) {
    std::string title(row.title);
    title[0] = static_cast<char>(std::tolower(title[0]));
    EXPECT_NE(text.find("\n| " + title + " | "), std::string::npos) << title;
  }
}

}  // namespace gnomon::viewer::page_test
