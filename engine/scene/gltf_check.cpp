#include "engine/scene/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <vector>

#include "engine/core/files.h"
#include "engine/scene/gltf_container.h"
#include "engine/scene/json_reader.h"

namespace hl {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 128;  // of nodes within nodes: importers recurse
constexpr uint64_t kMostBytes = uint64_t{1} << 40;
constexpr int kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126;  // glTF's component types that are read

struct View {
  uint64_t buffer = 0, offset = 0, length = 0, stride = 0;
};
struct Accessor {
  uint64_t view = 0, offset = 0, count = 0, size = 0, stride = 0;
  int componentType = 0;
  std::string type;
};

const Json& member(const Json& object, const char* key, const std::string& where) {
  const auto it = object.find(key);
  if (it == object.end()) throw badInput(where, fmt::format("'{}' is missing", key));
  return *it;
}

uint64_t whole(const Json& v, const std::string& where, uint64_t most) {
  if (!v.is_number_unsigned()) throw badInput(where, "a whole number that is not negative is wanted");
  const uint64_t n = v.get<uint64_t>();
  if (n > most) throw badInput(where, fmt::format("{} is out of range [0, {}]", n, most));
  return n;
}

uint64_t index(const Json& v, const std::string& where, size_t size) {
  if (size == 0) throw badInput(where, "it refers to an empty list");
  return whole(v, where, size - 1);
}

/// Copies values from one object to another, each with a check.
class Copy {
 public:
  Copy(const Json& from, std::string where) : from_(from), where_(std::move(where)), to_(Json::object()) {
    if (!from.is_object()) throw badInput(where_, "an object is wanted");
  }
  const std::string& where() const { return where_; }
  std::string at(const char* key) const { return fmt::format("{}.{}", where_, key); }
  bool has(const char* key) const { return from_.contains(key); }
  const Json& need(const char* key) const { return member(from_, key, where_); }
  void refuse(const char* key, const char* why) const {
    if (has(key)) throw badInput(at(key), why);
  }

  uint64_t number(const char* key, uint64_t otherwise, uint64_t most) {
    if (!has(key)) return otherwise;
    const uint64_t n = whole(from_[key], at(key), most);
    to_[key] = n;
    return n;
  }
  uint64_t needIndex(const char* key, size_t size) {
    const uint64_t n = index(need(key), at(key), size);
    to_[key] = n;
    return n;
  }
  void mayIndex(const char* key, size_t size) {
    if (has(key)) needIndex(key, size);
  }
  void text(const char* key) {
    if (has(key)) to_[key] = JsonObject::asText(from_[key], at(key));
  }
  void flag(const char* key) {
    if (!has(key)) return;
    if (!from_[key].is_boolean()) throw badInput(at(key), "true or false is wanted");
    to_[key] = from_[key];
  }
  void real(const char* key, double least, double most) {
    if (has(key)) to_[key] = JsonObject::asNumber(from_[key], at(key), least, most);
  }
  void reals(const char* key, size_t count, double least, double most) {
    if (!has(key)) return;
    const Json& all = from_[key];
    if (!all.is_array() || all.size() != count) throw badInput(at(key), fmt::format("{} numbers are wanted", count));
    for (const Json& v : all) JsonObject::asNumber(v, at(key), least, most);
    to_[key] = all;
  }
  void set(const char* key, Json value) { to_[key] = std::move(value); }
  Json& result() { return to_; }

 private:
  const Json& from_;
  std::string where_;
  Json to_;
};

class Check {
 public:
  Check(std::string_view bytes, const std::filesystem::path& file, Progress* progress)
      : file_(file), progress_(progress), container_(openGltf(bytes, file)) {
    json_ = parseJson(container_.json, name());
    if (!json_.is_object()) throw badInput(name(), "the JSON of a glTF file is an object");
  }

  /// Materials that say anything of them, which is not read.
  size_t metallicRoughness() const { return metallicRoughness_; }

