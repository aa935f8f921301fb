#include "app/command_line.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

namespace command_line_test {

using namespace gnomon;
using namespace gnomon::app;

struct Words {
  std::string name, mode = "fast";
  std::vector<std::string> colors;
  std::vector<double> sizes;
  std::optional<double> limit;
  std::filesystem::path file;
  int count = 1;
  bool is_loud = false;
};

/// A program with the commands `paint`, which takes one option of each kind, and `hidden`.
class Painter {
 public:
  Painter() {
    line_.early_option("--load", "FILE", "Loads", [this](const std::string& file) { order.push_back(file); });
    auto [paint, options] = line_.command<Words>("paint", "Paints", [this](const Words& read, const Command& command) {
      words = read;
      is_count_given = command.is_given("--count");
      order.push_back("paint");
      return 3;
    });
    paint.option("name", &options.name, "What to paint", {.is_required = true});
    const auto colors = paint.option("--colors", &options.colors, "Colors", {.delimiter = ','});
    paint.option("--sizes", &options.sizes, "Sizes", {.check = above_zero(), .delimiter = ','});
    paint.option("--limit", &options.limit, "Limit", {.check = number_in(0, 0.5), .needs = colors});
    paint.option("--file", &options.file, "File", {.check = not_empty(), .excludes = colors});
    paint.option("--count", &options.count, "Count", {.check = whole_in(1, 9)});
    paint.option("--mode,--style", &options.mode, "Mode", {.type_name = "MODE"});
    paint.flag("--loud", &options.is_loud, "Loud");
    line_.command<Words>("hidden", "Hides", [this](Words&) { order.push_back("hidden"); }).first.hide();
  }

  /// The exit status.
  int run(std::vector<std::string> words) {
    words.insert(words.begin(), "painter");
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return line_.run(static_cast<int>(words.size()), pointers.data());
  }

  Words words;
  bool is_count_given = false;
  std::vector<std::string> order;

