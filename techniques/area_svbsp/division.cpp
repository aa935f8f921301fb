#include "division.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::area_svbsp {

namespace {

/// Twice the area over the longest distance from the first corner: at least the width of a convex polygon.
double width_of(std::span<const Corner> polygon) {
  glm::dvec3 area(0);
  double longest = 0;
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    const glm::dvec3 arm = polygon[i].at - polygon[0].at;
    longest = std::max(longest, glm::dot(arm, arm));
    if (i + 1 < polygon.size()) area += glm::cross(arm, polygon[i + 1].at - polygon[0].at);
  }
  return longest > 0 ? std::sqrt(glm::dot(area, area) / longest) : 0;
}

/// The axis along which corners are the farthest apart, by how much, and the middle between them.
struct Span {
  int axis = 0;
  double length = 0, middle = 0;
};
Span longest_span(std::span<const Corner> polygon) {
  glm::dvec3 low = polygon[0].at, high = low;
  for (const Corner& corner : polygon) {
    low = glm::min(low, corner.at);
    high = glm::max(high, corner.at);
  }
  Span span;
  for (int axis = 0; axis < 3; ++axis)
    if (high[axis] - low[axis] > span.length) span = {axis, high[axis] - low[axis], 0.5 * (low[axis] + high[axis])};
  return span;
}

}  // namespace

double seen_past(std::span<const CasterPolygon> casters, std::span<const std::uint32_t> polygons, const glm::dvec3& point,
                 const LightFigure& figure, VisibleArea& area) {
  area.start(figure);
  for (const std::uint32_t number : polygons) area.add(casters[number], point);
  return area.share();
}

void Divider::run(std::span<const Corner> polygon, const glm::dvec3& normal, std::span<const std::uint32_t> volumes,
                  std::uint64_t most_tests, Tree& tree, Work& work) {
  tree_ = &tree;
  work_ = &work;
  normal_ = normal;
  most_spent_ = work.spent() + most_tests;
  corners_.assign(polygon.begin(), polygon.end());
  lists_.assign(volumes.begin(), volumes.end());
  tree.root = divide({.part = {0, polygon.size()}, .list = {0, volumes.size()}, .crowd = {}});
}

Link Divider::divide(const Fragment& fragment) {
  const std::size_t corner_count = corners_.size(), list_size = lists_.size();
  Fragment filtered = fragment;
  std::size_t crossing_count = 0;
  const bool is_umbra = filter(filtered, crossing_count);
  const Link link = is_umbra ? counted(&Work::umbra, umbra_cell) : divide_filtered(filtered, crossing_count);
  corners_.resize(corner_count);
  lists_.resize(list_size);
  return link;
}

bool Divider::filter(Fragment& fragment, std::size_t& crossing_count) {
  const Volumes& all = *lighting_.volumes;
  const Slice old = fragment.list;
  fragment.list = {lists_.size(), 0};
  work_->tests += old.count;
  int crossing = 0;
  for (std::size_t k = 0; k < old.count; ++k) {
    const std::uint32_t number = lists_[old.first + k];
    const Volume& volume = all.all()[number];
    const Relation lies = relation(all.penumbra(volume), corners(fragment.part), rules_.epsilon, crossing);
    if (lies == Relation::outside) continue;
    fragment.is_dim |= lies == Relation::inside;
    crossing_count += lies == Relation::across;
    const std::span<const ClipPlane> umbra = all.umbra(volume);
    if (lies == Relation::inside && !umbra.empty() &&
        relation(umbra, corners(fragment.part), rules_.epsilon, crossing) == Relation::inside)
      return true;
    lists_.push_back(number);
  }
  fragment.list.count = lists_.size() - fragment.list.first;
  return false;
}

Link Divider::divide_filtered(Fragment& fragment, std::size_t crossing_count) {
  if (fragment.list.count == 0) return counted(&Work::lit, lit_cell);
  if (work_->spent() >= most_spent_) {
    ++work_->stopped;
    return add_penumbra(fragment, false);
  }
  if (width_of(corners(fragment.part)) < rules_.least_width) return add_penumbra(fragment, rules_.asks_corners);
  if (!fragment.is_dim && crossing_count > rules_.tile_size && 5 * crossing_count <= 4 * fragment.crowd.before)
    return halve(fragment, crossing_count);
  if (const std::span<const ClipPlane> planes = best_planes(fragment, fragment.is_dim); !planes.empty())
    return cut_by(fragment, planes, fragment.is_dim);
  // Volumes lie across it by the signs of its corners, but none has any area in it.
  if (!fragment.is_dim) return counted(&Work::lit, lit_cell);
  if (longest_span(corners(fragment.part)).length > rules_.largest) return halve(fragment, crossing_count);
  if (rules_.light_splits > 0 && lighting_.body->is_flat) return divide_light(fragment);
  return add_penumbra(fragment, rules_.asks_corners);
}