  std::string run() {
    Copy asset(member(json_, "asset", name()), name() + ": asset");
    asset.text("version");
    if (JsonObject::asText(asset.need("version"), asset.at("version")).substr(0, 2) != "2.")
      throw badInput(asset.at("version"), "glTF 2.x is read");
    out_["asset"] = asset.result();
    required();
    each("buffers", [&](Copy& c, size_t i) { buffer(c, i); });
    each("bufferViews", [&](Copy& c, size_t) { view(c); });
    each("accessors", [&](Copy& c, size_t) { accessor(c); });
    each("images", [&](Copy& c, size_t) { image(c); });
    each("textures", [&](Copy& c, size_t) { c.mayIndex("source", size("images")); });
    each("materials", [&](Copy& c, size_t) { material(c); });
    each("meshes", [&](Copy& c, size_t) { mesh(c); });
    if (!triangles_) throw badInput(name(), "no triangles");
    each("nodes", [&](Copy& c, size_t i) { node(c, i); });
    tree();
    each("scenes", [&](Copy& c, size_t) { scene(c); });
    if (size("scenes") == 0) throw badInput(name(), "no triangles: it has no scene");
    if (json_.contains("scene")) out_["scene"] = index(json_["scene"], name() + ": scene", size("scenes"));
    return wrapGltf(container_, out_.dump());
  }

 private:
  std::string name() const { return file_.string(); }
  size_t size(const char* list) const { return out_.contains(list) ? out_[list].size() : 0; }

  template <class F>
  void each(const char* key, F&& f) {
    const auto it = json_.find(key);
    if (it == json_.end()) return;
    JsonObject::asArray(*it, fmt::format("{}: {}", name(), key));
    Json all = Json::array();
    for (size_t i = 0; i < it->size(); ++i) {
      Copy c((*it)[i], fmt::format("{}: {}[{}]", name(), key, i));
      f(c, i);
      all.push_back(std::move(c.result()));
    }
    if (!all.empty()) out_[key] = std::move(all);
  }

  /// A file that needs an extension means something else without it.
  void required() {
    const auto it = json_.find("extensionsRequired");
    if (it == json_.end()) return;
    for (const Json& e : JsonObject::asArray(*it, name() + ": extensionsRequired")) {
      const std::string extension = JsonObject::asText(e, name() + ": extensionsRequired");
      if (extension != "KHR_materials_unlit" && extension != "KHR_materials_emissive_strength")
        throw badInput(name(), fmt::format("it needs the glTF extension {}, which is not read", extension));
    }
  }

  void buffer(Copy& c, size_t i) {
    const uint64_t length = whole(c.need("byteLength"), c.at("byteLength"), kMostBytes);
    c.set("byteLength", length);
    c.text("uri");
    std::string content;
    if (!c.has("uri")) {
      if (i != 0 || !container_.hasChunk) throw badInput(c.where(), "'uri' is missing");
      content = std::string(container_.chunk);
    } else if (const std::string uri = c.need("uri").get<std::string>(); uri.rfind("data:", 0) == 0) {
      if (!decodeDataUri(uri, content)) throw badInput(c.at("uri"), "its data is not base64");
    } else {
      const std::filesystem::path path = file_.parent_path() / uri;
      if (!std::filesystem::is_regular_file(path))
        throw badInput(c.where(), fmt::format("its file '{}' is missing", uri));
      content = readFile(path);
    }
    if (content.size() < length || length == 0)
      throw badInput(c.where(), fmt::format("cut off: {} bytes are promised, {} are there", length, content.size()));
    content.resize(static_cast<size_t>(length));
    buffers_.push_back(std::move(content));
  }

