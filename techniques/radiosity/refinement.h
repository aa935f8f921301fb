#pragma once
#include <gnomon/kit/bytes.h>

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace gnomon::radiosity {

/// One side of a patch.
struct PatchSide {
  double area = 0;            ///< square meters
  glm::dvec3 reflectance{0};  ///< of what it gets, by color, below 1
};

/// Where the light is that the lamps gave: flux by color, in units of radiance times square meters. All that was emitted is in
/// one of the others. `defect` is what shots lost or made because form factors are not exact: of a shot the rest to 1 of what
/// they and what escaped add up to. Where form factors alone add up to far more than 1, surfaces lie in the same place, and the
/// shot is shared among them.
struct Ledger {
  glm::dvec3 emitted{0}, absorbed{0}, unshot{0}, escaped{0}, defect{0};
};

/// Finds form factors, shot by shot.
class Exchange {
 public:
  virtual ~Exchange() = default;
  /// `shares[j]` becomes the share of the light which side i of a patch sends that goes to side j, its form factor; the result
  /// is the share that meets no surface.
  virtual double look(std::uint32_t i, std::span<double> shares) = 0;
  /// The side that looked last sends so much, per square meter, to all that it saw.
  virtual void send(const glm::dvec3& exitance) = 0;
};

/// Progressive refinement (Cohen, Chen, Wallace and Greenberg 1988): again and again the side of a patch that has most light to
/// hand on sends it to all it sees.
class Refinement {
 public:
  explicit Refinement(std::vector<PatchSide> sides)
      : sides_(std::move(sides)), unshot_(sides_.size(), glm::dvec3(0)), shares_(sides_.size()), reached_(sides_.size()) {
    double most = 0.1;
    for (const PatchSide& side : sides_)
      for (int c = 0; c < 3; ++c) most = std::max(most, side.reflectance[c]);
    // Rows err, and cutting off only those that err upward would lose light; but with this reflectance light must not become
    // more from shot to shot.
    most_row_sum_ = std::clamp(0.98 / most, 1.0, 1.5);
  }

  /// Light of a lamp: `shares` as Exchange has them.
  void emit(const glm::dvec3& flux, std::span<const double> shares, double escaped) {
    ledger_.emitted += flux;
    spread(flux, shares, escaped, unshot_);
  }
  /// Sends on what is unshot, until no more than `rest` of all that was emitted waits, or after `most_shots`. What is got on
  /// the way waits as well if `again`, else it is kept. `told(waiting share)` is called now and then. Returns the shots made.
  template <class Told>
  std::size_t refine(Exchange& exchange, double rest, std::size_t most_shots, bool again, const Told& told) {
    kept_.assign(unshot_.size(), glm::dvec3(0));
    kept_sum_ = glm::dvec3(0);
    std::size_t shots = 0;
    for (; shots < most_shots && shoot(exchange, rest, again); ++shots)
      if (shots % 16 == 0) told(waiting_share());
    for (std::size_t i = 0; i < unshot_.size(); ++i) unshot_[i] += kept_[i];
    kept_sum_ = glm::dvec3(0);
    return shots;
  }

  const Ledger& ledger() const { return ledger_; }
  /// The share of all that was emitted which waits for its shot.
  double waiting_share() const {
    const double emitted = sum(ledger_.emitted);
    return emitted > 0 ? sum(ledger_.unshot - kept_sum_) / emitted : 0;
  }
  const glm::dvec3& unshot(std::size_t side) const { return unshot_[side]; }
  /// What a lack of shots leaves out, spread over all sides that light has reached: irradiance by color that all unshot light
  /// gives on the average, handed on for ever (the ambient term of the source), if as much of it escapes as of what was shot.
  glm::dvec3 ambient() const {
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
  std::size_t bytes() const { return bytes_of(sides_, unshot_, kept_, shares_, reached_); }

 private:
  static double sum(const glm::dvec3& color) { return color.x + color.y + color.z; }
  bool shoot(Exchange& exchange, double rest, bool again) {
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
  /// Adds to `got`, side by side, what these reflect. Returns what the shares were multiplied by.
  double spread(const glm::dvec3& flux, std::span<const double> shares, double escaped, std::vector<glm::dvec3>& got) {
    const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
    // Surfaces in the same place each get all that goes there: handed on for ever, that would be more and more. What escaped is
    // left out here: few rays estimate it, and rows that it makes too long by chance would all be cut.
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

  std::vector<PatchSide> sides_;
  std::vector<glm::dvec3> unshot_, kept_;  ///< flux, by side; kept: got while `again` was false
  glm::dvec3 kept_sum_{0};
  std::vector<double> shares_;
  std::vector<std::uint8_t> reached_;  ///< whether a side got any
  double most_row_sum_ = 1;            ///< what a row of form factors may sum to before it is scaled to 1
  double shot_ = 0, landed_ = 0;       ///< flux of all colors that surfaces sent, and what of it came to surfaces
  Ledger ledger_;
};

}  // namespace gnomon::radiosity
