#include <gnomon/param.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "error_words.h"

namespace param_test {

using namespace gnomon;
using error_words::error_of;

struct Rows : Parametrized {
  Number<int> size{this, "size", 8, {.unit = "texel", .min = 2, .max = 64, .log = true}, Stage::relight, "Side."};
  Number<double> bias{this, "bias", 0.5, {.unit = "m", .min = -1, .max = 1e6}, Stage::resolve, "Bias."};
  Choice mode{this, "mode", "slope", {"constant", "slope", "none"}, Stage::resolve, "Kind of bias."};
  Flag fast{this, "fast", false, Stage::setup, "Whether to hurry."};
  Rows() { set_id("rows"); }
};

std::string refused(std::string_view settings) {
  Rows rows;
  return error_of([&] { rows.apply(settings); });
}

TEST(param, rows_register_themselves_in_order_of_declaration) {
  const Rows rows;
  std::vector<std::string> names, allowed;
  for (const Parameter* row : rows.parameters()) {
    names.emplace_back(row->name());
    allowed.push_back(row->allowed());
    EXPECT_EQ(row->text(), row->default_text()) << row->name();
  }
  EXPECT_EQ(names, (std::vector<std::string>{"size", "bias", "mode", "fast"}));
  EXPECT_EQ(allowed, (std::vector<std::string>{"2 .. 64 texel", "-1 .. 1000000 m", "constant | slope | none", "true | false"}));
  EXPECT_EQ(rows.parameter("fast").spoils(), Stage::setup);
}

TEST(param, values_outside_their_range_are_refused_with_what_value_and_range) {
  EXPECT_EQ(refused("size=1"), "rows.size = 1 is outside 2 .. 64 texel");
  EXPECT_EQ(refused("size=65"), "rows.size = 65 is outside 2 .. 64 texel");
  EXPECT_EQ(refused("bias=-1.001"), "rows.bias = -1.001 is outside -1 .. 1000000 m");
  EXPECT_EQ(refused("mode=slop"), "rows.mode = slop is outside constant | slope | none");
  EXPECT_EQ(refused("fast=1"), "rows.fast = 1 is outside true | false");
  EXPECT_EQ(refused("size="), "rows.size = (nothing) is outside 2 .. 64 texel");
}

TEST(param, what_is_no_number_is_refused_whole) {
  for (const char* text : {"8x", " 8", "8 ", "+8", "0x10", "99999999999999999999", "eight", "-"})
    EXPECT_EQ(refused(std::string("size=") + text), fmt::format("rows.size = {} is outside 2 .. 64 texel", text));
  for (const char* text : {"nan", "inf", "1e400", "0.5m", "0,5"}) EXPECT_NE(refused(std::string("bias=") + text), "") << text;
}

TEST(param, a_number_that_is_not_written_as_a_whole_one_is_not_called_out_of_range) {
  for (const char* text : {"8.0", "12.5", "1e1", "-0.5", "80.5", "inf"})
    EXPECT_EQ(refused(std::string("size=") + text),
              fmt::format("rows.size = {} is not a whole number in digits; allowed are 2 .. 64 texel", text));
  for (const char* text : {"-8", "8e1", "1e300", "-1e300"})
    EXPECT_EQ(refused(std::string("size=") + text), fmt::format("rows.size = {} is outside 2 .. 64 texel", text));
  EXPECT_EQ(refused("bias=12.5"), "");
}

TEST(param, both_ends_of_a_range_are_allowed_and_are_the_probes) {
  Rows rows;
  for (Parameter* row : rows.parameters())
    for (const std::string& probe : row->probes()) {
      row->set(probe);
      EXPECT_EQ(row->text(), probe) << row->name();
    }
  EXPECT_EQ(rows.parameter("size").probes(), (std::vector<std::string>{"2", "64"}));
  EXPECT_EQ(rows.parameter("mode").probes().size(), 3u);
}

TEST(param, a_refused_value_leaves_the_old_one) {
  Rows rows;
  rows.apply("size=16,bias=0.25,mode=none,fast=true");
  for (const char* bad : {"size=1", "bias=nan", "mode=x", "fast=maybe"}) EXPECT_THROW(rows.apply(bad), Error) << bad;
  EXPECT_EQ(rows.settings(), "size=16,bias=0.25,mode=none,fast=true");
}

TEST(param, unknown_repeated_and_shapeless_settings_are_errors) {
  EXPECT_EQ(refused("sise=4"), "rows has no parameter sise; did you mean size? It has: size, bias, mode, fast");
  EXPECT_EQ(refused("size=4,size=4"), "rows.size is given twice");
  EXPECT_EQ(refused("size"), "rows: 'size' is not of the form parameter=value");
  EXPECT_EQ(refused("size=4,,fast=true"), "rows: '' is not of the form parameter=value");
  Parametrized bare;
  bare.set_id("bare");
  EXPECT_EQ(error_of([&] { bare.apply("size=4"); }), "bare has no parameter size; it has none at all");
}

TEST(param, an_empty_item_is_no_setting_wherever_it_stands) {
  for (const char* text : {"size=4,", ",size=4", "size=4,,fast=true", ",", "size=4,fast=true,"})
    EXPECT_EQ(refused(text), "rows: '' is not of the form parameter=value") << text;
}

TEST(param, settings_are_applied_all_or_none) {
  // The good ones come first, and more than one: each would be set if settings were applied one by one.
  for (const char* bad : {"size=4,bias=7,fast=true,mode=x", "size=4,bias=7,size=5", "size=4,bias=7,", "size=4,bias=7,sise=1",
                          "size=4,bias=7,fast"}) {
    Rows rows;
    rows.apply("size=16,bias=0.1");
    EXPECT_THROW(rows.apply(bad), Error) << bad;
    EXPECT_EQ(rows.settings(), "size=16,bias=0.1") << bad;
  }
}

RC_GTEST_PROP(param, a_list_with_one_bad_setting_changes_nothing, ()) {
  std::vector<std::string> items;
  for (const auto& item : {fmt::format("size={}", *rc::gen::inRange(2, 65)),
                           fmt::format("bias={}", *rc::gen::inRange(-1000, 1000000000) / 1000.0), std::string("mode=none")})
    if (*rc::gen::arbitrary<bool>()) items.push_back(item);
  const std::string good = fmt::format("{}", fmt::join(items, ","));
  const auto bad = *rc::gen::element<std::string>("", "fast", "fast=maybe", "fats=true", "fast=");
  items.insert(items.begin() + *rc::gen::inRange<long>(0, static_cast<long>(items.size()) + 1), bad);
  if (items.size() == 1 && bad.empty()) return;  // nothing at all is no setting, and no error
  Rows rows, fresh;
  RC_ASSERT_THROWS_AS(rows.apply(fmt::format("{}", fmt::join(items, ","))), Error);
  RC_ASSERT(rows.settings().empty());
  fresh.apply(good);
}

TEST(param, a_default_outside_its_own_range_cannot_be_constructed) {
  Parametrized owner;  // its rows are not read: they are gone at once
  const auto number = [&](double value, double min, double max) {
    return error_of(
        [&] { Number<double>{&owner, "bias", value, {.unit = "m", .min = min, .max = max}, Stage::build, "Bias."}; });
  };
  EXPECT_EQ(number(3, 0, 2), "parameter bias: default 3 is outside 0 .. 2 m");
  EXPECT_EQ(number(std::nan(""), 0, 2), "parameter bias: default nan is outside 0 .. 2 m");
  EXPECT_EQ(number(1, 2, 0), "parameter bias: default 1 is outside 2 .. 0 m");
  EXPECT_EQ(number(0, 0, 2), "");
  EXPECT_EQ(number(2, 0, 2), "");
  EXPECT_EQ(error_of([&] { Number<int>{&owner, "size", 0, {.unit = "", .min = 1, .max = 2}, Stage::build, "Side."}; }),
            "parameter size: default 0 is outside 1 .. 2");
  EXPECT_EQ(error_of([&] {
              Choice{&owner, "mode", "fats", {"slow", "fast"}, Stage::build, "Speed."};
            }),
            "parameter mode: default fats is outside slow | fast");
}

TEST(param, settings_are_canonical) {
  // Only what differs from the defaults, in order of declaration, each number in its shortest form.
  Rows rows;
  EXPECT_EQ(rows.settings(), "");
  rows.apply("");
  EXPECT_EQ(rows.settings(), "");
  rows.apply("fast=true,mode=slope,bias=1.50,size=8");
  EXPECT_EQ(rows.settings(), "bias=1.5,fast=true");
  rows.apply("bias=0.500,fast=false");
  EXPECT_EQ(rows.settings(), "");
}

RC_GTEST_PROP(param, settings_applied_to_a_fresh_object_give_the_same_object, ()) {
  Rows rows, fresh;
  rows.size.set(std::to_string(*rc::gen::inRange(2, 65)));
  rows.bias.set(fmt::format("{}", *rc::gen::inRange(-1000, 1000000000) / 1000.0));
  rows.mode.set(*rc::gen::elementOf(rows.mode.probes()));
  rows.fast.set(*rc::gen::elementOf(rows.fast.probes()));
  fresh.apply(rows.settings());
  RC_ASSERT(fresh.settings() == rows.settings());
  RC_ASSERT(fresh.bias.value() == rows.bias.value());
  RC_ASSERT(fresh.size.value() == rows.size.value());
  RC_ASSERT(fresh.mode.index() == rows.mode.index());
  RC_ASSERT(bool(fresh.fast) == bool(rows.fast));
}

/// Of two kinds: `plain` has a size, `rich` has the rows above.
class Kind final : public ObjectParameter {
 public:
  explicit Kind(Parametrized* owner) : ObjectParameter(owner, "of", "plain", Stage::setup, "What it is of.") {}

