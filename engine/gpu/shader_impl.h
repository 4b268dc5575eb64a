#pragma once
// Loaded shaders, as the frame graph takes them.
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/device_impl.h"
#include "engine/gpu/reflection.h"
#include "engine/gpu/shader_library.h"

namespace hl {

/// One version of a shader. A reload makes another; whoever holds this one keeps it.
struct Shader {
  std::shared_ptr<Device::Impl> device;
  std::string name;
  VkShaderStageFlagBits stage = VK_SHADER_STAGE_COMPUTE_BIT;
  uint64_t version = 0;  ///< unique among all shaders of the library
  VkShaderModule module = VK_NULL_HANDLE;
  ShaderReflection reflection;
  ~Shader();
};

struct ShaderLibrary::Impl {
  explicit Impl(Device& d) : device(d.impl().shared_from_this()) {}

  std::shared_ptr<const Shader> find(const std::string& name);

  struct Entry {
    std::shared_ptr<const Shader> shader;
    std::filesystem::path source;                                             ///< empty where there is none
    std::vector<std::pair<std::filesystem::path, std::string>> dependencies;  ///< as compiled
    bool stale = false;  ///< the build's SPIR-V is older than its source
  };
  std::shared_ptr<Device::Impl> device;
  std::map<std::string, Entry> entries;
  uint64_t versions = 0;

  std::shared_ptr<const Shader> make(const std::string& name, std::vector<uint32_t> words);
};

}  // namespace hl
