#pragma once
// Private to the importer: what the meshes of one file let through.
#include <map>

#include "measure/scene/import.h"

namespace gnomon::importing {

class FileTransmissions {
 public:
  /// Throws Error where the image of `choice` cannot be read. All outlive this object.
  FileTransmissions(const MeshFile& raw, const TransmissionChoice& choice, const Scene& scene);

  /// What a mesh of the file lets through; null: nothing. `where` opens errors: "FILE: mesh 'window'".
  std::shared_ptr<const Transmission> transmission(const std::string& where, const ImportedMesh& mesh);
  /// Whether its material's transparency counts, even where it turns out to be opaque.
  bool counts(const ImportedMesh& mesh) const { return is_chosen() || (choice_.is_used && mesh.transmission.is_there()); }
  /// Whether the eye sees the meshes that let light through.
  bool are_seen() const { return choice_.seen.value_or(false); }
  /// Ends errors: how a description avoids them.
  const std::string& hint() const { return choice_.hint; }
  /// Adds notes to the scene, which open with `name`. Throws Error, which opens with `file`, where the choice says what is seen
  /// and no mesh lets light through.
  void finish(const std::string& file, const std::string& name, Scene& scene) const;

 private:
  bool is_chosen() const { return choice_.everywhere || choice_.image; }
  const MaskImage* image(const std::string& where, std::uint32_t number) const;
  Transmission made(const std::string& where, const ImportedTransmission& material) const;

  const MeshFile& raw_;
  const TransmissionChoice& choice_;
  const Scene& scene_;
  std::shared_ptr<const Transmission> chosen_;
  std::map<std::string, std::shared_ptr<const Transmission>> known_;  ///< by the bytes of ImportedTransmission
  std::size_t transmitting_ = 0, opaque_ = 0, empty_ = 0;             ///< meshes
};

}  // namespace gnomon::importing
