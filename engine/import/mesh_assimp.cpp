#include "engine/scene/mesh_assimp.h"

#include <assimp/GltfMaterial.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>

#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/scene/vertex_table.h"

namespace hl {
namespace {

// A triangle whose doubled area is below this share of its longest edge squared has no direction that a float could
// tell.
constexpr float kDegenerateShare = 1e-7f;

/// Serves the mesh from memory, and further buffers from disk. Material libraries stay closed: we read those ourselves.
class ImportFiles : public Assimp::IOSystem {
 public:
  ImportFiles(std::string name, std::string_view bytes, bool others, std::vector<ImportInput>& inputs)
      : name_(std::move(name)), bytes_(bytes), others_(others), inputs_(inputs) {}

  bool Exists(const char* file) const override {
    return file == name_ || (others_ && std::filesystem::is_regular_file(file));
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (file == name_) return stream(bytes_);
    if (!others_) return nullptr;
    auto it = read_.find(file);
    if (it == read_.end()) {
      std::error_code ignored;
      if (!std::filesystem::is_regular_file(file, ignored)) {
        inputs_.push_back({file, ""});
        return nullptr;
      }
      it = read_.emplace(file, readFile(file)).first;
      inputs_.push_back({file, hashOf(it->second)});
    }
    return stream(it->second);
  }
  void Close(Assimp::IOStream* s) override { delete s; }

 private:
  static Assimp::IOStream* stream(std::string_view bytes) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  }
  std::string name_;
  std::string_view bytes_;
  bool others_;
  std::vector<ImportInput>& inputs_;
  std::map<std::string, std::string> read_;
};

bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool finite(vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }
vec3 toVec3(const aiVector3D& v) { return vec3(v.x, v.y, v.z); }

class Converter {
 public:
  Converter(const aiScene& from, std::string file, double scale, Progress* progress, Scene& to)
      : from_(from),
        file_(std::move(file)),
        scale_(scale),
        progress_(progress),
        to_(to),
        table_(to, hasLightmapUvs(from)) {}

  void run() {
    uint64_t faces = 0;
    for (unsigned i = 0; i < from_.mNumMeshes; ++i) faces += from_.mMeshes[i]->mNumFaces;
    if (progress_) progress_->begin("import: convert", faces);
    node(*from_.mRootNode, aiMatrix4x4());
    if (badNormals_ > 0)
      to_.report.warnings.push_back(
          fmt::format("{}: {} normals had no length and were replaced by their triangles'", file_, badNormals_));
    if (to_.indices.empty())
      throw badInput(fmt::format(
          "{}: no triangles{}", file_,
          to_.report.degenerateTriangles ? fmt::format(" but {} without area", to_.report.degenerateTriangles) : ""));
  }

