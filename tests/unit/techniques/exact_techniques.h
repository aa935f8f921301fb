#pragma once
// The exact techniques of lights without area, the settings in which the oracle checks them, and what they owe it.
#include <gnomon/registry.h>

extern "C" {
void gnomon_technique_alias_free_map(gnomon::Registry& registry);
void gnomon_technique_crow_counting(gnomon::Registry& registry);
void gnomon_technique_exact_rays(gnomon::Registry& registry);
void gnomon_technique_shadow_volume_tree(gnomon::Registry& registry);
void gnomon_technique_svbsp(gnomon::Registry& registry);
void gnomon_technique_two_pass_object(gnomon::Registry& registry);
}

namespace gnomon::exact_oracle {

/// What a technique owes an answer.
enum class Owes {
  all,
  proper,  ///< not where the way to the light goes exactly through an edge or a vertex, and through nothing else
  clear    ///< nor within its own epsilon, as questions.h has it, nor off its own triangle by more than rounding
};

struct ExactTechnique {
  void (*roll)(Registry&);  ///< its registration function
  std::vector<std::string> settings = {""};
  bool takes_turns = true;                           ///< one of them in a round of random scenes; else all of them
  std::vector<std::string> settings_at_size = {""};  ///< those that take little time for many triangles
  int many_triangles = 12'000;                       ///< which are these
  Owes owes = Owes::all;
  /// What explain() names is a triangle, counted over the scene, that blocks the way; named where the mask is dark.
  bool names_casters = true;

  std::vector<std::string> settings_in(int round) const {
    return takes_turns ? std::vector{settings[static_cast<std::size_t>(round) % settings.size()]} : settings;
  }
  std::string id() const { return entry().id; }
  std::unique_ptr<Technique> make() const { return entry().make(); }

 private:
  TechniqueEntry entry() const {
    Registry registry;
    roll(registry);
    return registry.techniques()[0];
  }
};
inline void PrintTo(const ExactTechnique& technique, std::ostream* out) { *out << technique.id(); }

/// Those that decide every point on its own triangle by exact signs, whatever is close to it.
inline std::vector<ExactTechnique> without_epsilon() {
  return {{.roll = gnomon_technique_alias_free_map,
           .settings = {"", "resolution=16", "resolution=32", "resolution=64", "resolution=128", "resolution=256",
                        "resolution=512", "resolution=1024"}},
          {.roll = gnomon_technique_crow_counting, .many_triangles = 500, .owes = Owes::proper, .names_casters = false},
          {.roll = gnomon_technique_exact_rays, .names_casters = false},
          {.roll = gnomon_technique_shadow_volume_tree,
           .settings = {"", "seed=2", "order=random", "order=scene", "order=near_first", "early_out=false", "wedge=false",
                        "order=scene,early_out=false,wedge=false", "order=near_first,early_out=false,wedge=false"},
           .takes_turns = false,
           .settings_at_size = {"", "order=near_first"}},
          {.roll = gnomon_technique_two_pass_object,
           .settings = {"", "cell_triangles=2", "cell_triangles=4", "cell_triangles=256"}}};
}

inline std::vector<ExactTechnique> exact_techniques() {
  std::vector<ExactTechnique> all = without_epsilon();
  all.push_back({.roll = gnomon_technique_svbsp,
                 .settings = {"", "order=bsp", "order=bsp,split=first", "order=bsp,free_cuts=false,split=fewest_splits",
                              "order=face_planes"},
                 .settings_at_size = {"", "order=bsp", "order=face_planes"},
                 .owes = Owes::clear});
  return all;
}

}  // namespace gnomon::exact_oracle