 protected:
  struct Plain : Parametrized {
    Number<int> size{this, "size", 8, {.unit = "texel", .min = 2, .max = 64}, Stage::relight, "Side."};
  };
  std::vector<std::string> ids() const override { return {"plain", "rich"}; }
  std::string objection(std::string_view id) const override {
    return id == "plain" || id == "rich" ? "" : fmt::format("did you mean {}?", nearest_word(id, ids()));
  }
  std::unique_ptr<Parametrized> made(std::string_view id) const override {
    if (id == "plain") return std::make_unique<Plain>();
    return std::make_unique<Rows>();
  }
};

struct Whole : Parametrized {
  Number<int> count{this, "count", 1, {.unit = "", .min = 1, .max = 9}, Stage::build, "How many."};
  Kind of{this};
  Flag fast{this, "fast", false, Stage::setup, "Whether to hurry."};
  Whole() { set_id("whole"); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Parameter* row : parameters()) all.emplace_back(row->name());
    return all;
  }
};

TEST(param, rows_of_an_object_within_stand_behind_it_and_follow_its_id) {
  Whole whole;
  EXPECT_EQ(whole.names(), (std::vector<std::string>{"count", "of", "of.size", "fast"}));
  whole.apply("of=rich");
  EXPECT_EQ(whole.names(), (std::vector<std::string>{"count", "of", "of.size", "of.bias", "of.mode", "of.fast", "fast"}));
  EXPECT_EQ(whole.settings(), "of=rich");
  EXPECT_EQ(whole.parameter("of.mode").spoils(), Stage::resolve);
  EXPECT_EQ(whole.parameter("of.bias").unit(), "m");
  EXPECT_NE(dynamic_cast<const Number<int>*>(&typed(whole.parameter("of.size"))), nullptr) << "a slider for it";
  EXPECT_EQ(&typed(whole.count), &whole.count);
}

