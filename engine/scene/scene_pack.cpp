#include "engine/scene/scene_pack.h"

#include <algorithm>

#include "engine/core/byte_stream.h"

namespace hl {
namespace {

// Each structure is told once: `Stream` writes or reads, by the direction of `Bytes`.
class Out {
 public:
  template <class T>
  void value(const T& v) { w.value(v); }
  void flag(bool v) { w.value<uint8_t>(v); }
  void text(const std::string& s) { w.text(s); }
  template <class T>
  void array(const std::vector<T>& v) { w.array(v); }
  template <class T, class Each>
  void list(std::vector<T>& v, Each&& each) {
    w.value<uint64_t>(v.size());
    for (T& item : v) each(item);
  }
  ByteWriter w;
};

class In {
 public:
  explicit In(std::string_view bytes) : r(bytes) {}
  template <class T>
  void value(T& v) { v = r.value<T>(); }
  void flag(bool& v) { v = r.value<uint8_t>() != 0; }
  void text(std::string& s) { s = r.text(); }
  template <class T>
  void array(std::vector<T>& v) { r.array(v); }
  template <class T, class Each>
  void list(std::vector<T>& v, Each&& each) {
    v.resize(r.count(sizeof(uint64_t)));  // each item has a text, whose length alone takes so much
    for (T& item : v) each(item);
  }
  ByteReader r;
};

template <class Stream>
void material(Stream& s, Material& m) {
  s.text(m.name);
  s.value(m.albedo), s.value(m.emission), s.value(m.albedoTexture), s.value(m.normalTexture), s.value(m.alphaCutoff);
  s.flag(m.twoSided);
  s.value(m.specular), s.value(m.roughness);
}

template <class Stream>
void lights(Stream& s, Scene& scene) {
  s.list(scene.pointLights, [&](PointLight& l) { s.text(l.name), s.value(l.position), s.value(l.intensity); });
  s.list(scene.spotLights, [&](SpotLight& l) {
    s.text(l.name), s.value(l.position), s.value(l.direction), s.value(l.intensity), s.value(l.innerAngle), s.value(l.outerAngle);
  });
  s.list(scene.directionalLights, [&](DirectionalLight& l) { s.text(l.name), s.value(l.direction), s.value(l.irradiance); });
  s.value(scene.sky);
  Environment& e = scene.environment;
  s.text(e.file), s.value(e.width), s.value(e.height), s.array(e.radiance), s.value(e.rotation), s.value(e.scale);
}

template <class Stream>
void whole(Stream& s, Scene& scene) {
  s.text(scene.name), s.text(scene.hash);
  s.array(scene.positions), s.array(scene.normals), s.array(scene.uvs), s.array(scene.lightmapUvs), s.flag(scene.hasUvs);
  s.array(scene.indices), s.array(scene.materialIds), s.array(scene.objectIds);
  s.list(scene.objects, [&](std::string& name) { s.text(name); });
  s.list(scene.materials, [&](Material& m) { material(s, m); });
  s.list(scene.textures, [&](Texture& t) { s.text(t.name), s.value(t.width), s.value(t.height), s.flag(t.srgb), s.array(t.rgba); });
  lights(s, scene);
  s.list(scene.cameras, [&](Camera& c) { s.text(c.name), s.value(c.position), s.value(c.target), s.value(c.up), s.value(c.verticalFov); });
  s.list(scene.regions, [&](Region& g) { s.text(g.name), s.value(g.x), s.value(g.y), s.value(g.width), s.value(g.height); });
  s.array(scene.probes);
  s.list(scene.animations, [&](ObjectAnimation& a) {
    s.text(a.name), s.array(a.objects), s.value(a.pivot), s.value(a.axis), s.value(a.repeat), s.flag(a.eased), s.array(a.keys);
  });
  s.list(scene.lightAnimations, [&](LightAnimation& a) {
    s.text(a.light), s.flag(a.movesPosition), s.flag(a.turnsDirection), s.flag(a.scalesIntensity), s.value(a.repeat), s.flag(a.eased), s.array(a.keys);
  });
  s.list(scene.cameraPaths, [&](CameraPath& p) {
    s.text(p.name), s.value(p.repeat);
    s.list(p.keys, [&](CameraKey& k) {
      s.text(k.camera.name), s.value(k.time), s.value(k.camera.position), s.value(k.camera.target), s.value(k.camera.up), s.value(k.camera.verticalFov);
    });
  });
  s.value(scene.bounds.min), s.value(scene.bounds.max);
  ImportReport& report = scene.report;
  s.value(report.degenerateTriangles), s.value(report.cappedAlbedo), s.value(report.cappedSpecular), s.value(report.missingTextures), s.value(report.recentred);
  s.list(report.warnings, [&](std::string& line) { s.text(line); });
}

void require(bool right) {
  if (!right) throw std::out_of_range("scene");
}

void checkReferences(const Scene& s) {
  const size_t vertices = s.positions.size(), triangles = s.indices.size();
  require(s.normals.size() == vertices && s.uvs.size() == vertices);
  require(s.lightmapUvs.empty() || s.lightmapUvs.size() == vertices);
  require(s.materialIds.size() == triangles && s.objectIds.size() == triangles);
  for (const uvec3 t : s.indices) require(std::max({t.x, t.y, t.z}) < vertices);
  for (const uint32_t id : s.materialIds) require(id < s.materials.size());
  for (const uint32_t id : s.objectIds) require(id < s.objects.size());
  for (const Material& m : s.materials)
    for (const uint32_t id : {m.albedoTexture, m.normalTexture}) require(id == kNone || id < s.textures.size());
  const auto ascending = [](const auto& keys) {
    require(!keys.empty() && keys.front().time == 0);
    for (size_t i = 1; i < keys.size(); ++i) require(keys[i].time > keys[i - 1].time);
  };
  for (const ObjectAnimation& a : s.animations) {
    ascending(a.keys);
    for (const uint32_t id : a.objects) require(id < s.objects.size());
  }
  for (const LightAnimation& a : s.lightAnimations) ascending(a.keys);
  for (const CameraPath& p : s.cameraPaths) ascending(p.keys);
  const Environment& e = s.environment;
  require(e.width >= 0 && e.height >= 0 && e.radiance.size() == static_cast<size_t>(e.width) * static_cast<size_t>(e.height));
  for (const Texture& t : s.textures)
    require(t.width > 0 && t.height > 0 && t.rgba.size() == size_t{4} * static_cast<size_t>(t.width) * static_cast<size_t>(t.height));
}

}  // namespace

std::string packScene(const Scene& scene) {
  Out out;
  whole(out, const_cast<Scene&>(scene));  // one description serves both ways; Out changes nothing
  return out.w.take();
}

Scene unpackScene(std::string_view bytes) {
  In in(bytes);
  Scene scene;
  whole(in, scene);
  require(in.r.atEnd());
  checkReferences(scene);
  return scene;
}

}  // namespace hl
