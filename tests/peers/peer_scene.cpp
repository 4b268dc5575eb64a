// What another renderer needs to draw the very same picture, and our own picture with the same pixel filter.
//
//   peer_scene export SCENE CAMERA DIR
//   peer_scene atlas SCENE RESOLUTION DIR
//   peer_scene render SCENE CAMERA WIDTH HEIGHT GRID SPP SEED DIR
//
// `export` writes DIR/scene.json and DIR/*.bin: the scene as the engine loaded it (little-endian arrays, world space, metres).
// `atlas` writes DIR/corner_uvs.bin and lumels.bin (texel, chart, area; row 0 at v = 0): the lightmap's layout, for bakes.
// `render` writes DIR/ours_SEED.pfm, total radiance of diffuse transport with every bounce: emission + albedo / pi * E. The
// reference starts from given points and knows no pixel filter; here its receivers are GRID x GRID places a pixel, one at random
// in each cell of a grid, so their mean is a box filter. Each place takes SPP paths (at least 2) and as many samples of direct light. Triangles'
// own normals everywhere: peers differ in what they do with smooth ones below the horizon.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/core/error.h"
#include "engine/core/image_io.h"
#include "engine/lightmap/atlas.h"
#include "engine/reference/reference.h"
#include "engine/reference/surface.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/texture_sampling.h"
#include "shaders/shared/random.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

const Camera& cameraNamed(const Scene& scene, const std::string& name) {
  for (const Camera& c : scene.cameras)
    if (c.name == name) return c;
  throw badInput(fmt::format("peer_scene: '{}' has no camera '{}'", scene.name, name));
}

std::string json(vec3 v) { return fmt::format("[{:.9g},{:.9g},{:.9g}]", v.x, v.y, v.z); }

template <class T>
void writeArray(const fs::path& file, const std::vector<T>& values) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!out) throw badInput(fmt::format("peer_scene: cannot write {}", file.string()));
}

/// Items as a JSON array, each through `one`.
template <class T, class F>
std::string jsonArray(const std::vector<T>& items, F one) {
  std::string text;
  for (const T& item : items) text += (text.empty() ? "\n  " : ",\n  ") + one(item);
  return fmt::format("[{}]", text);
}

void exportScene(const Scene& scene, const Camera& camera, const fs::path& folder) {
  static_assert(sizeof(vec3) == 12 && sizeof(vec2) == 8 && sizeof(uvec3) == 12);
  fs::create_directories(folder);
  writeArray(folder / "positions.bin", scene.positions);
  writeArray(folder / "uvs.bin", scene.uvs);
  writeArray(folder / "indices.bin", scene.indices);
  writeArray(folder / "materials.bin", scene.materialIds);
  for (size_t i = 0; i < scene.textures.size(); ++i)
    writeArray(folder / fmt::format("texture_{}.bin", i), scene.textures[i].rgba);
  const std::string materials = jsonArray(scene.materials, [](const Material& m) {
    return fmt::format(R"({{"albedo":{},"emission":{},"texture":{},"alpha_cutoff":{:.9g},"two_sided":{}}})", json(m.albedo), json(m.emission),
                       m.albedoTexture == kNone ? -1 : static_cast<int>(m.albedoTexture), m.alphaCutoff, m.twoSided);
  });
  const std::string textures = jsonArray(scene.textures, [](const Texture& t) {
    return fmt::format(R"({{"width":{},"height":{},"srgb":{}}})", t.width, t.height, t.srgb);
  });
  const std::string points = jsonArray(scene.pointLights, [](const PointLight& l) {
    return fmt::format(R"({{"position":{},"intensity":{}}})", json(l.position), json(l.intensity));
  });
  const std::string suns = jsonArray(scene.directionalLights, [](const DirectionalLight& l) {
    return fmt::format(R"({{"direction":{},"irradiance":{}}})", json(l.direction), json(l.irradiance));
  });
  if (!scene.spotLights.empty()) throw badInput("peer_scene: spot lights are not compared: peers' cones fall off in other ways");
  std::ofstream out(folder / "scene.json");
  out << fmt::format(
      R"({{"name":"{}","vertices":{},"triangles":{},"max_albedo":{:.9g},
"camera":{{"position":{},"target":{},"up":{},"vertical_fov":{:.9g}}},
"sky":{},
"materials":{},
"textures":{},
"point_lights":{},
"directional_lights":{}}}
)",
      scene.name, scene.positions.size(), scene.triangles(), kMaxAlbedo, json(camera.position), json(camera.target), json(camera.up),
      camera.verticalFov, json(scene.sky), materials, textures, points, suns);
  if (!out) throw badInput(fmt::format("peer_scene: cannot write {}", (folder / "scene.json").string()));
}

struct LumelRecord {
  uint32_t texel, chart;
  float area;
};

void exportAtlas(const Scene& scene, int resolution, const fs::path& folder) {
  fs::create_directories(folder);
  TaskPool pool;
  Progress progress;
  AtlasSettings settings;
  settings.resolution = resolution;
  const Atlas atlas = buildAtlas(scene, settings, pool, progress);
  writeArray(folder / "corner_uvs.bin", atlas.cornerUvs);
  std::vector<LumelRecord> lumels;
  for (const Lumel& l : atlas.lumels) lumels.push_back({l.texel, atlas.charts[l.triangle], l.area});
  writeArray(folder / "lumels.bin", lumels);
}

/// What the camera sees through one place of each pixel: where light is wanted, and what becomes of it.
struct View {
  std::vector<Receiver> receivers;
  std::vector<vec3> albedo, emission;
};

