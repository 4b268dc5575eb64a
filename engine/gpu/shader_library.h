#pragma once
// Shaders by name ("radiosity/gather.comp"): compiled by the build, reflected for their bindings, compiled again in
// process when their source changes.
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/device.h"

namespace hl {

struct ReloadReport {
  std::vector<std::string> reloaded;
  std::vector<std::string>
      errors;  ///< one a shader that did not compile: file, line, message; the old one stays in use
};

/// A block's members as the compiled shader has them, for checks against the C++ side.
struct BlockMember {
  std::string name;
  uint32_t offset = 0, size = 0;
};

class ShaderLibrary {
 public:
  explicit ShaderLibrary(Device&);
  ~ShaderLibrary();
  /// Recompiles shaders whose source, or anything it includes, changed on disk since it was last compiled.
  ReloadReport reload();
  /// Members of uniform block or push-constant block `block` of the shader. @throws Error(BadInput) naming shader and
  /// block.
  std::vector<BlockMember> reflectBlock(const std::string& shader, const std::string& block);
  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
