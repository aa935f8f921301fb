#pragma once
#include <gnomon/registry.h>

namespace gnomon {

/// A technique as a renderer of several lights holds it: an object for each light. Where the technique can share what setup and
/// build make (Technique::for_another_light), these two stages and update are done once for each scene, else by every object.
class LightObjects {
 public:
  LightObjects(const TechniqueEntry& entry, const std::string& settings);
  /// All of them share with an object that is held elsewhere and outlives them: none needs a stage before relight. That
  /// object's for_another_light() must give something.
  LightObjects(const TechniqueEntry& entry, const std::string& settings, const Technique& elsewhere);

  /// One at least. Answers whether an object is new that needs stages of its own from setup on.
  bool hold(std::size_t count) { return hold_by_scene(std::vector<std::size_t>(std::max<std::size_t>(count, 1), 0)); }
  /// One for each, by the number of the scene that it is built on: only objects of one scene can share.
  bool hold_by_scene(const std::vector<std::size_t>& scenes);
  std::size_t count() const { return objects_.size(); }
  Technique& operator[](std::size_t k) { return *objects_[k].technique; }
  /// Whether the objects for further lights share with the first of their scene; nothing where each has a scene of its own.
  std::optional<bool> shares() const;

  /// Sets what differs of the parameters, in every object. Answers the first stage that this spoils; nothing when nothing
  /// differs.
  std::optional<Stage> set(const std::string& settings);
  /// Does a stage in every object, in the order of the lights: does(object, number).
  template <class Does>
  void each(Stage stage, const Does& does) {
    for (std::size_t k = 0; k < count(); ++k)
      if (stage > Stage::update || !objects_[k].shares) does((*this)[k], k);
  }
  /// The next resolve of every object is the first of a sequence (Technique::forget).
  void forget();
  /// What all objects counted, each count as it says (Count::Together).
  Counts counts() const;

 private:
  std::unique_ptr<Technique> fresh() const;

  struct Object {
    std::unique_ptr<Technique> technique;
    std::size_t scene = 0;  ///< by number
    bool is_first = true;   ///< of its scene
    bool shares = false;    ///< what setup, build and update make, with the first
  };

  const TechniqueEntry& entry_;
  std::string settings_;
  const Technique* elsewhere_ = nullptr;  ///< the one that all share with
  std::vector<Object> objects_;
};

/// What several lights together are, where each is what `supports` says: unsupported when all are; else one that is unsupported
/// casts no shadows, and the whole is approximate with the reasons.
Support support_together(const std::vector<Light>& lights, const std::vector<Support>& supports);

}  // namespace gnomon
