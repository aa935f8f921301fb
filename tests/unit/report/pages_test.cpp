#include "report/pages.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <sstream>

#include "report/listing.h"

namespace pages_test {

using namespace gnomon;
namespace fs = std::filesystem;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class Blur : public Technique {
 public:
  Number<int> radius{this, "radius", 2, {.unit = "texel", .min = 0, .max = 9}, Stage::relight, "Width | of the blur."};
  Choice filter{this, "filter", "box", {"box", "tent"}, Stage::resolve, "Shape of the filter."};
  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override {}
  void build(const Scene&) override {}
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask&) override {}
  Counts counts() const override { return {}; }
};

TechniqueEntry blur(const std::string& id = "blur") {
  return {id,
          {.title = "Blur", .summary = "Blurs all.", .source = "Williams 1978", .error = "Large.", .fails = "Everywhere."},
          [] { return made<Technique, Blur>("blur"); }};
}

TEST(pages, page_says_all_that_the_technique_says_of_itself) {
  const std::string page = technique_page(blur());
  EXPECT_TRUE(has(page, "# Blur\n\nBlurs all.\n"));
  EXPECT_TRUE(has(page, "| Source | Williams 1978 |"));
  EXPECT_TRUE(has(page, "| Role | contender |"));
  EXPECT_TRUE(has(page, "| `radius` | `2` | `0 .. 9 texel` | texel | relight | Width \\| of the blur. |")) << page;
  EXPECT_TRUE(has(page, "| `filter` | `box` | `box \\| tent` |  | resolve | Shape of the filter. |")) << page;
  EXPECT_TRUE(has(page, "gnomon run --scene SCENE --technique blur:radius=0\n")) << page;
}

TEST(pages, page_of_a_technique_that_makes_polygons_says_how_to_write_them) {
  class Cut final : public Blur {
    std::optional<SurfaceDetail> surface_detail() const override { return SurfaceDetail{}; }
  };
  TechniqueEntry entry = blur("cut");
  EXPECT_FALSE(has(technique_page(entry), "Surface detail"));
  EXPECT_FALSE(describe_json(entry)["surface_detail"].get<bool>());
  entry.make = [] { return made<Technique, Cut>("cut"); };
  EXPECT_TRUE(has(technique_page(entry), "## Surface detail\n\n`gnomon render --technique cut --detail FILE.obj` writes"));
  EXPECT_TRUE(describe_json(entry)["surface_detail"].get<bool>());
}

TEST(pages, index_links_every_technique) {
  const std::vector<TechniqueEntry> entries{blur("a"), blur("b")};
  const std::string index = technique_index(entries);
  EXPECT_TRUE(has(index, "| [a](a.md) | Blur | contender | sampled | mesh | processor | Blurs all. |")) << index;
  EXPECT_TRUE(has(index, "| [b](b.md) |"));
}

TEST(pages, written_pages_are_fresh_and_pages_of_gone_techniques_are_removed) {
  std::string pattern = (fs::temp_directory_path() / "gnomon_pages_XXXXXX").string();
  const fs::path dir = mkdtemp(pattern.data());
  const std::vector<TechniqueEntry> two{blur("a"), blur("b")}, one{blur("a")};
  EXPECT_EQ(stale_pages(dir / "new", two), (std::vector<std::string>{"README.md", "a.md", "b.md"}));
  write_pages(dir / "new", two);
  EXPECT_TRUE(stale_pages(dir / "new", two).empty());
  std::ofstream(dir / "new" / "a.md") << "edited";
  std::ofstream(dir / "new" / "by_hand.md") << "# By hand\n";
  EXPECT_EQ(stale_pages(dir / "new", one), (std::vector<std::string>{"b.md", "README.md", "a.md"}));
  write_pages(dir / "new", one);
  EXPECT_TRUE(stale_pages(dir / "new", one).empty());
  EXPECT_FALSE(fs::exists(dir / "new" / "b.md"));
  EXPECT_TRUE(fs::exists(dir / "new" / "by_hand.md"));
  fs::remove_all(dir);
}

TEST(listing, description_holds_facts_and_parameters) {
  const std::string text = describe_text(blur());
  EXPECT_TRUE(has(text, "fails           Everywhere.\n")) << text;
  EXPECT_TRUE(has(text, "radius     2        0 .. 9 texel  relight  Width | of the blur.\n")) << text;
  const Json json = describe_json(blur());
  EXPECT_EQ(json["parameters"][1]["allowed"], "box | tent");
  EXPECT_EQ(json["sees"], "mesh");
}

TEST(listing, lists_hold_one_line_for_each_entry) {
  const std::vector<TechniqueEntry> entries{blur("a"), blur("b")};
  EXPECT_EQ(lines_of(list_text(entries)).size(), 4u);
  EXPECT_EQ(list_json(entries)[1]["id"], "b");
  EXPECT_EQ(list_json(metric_infos()).size(), metric_infos().size());
  EXPECT_TRUE(has(list_text(metric_infos()), "wrong_rate"));
}

}  // namespace pages_test
