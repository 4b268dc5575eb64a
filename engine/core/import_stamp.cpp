// Compiled into the program and into the import module, each with its own compiler and options.

#include "engine/core/import_module.h"

#define HL_TEXT2(x) #x
#define HL_TEXT(x) HL_TEXT2(x)

namespace hl {

// Raised when the type of an entry changes, or a structure that crosses the border.
#define HL_IMPORT_LAYOUT 1

const char* importStamp() {
  return "layout " HL_TEXT(HL_IMPORT_LAYOUT) ", g++ " __VERSION__ ", strings " HL_TEXT(_GLIBCXX_USE_CXX11_ABI)
#if defined(__SANITIZE_ADDRESS__)
      ", address"
#elif defined(__SANITIZE_THREAD__)
      ", thread"
#endif
#ifdef NDEBUG
      ", release";
#else
      ", asserts";
#endif
}

}  // namespace hl
