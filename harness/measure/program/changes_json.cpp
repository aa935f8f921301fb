#include "measure/program/changes_json.h"

#include <gnomon/error.h>

#include "measure/scene/scene_json.h"

namespace gnomon {

namespace {

Json corners_json(const Bounds& bounds) { return Json::array({number_json(bounds.min), number_json(bounds.max)}); }

Json rows_json(const glm::dmat4& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back(Json::array({matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]}));
  return rows;
}

}  // namespace

Json changes_json(const Scene& scene, const Changes& changes) {
  if (changes.meshes.size() != scene.meshes.size())
    throw Error("{} changes came for the {} meshes of {}; one for each is wanted", changes.meshes.size(), scene.meshes.size(),
                scene.name);
  Json list = Json::array();
  std::size_t first_vertex = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const MeshChange& change = changes.meshes[m];
    if (change.kind != MeshChange::Kind::still) {
      list.push_back(json_object({{"mesh", m},
                                  {"kind", name(change.kind)},
                                  {"first", first_vertex + change.first},
                                  {"count", change.count},
                                  {"before", corners_json(change.before)},
                                  {"after", corners_json(change.after)}}));
      if (change.kind == MeshChange::Kind::rigid) list.back()["matrix"] = rows_json(change.matrix);
    }
    first_vertex += scene.meshes[m].positions.size();
  }
  return list;
}

}  // namespace gnomon
