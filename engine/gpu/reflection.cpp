#include "engine/gpu/reflection.h"

#include <fmt/core.h>
#include <spirv_cross/spirv_cross_c.h>

#include <algorithm>
#include <memory>

#include "engine/core/error.h"

namespace hl {
namespace {

struct Reflector {
  const std::string& shader;
  std::vector<uint32_t>& words;
  uint32_t set;
  spvc_compiler compiler = nullptr;
  ShaderReflection result;

  void require(spvc_result r, const char* what) const {
    if (r != SPVC_SUCCESS) throw badInput(fmt::format("shader {}: cannot read its {}", shader, what));
  }
  void addName(std::vector<std::string>& names, const char* name) const {
    if (name == nullptr || *name == '\0') return;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
  }
  void patch(SpvId id, SpvDecoration decoration, uint32_t value) {
    unsigned offset = 0;
    if (spvc_compiler_get_binary_offset_for_decoration(compiler, id, decoration, &offset) == SPVC_FALSE) {
      throw badInput(fmt::format("shader {}: a resource without a binding number", shader));
    }
    words.at(offset) = value;
  }
  std::vector<BlockMember> members(const spvc_reflected_resource& r) const {
    const spvc_type type = spvc_compiler_get_type_handle(compiler, r.base_type_id);
    std::vector<BlockMember> out;
    for (unsigned i = 0; i < spvc_type_get_num_member_types(type); ++i) {
      BlockMember m;
      m.name = spvc_compiler_get_member_name(compiler, r.base_type_id, i);
      unsigned offset = 0;
      size_t size = 0;
      require(spvc_compiler_type_struct_member_offset(compiler, type, i, &offset), "block members");
      require(spvc_compiler_get_declared_struct_member_size(compiler, type, i, &size), "block members");
      m.offset = offset;
      m.size = static_cast<uint32_t>(size);
      out.push_back(std::move(m));
    }
    return out;
  }
  uint64_t blockBytes(const spvc_reflected_resource& r) const {
    size_t size = 0;
    require(spvc_compiler_get_declared_struct_size(compiler, spvc_compiler_get_type_handle(compiler, r.base_type_id),
                                                   &size),
            "block size");
    return size;
  }
  std::vector<std::string> namesOf(const spvc_reflected_resource& r, bool block) {
    std::vector<std::string> names;
    addName(names, spvc_compiler_get_name(compiler, r.id));
    if (block) {
      const std::vector<BlockMember> all = members(r);
      if (all.size() == 1) addName(names, all[0].name.c_str());
      addName(names, spvc_compiler_get_name(compiler, r.base_type_id));
      for (const std::string& name : names) result.blocks[name] = all;
    }
    if (names.empty()) addName(names, r.name);
    return names;
  }

  void add(spvc_resources all, spvc_resources active, spvc_resource_type type, BindingKind kind) {
    const spvc_reflected_resource *list = nullptr, *usedList = nullptr;
    size_t count = 0, usedCount = 0;
    require(spvc_resources_get_resource_list_for_type(all, type, &list, &count), "bindings");
    require(spvc_resources_get_resource_list_for_type(active, type, &usedList, &usedCount), "bindings");
    for (size_t i = 0; i < count; ++i) {
      const spvc_reflected_resource& r = list[i];
      const bool block = kind == BindingKind::StorageBuffer || kind == BindingKind::UniformBlock;
      ShaderBinding b;
      b.kind = kind;
      b.names = namesOf(r, block);
      b.used = std::any_of(usedList, usedList + usedCount, [&](const auto& u) { return u.id == r.id; });
      if (kind == BindingKind::UniformBlock) b.blockBytes = blockBytes(r);
      const spvc_type handle = spvc_compiler_get_type_handle(compiler, r.type_id);
      if (spvc_type_get_num_array_dimensions(handle) != 0) {
        throw badInput(
            fmt::format("shader {}, binding \"{}\": arrays of bindings are not supported", shader, b.names.front()));
      }
      if (!block && kind != BindingKind::AccelerationStructure) {
        b.arrayed = spvc_type_get_image_arrayed(handle) == SPVC_TRUE;
        const SpvDim dim = spvc_type_get_image_dimension(handle);
        if (dim == SpvDimBuffer && kind != BindingKind::StorageImage) {
          b.kind = BindingKind::TexelBuffer;
        } else if (dim != SpvDim2D || type == SPVC_RESOURCE_TYPE_SEPARATE_IMAGE) {
          throw badInput(
              fmt::format("shader {}, binding \"{}\": only 2D images, 2D arrays and uniform texel buffers are bound",
                          shader, b.names.front()));
        }
        const spvc_basetype texel =
            spvc_type_get_basetype(spvc_compiler_get_type_handle(compiler, spvc_type_get_image_sampled_type(handle)));
        b.integer = texel == SPVC_BASETYPE_UINT32 || texel == SPVC_BASETYPE_INT32;
      }
      b.index = static_cast<uint32_t>(result.bindings.size());
      patch(r.id, SpvDecorationBinding, b.index);
      patch(r.id, SpvDecorationDescriptorSet, set);
      result.bindings.push_back(std::move(b));
    }
  }

