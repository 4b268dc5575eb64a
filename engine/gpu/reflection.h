#pragma once
// What a compiled shader asks for, read off its SPIR-V.
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/gpu/shader_library.h"

namespace hl {

enum class BindingKind { StorageBuffer, UniformBlock, StorageImage, SampledImage, TexelBuffer, AccelerationStructure };
const char* kindName(BindingKind);

struct ShaderBinding {
  std::vector<std::string> names;  ///< what it answers to: variable, block, sole member; the first is for messages
  BindingKind kind = BindingKind::StorageBuffer;
  uint32_t index = 0;  ///< binding number in the patched code
  bool used = false;   ///< reached from main
  bool arrayed = false, integer = false;
  uint64_t blockBytes = 0;  ///< of uniform blocks
  bool answersTo(const std::string& name) const;
};

struct ShaderReflection {
  uint32_t set = 0;  ///< the descriptor set of its bindings
  std::vector<ShaderBinding> bindings;
  std::map<std::string, uint32_t> constants;  ///< specialisation constants: name to id
  std::map<std::string, std::vector<BlockMember>> blocks;
  std::array<uint32_t, 3> groupSize{1, 1, 1};
  std::array<std::string, 3> groupSizeConstant;  ///< the specialisation constant that sets it, or ""
  uint64_t pushBytes = 0;                        ///< 0 where the shader declares no push constants
  bool pushUsed = false;
};

/// Binding numbers that sources chose are replaced by consecutive ones in descriptor set `set`, so that sources need
/// not agree on any.
/// @throws Error(BadInput) naming the shader, for what the engine does not bind.
ShaderReflection reflectAndRenumber(const std::string& shader, std::vector<uint32_t>& words, uint32_t set);

}  // namespace hl
