#include "lighting.h"

#include <gnomon/error.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/progress.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "form_factor.h"

namespace gnomon::radiosity {

namespace {

constexpr int lamp_escape_packets = 64;  ///< of rays that tell how much of a part of the lamp's light meets no surface

/// On a hemicube an element is divided only while it fills so many texels of the top: with fewer, what it gets is more aliasing
/// than shadow.
constexpr double texels_to_divide = 256;

/// Whether a mesh hides all that is inside of its parts from a lamp that is outside of them.
bool is_shut(std::span<const Bounds> solid_parts, const Bounds& lamp) {
  const auto is_outside = [&](const Bounds& part) {
    return glm::any(glm::greaterThan(lamp.min, part.max)) || glm::any(glm::lessThan(lamp.max, part.min));
  };
  return !solid_parts.empty() && std::ranges::all_of(solid_parts, is_outside);
}

/// Points of a rule of Gauss along each side of an element that a near sender is averaged over.
int order_for(double distance, double sizes) {
  return distance > 5 * sizes ? 1 : distance > 2.5 * sizes ? 2 : distance > sizes ? 4 : 8;
}

/// The longest of an outline's sides.
double longest_side(std::span<const glm::dvec3> outline) {
  double longest = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    longest = std::max(longest, glm::distance(outline[i], outline[i + 1 < outline.size() ? i + 1 : 0]));
  return longest;
}

}  // namespace

Lighting::Lighting(const Surfaces& surfaces, const Light& light, const Settings& settings, Hemicube* hemicube)
    : surfaces_(surfaces),
      settings_(settings),
      hemicube_(hemicube),
      division_(*surfaces.patches),
      lamps_(senders_of(light, settings.patch_size)),
      exitance_(std::numbers::pi * light.intensity) {
  find_sides();
  light_directly(0);
  for (int level = 0; level < settings_.levels; ++level) {
    const std::size_t lit_before = division_.nodes().size();
    if (!divide()) break;
    if (settings_.bounces == Bounces::none) tell_progress((level + 1.0) / (settings_.levels + 1));
    light_directly(settings_.form_factor == FormFactor::hemicube ? 0 : lit_before);
  }
  start_refinement();
  if (settings_.bounces != Bounces::none) bounce();
}

void Lighting::find_sides() {
  Bounds lamp;
  for (const Sender& sender : lamps_)
    for (const glm::dvec3& corner : sender.polygon()) lamp.add(glm::vec3(corner));
  std::vector<std::uint8_t> shut;
  for (const std::vector<Bounds>& parts : surfaces_.solid_parts) shut.push_back(is_shut(parts, lamp));
  for (const Face& face : surfaces_.faces->all()) has_back_.push_back(!shut[face.mesh]);
}

void Lighting::choose(Cells which, std::size_t first_node) {
  cells_.clear();
  places_.clear();
  cell_at_.assign(division_.nodes().size(), none);
  std::vector<std::uint8_t> is_used(division_.nodes().size());
  const std::size_t count = which == Cells::patches ? division_.patch_count() : division_.elements().size();
  for (std::uint32_t e = 0; e < count; ++e) {
    const Element& element = division_.elements()[e];
    if (which == Cells::elements && element.is_divided()) continue;
    cell_at_[element.center] = static_cast<std::uint32_t>(cells_.size());
    cells_.push_back(e);
    is_used[element.center] = 1;
    if (settings_.form_factor == FormFactor::hemicube) continue;
    for (std::size_t k = 0; k < division_.corner_count(element); ++k) is_used[element.corners[k]] = 1;
  }
  for (std::size_t node = first_node; node < is_used.size(); ++node)
    for (const int side : {0, 1})
      if (is_used[node] && (side == 0 || has_back_[division_.nodes()[node].face]))
        places_.push_back(static_cast<std::uint32_t>(2 * node + side));
  if (settings_.form_factor == FormFactor::hemicube) hemicube_->show(division_, cells_);
}

Receiving Lighting::receiving(std::uint32_t place) const {
  const Node& node = division_.nodes()[place / 2];
  const Face& face = division_.faces()[node.face];
  return {node.point, place % 2 ? -face.normal : face.normal, face.mesh, face.triangle_at(node.place), place};
}

template <class Use>
void Lighting::gather(const Sender& sender, bool is_lamp, std::uint64_t seed, const Use& use) {
  const Gathering gathering(is_lamp ? *surfaces_.casters : *surfaces_.all,
                            settings_.form_factor == FormFactor::rays ? Way::rays : Way::contour, settings_.samples);
  const glm::dvec3 center = sender.center();
  const double sender_size = longest_side(sender.polygon());
  std::atomic<std::size_t> rays = 0, factors = 0;
  for_blocks(places_.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<Receiving> points;
    std::vector<std::pair<std::uint32_t, double>> owners;  // place and weight of each point
    for (std::size_t i = begin; i < end; ++i) {
      const Receiving at = receiving(places_[i]);
      // In the sender's plane nothing is got, and rounding decides on which side of it.
      const glm::dvec3 to = at.point - center;
      const std::uint32_t leaf = cell_at_[places_[i] / 2];
      const Element* element = leaf == none ? nullptr : &division_.elements()[cells_[leaf]];
      const std::array outline = element ? division_.outline(*element) : std::array<glm::dvec3, 4>();
      const double size = element ? longest_side({outline.data(), division_.corner_count(*element)}) : 0;
      if (glm::dot(to, sender.normal) <= 1e-6 * glm::length(to) - (element ? size : 0)) continue;
      const int order = element ? order_for(glm::length(to), size + sender_size) : 1;
      if (order == 1) {
        points.push_back(at);
        owners.push_back({places_[i], 1});
        continue;
      }
      const Face& face = division_.face_of(*element);
      std::uint64_t number = at.number << 32;
      for (const GaussPoint& part : gauss_points(order, face.is_triangle)) {
        const glm::dvec2 place = element->low + element->step * part.place;
        points.push_back({face.at(place), at.normal, at.mesh, face.triangle_at(place), ++number, 1.0 / (order * order)});
        owners.push_back({places_[i], part.weight});
      }
    }
    std::vector<Factor> found(points.size());
    rays += gathering.factors(sender, is_lamp, points, seed, found);
    factors += points.size();
    for (std::size_t k = 0; k < points.size(); ++k)
      if (found[k].whole > 0) use(owners[k].first, owners[k].second * found[k].whole, owners[k].second * found[k].seen);
  });
  rays_ += rays;
  factors_ += factors;
}

