// What setup draws, so that no timed stage compiles a shader.
#include "composite_planar_rig.h"
#include "techniques/composite_planar/patches.h"

namespace composite_planar_setup_test {
using namespace composite_rig;
using composite_planar::Entry;
using composite_planar::Patches;

class CompositeSetup : public TestRig {};

// The picture of warm_up has casters that the technique supports, and their
// shadows in it.
TEST_F(CompositeSetup, setup_has_drawn) {
  for (const char* settings : {"form=exact", "form=paper"}) {
    const auto technique = make(settings);
    technique->setup();
    EXPECT_GT(small_world::value(technique->counts(), "patches"), 0) << settings;
    EXPECT_GT(small_world::value(technique->counts(), "discs"), 0) << settings;
    EXPECT_GT(small_world::value(technique->counts(), "polygons"), 0) << settings;
  }
}

// Five tests of one tile: whatever they are, the limit says which of the three
// programs has them.
TEST_F(CompositeSetup, limits_of_lists_choose_the_program) {
  std::vector<Entry> entries;
  for (std::uint32_t test = 0; test < 5; ++test) entries.push_back({.tile = 0, .plane = 0, .test = test, .is_whole = false});
  Patches patches;
  patches.make(entries, 1, 8, 8, 0);
  EXPECT_EQ(patches.whole.size(), 1u);
  EXPECT_EQ(patches.size(), 1u);
  patches.make(entries, 1, 8, 8, 1);
  EXPECT_EQ(patches.single.size(), 5u);
  EXPECT_EQ(patches.size(), 5u);
  patches.make(entries, 1, 8, 8);
  EXPECT_EQ(patches.several.size(), 1u);
  EXPECT_EQ(patches.single.size(), 1u);
  EXPECT_EQ(patches.size(), 2u);
}

}  // namespace composite_planar_setup_test
