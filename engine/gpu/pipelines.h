#pragma once
// Pipelines, made once for every combination of shader version, specialisation and attachment formats.
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/shader_impl.h"

namespace hl {

struct Pipeline {
  std::shared_ptr<Device::Impl> device;
  std::vector<std::shared_ptr<const Shader>> shaders;  ///< compute; or vertex, fragment; or ray generation, miss,
                                                       ///< closest hit, any hit
  VkPipeline handle = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::vector<VkDescriptorSetLayout> sets;
  VkShaderStageFlags pushStages = 0;
  uint32_t pushBytes = 0;
  double creationMs = 0;
  // Of ray tracing pipelines: the shader binding table, and where in it each kind's records are.
  Buffer table;
  VkStridedDeviceAddressRegionKHR generation{}, miss{}, hit{};
  ~Pipeline();
};

struct PipelineRequest {
  std::vector<std::shared_ptr<const Shader>> shaders;
  std::map<std::string, uint32_t> constants;  ///< checked names
  bool dispatchBase = false;                  ///< will be dispatched in several pieces
  std::vector<VkFormat> color;
  VkFormat depth = VK_FORMAT_UNDEFINED;
};

VkDescriptorType descriptorType(BindingKind);

class PipelineCache {
 public:
  explicit PipelineCache(std::shared_ptr<Device::Impl>);
  ~PipelineCache();
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;

  /// `created`: it was made by this call, which took creationMs. @throws Error(Device)
  std::shared_ptr<Pipeline> get(const PipelineRequest&, const std::string& pass, bool* created);

 private:
  void makeRayPipeline(Pipeline&, const PipelineRequest&, const std::string& pass);
  std::shared_ptr<Pipeline> make(const PipelineRequest&, const std::string& pass);

  std::shared_ptr<Device::Impl> device_;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::map<std::string, std::shared_ptr<Pipeline>> pipelines_;
};

}  // namespace hl