 private:
  CommandLine line_{"Paints things", "painter", "1.2"};
};

/// The text of the Error that these words are refused with; empty when they are not.
std::string refused(const std::vector<std::string>& words) {
  try {
    Painter().run(words);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(command_line, every_kind_of_option_reaches_its_target) {
  Painter painter;
  EXPECT_EQ(painter.run({"paint", "wall", "--colors", "red,blue", "--sizes", "1.5,2", "--limit", "0.25", "--count", "4",
                         "--style", "slow", "--loud"}),
            3);
  EXPECT_EQ(painter.words.name, "wall");
  EXPECT_EQ(painter.words.colors, (std::vector<std::string>{"red", "blue"}));
  EXPECT_EQ(painter.words.sizes, (std::vector{1.5, 2.0}));
  EXPECT_EQ(painter.words.limit, 0.25);
  EXPECT_EQ(painter.words.count, 4);
  EXPECT_EQ(painter.words.mode, "slow");
  EXPECT_TRUE(painter.words.is_loud);
  EXPECT_TRUE(painter.is_count_given);
}

TEST(command_line, what_is_not_given_keeps_its_default) {
  Painter painter;
  EXPECT_EQ(painter.run({"paint", "wall", "--file", "a.png"}), 3);
  EXPECT_EQ(painter.words.file, "a.png");
  EXPECT_EQ(painter.words.mode, "fast");
  EXPECT_EQ(painter.words.count, 1);
  EXPECT_EQ(painter.words.limit, std::nullopt);
  EXPECT_FALSE(painter.words.is_loud);
  EXPECT_FALSE(painter.is_count_given);
}

TEST(command_line, early_options_are_used_before_the_command) {
  Painter painter;
  EXPECT_EQ(painter.run({"--load", "a", "--load", "b", "hidden"}), 0);
  EXPECT_EQ(painter.order, (std::vector<std::string>{"a", "b", "hidden"}));
}

TEST(command_line, early_options_may_stand_among_what_the_command_takes) {
  Painter painter;
  EXPECT_EQ(painter.run({"--load", "a", "paint", "--load", "b", "wall", "--loud", "--load", "c"}), 3);
  EXPECT_EQ(painter.order, (std::vector<std::string>{"a", "b", "c", "paint"}));
  EXPECT_EQ(painter.words.name, "wall");
  EXPECT_TRUE(painter.words.is_loud);
  const std::string unknown = refused({"paint", "wall", "--laod", "x"});
  EXPECT_TRUE(unknown.starts_with("painter paint has no option --laod; did you mean --load?")) << unknown;
}

TEST(command_line, words_that_are_none_are_refused_with_what_there_is) {
  EXPECT_EQ(refused({}), "a command is wanted; there are: paint");
  EXPECT_EQ(refused({"--load", "x", "pant"}), "there is no command pant; did you mean paint? There are: paint");
  const std::string unknown = refused({"paint", "wall", "--lout"});
  EXPECT_TRUE(unknown.starts_with("painter paint has no option --lout; did you mean --loud? It has: --")) << unknown;
  EXPECT_EQ(refused({"paint", "wall", "floor"}),
            "painter paint does not know what to do with 'floor'; painter paint --help says what it takes");
}

TEST(command_line, conditions_are_said_when_they_are_not_met) {
  const auto says = [](const std::vector<std::string>& words, std::string_view text) {
    EXPECT_NE(refused(words).find(text), std::string::npos) << refused(words);
  };
  says({"paint"}, "name is required");
  says({"paint", "wall", "--count", "10"}, "10 not in range ");  // "1 to 9" or "[1 - 9]", by the version of CLI11
  says({"paint", "wall", "--sizes", "1,0"}, "0 is not a number above 0");
  says({"paint", "wall", "--colors", "red", "--limit", "nan"}, "nan is not a number in 0 .. 0.5");
  says({"paint", "wall", "--limit", "0.5"}, "--limit requires --colors");
  says({"paint", "wall", "--file", ""}, "the name is empty");
  says({"paint", "wall", "--file", "a", "--colors", "red"}, "--colors excludes --file");
  EXPECT_EQ(seconds().error("86400"), "");
  EXPECT_EQ(seconds().error("86401"), "86401 is not a number of seconds above 0, at most 86400");
}

TEST(command_line, a_name_is_there_once_with_dashes_or_without) {
  CommandLine line("Paints things", "painter", "1.2");
  auto [paint, options] = line.command<Words>("paint", "Paints", [](const Words&) { return 0; });
  paint.option("name", &options.name);
  paint.option("--mode,--style", &options.mode);
  EXPECT_THROW(paint.option("--name", &options.file), Error);
  EXPECT_THROW(paint.option("style", &options.file), Error);
  EXPECT_THROW(paint.flag("--loud,--mode", &options.is_loud, ""), Error);
  paint.flag("--loud", &options.is_loud, "");
}

TEST(command_line, help_and_version_are_printed_and_nothing_is_done) {
  Painter painter;
  testing::internal::CaptureStdout();
  EXPECT_EQ(painter.run({"paint", "--help"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  for (const char* text :
       {"name TEXT REQUIRED", "--count INT:INT in [1 - 9]", "--mode,--style MODE", "--sizes FLOAT:above 0 ..."})
    EXPECT_NE(help.find(text), std::string::npos) << text << "\n" << help;
  constexpr auto npos = std::string::npos;  // the default, by the version of CLI11:
  EXPECT_TRUE(help.find("[1 - 9]=1") != npos || help.find("[1 - 9] [1]") != npos) << help;
  testing::internal::CaptureStdout();
  EXPECT_EQ(painter.run({"--version"}), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "1.2\n");
  EXPECT_TRUE(painter.order.empty());
}

TEST(command_line, a_hidden_command_is_not_in_the_help) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(Painter().run({"--help"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_NE(help.find("paint"), std::string::npos);
  EXPECT_EQ(help.find("hidden"), std::string::npos);
}

}  // namespace command_line_test