void Lighting::light_directly(std::size_t first_node) {
  choose(Cells::elements, first_node);
  received_.resize(2 * division_.nodes().size());
  if (settings_.form_factor == FormFactor::hemicube) return light_by_hemicubes();
  for (std::size_t k = 0; k < lamps_.size(); ++k)
    gather(lamps_[k], true, first_shot() + k, [&](std::uint32_t place, double whole, double seen) {
      received_[place].whole += whole;
      received_[place].seen += seen;
    });
}

void Lighting::light_by_hemicubes() {
  received_.assign(received_.size(), {});
  for (const Sender& lamp : lamps_) {
    const std::vector<double> shares = draw(lamp).shares;
    for (const std::uint32_t place : places_) {
      const std::uint32_t leaf = cell_at_[place / 2];
      const Element& element = division_.elements()[cells_[leaf]];
      const Receiving at = receiving(place);
      const glm::dvec3 to = at.point - lamp.center();
      if (glm::dot(to, lamp.normal) <= 1e-6 * glm::length(to)) continue;
      received_[place].whole += factor_at(at.point, at.normal, lamp.polygon());
      if (place % 2 == seen_side(division_.face_of(element), lamp.center()))
        received_[place].seen += shares[leaf] * lamp.area / division_.area(element);
    }
  }
  average_at_corners(received_);
}

