#include "engine/scene/mesh_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/import_module.h"
#include "engine/scene/gltf_check.h"
#include "engine/scene/mesh_assimp.h"
#include "engine/scene/mtl_file.h"
#include "engine/scene/obj_check.h"
#include "engine/scene/texture_load.h"
#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

constexpr float kMaskCutoff = 0.5f;  // OBJ has masks, but no place for their threshold

std::string lowerExtension(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  for (char& c : e) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  return e;
}

/// Reads the MTL files of an OBJ; gives each material that Assimp named its values. A material without an entry is
/// warned about.
void applyMtl(const std::filesystem::path& file, const ObjSummary& obj, AssimpMesh& mesh,
              std::vector<ImportInput>& inputs) {
  ImportReport& report = mesh.scene.report;
  std::map<std::string, MtlMaterial> known;
  for (const std::string& library : obj.materialLibraries) {
    std::string name = library;
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::filesystem::path path = file.parent_path() / name;
    if (!std::filesystem::is_regular_file(path)) {
      inputs.push_back({path, ""});
      report.warnings.push_back(fmt::format("{}: material library '{}' is missing", file.string(), library));
      continue;
    }
    const std::string text = readFile(path);
    inputs.push_back({path, hashOf(text)});
    for (MtlMaterial& m : parseMtl(text, path)) known.insert_or_assign(m.name, m);
  }
  for (MaterialSource& s : mesh.materials) {
    const std::string name = s.material.name;
    s = {};
    s.material.name = name;
    const auto it = known.find(name);
    if (it == known.end()) {
      if (std::find(obj.materials.begin(), obj.materials.end(), name) != obj.materials.end())
        report.warnings.push_back(
            fmt::format("{}: material '{}' is in no material library; it is grey", file.string(), name));
      continue;
    }
    const MtlMaterial& m = it->second;
    s.material.albedo = m.albedo, s.material.emission = m.emission;
    s.albedoMap = m.albedoMap, s.normalMap = m.normalMap, s.alphaMap = m.alphaMap;
    // Cut-out leaves and chains are sheets: seen, and lit, from both sides.
    if (!m.alphaMap.empty()) s.material.alphaCutoff = kMaskCutoff, s.material.twoSided = true;
    for (const std::string& key : m.ignored)
      report.warnings.push_back(fmt::format("{}: material '{}': {} is not read", file.string(), name, key));
  }
}

/// Keeps the materials that triangles use, in the file's order.
void dropUnused(AssimpMesh& mesh) {
  std::vector<uint32_t> map(mesh.materials.size(), kNone);
  for (const uint32_t id : mesh.scene.materialIds) map.at(id) = 0;
  std::vector<MaterialSource> used;
  for (size_t i = 0; i < map.size(); ++i)
    if (map[i] != kNone) map[i] = static_cast<uint32_t>(used.size()), used.push_back(std::move(mesh.materials[i]));
  for (uint32_t& id : mesh.scene.materialIds) id = map[id];
  mesh.materials = std::move(used);
}

class TextureLoader {
 public:
  TextureLoader(const std::filesystem::path& mesh, const std::vector<EmbeddedImage>& images, Scene& scene,
                std::vector<ImportInput>& inputs)
      : mesh_(mesh), images_(images), scene_(scene), inputs_(inputs) {}

  void apply(MaterialSource& s) {
    Material& m = s.material;
    if (!s.albedoMap.empty() || !s.alphaMap.empty()) m.albedoTexture = albedo(s.albedoMap, s.alphaMap);
    if (!s.normalMap.empty()) m.normalTexture = plain(s.normalMap, false);
    if (!s.emissiveMap.empty()) {
      // Emission is a constant of the material: the image's mean keeps the power.
      if (const Texture* t = load(s.emissiveMap, true)) m.emission *= mean(*t);
      scene_.report.warnings.push_back(
          fmt::format("{}: material '{}': the mean of its emissive image is used", mesh_.string(), m.name));
    }
    if (m.albedoTexture == kNone) m.alphaCutoff = 0;
  }

