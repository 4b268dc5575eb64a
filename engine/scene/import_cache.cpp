// The import cache: one file a mesh, holding what the import made, the hashes of every file it read, and a checksum
// over all of it.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/scene/mesh_import.h"

namespace hl {
namespace {

constexpr std::string_view kMagic = "halflight import";
constexpr uint32_t kVersion = 1;  // of this layout and of what the import makes: raise it when either changes
constexpr size_t kChecksumBytes = 32;

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void text(const std::string& s) { value<uint64_t>(s.size()), bytes_.append(s); }
  template <class T>
  void array(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value<uint64_t>(v.size());
    bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// Throws std::out_of_range past the end, which the caller takes for damage.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T value() {
    T v;
    std::memcpy(&v, take(sizeof v), sizeof v);
    return v;
  }
  std::string text() {
    const size_t n = count(1);
    return std::string(take(n), n);
  }
  template <class T>
  void array(std::vector<T>& v) {
    const size_t n = count(sizeof(T));
    v.resize(n);
    if (n > 0) std::memcpy(v.data(), take(n * sizeof(T)), n * sizeof(T));
  }
  size_t count(size_t size) {
    const uint64_t n = value<uint64_t>();
    if (n > bytes_.size() / size) throw std::out_of_range("count");
    return static_cast<size_t>(n);
  }
  bool atEnd() const { return bytes_.empty(); }

 private:
  const char* take(size_t n) {
    if (n > bytes_.size()) throw std::out_of_range("end");
    const char* at = bytes_.data();
    bytes_.remove_prefix(n);
    return at;
  }
  std::string_view bytes_;
};

void write(Writer& w, const Scene& s, const std::vector<ImportInput>& inputs, const std::filesystem::path& folder) {
  w.value<uint64_t>(inputs.size());
  for (const ImportInput& i : inputs) {
    const std::filesystem::path relative = i.file.lexically_relative(folder);
    w.text((relative.empty() ? i.file : relative).generic_string()), w.text(i.hash);
  }
  w.array(s.positions), w.array(s.normals), w.array(s.uvs), w.array(s.lightmapUvs), w.value<uint8_t>(s.hasUvs);
  w.array(s.indices), w.array(s.materialIds), w.array(s.objectIds);
  w.value<uint64_t>(s.objects.size());
  for (const std::string& name : s.objects) w.text(name);
  w.value<uint64_t>(s.materials.size());
  for (const Material& m : s.materials) {
    w.text(m.name);
    w.value(m.albedo), w.value(m.emission), w.value(m.albedoTexture), w.value(m.normalTexture), w.value(m.alphaCutoff);
    w.value<uint8_t>(m.twoSided);
  }
  w.value<uint64_t>(s.textures.size());
  for (const Texture& t : s.textures)
    w.text(t.name), w.value(t.width), w.value(t.height), w.value<uint8_t>(t.srgb), w.array(t.rgba);
  w.value(s.report.degenerateTriangles), w.value(s.report.missingTextures);
  w.value<uint64_t>(s.report.warnings.size());
  for (const std::string& line : s.report.warnings) w.text(line);
}

/// Whether every file that the import read, or looked for in vain, still is as it was.
bool inputsUnchanged(Reader& r, const std::filesystem::path& folder) {
  const size_t n = r.count(1);
  for (size_t i = 0; i < n; ++i) {
    const std::filesystem::path file = folder / r.text();
    const std::string hash = r.text();
    const bool there = std::filesystem::is_regular_file(file);
    if (there != !hash.empty() || (there && hashOf(readFile(file)) != hash)) return false;
  }
  return true;
}

Scene read(Reader& r) {
  Scene s;
  r.array(s.positions), r.array(s.normals), r.array(s.uvs), r.array(s.lightmapUvs), s.hasUvs = r.value<uint8_t>() != 0;
  r.array(s.indices), r.array(s.materialIds), r.array(s.objectIds);
  s.objects.resize(r.count(8));
  for (std::string& name : s.objects) name = r.text();
  s.materials.resize(r.count(8));
  for (Material& m : s.materials) {
    m.name = r.text();
    m.albedo = r.value<vec3>(), m.emission = r.value<vec3>(), m.albedoTexture = r.value<uint32_t>();
    m.normalTexture = r.value<uint32_t>(), m.alphaCutoff = r.value<float>(), m.twoSided = r.value<uint8_t>() != 0;
  }
  s.textures.resize(r.count(8));
  for (Texture& t : s.textures)
    t.name = r.text(), t.width = r.value<int>(), t.height = r.value<int>(), t.srgb = r.value<uint8_t>() != 0,
    r.array(t.rgba);
  s.report.degenerateTriangles = r.value<uint64_t>(), s.report.missingTextures = r.value<uint64_t>();
  s.report.warnings.resize(r.count(8));
  for (std::string& line : s.report.warnings) line = r.text();
  if (!r.atEnd()) throw std::out_of_range("rest");
  return s;
}

/// The scene in the cache file; nothing where there is none, where it is damaged or foreign, or where an input changed.
std::optional<Scene> fromCache(const std::filesystem::path& cached, const std::filesystem::path& folder) {
  if (!std::filesystem::is_regular_file(cached)) return {};
  const std::string bytes = readFile(cached);
  const auto damaged = [&] {
    logWarning(fmt::format("{}: damaged or foreign; the mesh is imported again", cached.string()));
    return std::optional<Scene>();
  };
  const size_t head = kMagic.size() + sizeof kVersion + kChecksumBytes;
  if (bytes.size() < head || bytes.compare(0, kMagic.size(), kMagic) != 0) return damaged();
  uint32_t version = 0;
  std::memcpy(&version, bytes.data() + kMagic.size(), sizeof version);
  if (version != kVersion) return {};
  const std::string_view body = std::string_view(bytes).substr(head);
  if (bytes.compare(head - kChecksumBytes, kChecksumBytes, hashOf(body)) != 0) return damaged();
  try {
    Reader r(body);
    if (!inputsUnchanged(r, folder)) return {};
    return read(r);
  } catch (const std::exception&) {
    return damaged();
  }
}

}  // namespace

std::filesystem::path importCacheFile(const std::filesystem::path& file, double scale) {
  const std::string content = hashOf(readFile(file));
  Hasher h;
  h.text(content).value(scale).value(kVersion).text(file.extension().string());
  return cacheFolder() / "import" / (h.hex() + ".hlmesh");
}

Scene importMeshCached(const std::filesystem::path& file, double scale, Progress* progress) {
  if (!isMeshFile(file)) return importMesh(file, scale, progress);  // for its message
  const std::filesystem::path cached = importCacheFile(file, scale), folder = file.parent_path();
  if (progress) progress->begin("import: look in the cache", 1);
  if (std::optional<Scene> scene = fromCache(cached, folder)) return std::move(*scene);
  std::vector<ImportInput> inputs;
  Scene scene = importMesh(file, scale, progress, &inputs);
  Writer w;
  write(w, scene, inputs, folder);
  std::string bytes(kMagic);
  bytes.append(reinterpret_cast<const char*>(&kVersion), sizeof kVersion);
  bytes += hashOf(w.bytes());
  bytes += w.bytes();
  try {
    std::filesystem::create_directories(cached.parent_path());
    writeFileAtomically(cached, bytes);
  } catch (const std::exception& e) {
    logWarning(fmt::format("the import cache cannot be written: {}", e.what()));  // the scene is there all the same
  }
  return scene;
}

}  // namespace hl
