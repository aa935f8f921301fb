// What the registry answers when nobody names a technique or scene.
#include <gnomon/registry.h>
#include <gtest/gtest.h>

namespace gnomon::registry_test {

TechniqueEntry technique(const std::string& id, bool is_default, Role role = Role::contender) {
  About about;
  about.role = role;
  about.is_default = is_default;
  return {id, about, nullptr};
}

SceneEntry scene(const std::string& id, bool is_default) {
  SceneAbout about;
  about.is_default = is_default;
  return {id, about, nullptr};
}

TEST(registry, the_default_is_the_first_whose_data_sheet_says_so) {
  Registry registry;
  registry.add(technique("zebra", true));
  registry.add(technique("yak", true));
  registry.add(technique("ant", false, Role::reference));
  registry.add(scene("dune", true));
  registry.add(scene("cave", false));
  EXPECT_EQ(registry.default_technique().id, "yak");
  EXPECT_EQ(registry.default_scene().id, "dune");
  EXPECT_EQ(registry.reference().id, "ant");
}

TEST(registry, without_such_a_data_sheet_the_default_is_the_first_of_all) {
  Registry registry;
  registry.add(technique("zebra", false));
  registry.add(technique("yak", false));
  EXPECT_EQ(registry.default_technique().id, "yak");
  EXPECT_THROW(registry.default_scene(), Error);
  EXPECT_THROW(registry.reference(), Error);
}

}  // namespace gnomon::registry_test
