#include "engine/gpu/acceleration.h"

#include <fmt/core.h>

#include <cstring>
#include <vector>

#include "engine/gpu/acceleration_impl.h"

namespace hl {
namespace {

constexpr VkBuildAccelerationStructureFlagsKHR kFlags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;

uint64_t aligned(uint64_t value, uint64_t to) { return (value + to - 1) / to * to; }

/// Later commands of this or another submission see what was written.
void barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to, VkAccessFlags2 read) {
  VkMemoryBarrier2 all{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  all.srcStageMask = from, all.srcAccessMask = written, all.dstStageMask = to, all.dstAccessMask = read;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &all;
  vkCmdPipelineBarrier2(commands, &info);
}

/// Storage, scratch and build of one level.
AccelerationState::Level build(Device::Impl& device, const std::string& name, VkAccelerationStructureTypeKHR type,
                               const std::vector<VkAccelerationStructureGeometryKHR>& geometries, const std::vector<uint32_t>& counts,
                               const std::vector<VkAccelerationStructureBuildRangeInfoKHR>& ranges) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  info.flags = kFlags;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vkGetAccelerationStructureBuildSizesKHR(device.device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts.data(), &sizes);

  AccelerationState::Level level;
  level.device = device.shared_from_this();
  level.storage = device.makeBuffer(name, sizes.accelerationStructureSize, TexelFormat::None, MemoryUse::Device);
  VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  create.buffer = level.storage.state()->handle;
  create.size = sizes.accelerationStructureSize;
  create.type = type;
  check(vkCreateAccelerationStructureKHR(device.device, &create, nullptr, &level.handle), name);
  device.name(VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, reinterpret_cast<uint64_t>(level.handle), name);

  const uint64_t alignment = device.survey.scratchAlignment;
  const Buffer scratch = device.makeBuffer(name + " scratch", sizes.buildScratchSize + alignment, TexelFormat::None, MemoryUse::Device);
  info.dstAccelerationStructure = level.handle;
  info.scratchData.deviceAddress = aligned(device.address(scratch), alignment);
  device.once([&](VkCommandBuffer commands) {
    // Vertices, indices and instances were copied there before, the lower level built.
    barrier(commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
            VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
            VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR);
    const VkAccelerationStructureBuildRangeInfoKHR* first = ranges.data();
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &first);
    barrier(commands, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
            VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR);
  });
  return level;
}

VkAccelerationStructureGeometryKHR triangles(const Device::Impl& device, const TriangleGeometry& g) {
  VkAccelerationStructureGeometryKHR out{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  out.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  // An alpha test that were asked twice for one triangle would give the same answer: no need to forbid it.
  out.flags = g.opaque ? static_cast<VkGeometryFlagsKHR>(VK_GEOMETRY_OPAQUE_BIT_KHR) : 0u;
  auto& t = out.geometry.triangles;
  t = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
  t.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  t.vertexData.deviceAddress = device.address(g.vertices);
  t.vertexStride = 3 * sizeof(float);
  t.maxVertex = g.vertexCount - 1;
  t.indexType = VK_INDEX_TYPE_UINT32;
  t.indexData.deviceAddress = device.address(g.indices);
  return out;
}

}  // namespace

VkDeviceAddress Device::Impl::address(const Buffer& buffer) const {
  VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
  info.buffer = buffer.state()->handle;
  return vkGetBufferDeviceAddress(device, &info);
}

AccelerationState::Level::~Level() {
  if (handle != VK_NULL_HANDLE) vkDestroyAccelerationStructureKHR(device->device, handle, nullptr);
}

uint64_t AccelerationStructure::bytes() const { return state_ ? state_->bottom.storage.size() + state_->top.storage.size() : 0; }

AccelerationStructure Device::accelerationStructure(const std::string& name, std::span<const TriangleGeometry> list) {
  Impl& device = *impl_;
  if (!device.survey.rayPipelines)
    throw Error(ErrorKind::Device, fmt::format("{}: {} has no ray tracing pipelines", name, device.survey.info.name));
  auto state = std::make_shared<AccelerationState>();

  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<uint32_t> counts;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const TriangleGeometry& g : list) {
    geometries.push_back(triangles(device, g));
    counts.push_back(g.triangleCount);
    ranges.push_back({g.triangleCount, g.firstTriangle * 3 * static_cast<uint32_t>(sizeof(uint32_t)), 0, 0});
  }
  const bool any = !geometries.empty();
  VkAccelerationStructureInstanceKHR instance{};
  if (any) {
    state->bottom = build(device, name, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometries, counts, ranges);
    VkAccelerationStructureDeviceAddressInfoKHR where{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
    where.accelerationStructure = state->bottom.handle;
    instance.accelerationStructureReference = vkGetAccelerationStructureDeviceAddressKHR(device.device, &where);
  }
  for (int i = 0; i < 3; ++i) instance.transform.matrix[i][i] = 1;
  instance.mask = 0xff;
  instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  const Buffer instances = buffer(name + ": instances", sizeof instance);
  upload(instances, &instance, sizeof instance);

  VkAccelerationStructureGeometryKHR top{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  top.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  top.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
  top.geometry.instances.data.deviceAddress = device.address(instances);
  const uint32_t count = any ? 1 : 0;
  state->top = build(device, name + ": top level", VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {top}, {count}, {{count, 0, 0, 0}});
  return AccelerationStructure(std::move(state));
}

}  // namespace hl