std::span<const ClipPlane> Divider::best_planes(const Fragment& fragment, bool of_umbra) {
  const Volumes& all = *lighting_.volumes;
  std::span<const ClipPlane> best;
  int fewest = std::numeric_limits<int>::max(), crossing = 0;
  for (std::size_t k = 0; k < fragment.list.count; ++k) {
    const Volume& v = volume(fragment.list.first + k);
    const std::span<const ClipPlane> planes = of_umbra ? all.umbra(v) : all.penumbra(v);
    if (planes.empty() || relation(planes, corners(fragment.part), rules_.epsilon, crossing) != Relation::across) continue;
    if (crossing >= fewest || !reaches_into(fragment.part, planes, of_umbra ? rules_.least_width : 0)) continue;
    fewest = crossing;
    best = planes;
    if (fewest == 1) break;
  }
  return best;
}

Link Divider::cut_by(Fragment fragment, std::span<const ClipPlane> planes, bool is_umbra) {
  Link first = lit_cell, last = lit_cell;
  bool has_node = false;
  const auto put = [&](Link link) {
    if (has_node)
      tree_->nodes[last].sides[1] = link;
    else
      first = link;
  };
  for (const ClipPlane& plane : planes) {
    values_.resize(std::max(values_.size(), fragment.part.count));
    if (classify(corners(fragment.part), plane, rules_.epsilon, values_.data()) != Lies::across) continue;
    ++work_->cuts;
    const auto [beyond, inside] = cut(fragment.part, plane);
    const auto node = static_cast<Link>(tree_->nodes.size());
    tree_->nodes.push_back({plane, {lit_cell, lit_cell}});
    put(node);
    last = node;
    has_node = true;
    const Link link = divide(with_part(fragment, beyond));
    tree_->nodes[node].sides[0] = link;
    fragment.part = inside;
  }
  fragment.is_dim = true;
  put(is_umbra ? counted(&Work::umbra, umbra_cell) : divide(fragment));
  return first;
}

Link Divider::halve(Fragment fragment, std::size_t crossing_count) {
  const Span span = longest_span(corners(fragment.part));
  ClipPlane plane{glm::dvec3(0), -span.middle};
  plane.normal[span.axis] = 1;
  ++work_->halved;
  fragment.crowd = {crossing_count, fragment.crowd.last};
  const auto [low, high] = cut(fragment.part, plane);
  const auto node = static_cast<Link>(tree_->nodes.size());
  tree_->nodes.push_back({plane, {lit_cell, lit_cell}});
  for (int side = 0; side < 2; ++side) {
    const Link link = divide(with_part(fragment, side == 0 ? low : high));
    tree_->nodes[node].sides[side] = link;
  }
  return node;
}

Link Divider::divide_light(Fragment& fragment) {
  polygons_.clear();
  for (const std::uint32_t v : volumes(fragment.list)) polygons_.push_back(lighting_.volumes->all()[v].polygon);
  if (share_at(middle(fragment.part), polygons_) > 1e-9) return add_penumbra(fragment, rules_.asks_corners);
  std::vector<ClipPlane> planes;
  if (is_hidden(fragment, *lighting_.body, rules_.light_splits, planes)) return counted(&Work::umbra, umbra_cell);
  return planes.empty() ? add_penumbra(fragment, rules_.asks_corners) : cut_by(fragment, planes, false);
}

