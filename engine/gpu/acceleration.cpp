#include "engine/gpu/acceleration.h"

#include <fmt/core.h>

#include <algorithm>
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
                               const std::vector<VkAccelerationStructureBuildRangeInfoKHR>& ranges, AccelerationState::Recipe* again = nullptr) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  info.flags = kFlags;
  if (again != nullptr && type == VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR) info.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
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
  const uint64_t scratchBytes = std::max(sizes.buildScratchSize, sizes.updateScratchSize) + alignment;
  const Buffer scratch = device.makeBuffer(name + " scratch", scratchBytes, TexelFormat::None, MemoryUse::Device);
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
  if (again != nullptr) *again = {type, info.flags, geometries, ranges, scratch, info.scratchData.deviceAddress};
  return level;
}

/// The level once more in its place: fitted to where its vertices are now, or built anew.
void repeat(VkCommandBuffer commands, const AccelerationState::Level& level, const AccelerationState::Recipe& recipe, bool fit) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = recipe.type;
  info.flags = recipe.flags;
  info.mode = fit ? VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR : VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.srcAccelerationStructure = fit ? level.handle : VK_NULL_HANDLE;
  info.dstAccelerationStructure = level.handle;
  info.geometryCount = static_cast<uint32_t>(recipe.geometries.size());
  info.pGeometries = recipe.geometries.data();
  info.scratchData.deviceAddress = recipe.scratchAddress;
  const VkAccelerationStructureBuildRangeInfoKHR* first = recipe.ranges.data();
  vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &first);
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

uint64_t AccelerationStructure::bytes() const {
  if (!state_) return 0;
  uint64_t sum = 0;
  for (const Buffer* b : {&state_->bottom.storage, &state_->moving.storage, &state_->top.storage, &state_->movingRecipe.scratch, &state_->topRecipe.scratch})
    if (*b) sum += b->size();
  return sum;
}

namespace {

/// One bottom level.
AccelerationState::Level bottomLevel(Device::Impl& device, const std::string& name, std::span<const TriangleGeometry> list, AccelerationState::Recipe* again) {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<uint32_t> counts;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const TriangleGeometry& g : list) {
    geometries.push_back(triangles(device, g));
    counts.push_back(g.triangleCount);
    ranges.push_back({g.triangleCount, g.firstTriangle * 3 * static_cast<uint32_t>(sizeof(uint32_t)), 0, 0});
  }
  return build(device, name, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometries, counts, ranges, again);
}

VkAccelerationStructureInstanceKHR instanceOf(const Device::Impl& device, const AccelerationState::Level& level, uint32_t number) {
  VkAccelerationStructureInstanceKHR instance{};
  VkAccelerationStructureDeviceAddressInfoKHR where{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  where.accelerationStructure = level.handle;
  instance.accelerationStructureReference = vkGetAccelerationStructureDeviceAddressKHR(device.device, &where);
  for (int i = 0; i < 3; ++i) instance.transform.matrix[i][i] = 1;
  instance.instanceCustomIndex = number & 0xffffffu;
  instance.mask = 0xff;
  instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  return instance;
}

}  // namespace

AccelerationStructure Device::accelerationStructure(const std::string& name, std::span<const TriangleGeometry> list,
                                                    std::span<const TriangleGeometry> movingList) {
  Impl& device = *impl_;
  if (!device.survey.rayPipelines)
    throw Error(ErrorKind::Device, fmt::format("{}: {} has no ray tracing pipelines", name, device.survey.info.name));
  auto state = std::make_shared<AccelerationState>();
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  if (!list.empty()) {
    state->bottom = bottomLevel(device, name, list, nullptr);
    instances.push_back(instanceOf(device, state->bottom, 0));
  }
  const bool moves = !movingList.empty();
  if (moves) {
    state->moving = bottomLevel(device, name + ": moving", movingList, &state->movingRecipe);
    instances.push_back(instanceOf(device, state->moving, 1));
    state->movingVertices = movingList.front().vertices;
    for (const TriangleGeometry& g : movingList) state->inputs.push_back(g.vertices), state->inputs.push_back(g.indices);
  }
  const auto count = static_cast<uint32_t>(instances.size());
  instances.resize(std::max<size_t>(1, instances.size()));
  const Buffer placed = buffer(name + ": instances", std::span<const VkAccelerationStructureInstanceKHR>(instances));
  if (moves) state->inputs.push_back(placed);

  VkAccelerationStructureGeometryKHR top{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  top.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  top.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
  top.geometry.instances.data.deviceAddress = device.address(placed);
  state->top = build(device, name + ": top level", VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {top}, {count}, {{count, 0, 0, 0}},
                     moves ? &state->topRecipe : nullptr);
  return AccelerationStructure(std::move(state));
}

void recordUpdate(VkCommandBuffer commands, AccelerationState& state) {
  constexpr VkPipelineStageFlags2 kBuild = VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
  constexpr VkAccessFlags2 kRead = VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, kWrite = VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
  // After the rays of before, and after the build of before, whose scratch memory this one uses.
  barrier(commands, VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR | kBuild, kWrite, kBuild, kRead | kWrite);
  const bool fit = ++state.updates % kUpdatesABuild != 0;
  repeat(commands, state.moving, state.movingRecipe, fit);
  barrier(commands, kBuild, kWrite, kBuild, kRead | kWrite);
  repeat(commands, state.top, state.topRecipe, false);
  barrier(commands, kBuild, kWrite, VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, kRead);
}

}  // namespace hl