  void view(Copy& c) {
    View v;
    v.buffer = c.needIndex("buffer", buffers_.size());
    v.offset = c.number("byteOffset", 0, kMostBytes);
    c.need("byteLength");
    v.length = c.number("byteLength", 0, kMostBytes);
    v.stride = c.number("byteStride", 0, 252);
    if (v.offset + v.length > buffers_[v.buffer].size())
      throw badInput(c.where(), fmt::format("it ends at byte {}, its buffer has {}", v.offset + v.length,
                                            buffers_[v.buffer].size()));
    views_.push_back(v);
  }

  void accessor(Copy& c) {
    Accessor a;
    c.need("count"), c.need("componentType");
    a.count = c.number("count", 0, uint64_t{1} << 31);
    a.componentType = static_cast<int>(c.number("componentType", 0, 1 << 16));
    a.type = JsonObject::asText(c.need("type"), c.at("type"));
    c.text("type");
    const uint64_t component = a.componentType == kFloat || a.componentType == kInt   ? 4
                               : a.componentType == kShort || a.componentType == 5122 ? 2
                               : a.componentType == kByte || a.componentType == 5120  ? 1
                                                                                      : 0;
    const uint64_t components = a.type == "SCALAR"                     ? 1
                                : a.type == "VEC2"                     ? 2
                                : a.type == "VEC3"                     ? 3
                                : a.type == "VEC4" || a.type == "MAT2" ? 4
                                : a.type == "MAT3"                     ? 9
                                : a.type == "MAT4"                     ? 16
                                                                       : 0;
    if (component == 0) throw badInput(c.at("componentType"), fmt::format("{} is no type of glTF", a.componentType));
    if (components == 0) throw badInput(c.at("type"), "it is no type of glTF");
    if (a.count == 0) throw badInput(c.at("count"), "it is 0");
    c.refuse("sparse", "sparse accessors are not read");
    a.size = component * components;
    a.view = c.needIndex("bufferView", views_.size());
    a.offset = c.number("byteOffset", 0, kMostBytes);
    const View& v = views_[a.view];
    if (v.stride != 0 && v.stride < a.size)
      throw badInput(c.where(), fmt::format("its elements of {} bytes overlap at a stride of {}", a.size, v.stride));
    a.stride = v.stride ? v.stride : a.size;
    if (const uint64_t end = a.offset + a.stride * (a.count - 1) + a.size; end > v.length)
      throw badInput(c.where(), fmt::format("its {} elements end at byte {}, its view has {}", a.count, end, v.length));
    accessors_.push_back(a);
  }

  void image(Copy& c) {
    if (c.has("uri") == c.has("bufferView")) throw badInput(c.where(), "either 'uri' or 'bufferView' is wanted");
    c.mayIndex("bufferView", views_.size());
    c.text("uri"), c.text("mimeType");
    if (c.has("bufferView")) c.need("mimeType");
    std::string decoded;
    if (c.has("uri"))
      if (const std::string uri = c.need("uri").get<std::string>();
          uri.rfind("data:", 0) == 0 && (!decodeDataUri(uri, decoded) || decoded.empty()))
        throw badInput(c.at("uri"), "its data is not base64");
  }

  void texture(Copy& owner, const char* key) {
    if (!owner.has(key)) return;
    Copy c(owner.need(key), owner.at(key));
    c.needIndex("index", size("textures"));
    if (c.number("texCoord", 0, 7) != 0)
      throw badInput(c.at("texCoord"), "images are read with the first set of coordinates, 0");
    if (const Json* e = extension(c, "KHR_texture_transform"); e)
      throw badInput(c.where(), "KHR_texture_transform is not read");
    owner.set(key, c.result());
  }

  static const Json* extension(const Copy& c, const char* which) {
    if (!c.has("extensions")) return nullptr;
    const Json& all = c.need("extensions");
    if (!all.is_object()) throw badInput(c.at("extensions"), "an object is wanted");
    const auto it = all.find(which);
    return it == all.end() ? nullptr : &*it;
  }

