// What the registry answers when nobody names a technique or scene.
#include <gnomon/registry.h>
#include <gtest/gtest.h>

namespace gnomon {
namespace {

TechniqueEntry technique(const std::string& id, const About& about) { return {id, about, nullptr}; }
SceneEntry scene(const std::string& id, const SceneAbout& about) { return {id, about, nullptr}; }

TEST(registry, the_default_is_the_first_whose_data_sheet_says_so) {
  Registry registry;
  registry.add(technique("zebra", {.is_default = true}));
  registry.add(technique("yak", {.is_default = true}));
  registry.add(technique("ant", {.role = Role::reference}));
  registry.add(scene("dune", {.is_default = true}));
  registry.add(scene("cave", {}));
  EXPECT_EQ(registry.default_technique().id, "yak");
  EXPECT_EQ(registry.default_scene().id, "dune");
  EXPECT_EQ(registry.reference().id, "ant");
}

TEST(registry, without_such_a_data_sheet_the_default_is_the_first_of_all) {
  Registry registry;
  registry.add(technique("zebra", {}));
  registry.add(technique("yak", {}));
  EXPECT_EQ(registry.default_technique().id, "yak");
  EXPECT_THROW(registry.default_scene(), Error);
  EXPECT_THROW(registry.reference(), Error);
}

}  // namespace
}  // namespace gnomon
