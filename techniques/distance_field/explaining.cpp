#include "explaining.h"

namespace gnomon::distance_field {

namespace {

std::vector<MeshDistances> distances_of(const Fields& fields) {
  std::vector<MeshDistances> meshes;
  for (std::uint32_t k = 0; k < fields.count(); ++k) meshes.emplace_back(fields.scene().meshes[fields.mesh(k)]);
  return meshes;
}

/// Whether `other` leaves at most half of the error of an answer.
bool is_better(double other, double answer, double truth) { return 2 * std::abs(other - truth) <= std::abs(answer - truth); }

}  // namespace

DoubledFields::DoubledFields(const Fields& fields, const std::vector<MeshDistances>& meshes)
    : fields_(fields), meshes_(meshes) {
  for (std::uint32_t k = 0; k < fields.count(); ++k) {
    frames_.emplace_back(fields.scene().meshes[fields.mesh(k)], 2 * fields.resolution());
    frames_.back().is_closed = fields.field(k).frame().is_closed;
    Samples& samples = samples_.emplace_back();
    samples.cubes = (frames_.back().cells >> 3) + 1;
    samples.made.resize(static_cast<std::size_t>(samples.cubes.x) * samples.cubes.y * samples.cubes.z);
  }
}

double DoubledFields::sample(std::uint32_t caster, const glm::ivec3& at) const {
  Samples& samples = samples_[caster];
  const glm::ivec3 cube = at >> 3, inner = at & 7;
  std::unique_ptr<Samples::Cube>& made = samples.made[(cube.z * samples.cubes.y + cube.y) * samples.cubes.x + cube.x];
  constexpr std::uint16_t unknown = 0x7fff;  // no number
  if (!made) {
    made = std::make_unique<Samples::Cube>();
    made->fill(unknown);
  }
  std::uint16_t& half = (*made)[inner.z << 6 | inner.y << 3 | inner.x];
  if (half == unknown) {
    const Frame& frame = frames_[caster];
    const glm::dvec3 place = frame.place(at);
    const double distance = meshes_[caster].to_nearest(place, samples.near);
    half = to_half(frame.held(distance, frame.is_closed && meshes_[caster].winding(place) != 0));
  }
  return from_half(half);
}

double DoubledFields::distance(std::uint32_t caster, const glm::dvec3& p) const {
  const Frame& frame = frames_[caster];
  const Frame::Place place = frame.find(p);
  return frame.from(place.off, interpolated(place, [&](const glm::ivec3& at) { return sample(caster, at); }));
}

double ExactDistances::distance(std::uint32_t caster, const glm::dvec3& p) const {
  const double distance = meshes_[caster].to_nearest(p, near_[caster]);
  if (!fields_.field(caster).frame().is_closed) return distance - voxel(caster) / 2;
  return meshes_[caster].winding(p) != 0 ? -distance : distance;
}

Judge::Judge(const Fields& fields, const Light& light)
    : fields_(fields),
      light_(light),
      meshes_(distances_of(fields)),
      doubled_(fields, meshes_),
      exact_(fields, meshes_),
      alone_(fields.count()) {
  whole_.prepare(fields.scene(), has_area(light));
  for (std::uint32_t k = 0; k < fields.count(); ++k) {
    alone_[k].alone = std::make_unique<Scene>();
    alone_[k].alone->meshes = {fields.scene().meshes[fields.mesh(k)]};
    alone_[k].prepare(*alone_[k].alone, has_area(light));
  }
}

void Judge::Witness::prepare(const Scene& scene, bool has_area) {
  if (has_area)
    area.emplace(scene, Truth::mesh, RayScene::Which::casters);
  else
    hard.emplace(scene);
}

double Judge::seen(const Witness& witness, const Question& question, const Receiver& receiver) const {
  if (!witness.area) {
    ExactTally tally;
    return witness.hard->occluded(receiver, homogeneous(light_), tally).blocked ? 0 : 1;
  }
  const GBuffer& g = question.gbuffer;
  const std::size_t i = question.pixel;
  const LightFigure figure(light_, g.position(i), g.normal(i));
  if (!figure.is_seen()) return 1;
  const glm::vec3 lift = static_cast<float>(area_ray_offset(g.position(i))) * g.normal(i);
  const FaceRays rays(*witness.area, g.position(i) + lift, lift, receiver.mesh, receiver.triangle, figure);
  return sample_shares(rays, i, {.error = area_error, .cap = 1024}).area;
}

double Judge::truth(const Question& question) const {
  return seen(whole_, question, receiver_at(fields_.scene(), question.gbuffer, question.pixel));
}

double Judge::hidden(const Question& question, std::uint32_t caster) const {
  Receiver receiver = receiver_at(fields_.scene(), question.gbuffer, question.pixel);
  if (receiver.mesh == fields_.mesh(caster))
    receiver.mesh = 0;
  else
    receiver = {.point = receiver.point};
  return 1 - seen(alone_[caster], question, receiver);
}

template <class Casters>
double Judge::answer(const Trace<Casters>& trace, const Question& question) const {
  return share_seen(question.formula, trace.least());
}

bool Judge::is_of_formula(const Question& question) const {
  if (question.formula == Formula::disc || !has_area(light_)) return false;
  const Trace trace(fields_, question.way);
  return is_better(share_seen(Formula::disc, trace.least()), question.answer, truth(question));
}

std::string_view Judge::cause(const Question& question) const {
  const double is = truth(question);
  if (question.answer == is) return "";
  if (is_better(answer(Trace(doubled_, question.way), question), question.answer, is)) return id_of(Own::field_resolution);
  const Trace exact(exact_, question.way);
  if (is_better(answer(exact, question), question.answer, is)) return id_of(Own::field_resolution);
  if (question.answer > is) return cause_of_lit(question, is, exact);
  return has_area(light_) ? id_of(Own::one_edge) : "";
}

// False lit, by exact distances, too.
std::string_view Judge::cause_of_lit(const Question& question, double truth, const Trace<ExactDistances>& trace) const {
  const double half = (question.answer - truth) / 2;
  double held_back = 0;
  for (std::uint32_t k = 0; k < fields_.count(); ++k)
    if (!trace.counted(k) && is_near(exact_, question.way, k)) held_back += hidden(question, k);
  if (held_back >= half) return id_of(Own::contact_gap);
  if (!has_area(light_)) return "";
  Way to_light = question.way;
  to_light.cone_end = to_light.length;
  if (is_better(answer(Trace(exact_, to_light), question), question.answer, truth)) return id_of(Own::near_light);
  // What the caster that hides most leaves, the others make darker by so much.
  double most = 0;
  for (std::uint32_t k = 0; k < fields_.count(); ++k) most = std::max(most, hidden(question, k));
  if (1 - most - truth >= half) return id_of(Own::nearest_caster);
  return id_of(trace.least() <= 0 ? Own::thin_caster : Own::one_edge);
}

}  // namespace gnomon::distance_field