  void run() {
    spvc_resources all = nullptr, active = nullptr;
    spvc_set used = nullptr;
    require(spvc_compiler_create_shader_resources(compiler, &all), "bindings");
    require(spvc_compiler_get_active_interface_variables(compiler, &used), "bindings");
    require(spvc_compiler_create_shader_resources_for_active_variables(compiler, &active, used), "bindings");
    add(all, active, SPVC_RESOURCE_TYPE_STORAGE_BUFFER, BindingKind::StorageBuffer);
    add(all, active, SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, BindingKind::UniformBlock);
    add(all, active, SPVC_RESOURCE_TYPE_STORAGE_IMAGE, BindingKind::StorageImage);
    add(all, active, SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, BindingKind::SampledImage);
    add(all, active, SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, BindingKind::SampledImage);
    add(all, active, SPVC_RESOURCE_TYPE_ACCELERATION_STRUCTURE, BindingKind::AccelerationStructure);

    const spvc_reflected_resource* push = nullptr;
    size_t count = 0;
    require(spvc_resources_get_resource_list_for_type(all, SPVC_RESOURCE_TYPE_PUSH_CONSTANT, &push, &count),
            "push constants");
    for (size_t i = 0; i < count; ++i) {
      namesOf(push[i], true);
      result.pushBytes = std::max(result.pushBytes, blockBytes(push[i]));
    }
    require(spvc_resources_get_resource_list_for_type(active, SPVC_RESOURCE_TYPE_PUSH_CONSTANT, &push, &count),
            "push constants");
    result.pushUsed = count > 0;

    const spvc_specialization_constant* constants = nullptr;
    require(spvc_compiler_get_specialization_constants(compiler, &constants, &count), "specialisation constants");
    std::map<SpvId, std::string> names;
    for (size_t i = 0; i < count; ++i) {
      names[constants[i].id] = spvc_compiler_get_name(compiler, constants[i].id);
      result.constants[names[constants[i].id]] = constants[i].constant_id;
    }
    spvc_specialization_constant size[3]{};
    spvc_compiler_get_work_group_size_specialization_constants(compiler, &size[0], &size[1], &size[2]);
    for (unsigned i = 0; i < 3; ++i) {
      result.groupSize[i] = spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, i);
      if (size[i].id != 0) {
        result.groupSizeConstant[i] = names[size[i].id];
        result.groupSize[i] =
            spvc_constant_get_scalar_u32(spvc_compiler_get_constant_handle(compiler, size[i].id), 0, 0);
      }
      result.groupSize[i] = std::max(result.groupSize[i], 1u);
    }
  }
};

}  // namespace

const char* kindName(BindingKind kind) {
  switch (kind) {
    case BindingKind::StorageBuffer:
      return "a storage buffer";
    case BindingKind::UniformBlock:
      return "a uniform block";
    case BindingKind::StorageImage:
      return "a storage image";
    case BindingKind::SampledImage:
      return "a sampled image";
    case BindingKind::TexelBuffer:
      return "a texel buffer";
    case BindingKind::AccelerationStructure:
      return "an acceleration structure";
  }
  return "";
}

bool ShaderBinding::answersTo(const std::string& name) const {
  return std::find(names.begin(), names.end(), name) != names.end();
}

ShaderReflection reflectAndRenumber(const std::string& shader, std::vector<uint32_t>& words, uint32_t set) {
  spvc_context raw = nullptr;
  if (spvc_context_create(&raw) != SPVC_SUCCESS) throw Error(ErrorKind::Run, "cannot start SPIR-V reflection");
  const std::unique_ptr<spvc_context_s, void (*)(spvc_context)> context(raw, spvc_context_destroy);
  spvc_parsed_ir ir = nullptr;
  Reflector reflector{shader, words, set, nullptr, {}};
  if (spvc_context_parse_spirv(raw, words.data(), words.size(), &ir) != SPVC_SUCCESS ||
      spvc_context_create_compiler(raw, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &reflector.compiler) !=
          SPVC_SUCCESS) {
    throw badInput(fmt::format("shader {}: not valid SPIR-V: {}", shader, spvc_context_get_last_error_string(raw)));
  }
  reflector.run();
  reflector.result.set = set;
  return std::move(reflector.result);
}

}  // namespace hl
