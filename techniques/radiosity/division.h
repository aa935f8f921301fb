#pragma once
#include <cmath>
#include <unordered_map>

#include "faces.h"

namespace gnomon::radiosity {

/// A point at which light is found: the center of an element, or one of its corners.
struct Node {
  glm::dvec3 point;  ///< world; a corner on its face's border a little inside
  std::uint32_t face;
  glm::dvec2 place;  ///< on the face
};

/// A cell of a face: of a parallelogram the places low .. low + step, of a triangle half of that, low, low + (step.x, 0) and
/// low + (0, step.y), where a step below zero turns it around.
struct Element {
  std::uint32_t face = 0, patch = 0;  ///< patch: of Division::patch_count()
  glm::dvec2 low{0}, step{1};
  std::uint32_t first_child = 0;           ///< of four; 0: it is not divided
  std::uint32_t center = 0;                ///< node
  std::array<std::uint32_t, 4> corners{};  ///< nodes; at (0, 0), (1, 0), (0, 1), (1, 1) of the step
  std::uint32_t level = 0;                 ///< 0: a whole patch
  bool is_divided() const { return first_child != 0; }
};

/// All faces of a scene in patches, and the patches in elements: by a grid, then by quadtrees. Patches send light, elements get
/// it (Cohen, Greenberg, Immel and Brock 1986).
class Division {
 public:
  static constexpr std::uint32_t most_levels = 8;

  Division() = default;
  /// Patches no longer than `size` meters along the sides of their face. The faces must outlive it.
  Division(const Faces& faces, double size);
  /// How many patches that would be.
  static double patch_count(const Faces& faces, double size);

  const Faces& faces() const { return *faces_; }
  /// Undivided ones and divided ones; first the patches.
  const std::vector<Element>& elements() const { return elements_; }
  std::size_t patch_count() const { return patch_count_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  const Face& face_of(const Element& element) const { return (*faces_)[element.face]; }
  double area(const Element& element) const { return face_of(element).area() * std::abs(element.step.x * element.step.y); }
  /// Where the element has its corners: four, or three of a triangle.
  std::size_t corner_count(const Element& element) const { return face_of(element).is_triangle ? 3 : 4; }
  /// The corners in order around it, world space; of a triangle three.
  std::array<glm::dvec3, 4> outline(const Element& element) const;

  /// Divides an element into four, with the nodes that this takes.
  void divide(std::uint32_t element);
  /// The undivided element that holds a place of a face; places outside count as the nearest inside.
  std::uint32_t element_at(std::uint32_t face, glm::dvec2 place) const;
  /// Weights of an element's corners at a place of its face, in their order: bilinear, of a triangle linear.
  std::array<double, 4> weights(const Element& element, const glm::dvec2& place) const;
  std::size_t bytes() const { return bytes_of(elements_, nodes_, grids_, corner_at_); }

 private:
  struct Grid {
    std::uint32_t first;          ///< patch
    std::uint32_t columns, rows;  ///< of a triangle both are the number of rows
  };
  static glm::uvec2 grid_of(const Face& face, double size);
  void add_nodes(Element& element);
  std::uint32_t corner_node(const Element& element, const glm::dvec2& place, const glm::dvec2& center);

  const Faces* faces_ = nullptr;
  std::vector<Grid> grids_;  // of each face
  std::vector<Element> elements_;
  std::size_t patch_count_ = 0;
  std::vector<Node> nodes_;
  /// A corner's face, and its place in steps of the finest level.
  struct CornerKey {
    std::uint32_t face, x, y;
    bool operator==(const CornerKey&) const = default;
  };
  struct CornerHash {
    std::size_t operator()(const CornerKey& key) const {
      return ((std::uint64_t{key.x} << 32 | key.y) ^ key.face * 0x9e3779b97f4a7c15u) * 0xff51afd7ed558ccdu;
    }
  };
  std::unordered_map<CornerKey, std::uint32_t, CornerHash> corner_at_;  // node
};

}  // namespace gnomon::radiosity
