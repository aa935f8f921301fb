#pragma once
#include <gnomon/error.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// What is paid when. A later stage repeats without the earlier ones.
///   setup    once per process: shaders, allocations that depend on nothing
///   build    another scene
///   update   the geometry moved: in place of build, which brings all up to date that update would
///   relight  the light changed, or update was called
///   resolve  the camera changed
enum class Stage { setup, build, update, relight, resolve };
inline constexpr std::string_view stage_names[] = {"setup", "build", "update", "relight", "resolve"};
inline constexpr Stage all_stages[] = {Stage::setup, Stage::build, Stage::update, Stage::relight, Stage::resolve};
/// Timed again and again in every row; setup is done once.
inline constexpr Stage timed_stages[] = {Stage::build, Stage::relight, Stage::resolve};
inline constexpr Stage frame_stages[] = {Stage::relight, Stage::resolve};                  ///< that every frame takes
inline constexpr Stage motion_stages[] = {Stage::update, Stage::relight, Stage::resolve};  ///< where geometry moves
inline constexpr std::string_view name(Stage stage) { return stage_names[static_cast<int>(stage)]; }

class Parametrized;

/// One member is one row: name, default, range, unit, the stage it spoils and one sentence. From it follow the command-line
/// setting, the sweep, the table column, the slider and the page. Values are text at this level; typed rows derive from it.
class Parameter {
 public:
  Parameter(Parametrized* owner, std::string_view name, std::string_view unit, Stage spoils, std::string_view sentence);
  Parameter(const Parameter&) = delete;
  Parameter& operator=(const Parameter&) = delete;
  virtual ~Parameter() = default;

  std::string_view name() const { return name_; }
  std::string_view unit() const { return unit_; }
  std::string_view sentence() const { return sentence_; }
  Stage spoils() const { return spoils_; }

  virtual std::string text() const = 0;          ///< current value; `set(text())` changes nothing
  virtual std::string default_text() const = 0;  ///< value of a fresh object
  virtual std::string allowed() const = 0;       ///< "64 .. 8192 texel", "constant | slope", "true | false"
  /// Both ends of the range, or every choice: what the conformance tests run.
  virtual std::vector<std::string> probes() const = 0;
  /// Throws Error "ID.NAME = VALUE is outside ALLOWED"; the old value then stays.
  virtual void set(std::string_view value) = 0;

 protected:
  /// A row that its owner does not list by itself.
  Parameter(const Parametrized& owner, std::string_view name, std::string_view unit, Stage spoils, std::string_view sentence)
      : owner_(&owner), name_(name), unit_(unit), sentence_(sentence), spoils_(spoils) {}
  /// `more` goes behind the sentence: "; did you mean slope?".
  [[noreturn]] void refuse(std::string_view value, std::string_view more = "") const;
  const Parametrized& owner() const { return *owner_; }

 private:
  const Parametrized* owner_;
  std::string_view name_, unit_, sentence_;
  Stage spoils_;
};

/// Whatever has parameter rows: techniques and scene generators. Rows register themselves in order of declaration.
class Parametrized {
 public:
  Parametrized() = default;
  Parametrized(const Parametrized&) = delete;
  Parametrized& operator=(const Parametrized&) = delete;
  virtual ~Parametrized() = default;

  const std::string& id() const { return id_; }
  void set_id(std::string_view id) { id_ = id; }  ///< called once by the registry
  /// In order of declaration; behind an ObjectParameter those of the object that it names.
  std::vector<Parameter*> parameters() const;
  /// Throws Error with the nearest name and the list of names when `name` is unknown.
  Parameter& parameter(std::string_view name) const;
  /// "a=1,b=2": what differs from the defaults, in order of declaration; empty when nothing does.
  std::string settings() const;
  /// Sets from "a=1,b=2"; empty sets nothing. Throws Error on unknown names, bad values, repeated names
  /// and empty items; nothing is set then. Any order will do: `of` is set before `of.count`.
  void apply(std::string_view settings);

 private:
  friend class Parameter;
  std::string id_;
  std::vector<Parameter*> parameters_;
};

/// Range of a Number: both ends allowed. `log` is a hint for sweeps and sliders.
template <class T>
struct Range {
  std::string_view unit = "";
  T min;
  T max;
  bool log = false;
};

