#include "engine/scene/scene_description.h"

#include <cmath>

#include "engine/core/files.h"
#include "engine/scene/animation.h"
#include "engine/scene/json_reader.h"
#include "shaders/shared/ggx.h"

namespace hl {
namespace {

using Json = nlohmann::json;
constexpr double kFarthest = 1e9;    // metres; beyond it a float has no centimetres, whatever is recentred
constexpr double kBrightest = 1e15;  // radiance and intensity; sums of many stay below a float's 3e38

/// The bound as a person writes it: 0.05, not the float's 0.05000000075.
const double kLeastRoughness = std::round(static_cast<double>(shared::kMinRoughness) * 1e6) / 1e6;

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
    each(o, "shapes", [&](const Json& v, const std::string& place) { addShapes(d, v, place); });
    if (const Json* v = o.find("materials")) {
      if (!v->is_object())
        throw badInput(o.at("materials"), "an object is wanted: material names and what they change");
      for (const auto& [name, m] : v->items()) d.materials.emplace_back(name, material(m, o.at("materials." + name)));
    }
    each(o, "lights", [&](const Json& v, const std::string& place) { light(d, v, place); });
    if (const Json* v = o.find("sky")) d.sky = JsonObject::asVec3(*v, o.at("sky"), 0, kBrightest, true);
    if (const Json* v = o.find("environment")) d.environment = environment(*v, o.at("environment"));
    each(o, "cameras", [&](const Json& v, const std::string& place) { d.cameras.push_back(camera(v, place)); });
    each(o, "regions", [&](const Json& v, const std::string& place) { d.regions.push_back(region(v, place)); });
    each(o, "probes", [&](const Json& v, const std::string& place) { d.probes.push_back(JsonObject::asVec3(v, place, -kFarthest, kFarthest)); });
    each(o, "animations", [&](const Json& v, const std::string& place) { readAnimation(d, v, place); });
    each(o, "camera_paths", [&](const Json& v, const std::string& place) { d.cameraPaths.push_back(readCameraPath(v, place)); });
    for (size_t i = 0; i < d.cameraPaths.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (d.cameraPaths[j].name == d.cameraPaths[i].name)
          throw badInput(fmt::format("{}[{}].name", o.at("camera_paths"), i), fmt::format("there is a path '{}' already", d.cameraPaths[i].name));
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

  static Camera cameraView(JsonObject& o) {
    Camera c;
    c.position = point(o, "position");
    c.target = point(o, "target");
    if (o.find("up")) c.up = direction(o, "up");
    c.verticalFov = static_cast<float>(o.number("vertical_fov_degrees", 45, 1, 170)) * kPi / 180;
    const vec3 view = c.target - c.position;
    if (!(glm::length(view) > 0)) throw badInput(o.at("target"), "it must differ from 'position'");
    if (glm::length(glm::cross(glm::normalize(view), c.up)) < 1e-4f)
      throw badInput(o.at("up"), "it must not lie along the line of sight");
    return c;
  }

  static Repeat repeat(JsonObject& o, const char* otherwise) {
    const std::string way = o.text("repeat", otherwise);
    if (way == "once") return Repeat::Once;
    if (way == "loop") return Repeat::Loop;
    if (way == "ping_pong") return Repeat::PingPong;
    throw badInput(o.at("repeat"), fmt::format("once, loop or ping_pong is wanted, not '{}'", way));
  }

  /// Calls `f` for each key, an object, with its time. Times begin at 0 and ascend.
  template <class F>
  static void keys(JsonObject& o, F&& f) {
    const Json& list = JsonObject::asArray(o.need("keys"), o.at("keys"));
    if (list.empty()) throw badInput(o.at("keys"), "at least one key is wanted");
    float last = -1;
    for (size_t i = 0; i < list.size(); ++i) {
      JsonObject k(list[i], fmt::format("{}[{}]", o.at("keys"), i));
      const auto time = static_cast<float>(JsonObject::asNumber(k.need("time"), k.at("time"), 0, static_cast<double>(kLongestAnimation)));
      if (i == 0 && time != 0) throw badInput(k.at("time"), fmt::format("the first key is at 0 s, not at {}", time));
      if (!(time > last)) throw badInput(k.at("time"), fmt::format("{} s is not after the key before it, at {} s", time, last));
      last = time;
      f(k, time);
      k.refuseUnknown();
    }
  }

  static void readAnimation(SceneDescription& d, const Json& v, const std::string& place) {
    JsonObject o(v, place);
    if (o.find("light")) return lightAnimation(d, o);
    AnimationDescription out;
    out.place = place;
    for (const Json& name : JsonObject::asArray(o.need("objects"), o.at("objects"))) out.objects.push_back(JsonObject::asText(name, o.at("objects")));
    if (out.objects.empty()) throw badInput(o.at("objects"), "the names of the objects that move are wanted");
    ObjectAnimation& a = out.animation;
    a.name = o.text("name", out.objects.front());
    if (o.find("pivot")) a.pivot = point(o, "pivot");
    if (o.find("axis")) a.axis = direction(o, "axis");
    a.repeat = repeat(o, "loop");
    a.eased = o.boolean("eased", false);
    keys(o, [&](JsonObject& k, float time) {
      PoseKey key;
      key.time = time;
      if (k.find("translation")) key.translation = point(k, "translation");
      key.angle = static_cast<float>(k.number("angle_degrees", 0, -1e6, 1e6) * (3.14159265358979323846 / 180));
      if (const Json* s = k.find("scale")) key.scale = JsonObject::asVec3(*s, k.at("scale"), 1e-4, 1e4, true);
      a.keys.push_back(key);
    });
    o.refuseUnknown();
    d.animations.push_back(std::move(out));
  }

  static void lightAnimation(SceneDescription& d, JsonObject& o) {
    LightAnimation a;
    a.light = JsonObject::asText(o.need("light"), o.at("light"));
    a.repeat = repeat(o, "loop");
    a.eased = o.boolean("eased", false);
    bool first = true;
    keys(o, [&](JsonObject& k, float time) {
      LightKey key;
      key.time = time;
      const bool position = k.find("position"), turns = k.find("direction"), factor = k.find("intensity_factor");
      if (first) a.movesPosition = position, a.turnsDirection = turns, a.scalesIntensity = factor, first = false;
      if (position != a.movesPosition || turns != a.turnsDirection || factor != a.scalesIntensity)
        throw badInput(k.place(), "each key of a light's animation says the same things, of position, direction and intensity_factor");
      if (!position && !turns && !factor) throw badInput(k.place(), "position, direction or intensity_factor is wanted");
      if (position) key.position = point(k, "position");
      if (turns) key.direction = direction(k, "direction");
      if (factor) key.factor = static_cast<float>(k.number("intensity_factor", 1, 0, 1e6));
      a.keys.push_back(key);
    });
    o.refuseUnknown();
    d.lightAnimations.emplace_back(o.place(), std::move(a));
  }

  static CameraPath readCameraPath(const Json& v, const std::string& place) {
    JsonObject o(v, place);
    CameraPath p;
    p.name = JsonObject::asText(o.need("name"), o.at("name"));
    if (p.name.empty()) throw badInput(o.at("name"), "a name is wanted");
    p.repeat = repeat(o, "once");
    keys(o, [&](JsonObject& k, float time) { p.keys.push_back({time, cameraView(k)}); });
    o.refuseUnknown();
    return p;
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

  static EnvironmentReference environment(const Json& v, const std::string& place) {
    EnvironmentReference e;
    if (v.is_string()) {
      e.file = v.get<std::string>();
      return e;
    }
    JsonObject o(v, place);
    e.file = JsonObject::asText(o.need("file"), o.at("file"));
    e.rotation = static_cast<float>(o.number("rotation_degrees", 0, -360, 360)) * kPi / 180;
    if (const Json* s = o.find("scale")) e.scale = JsonObject::asVec3(*s, o.at("scale"), 0, 1e9, true);
    e.obtain = o.text("obtain", "");
    o.refuseUnknown();
    return e;
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

  /// About, and never too few.
  static size_t trianglesOf(const Shape& s) {
    const auto n = static_cast<size_t>(s.subdivisions);
    switch (s.type) {
      case ShapeType::Box: return 12 * n * n;
      case ShapeType::UvSphere: return 4 * n * n;
      case ShapeType::Icosphere: return 20 * n * n;
      case ShapeType::Lathe: return 2 * n * s.profile.size();
      case ShapeType::Arch: return 6 * n + 32;
      default: return 2 * n * n;
    }
  }

  /// The shape, and its copies: `copies` has a number and a step each, and multiplies what those before it made.
  static void addShapes(SceneDescription& d, const Json& v, const std::string& place) {
    std::vector<std::pair<int, vec3>> copies;
    std::vector<Shape> made = {shape(v, place, copies)};
    for (const auto& [count, step] : copies) {
      const size_t before = made.size();
      if (before * static_cast<size_t>(count) + d.shapes.size() > kMostShapes)
        throw badInput(place + ".copies", fmt::format("more than {} shapes in the scene", kMostShapes));
      if (before * static_cast<size_t>(count) * trianglesOf(made[0]) > kMostShapeTriangles)
        throw badInput(place + ".copies", fmt::format("they make more than {} triangles", kMostShapeTriangles));
      for (int i = 1; i < count; ++i)
        for (size_t k = 0; k < before; ++k) {
          Shape s = made[k];
          const vec3 by = static_cast<float>(i) * step;
          for (vec3& c : s.corners) c += by;
          s.min += by, s.max += by, s.centre += by;
          made.push_back(std::move(s));
        }
    }
    if (made.size() > 1)
      for (size_t i = 0; i < made.size(); ++i) made[i].name += fmt::format(" {}", i + 1);
    d.shapes.insert(d.shapes.end(), made.begin(), made.end());
  }

  static Shape shape(const Json& v, const std::string& place, std::vector<std::pair<int, vec3>>& copies) {
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
    else if (type == "lathe")
      lathe(o, s);
    else if (type == "arch")
      arch(o, s);
    else if (type == "cloth")
      cloth(o, s);
    else
      throw badInput(o.at("type"), fmt::format("unknown shape '{}'; known are quad, box, uv_sphere, icosphere, lathe, arch, cloth", type));
    if (const Json* list = o.find("copies")) {
      JsonObject::asArray(*list, o.at("copies"));
      for (size_t i = 0; i < list->size(); ++i) {
        JsonObject c((*list)[i], fmt::format("{}[{}]", o.at("copies"), i));
        c.need("count");
        const int count = c.integer("count", 1, 1, 1000);
        copies.emplace_back(count, point(c, "step"));
        c.refuseUnknown();
      }
    }
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

  static void lathe(JsonObject& o, Shape& s) {
    s.type = ShapeType::Lathe;
    s.centre = point(o, "centre");
    const Json& list = JsonObject::asArray(o.need("profile"), o.at("profile"));
    if (list.size() < 2) throw badInput(o.at("profile"), "at least two points [radius, height] are wanted");
    for (size_t i = 0; i < list.size(); ++i) {
      const std::string at = fmt::format("{}[{}]", o.at("profile"), i);
      if (!list[i].is_array() || list[i].size() != 2) throw badInput(at, "[radius, height] is wanted");
      s.profile.emplace_back(static_cast<float>(JsonObject::asNumber(list[i][0], at, 0, kFarthest)),
                             static_cast<float>(JsonObject::asNumber(list[i][1], at, -kFarthest, kFarthest)));
      if (i > 0 && s.profile[i] == s.profile[i - 1]) throw badInput(at, "it is the same as the point before");
    }
    s.smooth = o.boolean("smooth", true);
    s.subdivisions = o.integer("subdivisions", 24, 3, 256);
  }

  static void arch(JsonObject& o, Shape& s) {
    s.type = ShapeType::Arch;
    s.min = point(o, "min");
    s.max = point(o, "max");
    for (int i = 0; i < 3; ++i)
      if (!(s.min[i] < s.max[i])) throw badInput(o.at("max"), "each of its coordinates must exceed that of 'min'");
    const std::string along = o.text("along", "x");
    if (along != "x" && along != "z") throw badInput(o.at("along"), fmt::format("x or z is wanted, not '{}'", along));
    s.alongX = along == "x";
    s.radius = static_cast<float>(o.number("radius", 1, 1e-6, kFarthest));
    const float half = 0.5f * (s.alongX ? s.max.x - s.min.x : s.max.z - s.min.z);
    if (!(s.radius < half && s.radius < s.max.y - s.min.y))
      throw badInput(o.at("radius"), fmt::format("it must be below {}, so that the opening lies in the wall", std::min(half, s.max.y - s.min.y)));
    s.subdivisions = o.integer("subdivisions", 24, 2, 256);
  }

  static void cloth(JsonObject& o, Shape& s) {
    quad(o, s);
    s.type = ShapeType::Cloth;
    if (s.subdivisions < 2) throw badInput(o.at("subdivisions"), "a cloth has at least 2");
    s.folds = o.integer("folds", 0, 0, 64);
    s.depth = static_cast<float>(o.number("depth", 0, 0, kFarthest));
    s.sag = static_cast<float>(o.number("sag", 0, 0, kFarthest));
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
    if (const Json* f0 = o.find("specular")) m.specular = JsonObject::asVec3(*f0, o.at("specular"), 0, 1, true);
    if (o.find("roughness")) m.roughness = static_cast<float>(o.number("roughness", kDefaultRoughness, kLeastRoughness, 1));
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
    const std::string name = JsonObject::asText(o.need("name"), o.at("name"));
    Camera c = cameraView(o);
    c.name = name;
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
