#pragma once
#include <gnomon/kit/add_up.h>

#include <optional>
#include <vector>

#include "gathering.h"
#include "hemicube.h"
#include "refinement.h"
#include "surfaces.h"

namespace gnomon::radiosity {

enum class FormFactor { hemicube, rays, contour };
enum class Bounces { none, one, all };

struct Settings {
  FormFactor form_factor = FormFactor::contour;
  double patch_size = 0;  ///< meters
  int resolution = 0;     ///< of a hemicube, texels
  int samples = 1;        ///< rays
  int levels = 0;         ///< how often patches may be divided
  double contrast = 0;    ///< of the shares of the lamp seen within an element, beyond which it is divided
  Bounces bounces = Bounces::none;
  double rest = 0;                      ///< unshot share at the end
  std::uint64_t seed = 1;               ///< chooses the rays
  std::size_t most_elements = 1000000;  ///< that patches may be divided into
};

/// Direct light at a node, on one side: form factors to all parts of the lamp, summed: of the whole lamp and of what is seen.
struct Received {
  double whole = 0, seen = 0;
  Received& operator+=(const Received& other) { return add_up(*this, other, &Received::whole, &Received::seen); }
  Received operator*(double factor) const { return {whole * factor, seen * factor}; }
};

/// Light on all surfaces from one lamp. Direct light is found at the nodes of elements; what surfaces hand on varies slower and
/// is found at those of whole patches. Throws Error where elements become too many, or shots do not come to an end.
class Lighting final : private Exchange {
 public:
  /// `hemicube` may be null where form factors are found otherwise.
  Lighting(const Surfaces& surfaces, const Light& light, const Settings& settings, Hemicube* hemicube);

  const Division& division() const { return division_; }
  /// Of a node and a side, 0 in front.
  const Received& received(std::uint32_t node, int side) const { return received_[2 * node + side]; }
  /// Irradiance by color that surfaces give there; of the nodes of patches.
  const glm::dvec3& handed_on(std::uint32_t node, int side) const { return handed_on_[2 * node + side]; }
  /// The lamp's radiance times pi: what a form factor is multiplied by.
  double exitance() const { return exitance_; }
  glm::dvec3 ambient() const { return refinement_->ambient(); }
  /// Unshot light of a side of a patch, per square meter.
  glm::dvec3 unshot(std::uint32_t patch, int side) const;
  const Ledger& ledger() const { return refinement_->ledger(); }
  std::span<const Sender> lamps() const { return lamps_; }
  Sender sender_of(std::uint32_t patch, int side) const;
  /// Form factors from a side of a patch (twice the patch, plus the side) to all patches, summed: 1 in a closed room.
  double row_sum(std::uint32_t i);

  /// Shots for each patch after which light is taken never to be used up.
  static constexpr std::size_t most_shots_of_patch = 100;

  std::size_t element_count() const { return element_count_; }
  std::size_t factor_count() const { return factors_; }
  std::size_t ray_count() const { return rays_; }
  std::size_t shot_count() const { return shots_; }
  std::size_t bytes() const;

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// Sides that light may reach: not the inside of a closed body that the lamp is outside of.
  void find_sides();
  /// Chooses who gets light now: undivided elements or whole patches, at their nodes from `first_node` on and the sides that
  /// light may reach.
  enum class Cells { elements, patches };
  void choose(Cells which, std::size_t first_node);
  Receiving receiving(std::uint32_t place) const;
  /// What the lamps give these.
  void light_directly(std::size_t first_node);
  void light_by_hemicubes();
  /// Divides elements that shadow edges cross. Whether there were any.
  bool divide();
  /// Whether an element is large enough on the hemicubes of the lamp to be divided.
  bool fills_texels(const Element& element, std::uint32_t side) const;
  /// Whether corners and center see too different shares of the lamp.
  bool crosses_shadow_edge(const Element& element) const;
  void start_refinement();
  void bounce();
  double look(std::uint32_t patch, std::span<double> shares) override;
  void send(const glm::dvec3& exitance) override;
  /// Calls use(place, whole, seen) with form factors from the places to a sender; of one place several that add up.
  template <class Use>
  void gather(const Sender& sender, bool is_lamp, std::uint64_t seed, const Use& use);
  struct Drawn {
    std::vector<double> shares;
    double nothing{};  ///< the share that meets no cell
  };
  /// The form factors from a sender to the cells, by hemicube.
  Drawn draw(const Sender& sender);
  static std::uint32_t seen_side(const Face& face, const glm::dvec3& from);
  /// The seed of the first shot; the next ones count on.
  std::uint64_t first_shot() const { return settings_.seed << 32; }
  double escaped_share(const Sender& sender, bool is_lamp, int packets, std::uint64_t seed);
  /// Where light is found at centers alone, a corner has the mean of the elements around it.
  template <class Value>
  void average_at_corners(std::vector<Value>& values);

  const Surfaces& surfaces_;
  Settings settings_;
  Hemicube* hemicube_;
  Division division_;
  std::vector<Sender> lamps_;
  double exitance_ = 0;
  std::vector<std::uint8_t> has_back_;  ///< of each face
  std::vector<std::uint32_t> cells_;    ///< elements that get light now
  std::vector<std::uint32_t> cell_at_;  ///< of a node that is the center of one
  // A place is a node and a side: twice the one, plus the other.
  std::vector<std::uint32_t> places_;
  std::vector<Received> received_;     ///< by place
  std::vector<glm::dvec3> handed_on_;  ///< by place of the nodes of patches
  std::vector<double> looked_;         ///< form factors to the patch that looked last, the same way
  std::optional<Refinement> refinement_;
  std::size_t element_count_ = 0, factors_ = 0, rays_ = 0, shots_ = 0;
};

}  // namespace gnomon::radiosity
