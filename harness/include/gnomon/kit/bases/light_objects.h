#pragma once
#include <gnomon/registry.h>

namespace gnomon {

/// A technique as a renderer of several lights holds it: an object for each light. Where the technique can share what setup and
/// build make (Technique::for_another_light), these two stages are done once, else by every object.
class LightObjects {
 public:
  LightObjects(const TechniqueEntry& entry, const std::string& settings);
  /// All of them share with an object that is held elsewhere and outlives them: none needs a stage before relight. That
  /// object's for_another_light() must give something.
  LightObjects(const TechniqueEntry& entry, const std::string& settings, const Technique& elsewhere);

  /// One at least. Answers whether an object is new that needs stages of its own from setup on.
  bool hold(std::size_t count);
  std::size_t count() const { return (first_ ? 1 : 0) + others_.size(); }
  Technique& operator[](std::size_t k) { return !first_ ? *others_[k] : k == 0 ? *first_ : *others_[k - 1]; }
  /// Whether the objects for further lights share with the first; nothing while there is only one.
  std::optional<bool> shares() const { return others_.empty() ? std::nullopt : std::optional(shares_); }

  /// Sets what differs of the parameters, in every object. Answers the first stage that this spoils; nothing when nothing
  /// differs.
  std::optional<Stage> set(const std::string& settings);
  /// Does a stage in every object, in the order of the lights: does(object, number).
  template <class Does>
  void each(Stage stage, const Does& does) {
    const bool is_shared = stage <= Stage::build && shares_;
    for (std::size_t k = 0; k < (is_shared ? (first_ ? 1 : 0) : count()); ++k) does((*this)[k], k);
  }
  /// What all objects counted, each count as it says (Count::Together).
  Counts counts() const;

 private:
  std::unique_ptr<Technique> fresh() const;

  const TechniqueEntry& entry_;
  std::string settings_;
  std::unique_ptr<Technique> first_;  ///< null: it is elsewhere
  const Technique* source_;           ///< the one that others share with
  std::vector<std::unique_ptr<Technique>> others_;
  bool shares_ = false;
};

/// What several lights together are, where each is what `supports` says: unsupported when all are; else one that is unsupported
/// casts no shadows, and the whole is approximate with the reasons.
Support support_together(const std::vector<Light>& lights, const std::vector<Support>& supports);

}  // namespace gnomon