View viewThrough(const EmbreeScene& embree, const Camera& camera, int width, int height, ivec2 cell, int grid, uint32_t seed) {
  const Scene& scene = embree.scene();
  const vec3 forward = glm::normalize(camera.target - camera.position);
  const vec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
  const float half = std::tan(0.5f * camera.verticalFov), aspect = static_cast<float>(width) / static_cast<float>(height);
  const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
  View view{std::vector<Receiver>(count), std::vector<vec3>(count, vec3(0.0f)), std::vector<vec3>(count, vec3(0.0f))};
  for (size_t i = 0; i < count; ++i) {
    shared::Random random = shared::randomInit(seed, static_cast<uint32_t>(i), static_cast<uint32_t>(cell.y * grid + cell.x));
    const float jx = shared::randomFloat(random), jy = shared::randomFloat(random);
    const float px = static_cast<float>(i % static_cast<size_t>(width)) + (static_cast<float>(cell.x) + jx) / static_cast<float>(grid);
    const float py = static_cast<float>(i / static_cast<size_t>(width)) + (static_cast<float>(cell.y) + jy) / static_cast<float>(grid);
    const float sx = (2 * px / static_cast<float>(width) - 1) * half * aspect, sy = (1 - 2 * py / static_cast<float>(height)) * half;
    const vec3 direction = glm::normalize(forward + sx * right + sy * up);
    const shared::Hit hit = embree.closest({camera.position, 0.0f, direction, std::numeric_limits<float>::infinity()});
    if (hit.primitive == shared::kMiss) {
      view.emission[i] = scene.sky;
      continue;
    }
    const Surface s = surfaceAt(scene, hit, direction, false);
    if (!s.backFace) view.emission[i] = scene.materials[scene.materialIds[hit.primitive]].emission;
    view.albedo[i] = s.albedo;
    view.receivers[i] = Receiver{s.position, s.geometricNormal, s.normal, s.backFace, s.twoSided};
  }
  return view;
}

vec3 rgbAt(const Image& image, size_t i) { return vec3(image.data[3 * i], image.data[3 * i + 1], image.data[3 * i + 2]); }

void render(const Scene& scene, const Camera& camera, int width, int height, int grid, int samples, uint32_t seed, const fs::path& folder) {
  fs::create_directories(folder);
  const auto start = std::chrono::steady_clock::now();
  auto embree = std::make_shared<EmbreeScene>(scene);
  TaskPool pool;
  Image sum(width, height, 3);
  uint64_t nonFinite = 0, paths = 0, rays = 0;
  for (int y = 0; y < grid; ++y)
    for (int x = 0; x < grid; ++x) {
      View view = viewThrough(*embree, camera, width, height, {x, y}, grid, seed);
      ReferenceSettings settings;
      settings.samplesPerPixel = settings.directSamples = samples;
      settings.receiver = ReceiverNormal::Geometric;
      settings.seed = (static_cast<uint64_t>(seed) << 32) + static_cast<uint64_t>(y * grid + x);
      ReferenceTracer tracer(embree, view.receivers, width, height, settings, pool);
      Progress progress;
      while (!tracer.settled()) tracer.advance(progress);
      const auto result = tracer.result();
      const Image direct = result->directImage().mean, indirect = result->indirectImage(kAllBounces).mean;
      for (size_t i = 0; i < sum.pixels(); ++i) {
        const vec3 l = view.emission[i] + view.albedo[i] / kPi * (rgbAt(direct, i) + rgbAt(indirect, i));
        for (int c = 0; c < 3; ++c) sum.data[3 * i + static_cast<size_t>(c)] += l[c] / static_cast<float>(grid * grid);
      }
      nonFinite += result->nonFinite, paths += result->paths, rays += result->rays;
    }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  writeImage(folder / fmt::format("ours_{}.pfm", seed), sum);
  std::ofstream(folder / fmt::format("ours_{}.json", seed))
      << fmt::format("{{\"seconds\":{:.3f},\"samples\":{},\"paths\":{},\"rays\":{},\"non_finite\":{}}}\n", seconds, grid * grid * samples, paths, rays,
                     nonFinite);
  if (nonFinite) throw Error(ErrorKind::Run, fmt::format("peer_scene: {} contributions were not finite", nonFinite));
}

int wholeNumber(const std::string& text, int least) {
  char* end = nullptr;
  const long v = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end || v < least || v > 65536)
    throw badInput(fmt::format("peer_scene: '{}' should be a number from {} to 65536", text, least));
  return static_cast<int>(v);
}

int run(const std::vector<std::string>& a) {
  if (a.size() == 4 && a[0] == "export") {
    const Scene scene = loadScene(a[1]);
    exportScene(scene, cameraNamed(scene, a[2]), a[3]);
    return 0;
  }
  if (a.size() == 4 && a[0] == "atlas") {
    const int resolution = wholeNumber(a[2], 4);
    exportAtlas(loadScene(a[1]), resolution, a[3]);
    return 0;
  }
  if (a.size() == 9 && a[0] == "render") {
    const Scene scene = loadScene(a[1]);
    render(scene, cameraNamed(scene, a[2]), wholeNumber(a[3], 1), wholeNumber(a[4], 1), wholeNumber(a[5], 1), wholeNumber(a[6], 2),
           static_cast<uint32_t>(wholeNumber(a[7], 0)), a[8]);
    return 0;
  }
  std::fputs("usage: peer_scene export SCENE CAMERA DIR | peer_scene atlas SCENE RESOLUTION DIR | peer_scene render SCENE CAMERA WIDTH HEIGHT GRID SPP SEED DIR\n", stderr);
  return 2;
}

}  // namespace
}  // namespace hl

int main(int argc, char** argv) {
  try {
    return hl::run({argv + 1, argv + argc});
  } catch (const hl::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return e.exitCode();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
