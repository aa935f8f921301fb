#include "refinement.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gnomon::radiosity {

namespace {

/// What a row of form factors may sum to before it is scaled to 1. Rows err, and cutting off only those that err upward would
/// lose light; but with this reflectance light must not become more from shot to shot.
double most_row_sum(double reflectance) { return std::clamp(0.98 / reflectance, 1.0, 1.5); }

double sum(const glm::dvec3& color) { return color.x + color.y + color.z; }

}  // namespace

Refinement::Refinement(std::vector<PatchSide> sides)
    : sides_(std::move(sides)), unshot_(sides_.size(), glm::dvec3(0)), shares_(sides_.size()), reached_(sides_.size()) {
  double most = 0.1;
  for (const PatchSide& side : sides_)
    for (int c = 0; c < 3; ++c) most = std::max(most, side.reflectance[c]);
  most_row_sum_ = most_row_sum(most);
}

double Refinement::spread(const glm::dvec3& flux, std::span<const double> shares, double escaped,
                          std::vector<glm::dvec3>& got) {
  const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
  // Surfaces in the same place each get all that goes there: handed on for ever, that would be more and more. What escaped is
  // left out here: it is told by few rays, and rows that it makes too long by chance would all be cut.
  const double factor = total > most_row_sum_ ? 1 / total : 1;
  glm::dvec3 handed_on(0);
  for (std::size_t j = 0; j < sides_.size(); ++j) {
    if (shares[j] == 0) continue;
    const glm::dvec3 reflected = flux * factor * shares[j] * sides_[j].reflectance;
    got[j] += reflected;
    reached_[j] = 1;
    handed_on += reflected;
  }
  ledger_.unshot += handed_on;
  ledger_.absorbed += flux * (factor * total) - handed_on;
  ledger_.escaped += flux * escaped;
  ledger_.defect += flux * (1 - factor * total - escaped);
  return factor;
}

void Refinement::emit(const glm::dvec3& flux, std::span<const double> shares, double escaped) {
  ledger_.emitted += flux;
  spread(flux, shares, escaped, unshot_);
}

double Refinement::waiting_share() const {
  const double emitted = sum(ledger_.emitted);
  return emitted > 0 ? sum(ledger_.unshot - kept_sum_) / emitted : 0;
}

void Refinement::begin() {
  kept_.assign(unshot_.size(), glm::dvec3(0));
  kept_sum_ = glm::dvec3(0);
}

bool Refinement::shoot(Exchange& exchange, double rest, bool again) {
  if (waiting_share() <= rest) return false;
  const auto most = std::ranges::max_element(unshot_, {}, sum);
  if (most == unshot_.end() || !(sum(*most) > 0)) return false;
  const auto side = static_cast<std::uint32_t>(most - unshot_.begin());
  const glm::dvec3 flux = std::exchange(*most, glm::dvec3(0));
  ledger_.unshot -= flux;
  std::ranges::fill(shares_, 0.0);
  const double escaped = exchange.look(side, shares_);
  shot_ += sum(flux);
  landed_ += sum(flux) * (1 - escaped);
  const glm::dvec3 unshot = ledger_.unshot;
  const double factor = spread(flux, shares_, escaped, again ? unshot_ : kept_);
  if (!again) kept_sum_ += ledger_.unshot - unshot;
  exchange.send(factor * flux / sides_[side].area);
  return true;
}

void Refinement::end() {
  for (std::size_t i = 0; i < unshot_.size(); ++i) unshot_[i] += kept_[i];
  kept_sum_ = glm::dvec3(0);
}

glm::dvec3 Refinement::ambient() const {
  double area = 0;
  glm::dvec3 reflected(0), unshot(0);
  for (std::size_t j = 0; j < sides_.size(); ++j) {
    if (!reached_[j]) continue;
    area += sides_[j].area;
    reflected += sides_[j].area * sides_[j].reflectance;
  }
  for (const glm::dvec3& flux : unshot_) unshot += flux;
  const double landing = shot_ > 0 ? landed_ / shot_ : 1;
  return area > 0 ? unshot * landing / area / (1.0 - landing * reflected / area) : glm::dvec3(0);
}

std::size_t Refinement::bytes() const {
  return sides_.size() * sizeof(PatchSide) + shares_.size() * sizeof(double) + reached_.size() +
         (unshot_.size() + kept_.size()) * sizeof(glm::dvec3);
}

}  // namespace gnomon::radiosity
