#include "engine/scene/scene_description.h"

#include "engine/core/files.h"
#include "engine/scene/json_reader.h"

namespace hl {
namespace {

using Json = nlohmann::json;
constexpr double kFarthest = 1e9;    // metres; beyond it a float has no centimetres, whatever is recentred
constexpr double kBrightest = 1e15;  // radiance and intensity; sums of many stay below a float's 3e38

class Reader {
 public:
  Reader(const Json& root, std::string file) : root_(root), file_(std::move(file)) {}

  SceneDescription read() {
    JsonObject o(root_, file_);
    SceneDescription d;
    const int version = o.integer("version", 1, 1, 1 << 30);
    if (version > 1)
      throw badInput(o.at("version"), fmt::format("scene files have version 1 here, this one has {}", version));
    d.label = o.text("label", "");
    comment(o);
    if (const Json* v = o.find("mesh")) d.mesh = mesh(*v, o.at("mesh"));
    d.lightmapUvs = o.boolean("lightmap_uvs", false);
    if (d.lightmapUvs && d.mesh)
      throw badInput(o.at("lightmap_uvs"), "only shapes get a lightmap UV set; a mesh brings its own");
    each(o, "shapes", [&](const Json& v, const std::string& place) { d.shapes.push_back(shape(v, place)); });
    if (const Json* v = o.find("materials")) {
      if (!v->is_object())
        throw badInput(o.at("materials"), "an object is wanted: material names and what they change");
      for (const auto& [name, m] : v->items()) d.materials.emplace_back(name, material(m, o.at("materials." + name)));
    }
    each(o, "lights", [&](const Json& v, const std::string& place) { light(d, v, place); });
    if (const Json* v = o.find("sky")) d.sky = JsonObject::asVec3(*v, o.at("sky"), 0, kBrightest, true);
    each(o, "cameras", [&](const Json& v, const std::string& place) { d.cameras.push_back(camera(v, place)); });
    each(o, "regions", [&](const Json& v, const std::string& place) { d.regions.push_back(region(v, place)); });
    o.refuseUnknown();
    return d;
  }

 private:
  template <class F>
  void each(JsonObject& o, const char* key, F&& f) {
    const Json* list = o.find(key);
    if (!list) return;
    JsonObject::asArray(*list, o.at(key));
    for (size_t i = 0; i < list->size(); ++i) f((*list)[i], fmt::format("{}[{}]", o.at(key), i));
  }

  static void comment(JsonObject& o) {
    const Json* v = o.find("comment");
    if (!v || v->is_string()) return;
    for (const Json& line : JsonObject::asArray(*v, o.at("comment"))) JsonObject::asText(line, o.at("comment"));
  }

  static MeshReference mesh(const Json& v, const std::string& place) {
    MeshReference m;
    if (v.is_string()) {
      m.file = v.get<std::string>();
      return m;
    }
    JsonObject o(v, place);
    m.file = JsonObject::asText(o.need("file"), o.at("file"));
    m.scale = o.number("import_scale", 1, 1e-9, 1e9);
    m.vDown = o.boolean("v_down", false);
    m.obtain = o.text("obtain", "");
    o.refuseUnknown();
    return m;
  }

  static vec3 point(JsonObject& o, const char* key) {
    return JsonObject::asVec3(o.need(key), o.at(key), -kFarthest, kFarthest);
  }
  static vec3 direction(JsonObject& o, const char* key) {
    const vec3 d = point(o, key);
    if (!(glm::length(d) > 0)) throw badInput(o.at(key), "a direction of length 0 points nowhere");
    return glm::normalize(d);
  }
  static vec3 amount(JsonObject& o, const char* key) {
    return JsonObject::asVec3(o.need(key), o.at(key), 0, kBrightest, true);
  }

  static Shape shape(const Json& v, const std::string& place) {
    JsonObject o(v, place);
    Shape s;
    const std::string type = JsonObject::asText(o.need("type"), o.at("type"));
    s.name = o.text("name", type);
    s.material = o.text("material", "");
    if (type == "quad")
      quad(o, s);
    else if (type == "box")
      box(o, s);
    else if (type == "uv_sphere" || type == "icosphere")
      sphere(o, s, type == "uv_sphere");
    else
      throw badInput(o.at("type"), fmt::format("unknown shape '{}'; known are quad, box, uv_sphere, icosphere", type));
    if (s.material.empty() && s.faceMaterials.size() < 6) throw badInput(place, "'material' is missing");
    o.refuseUnknown();
    return s;
  }

  static void quad(JsonObject& o, Shape& s) {
    s.type = ShapeType::Quad;
    const Json& corners = JsonObject::asArray(o.need("corners"), o.at("corners"));
    if (corners.size() != 4)
      throw badInput(o.at("corners"), fmt::format("4 points are wanted, not {}", corners.size()));
    for (size_t i = 0; i < 4; ++i)
      s.corners.push_back(
          JsonObject::asVec3(corners[i], fmt::format("{}[{}]", o.at("corners"), i), -kFarthest, kFarthest));
    s.subdivisions = o.integer("subdivisions", 1, 1, 256);
  }