std::uint32_t Lighting::seen_side(const Face& face, const glm::dvec3& from) {
  return glm::dot(face.normal, from - face.corner) > 0 ? 0 : 1;
}

Lighting::Drawn Lighting::draw(const Sender& sender) {
  Drawn drawn{.shares = std::vector<double>(cells_.size())};
  drawn.nothing = hemicube_->look(sender.center(), sender.normal, settings_.resolution, drawn.shares);
  factors_ += cells_.size();
  return drawn;
}

template <class Value>
void Lighting::average_at_corners(std::vector<Value>& values) {
  std::vector<std::uint32_t> counts(values.size());
  const auto for_corners = [&](const auto& use) {
    for (const std::uint32_t e : cells_) {
      const Element& element = division_.elements()[e];
      for (std::size_t k = 0; k < division_.corner_count(element); ++k)
        for (const std::uint32_t side : {0u, 1u}) use(2 * element.corners[k] + side, 2 * element.center + side);
    }
  };
  for_corners([&](std::uint32_t corner, std::uint32_t) {
    values[corner] = Value();
    ++counts[corner];
  });
  for_corners([&](std::uint32_t corner, std::uint32_t center) { values[corner] += values[center] * (1.0 / counts[corner]); });
}

bool Lighting::fills_texels(const Element& element, std::uint32_t side) const {
  const double delta = 4 / (std::numbers::pi * settings_.resolution * settings_.resolution);
  const double of_one_part = received_[2 * element.center + side].whole / static_cast<double>(lamps_.size());
  return of_one_part * division_.area(element) / lamps_[0].area >= texels_to_divide * delta;
}

bool Lighting::crosses_shadow_edge(const Element& element) const {
  for (const std::uint32_t side : {0u, 1u}) {
    if (settings_.form_factor == FormFactor::hemicube && !fills_texels(element, side)) continue;
    double least = 1, most = 0;
    const auto add = [&](std::uint32_t node) {
      const Received& here = received_[2 * node + side];
      if (!(here.whole > 0)) return;
      least = std::min(least, here.seen / here.whole);
      most = std::max(most, here.seen / here.whole);
    };
    add(element.center);
    for (std::size_t k = 0; k < division_.corner_count(element); ++k) add(element.corners[k]);
    if (most - least > settings_.contrast) return true;
  }
  return false;
}

bool Lighting::divide() {
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t leaf : cells_)
    if (crosses_shadow_edge(division_.elements()[leaf])) chosen.push_back(leaf);
  if (const std::size_t count = cells_.size() + 3 * chosen.size(); count > settings_.most_elements)
    throw Error(
        "levels = {} divides the patches into {} elements and more; at most {}: a larger patch_size or contrast, or more "
        "samples, make fewer",
        settings_.levels, count, settings_.most_elements);
  for (const std::uint32_t leaf : chosen) division_.divide(leaf);
  return !chosen.empty();
}

Sender Lighting::sender_of(std::uint32_t patch, int side) const {
  const Element& element = division_.elements()[patch];
  const Face& face = division_.face_of(element);
  const std::array outline = division_.outline(element);
  return make_sender({outline.data(), division_.corner_count(element)}, side ? -face.normal : face.normal);
}

