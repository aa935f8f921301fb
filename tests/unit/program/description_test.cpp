#include "measure/program/description.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <set>

#include "error_words.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace description_test {
using namespace gnomon;

/// A description with one more line at its end.
std::shared_ptr<const ProgramDescription> described(const ScratchFolder& folder, const std::string& line) {
  const std::string sheet =
      "title = \"T\"\nsummary = \"S.\"\nsource = \"None.\"\nerror = \"E.\"\nfails = \"F.\"\ncommand = [\"true\"]\n";
  write_file(folder.path() / "program.toml", sheet + line + "\n");
  return read_program(folder.path() / "program.toml");
}

TEST(description, says_what_of_scenes_a_program_handles) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  EXPECT_TRUE(described(folder, "")->about.handles.empty());
  EXPECT_TRUE(described(folder, "handles = []")->about.handles.empty());
  const auto masks = described(folder, "handles = [\"alpha_masks\"]");
  ASSERT_EQ(masks->about.handles.size(), 1u);
  EXPECT_EQ(masks->about.handles[0], Feature::alpha_masks);
  for (const char* const line : {"handles = [\"alpha_mask\"]", "handles = \"alpha_masks\"", "handles = [1]"}) {
    try {
      described(folder, line);
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_NE(std::string_view(error.what()).find("alpha_masks"), std::string_view::npos) << error.what();
      EXPECT_NE(std::string_view(error.what()).find("program.toml:7"), std::string_view::npos) << error.what();
    }
  }
}

TEST(description, has_all_stages_but_update_unless_it_lists_them) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  const auto stages = [&](const std::string& line) {
    std::vector<std::string> names;
    for (const Stage stage : all_stages)
      if (described(folder, line)->has_stage[static_cast<std::size_t>(stage)]) names.emplace_back(name(stage));
    return joined(names, " ");
  };
  EXPECT_EQ(stages(""), "setup build relight resolve");
  EXPECT_EQ(stages("stages = [\"resolve\", \"update\", \"build\"]"), "build update resolve");
  EXPECT_EQ(stages("stages = [\"resolve\"]"), "resolve");
  const auto refused = [&](const std::string& line) { return error_words::error_of([&] { described(folder, line); }); };
  error_words::expect_words(refused("stages = [\"update\", \"resolve\"]"), {"stages", "build beside update", "program.toml:7"});
  error_words::expect_words(refused("stages = [\"build\", \"update\"]"), {"stages", "resolve", "program.toml:7"});
  error_words::expect_words(refused("stages = [\"move\"]"), {"'move'", "setup, build, update, relight, resolve"});
}

TEST(description, has_an_update_error_of_a_share) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  EXPECT_EQ(described(folder, "")->about.update_error, 0);
  EXPECT_EQ(described(folder, "update_error = 1e-6")->about.update_error, 1e-6f);
  for (const char* const line : {"update_error = -1", "update_error = 1.5", "update_error = nan"})
    error_words::expect_words(error_words::error_of([&] { described(folder, line); }), {"update_error", "program.toml:7"});
}

TEST(description, says_whether_a_program_remembers_frames) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  EXPECT_FALSE(described(folder, "")->about.remembers);
  EXPECT_FALSE(described(folder, "remembers = false")->about.remembers);
  EXPECT_TRUE(described(folder, "remembers = true")->about.remembers);
  error_words::expect_words(error_words::error_of([&] { described(folder, "remembers = \"frames\""); }),
                            {"remembers", "program.toml:7"});
}

TEST(description, has_no_parameter_that_spoils_update) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  const auto with = [&](const std::string& stage) {
    return described(folder, "[[parameter]]\nname = \"a\"\nvalue = true\nsentence = \"S.\"\nstage = \"" + stage + "\"");
  };
  for (const Stage stage : spoilable_stages) EXPECT_EQ(with(std::string(name(stage)))->parameters.at(0).stage, stage);
  error_words::expect_words(error_words::error_of([&] { with("update"); }),
                            {"'update'", "is not one of setup, build, relight, resolve", "program.toml"});
}

TEST(description, names_the_stages_of_a_technique_that_is_a_program) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  described(folder, "stages = [\"build\", \"update\", \"resolve\"]");
  TechniqueEntry entry;
  EXPECT_TRUE(described_stages(entry).empty());
  entry.origin = "plugin.so";
  EXPECT_TRUE(described_stages(entry).empty());
  entry.origin = (folder.path() / "program.toml").string();
  EXPECT_EQ(described_stages(entry), (std::vector<std::string>{"build", "update", "resolve"}));
}

// Where two programs share a folder, a change of any file there is a change of both.
TEST(description, files_of_a_program_are_those_of_the_folders_that_its_command_leads_into) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-description");
  const auto place = [&](const char* file) { return folder.path() / file; };
  for (const char* const inner : {"shared/deeper", "program", "other"}) std::filesystem::create_directories(place(inner));
  for (const char* const file : {"shared/first.py", "shared/second.py", "shared/deeper/third.py", "program/own.txt",
                                 "other/no.py", "beside.py", "alone.py"})
    write_file(place(file), "");
  const auto files_of = [&](const std::string& command) {
    write_file(place("program.toml"), "title = \"T\"\nsummary = \"S.\"\nsource = \"None.\"\nerror = \"E.\"\nfails = \"F.\"\n" +
                                          ("command = [" + command + "]\n"));
    const std::vector<std::filesystem::path> files = program_files(*read_program(place("program.toml")));
    return std::set<std::filesystem::path>(files.begin(), files.end());
  };
  const auto expected = [&](std::vector<const char*> more) {
    std::set<std::filesystem::path> files = {place("program.toml"), place("program/own.txt")};
    for (const char* const file : more) files.insert(place(file));
    return files;
  };
  EXPECT_EQ(files_of("\"python3\", \"shared/first.py\""), expected({"shared/first.py", "shared/second.py"}));
  EXPECT_EQ(files_of("\"python3\", \"beside.py\""), expected({"beside.py"}));
  EXPECT_EQ(files_of("\"python3\", \"program/own.txt\""), expected({}));
  EXPECT_EQ(files_of("\"python3\", \"" + place("other/no.py").string() + "\""), expected({"other/no.py"}));
}

}  // namespace description_test