TEST(param, settings_of_an_object_within_come_in_any_order_and_are_canonical) {
  Whole whole;
  whole.apply("of.mode=none,fast=true,of.size=16,of=rich,count=1");
  EXPECT_EQ(whole.settings(), "of=rich,of.size=16,of.mode=none,fast=true");
  EXPECT_EQ(whole.of.object().settings(), "size=16,mode=none");
  Whole fresh;
  fresh.apply(whole.settings());
  EXPECT_EQ(fresh.settings(), whole.settings());
}

TEST(param, errors_of_an_object_within_name_what_was_written) {
  const auto refusal = [](const char* settings) {
    Whole whole;
    return error_of([&] { whole.apply(settings); });
  };
  EXPECT_EQ(refusal("of.size=1"), "whole.of.size = 1 is outside 2 .. 64 texel");
  EXPECT_EQ(refusal("of.size=8.5"), "whole.of.size = 8.5 is not a whole number in digits; allowed are 2 .. 64 texel");
  EXPECT_EQ(refusal("of=rihc"), "whole.of = rihc is outside plain | rich; did you mean rich?");
  EXPECT_EQ(
      refusal("of=rich,of.mdoe=none"),
      "whole has no parameter of.mdoe; did you mean of.mode? It has: count, of, of.size, of.bias, of.mode, of.fast, fast");
  EXPECT_EQ(refusal("of.mode=none"), "whole has no parameter of.mode; did you mean of.size? It has: count, of, of.size, fast");
  EXPECT_EQ(refusal("of=rich,of=plain"), "whole.of is given twice");
  EXPECT_EQ(refusal("of.size=4,of.size=4"), "whole.of.size is given twice");
}

