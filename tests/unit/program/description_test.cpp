#include "measure/program/description.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

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

}  // namespace description_test
