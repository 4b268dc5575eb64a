#include "engine/reference/receivers.h"

#include "engine/core/error.h"

namespace hl {
namespace {

vec3 rgb(const Image& image, size_t pixel) {
  const float* p = image.data.data() + pixel * static_cast<size_t>(image.channels);
  return vec3(p[0], p[1], p[2]);
}

}  // namespace

std::vector<Receiver> receiversFromGBuffer(const Image& position, const Image& normal, const Image& geometricNormal,
                                           std::span<const uint32_t> ids, const Scene* scene, const vec3* eye) {
  const size_t count = position.pixels();
  if (position.channels != 4 || normal.channels < 3 || geometricNormal.channels < 3 || normal.pixels() != count ||
      geometricNormal.pixels() != count)
    throw badInput("reference: position, normal and geometric normal must be images of one size, position with 4 channels");
  if (!ids.empty() && (ids.size() != 2 * count || !scene))
    throw badInput("reference: ids need two words a pixel and the scene whose materials they name");
  std::vector<Receiver> receivers(count);
  for (size_t i = 0; i < count; ++i) {
    const float side = position.data[4 * i + 3];
    if (side == 0) continue;
    Receiver& r = receivers[i];
    r.position = rgb(position, i);
    r.geometricNormal = glm::normalize(rgb(geometricNormal, i));
    r.mappedNormal = glm::normalize(rgb(normal, i));
    r.backFace = side < 0;
    r.twoSided = true;
    if (ids.empty() || ids[2 * i + 1] >= scene->materials.size()) continue;
    const Material& m = scene->materials[ids[2 * i + 1]];
    r.twoSided = m.twoSided;
    if (eye && m.glossy()) r.view = glm::normalize(*eye - r.position), r.specular = m.specular, r.roughness = m.roughness;
  }
  return receivers;
}

std::vector<Receiver> receiversFromLumels(const std::vector<Lumel>& lumels) {
  std::vector<Receiver> receivers(lumels.size());
  for (size_t i = 0; i < lumels.size(); ++i) {
    receivers[i].position = lumels[i].position;
    receivers[i].geometricNormal = receivers[i].mappedNormal = lumels[i].normal;
  }
  return receivers;
}

}  // namespace hl
