#include "cell.h"

namespace gnomon::two_pass_object {

void CellClipper::start(const Node& cell, double margin, std::span<const Footprint* const> footprints) {
  corners_.clear();
  near_.clear();
  casters_.clear();
  order_.clear();
  next_caster_ = 0;
  cover_.start();
  places_ = {cell.u0 - margin, cell.v0 - margin, cell.u1 + margin, cell.v1 + margin};
  borders_[0] = space_.border(face_, 0, places_.u0);
  borders_[1] = space_.border(face_, 0, places_.u1);
  borders_[2] = space_.border(face_, 1, places_.v0);
  borders_[3] = space_.border(face_, 1, places_.v1);
  for (const int k : {1, 3}) borders_[k] = -borders_[k];
  if (members_.size() < footprints.size()) members_.resize(footprints.size());
  for (std::uint32_t i = 0; i < footprints.size(); ++i) {
    const Footprint& f = *footprints[i];
    Member& m = members_[i];
    m.triangle = f.triangle;
    m.box = {std::max(f.u0, places_.u0), std::max(f.v0, places_.v0), std::min(f.u1, places_.u1), std::min(f.v1, places_.v1)};
    m.casts = triangles_.is(f.triangle, Triangles::casts);
    m.receives = triangles_.is(f.triangle, Triangles::receives);
    m.doubtful = triangles_.is(f.triangle, Triangles::doubtful);
    m.state = State::waiting;
    m.is_known = false;
    m.first = m.count = m.clips = m.first_near = m.near_count = 0;
    const Depths d = depths(space_, f, m.box);
    order_.push_back({d.nearest, i});
    if (m.casts && d.farthest < INFINITY) cover_.expect(d.farthest, std::min(f.area, m.box.area()), i);
  }
  std::sort(order_.begin(), order_.end());
}

/// A member with what the cell sees of it and its planes, found when it is first asked for.
CellClipper::Member& CellClipper::known(std::uint32_t index) {
  Member& m = members_[index];
  if (m.is_known) return m;
  m.is_known = true;
  cut_to_cell(m);
  if (m.count == 0 && !m.doubtful) {
    m.state = State::absent;
    return m;
  }
  for (int k = 0; k < 3; ++k) m.planes[k] = triangles_.side(m.triangle, k).unit();
  m.planes[3] = triangles_.cap(m.triangle).unit();
  const double height = std::abs(space_.height(m.planes[3]));
  double steepest = space_.is_parallel() ? height : INFINITY;
  m.nearest = INFINITY;
  m.farthest = -INFINITY;
  Places box{INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (const Corner& corner : polygon_of(m)) {
    const PlaceAndDepth s = space_.seen(face_, corner.at);
    m.nearest = std::min(m.nearest, s.depth);
    m.farthest = std::max(m.farthest, s.depth);
    if (!space_.is_parallel()) {
      steepest = std::min(steepest, height / glm::distance(corner.at, glm::dvec3(space_.light())));
      if (!space_.has_place(s.depth)) box = places_;
    }
    box.u0 = std::min(box.u0, s.u);
    box.u1 = std::max(box.u1, s.u);
    box.v0 = std::min(box.v0, s.v);
    box.v1 = std::max(box.v1, s.v);
  }
  m.reach = space_.rounding() / steepest;
  m.box = {std::max(box.u0, places_.u0), std::max(box.v0, places_.v0), std::min(box.u1, places_.u1),
           std::min(box.v1, places_.v1)};
  // A doubtful triangle may be anywhere.
  if (m.doubtful) {
    m.nearest = -INFINITY;
    m.farthest = INFINITY;
    m.box = places_;
  }
  return m;
}

void CellClipper::cut_to_cell(Member& m) {
  clipper_.start();
  for (const glm::vec3& p : triangles_[m.triangle].points) clipper_.add({p});
  for (const ClipPlane& border : borders_)
    if (!has_inside(clipper_.keep_positive(border, space_.epsilon()))) return;
  const std::span<const Corner> seen = clipper_.corners();
  m.first = static_cast<std::uint32_t>(corners_.size());
  m.count = static_cast<std::uint32_t>(seen.size());
  corners_.insert(corners_.end(), seen.begin(), seen.end());
}

/// Adds casters that may lie nearer than a depth.
void CellClipper::add_casters(double depth) {
  for (; next_caster_ < order_.size() && order_[next_caster_].nearest < depth; ++next_caster_) {
    const std::uint32_t i = order_[next_caster_].member;
    if (!members_[i].casts || members_[i].state == State::hidden || members_[i].state == State::dark) continue;
    if (known(i).state != State::absent) casters_.push_back(i);
  }
}

bool CellClipper::are_apart(const Member& receiver, const Member& caster) const {
  const double epsilon = space_.epsilon();
  const std::span<const Corner> polygon = polygon_of(receiver);
  for (int k = 0; k < 3; ++k) {
    double most = -INFINITY;
    for (const Corner& corner : polygon) most = std::max(most, caster.planes[k].at(corner.at));
    if (most <= epsilon) return true;
  }
  if (receiver.doubtful) return false;
  for (int k = 0; k < 3; ++k) {
    double most = -INFINITY;
    for (const glm::vec3& p : triangles_[caster.triangle].points) most = std::max(most, receiver.planes[k].at(glm::dvec3(p)));
    if (most <= epsilon) return true;
  }
  return false;
}

CellClipper::Verdict CellClipper::judge(const Member& receiver, const Member& caster) {
  if (caster.doubtful) return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
  double least = INFINITY, most = -INFINITY;
  for (const Corner& corner : polygon_of(receiver)) {
    const double value = caster.planes[3].at(corner.at);
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (most < -receiver.reach) return Verdict::apart;
  if (are_apart(receiver, caster)) return Verdict::apart;
  if (least > receiver.reach) return Verdict::cuts;
  // Only what the caster may shade counts.
  const std::span<const Corner> part = pieces_.part_inside(polygon_of(receiver), {caster.planes, 3}, space_.epsilon());
  if (part.empty()) return Verdict::apart;
  least = INFINITY;
  most = -INFINITY;
  for (const Corner& corner : part) {
    const double value = caster.planes[3].at(corner.at);
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (most < -receiver.reach) return Verdict::apart;
  if (least > receiver.reach) return Verdict::cuts;
  return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
}

void CellClipper::clip(const Node& cell, double margin, bool is_detail, std::span<const Footprint* const> footprints,
                       const Done& done, const Dark& dark) {
  ++work_.cells;
  start(cell, margin, footprints);
  for (const auto& [nearest, i] : order_) {
    Member& m = members_[i];
    cover_.take(space_, face_, places_, nearest, [&](std::uint32_t caster) { return known(caster).sides(); });
    if (is_detail || !cover_.is_closed()) known(i);
    if (m.state == State::absent) continue;
    if (cover_.is_closed() || (!m.doubtful && cover_.hides(m.sides(), space_.epsilon()))) {
      m.state = State::hidden;
      ++work_.hidden;
      if (is_detail) dark(m, polygon_of(m));
    } else if (m.doubtful && !is_detail) {
      m.state = State::asks;
    } else if (m.count > 0) {
      clip(i, is_detail, done, dark);
    }
    // What is in shadow throughout shades nothing that is not in shadow without it.
    if (m.casts && (m.state == State::hidden || m.state == State::dark)) std::erase(casters_, i);
  }
}

void CellClipper::clip(std::uint32_t index, bool is_detail, const Done& done, const Dark& dark) {
  const double farthest = members_[index].farthest + members_[index].reach;
  add_casters(farthest);
  Member& receiver = members_[index];
  receiver.first_near = static_cast<std::uint32_t>(near_.size());
  pieces_.start(polygon_of(receiver));
  receiver.state = State::lit;
  const Places& box = receiver.box;
  for (const std::uint32_t j : casters_) {
    const Member& caster = members_[j];
    if (j == index || caster.nearest >= farthest) continue;
    if (caster.box.u0 > box.u1 || caster.box.u1 < box.u0 || caster.box.v0 > box.v1 || caster.box.v1 < box.v0) continue;
    ++work_.pairs_tested;
    const Verdict verdict = judge(receiver, caster);
    if (verdict == Verdict::apart) continue;
    if (verdict == Verdict::near && !is_detail) {
      near_.push_back(caster.triangle);
      ++receiver.near_count;
      continue;
    }
    const Pieces::Cut cut = pieces_.take({caster.planes, verdict == Verdict::near ? 4u : 3u}, caster.triangle, space_.epsilon(),
                                         [&](std::span<const Corner> part) { dark(receiver, part); });
    if (cut.shadowed == 0) continue;
    receiver.state = State::cut;
    ++receiver.clips;
    ++work_.pairs_clipped;
    work_.splits += cut.splits;
    work_.shadowed += cut.shadowed;
    if (pieces_.size() == 0) break;
  }
  if (pieces_.size() == 0) receiver.state = State::dark;
  work_.lit += pieces_.size();
  work_.near += receiver.near_count;
  if (receiver.receives) done(index, pieces_);
}

}  // namespace gnomon::two_pass_object