 private:
  uint32_t plain(const std::string& map, bool srgb) {
    const std::string key = fmt::format("{}|{}", map, srgb);
    return layer(key, [&] { return load(map, srgb); });
  }
  uint32_t albedo(const std::string& map, const std::string& alphaMap) {
    if (alphaMap.empty() || alphaMap == map) return plain(map, true);
    const std::string key = fmt::format("{}|alpha {}", map, alphaMap);
    if (const auto it = layers_.find(key); it != layers_.end()) return it->second;
    const Texture* mask = load(alphaMap, false);
    if (!mask) return map.empty() ? kNone : plain(map, true);
    Texture merged = *mask;
    if (const Texture* colour = map.empty() ? nullptr : load(map, true)) {
      merged = *colour;
    } else {
      merged.srgb = true;
      std::fill(merged.rgba.begin(), merged.rgba.end(), uint8_t{255});
    }
    setAlpha(merged, *load(alphaMap, false));
    return layer(key, [&] { return &merged; });
  }
  template <class F>
  uint32_t layer(const std::string& key, F&& make) {
    if (const auto it = layers_.find(key); it != layers_.end()) return it->second;
    const Texture* t = make();
    uint32_t index = kNone;
    if (t) index = static_cast<uint32_t>(scene_.textures.size()), scene_.textures.push_back(*t);
    layers_[key] = index;
    return index;
  }
  /// Null where it is missing (a warning and a count); one that is no image is the file's error.
  const Texture* load(const std::string& map, bool srgb) {
    const std::string key = fmt::format("{}|{}", map, srgb);
    if (const auto it = loaded_.find(key); it != loaded_.end()) return it->second.rgba.empty() ? nullptr : &it->second;
    Texture& t = loaded_[key];
    if (map.front() == '*') {
      const size_t i = static_cast<size_t>(std::strtoul(map.c_str() + 1, nullptr, 10));
      if (i >= images_.size()) throw badInput(fmt::format("{}: there is no embedded image {}", mesh_.string(), map));
      t = loadTexture(images_[i].bytes, fmt::format("{}: embedded image {}", mesh_.string(), i), images_[i].extension,
                      srgb);
      return &t;
    }
    const std::filesystem::path file = mesh_.parent_path() / map;
    if (!std::filesystem::is_regular_file(file)) {
      inputs_.push_back({file, ""});
      ++scene_.report.missingTextures;
      scene_.report.warnings.push_back(
          fmt::format("{}: texture '{}' is missing; its material's constant is used", mesh_.string(), map));
      return nullptr;
    }
    inputs_.push_back({file, hashOf(readFile(file))});
    t = loadTexture(file, srgb);
    return &t;
  }
  static vec3 mean(const Texture& t) {
    double sum[3] = {};
    for (size_t i = 0; i < t.rgba.size(); ++i)
      if (i % 4 < 3) sum[i % 4] += static_cast<double>(srgbDecodeTable()[t.rgba[i]]);
    const double n = static_cast<double>(t.rgba.size() / 4);
    return vec3(static_cast<float>(sum[0] / n), static_cast<float>(sum[1] / n), static_cast<float>(sum[2] / n));
  }

  const std::filesystem::path& mesh_;
  const std::vector<EmbeddedImage>& images_;
  Scene& scene_;
  std::vector<ImportInput>& inputs_;
  std::map<std::string, Texture> loaded_;
  std::map<std::string, uint32_t> layers_;
};

}  // namespace

bool isMeshFile(const std::filesystem::path& file) {
  const std::string e = lowerExtension(file);
  return e == ".obj" || e == ".gltf" || e == ".glb";
}

Scene importMesh(const std::filesystem::path& file, double scale, Progress* progress,
                 std::vector<ImportInput>* inputs) {
  if (!isMeshFile(file))
    throw badInput(fmt::format("{}: not a kind of mesh that is read; {} are", file.string(), kMeshKinds));
  const auto readMesh = importEntry<ReadMeshEntry>(ImportEntry::kReadMesh, file.string());
  std::vector<ImportInput> read;
  std::string bytes = readFile(file);
  read.push_back({file, hashOf(bytes)});
  const bool obj = lowerExtension(file) == ".obj";
  if (progress) progress->begin("import: check", 1);
  ObjSummary summary;
  std::vector<std::string> warnings;
  if (obj)
    summary = checkObj(bytes, file, progress);
  else
    bytes = checkGltf(bytes, file, progress, &warnings);
  AssimpMesh mesh = readMesh(file, bytes, scale, progress, read);
  mesh.scene.report.warnings.insert(mesh.scene.report.warnings.end(), warnings.begin(), warnings.end());
  if (obj) applyMtl(file, summary, mesh, read);
  dropUnused(mesh);
  if (progress) progress->begin("import: textures", mesh.materials.size());
  TextureLoader loader(file, mesh.images, mesh.scene, read);
  for (MaterialSource& s : mesh.materials) {
    if (progress) progress->check();
    loader.apply(s);
    mesh.scene.materials.push_back(s.material);
    if (progress) progress->advance();
  }
  if (inputs) *inputs = std::move(read);
  return std::move(mesh.scene);
}

}  // namespace hl