  void material(Copy& c) {
    c.text("name"), c.text("alphaMode"), c.flag("doubleSided");
    c.real("alphaCutoff", 0, 1);
    c.reals("emissiveFactor", 3, 0, 1e15);
    if (const Json* e = extension(c, "KHR_materials_emissive_strength"); e && c.has("emissiveFactor")) {
      Copy strength(*e, c.at("extensions.KHR_materials_emissive_strength"));
      strength.real("emissiveStrength", 0, 1e15);
      const double factor = strength.has("emissiveStrength") ? strength.need("emissiveStrength").get<double>() : 1.0;
      for (Json& v : c.result()["emissiveFactor"]) v = v.get<double>() * factor;
    }
    texture(c, "normalTexture");
    texture(c, "emissiveTexture");
    if (!c.has("pbrMetallicRoughness")) return;
    Copy pbr(c.need("pbrMetallicRoughness"), c.at("pbrMetallicRoughness"));
    pbr.reals("baseColorFactor", 4, 0, 1);
    texture(pbr, "baseColorTexture");
    if (pbr.has("metallicFactor") || pbr.has("roughnessFactor") || pbr.has("metallicRoughnessTexture")) ++metallicRoughness_;
    c.set("pbrMetallicRoughness", pbr.result());
  }

  void mesh(Copy& c) {
    c.text("name");
    Json kept = Json::array();
    const Json& primitives = JsonObject::asArray(c.need("primitives"), c.at("primitives"));
    for (size_t k = 0; k < primitives.size(); ++k) {
      Copy p(primitives[k], fmt::format("{}.primitives[{}]", c.where(), k));
      primitive(p);
      kept.push_back(std::move(p.result()));
    }
    c.set("primitives", std::move(kept));
  }

  void primitive(Copy& c) {
    if (progress_) progress_->check();
    const uint64_t mode = c.number("mode", 4, 6);
    c.mayIndex("material", size("materials"));
    c.refuse("targets", "morph targets are not read");
    Copy attributes(c.need("attributes"), c.at("attributes"));
    for (const char* skin : {"JOINTS_0", "WEIGHTS_0"}) attributes.refuse(skin, "skins are not read");
    attributes.need("POSITION");
    const uint64_t vertices = vectors(attributes, "POSITION", "VEC3", 0);
    vectors(attributes, "NORMAL", "VEC3", vertices);
    vectors(attributes, "TEXCOORD_0", "VEC2", vertices);
    vectors(attributes, "TEXCOORD_1", "VEC2", vertices);
    c.set("attributes", attributes.result());
    uint64_t corners = vertices;
    if (c.has("indices")) {
      const Accessor& a = accessors_[c.needIndex("indices", accessors_.size())];
      if (a.type != "SCALAR" || (a.componentType != kByte && a.componentType != kShort && a.componentType != kInt))
        throw badInput(c.at("indices"), "indices are SCALAR of unsigned integers");
      indicesInRange(a, vertices, c.at("indices"));
      corners = a.count;
    }
    if (mode == 4 && corners % 3 != 0)
      throw badInput(c.where(), fmt::format("its {} corners make no whole triangles", corners));
    triangles_ = triangles_ || (mode >= 4 && corners >= 3);
  }

