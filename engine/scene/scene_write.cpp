// "Save scene as": what was edited goes over the JSON of the scene's file; the rest of that file stays.
#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "engine/core/files.h"
#include "engine/scene/json_reader.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene_bundle.h"
#include "engine/scene/scene_file.h"

namespace hl {
namespace {

using Json = nlohmann::json;

/// The shortest decimal that reads back as the same float: 0.1 instead of 0.10000000149.
double decimal(float v) { return std::strtod(fmt::format("{}", v).c_str(), nullptr); }
Json numbers(vec3 v) { return {decimal(v.x), decimal(v.y), decimal(v.z)}; }
double degrees(float radians) { return std::strtod(fmt::format("{:.6g}", radians * 180 / kPi).c_str(), nullptr); }

Json lights(const Scene& s) {
  Json all = Json::array();
  const vec3 back = s.report.recentred;  // files have the places from before
  for (const PointLight& l : s.pointLights)
    all.push_back({{"type", "point"},
                   {"name", l.name},
                   {"position", numbers(l.position + back)},
                   {"intensity", numbers(l.intensity)}});
  for (const SpotLight& l : s.spotLights)
    all.push_back({{"type", "spot"},
                   {"name", l.name},
                   {"position", numbers(l.position + back)},
                   {"direction", numbers(l.direction)},
                   {"intensity", numbers(l.intensity)},
                   {"inner_degrees", degrees(l.innerAngle)},
                   {"outer_degrees", degrees(l.outerAngle)}});
  for (const DirectionalLight& l : s.directionalLights)
    all.push_back({{"type", "directional"},
                   {"name", l.name},
                   {"direction", numbers(l.direction)},
                   {"irradiance", numbers(l.irradiance)}});
  return all;
}

Json cameras(const Scene& s) {
  Json all = Json::array();
  for (const Camera& c : s.cameras)
    all.push_back({{"name", c.name},
                   {"position", numbers(c.position + s.report.recentred)},
                   {"target", numbers(c.target + s.report.recentred)},
                   {"up", numbers(c.up)},
                   {"vertical_fov_degrees", degrees(c.verticalFov)}});
  return all;
}

Json cameraPaths(const Scene& s) {
  Json all = Json::array();
  for (const CameraPath& p : s.cameraPaths) {
    Json keys = Json::array();
    for (const CameraKey& k : p.keys)
      keys.push_back({{"time", decimal(k.time)},
                      {"position", numbers(k.camera.position + s.report.recentred)},
                      {"target", numbers(k.camera.target + s.report.recentred)},
                      {"up", numbers(k.camera.up)},
                      {"vertical_fov_degrees", degrees(k.camera.verticalFov)}});
    const char* repeat = p.repeat == Repeat::Once ? "once" : p.repeat == Repeat::Loop ? "loop" : "ping_pong";
    all.push_back({{"name", p.name}, {"repeat", repeat}, {"keys", std::move(keys)}});
  }
  return all;
}

/// Materials whose constants differ from those the file gives.
void materials(const Scene& s, Json& root) {
  const Scene before = loadScene(s.source.string());
  for (const Material& m : s.materials)
    for (const Material& old : before.materials) {
      if (old.name != m.name) continue;
      Json& all = root["materials"];
      if (m.albedo != old.albedo) all[m.name]["albedo"] = numbers(m.albedo);
      if (m.emission != old.emission) all[m.name]["emission"] = numbers(m.emission);
      if (m.specular != old.specular) all[m.name]["specular"] = numbers(m.specular);
      if (m.roughness != old.roughness) all[m.name]["roughness"] = decimal(m.roughness);
      if (m.twoSided != old.twoSided) all[m.name]["two_sided"] = m.twoSided;
      if (all.is_null()) root.erase("materials");
      break;
    }
}

}  // namespace

std::string sceneJson(const Scene& scene) {
  if (isBundleFile(scene.source))
    throw badInput(fmt::format("{}: a scene out of a bundle has no file to write over; save a preset, or open the scene's own file", scene.source.string()));
  Json root = {{"version", 1}};
  if (isMeshFile(scene.source))
    root["mesh"] = {{"file", std::filesystem::absolute(scene.source).string()}};
  else if (!scene.source.empty())
    root = parseJson(readFile(scene.source), scene.source.string());
  if (!scene.source.empty()) materials(scene, root);
  root["lights"] = lights(scene);
  root["sky"] = numbers(scene.sky);
  root["cameras"] = cameras(scene);
  if (!scene.probes.empty() || root.contains("probes")) {
    root["probes"] = Json::array();
    for (const vec3 p : scene.probes) root["probes"].push_back(numbers(p + scene.report.recentred));
  }
  if (!scene.cameraPaths.empty()) root["camera_paths"] = cameraPaths(scene);
  return root.dump(2) + "\n";
}

}  // namespace hl