TEST(param, a_refused_list_leaves_an_object_within_as_it_was) {
  for (const char* bad : {"of=rich,of.size=16,of.mode=x", "of.bias=1,of=plain", "of=plain,of.size=4,count=0", "of=poor"}) {
    Whole whole;
    whole.apply("of=rich,of.size=32,of.mode=none,count=2");
    EXPECT_THROW(whole.apply(bad), Error) << bad;
    EXPECT_EQ(whole.settings(), "count=2,of=rich,of.size=32,of.mode=none") << bad;
  }
}

TEST(param, rows_of_an_object_that_was_left_live_on_and_come_back_with_their_values) {
  Whole whole;
  whole.apply("of.size=4");
  Parameter& size = whole.parameter("of.size");
  whole.apply("of=rich");
  EXPECT_EQ(size.text(), "4");
  EXPECT_EQ(whole.parameter("of.size").text(), "8") << "another object";
  whole.apply("of=plain");
  EXPECT_EQ(&whole.parameter("of.size"), &size);
  EXPECT_EQ(whole.settings(), "of.size=4");
}

TEST(param, nearest_word_counts_insertions_deletions_and_substitutions) {
  const std::vector<std::string> words{"resolution", "depth_bias", "filter"};
  EXPECT_EQ(nearest_word("resolutoin", words), "resolution");
  EXPECT_EQ(nearest_word("depthbias", words), "depth_bias");
  EXPECT_EQ(nearest_word("filtre", words), "filter");
  EXPECT_EQ(nearest_word("anything", {}), "");
  EXPECT_EQ(nearest_word("ab", std::vector<std::string>{"cb", "ac"}), "cb");  // a tie goes to the first
}

TEST(param, nearest_words_come_by_their_distance) {
  // Distances to "bias": 0 of itself; 1 of bits and bids, t or d for a; more of map, whose length is another.
  const std::vector<std::string> words{"map", "bits", "bias", "bids"};
  EXPECT_EQ(nearest_words("bias", words, 3), (std::vector<std::string>{"bias", "bits", "bids"}));
  EXPECT_EQ(nearest_words("bias", words, 9).size(), 4u);
  EXPECT_TRUE(nearest_words("bias", {}, 3).empty());
}

RC_GTEST_PROP(param, a_word_of_the_list_is_nearest_to_itself, ()) {
  const auto letters = rc::gen::container<std::string>(rc::gen::inRange('a', 'd'));
  const auto words = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::string>>(letters));
  const std::string word = *rc::gen::elementOf(words);
  RC_ASSERT(nearest_word(word, words) == word);
}

}  // namespace param_test