  static void box(JsonObject& o, Shape& s) {
    s.type = ShapeType::Box;
    s.min = point(o, "min");
    s.max = point(o, "max");
    for (int i = 0; i < 3; ++i)
      if (!(s.min[i] < s.max[i])) throw badInput(o.at("max"), "each of its coordinates must exceed that of 'min'");
    facing(o, s);
    s.subdivisions = o.integer("subdivisions", 1, 1, 256);
    const std::vector<std::string> known(std::begin(kBoxFaces), std::end(kBoxFaces));
    const auto face = [&](const std::string& name, const std::string& where) {
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw badInput(where, fmt::format("unknown face '{}'; known are {}", name, fmt::join(known, ", ")));
      return name;
    };
    if (const Json* v = o.find("faces"))
      for (const Json& f : JsonObject::asArray(*v, o.at("faces")))
        s.faces.push_back(face(JsonObject::asText(f, o.at("faces")), o.at("faces")));
    if (const Json* v = o.find("face_materials")) {
      if (!v->is_object()) throw badInput(o.at("face_materials"), "an object is wanted: faces and their materials");
      for (const auto& [name, m] : v->items())
        s.faceMaterials[face(name, o.at("face_materials"))] = JsonObject::asText(m, o.at("face_materials." + name));
    }
  }

  static void sphere(JsonObject& o, Shape& s, bool uv) {
    s.type = uv ? ShapeType::UvSphere : ShapeType::Icosphere;
    s.centre = point(o, "centre");
    s.radius = static_cast<float>(o.number("radius", 1, 1e-6, kFarthest));
    facing(o, s);
    s.smooth = o.boolean("smooth", false);
    s.subdivisions = o.integer("subdivisions", 16, uv ? 2 : 1, 256);
  }

  static void facing(JsonObject& o, Shape& s) {
    const std::string way = o.text("facing", "outward");
    if (way != "inward" && way != "outward")
      throw badInput(o.at("facing"), fmt::format("'inward' or 'outward' is wanted, not '{}'", way));
    s.inward = way == "inward";
  }

  static MaterialOverride material(const Json& v, const std::string& place) {
    JsonObject o(v, place);
    MaterialOverride m;
    if (const Json* a = o.find("albedo")) m.albedo = JsonObject::asVec3(*a, o.at("albedo"), 0, 1, true);
    if (const Json* e = o.find("emission")) m.emission = JsonObject::asVec3(*e, o.at("emission"), 0, kBrightest, true);
    if (o.find("two_sided")) m.twoSided = o.boolean("two_sided", false);
    if (o.find("alpha_cutoff")) m.alphaCutoff = static_cast<float>(o.number("alpha_cutoff", 0, 0, 1));
    o.refuseUnknown();
    return m;
  }

  static void light(SceneDescription& d, const Json& v, const std::string& place) {
    JsonObject o(v, place);
    const std::string type = JsonObject::asText(o.need("type"), o.at("type"));
    const std::string name = o.text("name", type);
    constexpr float kDegree = kPi / 180;
    if (type == "point") {
      d.pointLights.push_back({name, point(o, "position"), amount(o, "intensity")});
    } else if (type == "spot") {
      SpotLight s{name, point(o, "position"), direction(o, "direction"), amount(o, "intensity"), 0, 0};
      s.innerAngle = static_cast<float>(o.number("inner_degrees", 20, 0, 89.9)) * kDegree;
      s.outerAngle = static_cast<float>(o.number("outer_degrees", 30, 0.1, 90)) * kDegree;
      if (!(s.innerAngle < s.outerAngle)) throw badInput(o.at("inner_degrees"), "it must be below 'outer_degrees'");
      d.spotLights.push_back(s);
    } else if (type == "directional") {
      d.directionalLights.push_back({name, direction(o, "direction"), amount(o, "irradiance")});
    } else {
      throw badInput(o.at("type"), fmt::format("unknown light '{}'; known are point, spot, directional", type));
    }
    o.refuseUnknown();
  }

  static Camera camera(const Json& v, const std::string& place) {
    JsonObject o(v, place);
    Camera c;
    c.name = JsonObject::asText(o.need("name"), o.at("name"));
    c.position = point(o, "position");
    c.target = point(o, "target");
    if (o.find("up")) c.up = direction(o, "up");
    c.verticalFov = static_cast<float>(o.number("vertical_fov_degrees", 45, 1, 170)) * kPi / 180;
    const vec3 view = c.target - c.position;
    if (!(glm::length(view) > 0)) throw badInput(o.at("target"), "it must differ from 'position'");
    if (glm::length(glm::cross(glm::normalize(view), c.up)) < 1e-4f)
      throw badInput(o.at("up"), "it must not lie along the line of sight");
    o.refuseUnknown();
    return c;
  }

  static Region region(const Json& v, const std::string& place) {
    JsonObject o(v, place);
    Region r;
    r.name = JsonObject::asText(o.need("name"), o.at("name"));
    r.x = static_cast<float>(o.number("x", 0, 0, 1));
    r.y = static_cast<float>(o.number("y", 0, 0, 1));
    r.width = static_cast<float>(o.number("width", 1, 1e-6, 1));
    r.height = static_cast<float>(o.number("height", 1, 1e-6, 1));
    if (r.x + r.width > 1.0001f || r.y + r.height > 1.0001f)
      throw badInput(place, "the region reaches beyond the image; x + width and y + height are at most 1");
    o.refuseUnknown();
    return r;
  }

  const Json& root_;
  std::string file_;
};

/// The part of nlohmann's message that speaks to a person: after "[json.exception.x.n] ".
std::string plain(const std::exception& e) {
  const std::string text = e.what();
  const size_t end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

}  // namespace

Json parseJson(std::string_view text, const std::string& file) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& e) {
    // The message quotes the input, which need not be text.
    std::string what = plain(e);
    for (char& c : what)
      if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
    throw badInput(file, fmt::format("not JSON: {}", what));
  }
}

SceneDescription parseSceneDescription(std::string_view text, const std::filesystem::path& file) {
  const Json root = parseJson(text, file.string());
  return Reader(root, file.string()).read();
}

}  // namespace hl
