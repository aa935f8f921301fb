#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
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
  explicit Refinement(std::vector<PatchSide> sides);

  /// Light of a lamp: `shares` as Exchange has them.
  void emit(const glm::dvec3& flux, std::span<const double> shares, double escaped);
  /// Sends on what is unshot, until no more than `rest` of all that was emitted waits, or after `most_shots`. What is got on
  /// the way waits as well if `again`, else it is kept. `told(waiting share)` is called now and then. Returns the shots made.
  template <class Told>
  std::size_t refine(Exchange& exchange, double rest, std::size_t most_shots, bool again, const Told& told) {
    begin();
    std::size_t shots = 0;
    for (; shots < most_shots && shoot(exchange, rest, again); ++shots)
      if (shots % 16 == 0) told(waiting_share());
    end();
    return shots;
  }

  const Ledger& ledger() const { return ledger_; }
  /// The share of all that was emitted which waits for its shot.
  double waiting_share() const;
  const glm::dvec3& unshot(std::size_t side) const { return unshot_[side]; }
  /// What a lack of shots leaves out, spread over all sides that light has reached: irradiance by color that all unshot light
  /// gives on the average, handed on for ever (the ambient term of the source), if as much of it escapes as of what was shot.
  glm::dvec3 ambient() const;
  std::size_t bytes() const;

 private:
  void begin();
  bool shoot(Exchange& exchange, double rest, bool again);
  void end();
  /// Adds to `got`, side by side, what these reflect. Returns what the shares were multiplied by.
  double spread(const glm::dvec3& flux, std::span<const double> shares, double escaped, std::vector<glm::dvec3>& got);

  std::vector<PatchSide> sides_;
  std::vector<glm::dvec3> unshot_, kept_;  ///< flux, by side; kept: got while `again` was false
  glm::dvec3 kept_sum_{0};
  std::vector<double> shares_;
  std::vector<std::uint8_t> reached_;  ///< whether a side got any
  double most_row_sum_ = 1;
  double shot_ = 0, landed_ = 0;  ///< flux of all colors that surfaces sent, and what of it came to surfaces
  Ledger ledger_;
};

}  // namespace gnomon::radiosity