  /// An attribute of floats, all finite; gives its count, which must be `wanted` where that is not 0.
  uint64_t vectors(Copy& attributes, const char* key, const char* type, uint64_t wanted) {
    if (!attributes.has(key)) return 0;
    const Accessor& a = accessors_[attributes.needIndex(key, accessors_.size())];
    const std::string where = attributes.at(key);
    if (a.type != type || a.componentType != kFloat)
      throw badInput(where, fmt::format("it is read as {} of floats", type));
    if (wanted != 0 && a.count != wanted)
      throw badInput(where, fmt::format("it has {} elements, POSITION has {}", a.count, wanted));
    elements(a, [&](uint64_t i, const char* p) {
      for (uint64_t k = 0; k < a.size; k += 4) {
        float x = 0;
        std::memcpy(&x, p + k, 4);
        if (!std::isfinite(x)) throw badInput(where, fmt::format("element {} is not finite", i));
      }
    });
    return a.count;
  }
  void indicesInRange(const Accessor& a, uint64_t vertices, const std::string& where) const {
    elements(a, [&](uint64_t i, const char* p) {
      uint32_t v = 0;
      std::memcpy(&v, p, a.size);  // little-endian, as the format is
      if (v >= vertices)
        throw badInput(where, fmt::format("index {} is {}, but there are {} vertices", i, v, vertices));
    });
  }
  template <class F>
  void elements(const Accessor& a, F&& f) const {
    const View& v = views_[a.view];
    const char* data = buffers_[v.buffer].data() + v.offset + a.offset;
    for (uint64_t i = 0; i < a.count; ++i) f(i, data + i * a.stride);
  }

  void node(Copy& c, size_t i) {
    const size_t count = json_["nodes"].size();
    c.text("name");
    c.mayIndex("mesh", size("meshes"));
    c.refuse("skin", "skins are not read");
    c.reals("matrix", 16, -1e30, 1e30);
    c.reals("translation", 3, -1e30, 1e30), c.reals("rotation", 4, -1e30, 1e30), c.reals("scale", 3, -1e30, 1e30);
    children_.resize(count), parents_.resize(count);
    if (!c.has("children")) return;
    for (const Json& child : JsonObject::asArray(c.need("children"), c.at("children"))) {
      const uint64_t k = index(child, c.at("children"), count);
      children_[i].push_back(k);
      if (++parents_[k] > 1) throw badInput(c.at("children"), fmt::format("node {} has two parents", k));
    }
    c.set("children", children_[i]);
  }

  /// Every node has one parent at most: one that no root reaches is on a circle.
  void tree() {
    std::vector<std::pair<uint64_t, int>> open;
    for (size_t i = 0; i < children_.size(); ++i)
      if (parents_[i] == 0) open.emplace_back(i, 0);
    size_t reached = 0;
    for (; !open.empty(); ++reached) {
      const auto [node, depth] = open.back();
      open.pop_back();
      if (depth > kDeepest) throw badInput(name() + ": nodes", fmt::format("they are nested deeper than {}", kDeepest));
      for (const uint64_t child : children_[node]) open.emplace_back(child, depth + 1);
    }
    if (reached != children_.size()) throw badInput(name() + ": nodes", "some are their own ancestors");
  }

  void scene(Copy& c) {
    if (!c.has("nodes")) return;
    std::vector<uint64_t> roots;
    for (const Json& n : JsonObject::asArray(c.need("nodes"), c.at("nodes"))) {
      const uint64_t k = index(n, c.at("nodes"), children_.size());
      if (parents_[k] != 0 || std::find(roots.begin(), roots.end(), k) != roots.end())
        throw badInput(c.at("nodes"), fmt::format("node {} is no root, or is listed twice", k));
      roots.push_back(k);
    }
    c.set("nodes", roots);
  }

  std::filesystem::path file_;
  Progress* progress_;
  GltfContainer container_;
  Json json_, out_ = Json::object();
  std::vector<std::string> buffers_;
  std::vector<View> views_;
  std::vector<Accessor> accessors_;
  std::vector<std::vector<uint64_t>> children_;
  std::vector<int> parents_;
  bool triangles_ = false;
  size_t metallicRoughness_ = 0;
};

}  // namespace

std::string checkGltf(std::string_view bytes, const std::filesystem::path& file, Progress* progress, std::vector<std::string>* warnings) {
  Check check(bytes, file, progress);
  std::string checked = check.run();
  if (const size_t n = check.metallicRoughness(); n > 0 && warnings)
    warnings->push_back(fmt::format("{}: metallic and roughness of {} material{} are not read; surfaces are diffuse", file.string(), n, n == 1 ? "" : "s"));
  return checked;
}

}  // namespace hl