bool Divider::is_hidden(const Fragment& fragment, const LightBody& light, int splits, std::vector<ClipPlane>& planes) {
  ++work_->light_parts;
  work_->tests += fragment.list.count;
  const PlaneMaker maker(light, rules_.epsilon);
  std::vector<ClipPlane> umbra, best;
  int crossing = 0;
  for (std::size_t k = 0; k < fragment.list.count; ++k) {
    const Volume& v = volume(fragment.list.first + k);
    const CasterPolygon& polygon = lighting_.casters->polygons[v.polygon];
    const ClipPlane& far = lighting_.volumes->penumbra(v)[0];
    if (!v.is_whole || lies_of(light, far, rules_.epsilon) != Lies::negative) continue;
    Corner own[4];
    for (std::uint32_t c = 0; c < polygon.count; ++c) own[c] = {glm::dvec3(polygon.corners[c])};
    umbra.assign(1, far);
    if (!maker.add_umbra({own, polygon.count}, umbra)) continue;
    for (std::size_t k = 1; k < umbra.size(); ++k) umbra[k].offset -= rounding * rules_.epsilon;
    const Relation lies = relation(umbra, corners(fragment.part), rules_.epsilon, crossing);
    if (lies == Relation::inside) return true;
    if (splits == 0 && best.empty() && lies == Relation::across && reaches_into(fragment.part, umbra, rules_.least_width))
      best = umbra;
  }
  if (splits == 0) {
    planes = best;
    return false;
  }
  for (const LightBody& half : halves(light))
    if (half.corners.size() < 3 || !is_hidden(fragment, half, splits - 1, planes)) return false;
  return true;
}

Link Divider::add_penumbra(const Fragment& fragment, bool has_corners) {
  polygons_.clear();
  const bool is_short = fragment.list.count <= 4 * rules_.most_listed;
  for (std::size_t k = 0; k < fragment.list.count; ++k) {
    const Volume& v = volume(fragment.list.first + k);
    if (!is_short || reaches_into(fragment.part, lighting_.volumes->penumbra(v), 0)) polygons_.push_back(v.polygon);
  }
  std::ranges::sort(polygons_);
  polygons_.erase(std::unique(polygons_.begin(), polygons_.end()), polygons_.end());
  if (polygons_.empty()) return counted(&Work::lit, lit_cell);
  ++work_->penumbra;
  Penumbra made{.first = static_cast<std::uint32_t>(tree_->polygons.size()),
                .count = static_cast<std::uint32_t>(polygons_.size()),
                .corner = static_cast<std::uint32_t>(tree_->corners.size()),
                .corner_count = 0};
  if (polygons_.size() > rules_.most_listed)
    made.count = Penumbra::open;
  else
    tree_->polygons.insert(tree_->polygons.end(), polygons_.begin(), polygons_.end());
  if (has_corners) {
    made.corner_count = static_cast<std::uint32_t>(fragment.part.count);
    const glm::dvec3 center = middle(fragment.part);
    // A little inside: where a polygon touches the receiver the share jumps at the corner itself.
    for (const Corner& corner : corners(fragment.part))
      tree_->corners.push_back({corner.at, share_at(corner.at + 1e-6 * (center - corner.at), polygons_)});
  }
  tree_->penumbras.push_back(made);
  return penumbra_cell(tree_->penumbras.size() - 1);
}

std::pair<Slice, Slice> Divider::cut(const Slice& part, const ClipPlane& plane) {
  values_.resize(std::max(values_.size(), part.count));
  const std::size_t first = corners_.size();
  corners_.resize(first + 2 * (part.count + 1));
  double epsilon = rules_.epsilon;
  if (classify(corners(part), plane, epsilon, values_.data()) != Lies::across) epsilon = 0;
  Corner* const negative = corners_.data() + first;
  const CutCounts counts = cut_polygon(corners(part), values_.data(), epsilon, 0, negative, negative + part.count + 1);
  return {{first, counts.negative}, {first + part.count + 1, counts.positive}};
}

bool Divider::reaches_into(const Slice& part, std::span<const ClipPlane> planes, double least_width) {
  clipper_.start(corners(part));
  for (const ClipPlane& plane : planes)
    if (!has_inside(clipper_.keep_positive(plane, rules_.epsilon))) return false;
  return width_of(clipper_.corners()) > std::max(least_width, rules_.epsilon);
}

glm::dvec3 Divider::middle(const Slice& part) const {
  glm::dvec3 sum(0);
  for (const Corner& corner : corners(part)) sum += corner.at;
  return sum / static_cast<double>(part.count);
}

double Divider::share_at(const glm::dvec3& point, std::span<const std::uint32_t> polygons) {
  const LightFigure figure(lighting_.light, point, normal_);
  if (!figure.is_seen()) return 1;
  work_->clips += polygons.size();
  return seen_past(lighting_.casters->polygons, polygons, point, figure, area_);
}

}  // namespace gnomon::area_svbsp
