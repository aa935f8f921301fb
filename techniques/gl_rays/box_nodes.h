#pragma once
#include <gnomon/scene.h>

#include <cstdint>
#include <span>
#include <vector>

// A tree of boxes as a shader walks it: without a stack, over one array.
namespace gnomon::gl_rays {

/// A box, as a buffer of layout std430 holds it. Boxes lie in depth-first order: the first child of an inner node is the next
/// node, and a node whose box is missed is left together with all it holds by `skip`.
struct Node {
  glm::vec3 low{0};
  std::int32_t skip = 0;  ///< the node after the last one below this one
  glm::vec3 high{0};
  std::int32_t leaf = -1;  ///< of a leaf: 16 times its first place, plus how many there are; of an inner node -1

  bool is_leaf() const { return leaf >= 0; }
  std::uint32_t first() const { return static_cast<std::uint32_t>(leaf) / 16; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(leaf) % 16; }
  Bounds box() const { return {low, high}; }
};
static_assert(sizeof(Node) == 32);

/// Places of a leaf, at most.
inline constexpr std::uint32_t leaf_size = 4;
/// Items of a tree, at most: the places of their corners fit 32 bits.
inline constexpr std::size_t most_items = std::size_t{1} << 27;

struct BoxNodes {
  std::vector<Node> nodes;
  std::vector<std::uint32_t> order;  ///< order[place] is the number of the item there
};

/// Of items with these boxes, none of which is empty; at most `most_items`. Splits by the surface area heuristic (Goldsmith and
/// Salmon 1987) between 16 bins of the centers along each axis (Wald 2007); where centers tell nothing apart, and below 48
/// levels, in half by count. A leaf stays one where a split would not lower the cost. On all threads; the tree is the same on
/// any number of them. At most two nodes an item.
BoxNodes build_nodes(std::span<const Bounds> boxes);

/// What a ray that meets the box of the whole tests on the mean, boxes and items, by the surface area heuristic; 0 where that
/// box has no area.
double cost(std::span<const Node> nodes);

/// Items have moved: bounds_at(place) is where each is now. Which box holds which stays.
template <class BoundsAt>
void refit(std::span<Node> nodes, const BoundsAt& bounds_at) {
  // Children come after their parent: the next node, and the one that this one skips to.
  for (std::size_t i = nodes.size(); i-- > 0;) {
    Node& node = nodes[i];
    Bounds box;
    if (node.is_leaf()) {
      for (std::uint32_t k = 0; k < node.count(); ++k) box.add(bounds_at(node.first() + k));
    } else {
      box = nodes[i + 1].box();
      box.add(nodes[static_cast<std::size_t>(nodes[i + 1].skip)].box());
    }
    node.low = box.min;
    node.high = box.max;
  }
}

}  // namespace gnomon::gl_rays
