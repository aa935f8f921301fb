#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "half.h"
#include "mesh_distances.h"

namespace gnomon::distance_field {

/// Where the samples of a mesh's field are: at the corners of cubic voxels, which fill the mesh's box and `margin` more on
/// each side.
struct Frame {
  static constexpr int margin = 1;
  static constexpr double half_plate = 0.5;  ///< voxels, of an open mesh

  glm::dvec3 low{0};       ///< the first sample
  double voxel = 0;        ///< side, meters; 0: the mesh has no extent and no field
  double per_meter = 0;    ///< voxels
  glm::ivec3 cells{0};     ///< voxels along x, y and z
  bool is_closed = false;  ///< distances within the mesh are negative

  Frame() = default;
  /// `resolution` voxels are along the longest side of the mesh's box. Where the box is thinner than a voxel, samples lie in
  /// its middle: between two layers of samples a sheet would be lost. Whether the mesh is closed is left open.
  Frame(const Mesh& mesh, int resolution);

  bool empty() const { return !(voxel > 0); }
  std::size_t sample_count() const {
    return empty() ? 0 : (cells.x + std::size_t{1}) * (cells.y + std::size_t{1}) * (cells.z + std::size_t{1});
  }
  std::size_t index(const glm::ivec3& sample) const {
    return (sample.z * (cells.y + std::size_t{1}) + sample.y) * (cells.x + std::size_t{1}) + sample.x;
  }
  glm::dvec3 place(const glm::ivec3& sample) const { return low + voxel * glm::dvec3(sample); }
  /// Around all samples, rounded outward.
  Bounds bounds() const;

  /// What a sample holds, in voxels, of the distance to the nearest triangle in meters. An open mesh has no inside: its
  /// triangles are taken for plates one voxel thick.
  float held(double distance, bool is_inside) const {
    const double voxels = distance / voxel;
    return static_cast<float>(!is_closed ? voxels - half_plate : is_inside ? -voxels : voxels);
  }

  /// Where a point is among the samples.
  struct Place {
    glm::ivec3 cell;   ///< the first of the eight samples around the nearest point of the frame
    glm::dvec3 share;  ///< of that point between them, 0 .. 1
    glm::dvec3 off;    ///< from that point, voxels
  };
  Place find(const glm::dvec3& p) const {
    const glm::dvec3 place = (p - low) * per_meter, inside = glm::clamp(place, glm::dvec3(0), glm::dvec3(cells));
    const glm::ivec3 cell = glm::min(glm::ivec3(inside), cells - 1);
    return {cell, inside - glm::dvec3(cell), place - inside};
  }
  /// The field at a point, meters, by what is interpolated at the nearest point of the frame, in voxels. Outside of the frame a
  /// bound from below. Let q be the nearest point of the frame to p. A triangle's point x is on the other side of q, by
  /// `margin` at least along each axis, so with o = |p - q| per axis
  /// |p - x|^2 >= |o|^2 + 2 margin (o.x + o.y + o.z) + d(q)^2, and equal where x is straight below.
  double from(const glm::dvec3& off, double value) const {
    const double square = glm::dot(off, off);
    if (!(square > 0)) return voxel * value;
    const double plate = is_closed ? 0 : half_plate, beside = std::max(value + plate, 0.0);
    const double before = std::abs(off.x) + std::abs(off.y) + std::abs(off.z);
    return voxel * (std::sqrt(square + 2 * margin * before + beside * beside) - plate);
  }
};

/// The trilinear value among eight samples by at(sample), in voxels.
template <class SampleAt>
double interpolated(const Frame::Place& place, const SampleAt& at) {
  const auto along_x = [&](int y, int z) {
    const double here = at(place.cell + glm::ivec3(0, y, z)), next = at(place.cell + glm::ivec3(1, y, z));
    return here + place.share.x * (next - here);
  };
  const auto along_y = [&](int z) {
    const double here = along_x(0, z), next = along_x(1, z);
    return here + place.share.y * (next - here);
  };
  const double here = along_y(0);
  return here + place.share.z * (along_y(1) - here);
}

/// Signed distances to one mesh on a grid of half floats.
class Field {
 public:
  Field() = default;
  /// On all threads; the samples depend on mesh and resolution alone.
  Field(const Mesh& mesh, int resolution);

  const Frame& frame() const { return frame_; }
  double distance(const glm::dvec3& p) const {
    const Frame::Place place = frame_.find(p);
    return frame_.from(place.off, value(place));
  }
  std::size_t bytes() const { return bytes_of(samples_); }

 private:
  /// The trilinear value, voxels, in float: off by less than 2^-22 of the largest sample, where a half is by 2^-12.
  float value(const Frame::Place& place) const {
    const std::size_t row = frame_.cells.x + std::size_t{1}, slice = row * (frame_.cells.y + std::size_t{1});
    const std::uint16_t* const first = &samples_[frame_.index(place.cell)];
    const FourBits pairs = {pair_at(first), pair_at(first + row), pair_at(first + slice), pair_at(first + slice + row)};
    const FourFloats here = from_halves(pairs & 0xffffu), next = from_halves(pairs >> 16);
    const glm::vec3 share(place.share);
    const FourFloats along_x = here + share.x * (next - here);
    const float low = along_x[0] + share.y * (along_x[1] - along_x[0]);
    const float high = along_x[2] + share.y * (along_x[3] - along_x[2]);
    return low + share.z * (high - low);
  }

  Frame frame_;
  std::vector<std::uint16_t> samples_;  ///< row by row, slice by slice
};

}  // namespace gnomon::distance_field