/// A number with a range; T is int or double. The constructor throws Error on a default outside the range.
template <class T>
class Number final : public Parameter {
 public:
  Number(Parametrized* owner, std::string_view name, T value, Range<T> range, Stage spoils, std::string_view sentence)
      : Parameter(owner, name, range.unit, spoils, sentence), value_(value), default_(value), range_(range) {
    // The owner's id is not known yet: its registry gives it after construction.
    if (!(value >= range.min && value <= range.max))
      throw Error("parameter {}: default {} is outside {}", name, value, allowed());
  }
  operator T() const { return value_; }
  T value() const { return value_; }
  const Range<T>& range() const { return range_; }
  std::string text() const override { return fmt::format("{}", value_); }
  std::string default_text() const override { return fmt::format("{}", default_); }
  std::string allowed() const override {
    return fmt::format("{} .. {}{}{}", range_.min, range_.max, unit().empty() ? "" : " ", unit());
  }
  std::vector<std::string> probes() const override { return {fmt::format("{}", range_.min), fmt::format("{}", range_.max)}; }
  void set(std::string_view value) override;

 private:
  T value_, default_;
  Range<T> range_;
};
extern template class Number<int>;
extern template class Number<double>;

/// One of a few words. The constructor throws Error on a default that is none of them.
class Choice : public Parameter {
 public:
  Choice(Parametrized* owner, std::string_view name, std::string_view value, std::initializer_list<std::string_view> choices,
         Stage spoils, std::string_view sentence)
      : Choice(owner, name, value, std::vector<std::string_view>(choices), spoils, sentence) {}
  Choice(Parametrized* owner, std::string_view name, std::string_view value, std::vector<std::string_view> choices,
         Stage spoils, std::string_view sentence);
  std::string_view value() const { return choices_[index_]; }
  int index() const { return index_; }  ///< position in the list of choices
  bool is(std::string_view choice) const { return value() == choice; }
  std::string text() const override { return std::string(value()); }
  std::string default_text() const override { return std::string(choices_[default_]); }
  std::string allowed() const override { return joined(choices_, " | "); }
  std::vector<std::string> probes() const override { return {choices_.begin(), choices_.end()}; }
  void set(std::string_view value) override;

 private:
  std::vector<std::string_view> choices_;
  int index_ = 0, default_ = 0;
};

/// On or off: `true` or `false`.
class Flag final : public Choice {
 public:
  Flag(Parametrized* owner, std::string_view name, bool value, Stage spoils, std::string_view sentence)
      : Choice(owner, name, value ? "true" : "false", {"false", "true"}, spoils, sentence) {}
  operator bool() const { return index() == 1; }
  std::string allowed() const override { return "true | false"; }
};

/// Another object among the rows: its id is the value, and its own rows follow, with the name of this one before theirs. With
/// of=stencil_volume there is a row of.count. Another id brings another object, and the first one back with the values that it
/// had. Rows that were listed live as long as this one, also those of objects that are not the present one any more.
class ObjectParameter : public Parameter {
 public:
  ObjectParameter(Parametrized* owner, std::string_view name, std::string_view id, Stage spoils, std::string_view sentence)
      : Parameter(owner, name, "", spoils, sentence), id_(id), default_(id) {}
  ~ObjectParameter() override;

  /// The present object, which holds the values of its rows. Made at its first use.
  Parametrized& object() const { return *known().object; }
  std::span<const std::unique_ptr<Parameter>> inner() const { return known().rows; }
  std::string text() const override { return id_; }
  std::string default_text() const override { return std::string(default_); }
  std::string allowed() const override { return joined(ids(), " | "); }
  std::vector<std::string> probes() const override { return ids(); }
  void set(std::string_view value) override;

 protected:
  virtual std::vector<std::string> ids() const = 0;
  /// Why an id is none of these, in words behind what is allowed: "did you mean svbsp?". Empty: it is one of them.
  virtual std::string objection(std::string_view id) const = 0;
  /// A fresh object of one of them.
  virtual std::unique_ptr<Parametrized> made(std::string_view id) const = 0;

 private:
  struct Known {
    std::unique_ptr<Parametrized> object;
    std::vector<std::unique_ptr<Parameter>> rows;
  };
  Known& known() const;

  std::string id_;
  std::string_view default_;
  mutable std::map<std::string, Known, std::less<>> known_;
};

/// The row itself; of a row behind an ObjectParameter the one of its own object, which is a Number or a Choice.
const Parameter& typed(const Parameter& row);

/// The candidates with the smallest edit distances to `word`, at most so many: the nearest first, then the earlier.
std::vector<std::string> nearest_words(std::string_view word, std::span<const std::string> candidates, std::size_t most);

/// The candidate with the smallest edit distance to `word`; empty when there is no candidate.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

}  // namespace gnomon