 private:
  static bool hasLightmapUvs(const aiScene& s) {
    bool all = s.mNumMeshes > 0;
    for (unsigned i = 0; i < s.mNumMeshes; ++i)
      all = all && (!hasTriangles(*s.mMeshes[i]) || s.mMeshes[i]->HasTextureCoords(1));
    return all;
  }
  static bool hasTriangles(const aiMesh& m) { return (m.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0; }

  void node(const aiNode& n, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * n.mTransformation;
    uint32_t object = kNone;
    for (unsigned i = 0; i < n.mNumMeshes; ++i) {
      const aiMesh& m = *from_.mMeshes[n.mMeshes[i]];
      if (!hasTriangles(m)) continue;
      if (object == kNone) {
        object = static_cast<uint32_t>(to_.objects.size());
        to_.objects.emplace_back(n.mName.length ? n.mName.C_Str() : m.mName.C_Str());
      }
      mesh(m, transform, object);
    }
    for (unsigned i = 0; i < n.mNumChildren; ++i) node(*n.mChildren[i], transform);
  }

  void mesh(const aiMesh& m, const aiMatrix4x4& transform, uint32_t object) {
    aiMatrix3x3 forNormals(transform);
    const bool mirrored = forNormals.Determinant() < 0;
    forNormals.Inverse().Transpose();
    std::vector<vec3> positions(m.mNumVertices), normals(m.mNumVertices, vec3(0.0f));
    for (unsigned i = 0; i < m.mNumVertices; ++i) {
      const aiVector3D p = transform * m.mVertices[i];
      for (int k = 0; k < 3; ++k)
        positions[i][k] = static_cast<float>(scale_ * static_cast<double>(p[static_cast<unsigned>(k)]));
      if (!finite(positions[i])) throw badInput(fmt::format("{}: {} vertex {} is not finite", file_, named(m), i));
      if (m.HasNormals()) normals[i] = toVec3(forNormals * m.mNormals[i]);
    }
    to_.hasUvs = to_.hasUvs || m.HasTextureCoords(0);
    for (unsigned f = 0; f < m.mNumFaces; ++f) {
      if (progress_) {
        progress_->advance();
        if (f % 8192 == 0) progress_->check();
      }
      const aiFace& face = m.mFaces[f];
      if (face.mNumIndices != 3) continue;
      for (unsigned k = 0; k < 3; ++k)
        if (face.mIndices[k] >= m.mNumVertices)
          throw badInput(fmt::format("{}: {} face {} refers to vertex {} of {}", file_, named(m), f, face.mIndices[k],
                                     m.mNumVertices));
      triangle(m, face.mIndices, positions, normals, mirrored, object);
    }
  }

  void triangle(const aiMesh& m, const unsigned* corners, const std::vector<vec3>& positions,
                const std::vector<vec3>& normals, bool mirrored, uint32_t object) {
    const unsigned i[3] = {corners[0], corners[mirrored ? 2 : 1], corners[mirrored ? 1 : 2]};
    const vec3 p0 = positions[i[0]], p1 = positions[i[1]], p2 = positions[i[2]];
    const vec3 across = glm::cross(p1 - p0, p2 - p0);
    const float doubledArea = glm::length(across);
    const float edge = std::max({glm::dot(p1 - p0, p1 - p0), glm::dot(p2 - p0, p2 - p0), glm::dot(p2 - p1, p2 - p1)});
    if (!(doubledArea > kDegenerateShare * edge)) {
      ++to_.report.degenerateTriangles;
      return;
    }
    uvec3 out{};
    for (int k = 0; k < 3; ++k) {
      MeshVertex v;
      v.position = positions[i[k]] + vec3(0.0f);  // -0 becomes 0: bits are compared
      const float length = glm::length(normals[i[k]]);
      const bool given = length > 0 && std::isfinite(length);
      if (!given && m.HasNormals()) ++badNormals_;
      v.normal = (given ? normals[i[k]] / length : across / doubledArea) + vec3(0.0f);
      if (m.HasTextureCoords(0)) v.uv = uv(m, 0, i[k]);
      if (m.HasTextureCoords(1)) v.lightmapUv = uv(m, 1, i[k]);
      out[k] = table_.add(v);
    }
    to_.indices.push_back(out);
    to_.materialIds.push_back(m.mMaterialIndex);
    to_.objectIds.push_back(object);
  }

  vec2 uv(const aiMesh& m, unsigned set, unsigned vertex) const {
    const aiVector3D& t = m.mTextureCoords[set][vertex];
    const vec2 v = vec2(t.x, t.y) + vec2(0.0f);
    if (!finite(v)) throw badInput(fmt::format("{}: {} texture coordinate {} is not finite", file_, named(m), vertex));
    return v;
  }
  static std::string named(const aiMesh& m) { return fmt::format("mesh '{}':", m.mName.C_Str()); }

  const aiScene& from_;
  std::string file_;
  double scale_;
  Progress* progress_;
  Scene& to_;
  VertexTable table_;
  uint64_t badNormals_ = 0;
};

std::string mapOf(const aiMaterial& m, aiTextureType type) {
  aiString name;
  return m.GetTexture(type, 0, &name) == aiReturn_SUCCESS ? std::string(name.C_Str()) : std::string();
}

/// The glTF side; OBJ's materials come from our own reading of the MTL.
MaterialSource source(const aiMaterial& m, const std::string& file, ImportReport& report) {
  MaterialSource s;
  s.material.name = m.GetName().C_Str();
  aiColor4D base(1, 1, 1, 1);
  if (m.Get(AI_MATKEY_BASE_COLOR, base) != aiReturn_SUCCESS) m.Get(AI_MATKEY_COLOR_DIFFUSE, base);
  aiColor3D emission(0, 0, 0);
  m.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
  s.material.albedo = vec3(base.r, base.g, base.b);
  s.material.emission = vec3(emission.r, emission.g, emission.b);
  int twoSided = 0;
  if (m.Get(AI_MATKEY_TWOSIDED, twoSided) == aiReturn_SUCCESS) s.material.twoSided = twoSided != 0;
  s.albedoMap = mapOf(m, aiTextureType_BASE_COLOR);
  if (s.albedoMap.empty()) s.albedoMap = mapOf(m, aiTextureType_DIFFUSE);
  s.normalMap = mapOf(m, aiTextureType_NORMALS);
  s.emissiveMap = mapOf(m, aiTextureType_EMISSIVE);
  aiString mode;
  if (m.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS && std::string_view(mode.C_Str()) != "OPAQUE") {
    float cutoff = 0.5f;
    if (std::string_view(mode.C_Str()) == "MASK")
      m.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
    else
      report.warnings.push_back(
          fmt::format("{}: material '{}': blended alpha is taken as a cut-off at 0.5", file, s.material.name));
    if (base.a > 0) s.material.alphaCutoff = cutoff / base.a;  // the factor scales the texture's alpha
  }
  return s;
}

std::string oneLine(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = ' ';
  return text;
}

}  // namespace

extern "C" AssimpMesh halflight_read_mesh(const std::filesystem::path& file, std::string_view bytes, double scale, Progress* progress,
                                          std::vector<ImportInput>& inputs) {
  const bool gltf = file.extension() != ".obj" && file.extension() != ".OBJ";
  Assimp::Importer importer;
  importer.SetIOHandler(new ImportFiles(file.string(), bytes, gltf, inputs));  // the importer owns it
  if (progress) progress->begin("import: read", 1);
  const aiScene* from = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (progress) progress->check();
  if (!from || !from->mRootNode)
    throw badInput(fmt::format("{}: {}", file.string(), oneLine(importer.GetErrorString())));
  AssimpMesh out;
  Converter(*from, file.string(), scale, progress, out.scene).run();
  for (unsigned i = 0; i < from->mNumMaterials; ++i)
    out.materials.push_back(source(*from->mMaterials[i], file.string(), out.scene.report));
  for (unsigned i = 0; i < from->mNumTextures; ++i) {
    const aiTexture& t = *from->mTextures[i];
    if (t.mHeight != 0) throw badInput(fmt::format("{}: embedded image {} is not an encoded one", file.string(), i));
    out.images.push_back(
        {fmt::format(".{}", t.achFormatHint), std::string(reinterpret_cast<const char*>(t.pcData), t.mWidth)});
  }
  return out;
}

}  // namespace hl