void Lighting::start_refinement() {
  choose(Cells::elements, 0);
  element_count_ = cells_.size();
  std::vector<PatchSide> sides;
  for (std::size_t p = 0; p < division_.patch_count(); ++p) {
    const Element& patch = division_.elements()[p];
    const glm::dvec3 albedo(surfaces_.scene->meshes[division_.face_of(patch).mesh].albedo);
    sides.insert(sides.end(), 2, {division_.area(patch), albedo});
  }
  double flux = 0, escaped = 0;
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    flux += exitance_ * lamps_[k].area;
    escaped += exitance_ * lamps_[k].area * escaped_share(lamps_[k], true, lamp_escape_packets, first_shot() + k);
  }
  std::vector<double> shares(sides.size());
  for (const std::uint32_t e : cells_) {
    const Element& element = division_.elements()[e];
    for (const std::uint32_t side : {0u, 1u})
      shares[2 * element.patch + side] += received_[2 * element.center + side].seen * exitance_ * division_.area(element) /
                                          flux * surfaces_.solid_share(element.patch);
  }
  refinement_.emplace(std::move(sides));
  refinement_->emit(glm::dvec3(flux), shares, escaped / flux);
  handed_on_.assign(2 * surfaces_.patches->nodes().size(), glm::dvec3(0));
}

void Lighting::bounce() {
  choose(Cells::patches, 0);
  const double first = refinement_->waiting_share();
  const std::size_t most_shots = most_shots_of_patch * division_.patch_count();
  const auto tell = [&](double waiting) {
    // Light becomes less by nearly the same factor from shot to shot.
    if (waiting > 0 && settings_.rest < first) tell_progress(std::log(first / waiting) / std::log(first / settings_.rest));
  };
  if (refinement_->refine(*this, settings_.rest, most_shots, settings_.bounces == Bounces::all, tell) == most_shots)
    throw Error(
        "unshot = {} is not reached: after {} shots, {} for each patch, {:.2g} of the light is left; surfaces reflect "
        "nearly all of it, and a larger unshot ends sooner",
        settings_.rest, most_shots, most_shots_of_patch, refinement_->waiting_share());
  if (settings_.form_factor == FormFactor::hemicube) average_at_corners(handed_on_);
}

double Lighting::look(std::uint32_t i, std::span<double> shares) {
  looked_.assign(handed_on_.size(), 0);
  const Sender sender = sender_of(i / 2, i % 2);
  const std::uint64_t seed = first_shot() + lamps_.size() + shots_++;
  if (settings_.form_factor == FormFactor::hemicube) {
    const auto& [seen, nothing] = draw(sender);
    for (std::uint32_t p = 0; p < seen.size(); ++p) {
      if (seen[p] == 0) continue;
      const Element& patch = division_.elements()[p];
      const std::uint32_t side = seen_side(division_.face_of(patch), sender.center());
      looked_[2 * patch.center + side] += seen[p] * sender.area / division_.area(patch);
      shares[2 * p + side] += seen[p];
    }
    return nothing;
  }
  gather(sender, false, seed, [&](std::uint32_t place, double, double seen) {
    looked_[place] += seen;
    if (const std::uint32_t p = cell_at_[place / 2]; p != none)
      shares[2 * p + place % 2] += seen * division_.area(division_.elements()[p]) / sender.area * surfaces_.solid_share(p);
  });
  return escaped_share(sender, false, 1, seed);
}

void Lighting::send(const glm::dvec3& exitance) {
  for (const std::uint32_t place : places_) handed_on_[place] += exitance * looked_[place];
}

double Lighting::escaped_share(const Sender& sender, bool is_lamp, int packets, std::uint64_t seed) {
  rays_ += 16 * static_cast<std::size_t>(packets);
  return radiosity::escaped_share(*surfaces_.all, sender, is_lamp, packets, seed);
}

double Lighting::row_sum(std::uint32_t i) {
  choose(Cells::patches, 0);
  std::vector<double> shares(2 * division_.patch_count());
  look(i, shares);
  return std::accumulate(shares.begin(), shares.end(), 0.0);
}

glm::dvec3 Lighting::unshot(std::uint32_t patch, int side) const {
  return refinement_->unshot(2 * patch + side) / division_.area(division_.elements()[patch]);
}

std::size_t Lighting::bytes() const {
  return division_.bytes() + refinement_->bytes() +
         bytes_of(lamps_, has_back_, cells_, cell_at_, places_, received_, handed_on_, looked_);
}

}  // namespace gnomon::radiosity
