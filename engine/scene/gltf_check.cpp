#include "engine/scene/gltf_check.h"

namespace hl {

void checkGltf(std::string_view, const std::filesystem::path&, Progress*) {}

}  // namespace hl
