#pragma once
// The import module: a library of its own with everything that rests on OpenImageIO and Assimp (engine/import), loaded when the first file of
// theirs is asked for. A program without it opens bundles, and reads and writes PFM.
#include <string>
#include <string_view>

#include "engine/core/log.h"

namespace hl {

/// The module's functions, each by its name there. Who calls one, and the module, share its type through a header.
struct ImportEntry {
  static constexpr const char* kStamp = "halflight_import_stamp";
  static constexpr const char* kOpen = "halflight_import_open";
  static constexpr const char* kReadImage = "halflight_read_image";
  static constexpr const char* kWriteImage = "halflight_write_image";
  static constexpr const char* kReadMesh = "halflight_read_mesh";
};

/// What a module was built as. Objects cross its border, so program and module must be of one build: compiler, layout and sanitizers.
using ImportStamp = const char*();
const char* importStamp();
/// Takes the program's log in; called once, first.
using ImportOpen = void(void (*)(LogLevel, std::string_view));

/// The function of that name. `wantedFor` begins the message. Loaded from HALFLIGHT_IMPORT_MODULE (a file, or "none" to go without), else
/// beside the program, else from the build.
/// @throws Error(BadInput) where the module is not there or of another build: with the reason, and what can be read without it.
void* importEntry(const char* name, const std::string& wantedFor);
template <class Function>
Function* importEntry(const char* name, const std::string& wantedFor) {
  return reinterpret_cast<Function*>(importEntry(name, wantedFor));
}

/// Why it cannot be had, or "".
std::string importMissing();

}  // namespace hl
