// The module's own entries, and the log of what is in it.
#include "engine/core/import_module.h"

namespace hl {
namespace {

void (*programLog)(LogLevel, std::string_view) = nullptr;

}  // namespace

// In here this is the only log(): what the module says goes to the program's log, and to whom that goes is decided there.
void log(LogLevel level, std::string_view message) {
  if (programLog) programLog(level, message);
}

extern "C" const char* halflight_import_stamp() { return importStamp(); }

extern "C" void halflight_import_open(void (*log)(LogLevel, std::string_view)) { programLog = log; }

}  // namespace hl
