#include "engine/core/import_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "libhalflight_import.so";

struct Module {
  void* handle = nullptr;
  std::string missing;
};

std::string loaderReason() {
  const char* text = ::dlerror();
  return text ? text : "the system does not say why";
}

/// Never closed: its functions, and the types of what they throw, are used until the program ends.
Module open(const fs::path& file) {
  void* handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) return {nullptr, loaderReason()};
  const auto stamp = reinterpret_cast<ImportStamp*>(::dlsym(handle, ImportEntry::kStamp));
  const auto start = reinterpret_cast<ImportOpen*>(::dlsym(handle, ImportEntry::kOpen));
  if (!stamp || !start || std::string_view(stamp()) != importStamp()) {
    ::dlclose(handle);
    return {nullptr, fmt::format("{} is of another build", file.string())};
  }
  start(&log);
  return {handle, ""};
}

Module find() {
  if (const char* named = std::getenv("HALFLIGHT_IMPORT_MODULE"); named && *named) {
    if (std::string_view(named) == "none") return {nullptr, "HALFLIGHT_IMPORT_MODULE says none"};
    return open(named);
  }
  std::error_code ignored;
  for (const fs::path& folder : {programFolder(), fs::path(HALFLIGHT_MODULE_DIR)})
    if (fs::is_regular_file(folder / kFile, ignored)) return open(folder / kFile);
  return {nullptr, fmt::format("{} is not beside the program", kFile)};
}

const Module& module() {
  static const Module found = find();
  return found;
}

}  // namespace

void* importEntry(const char* name, const std::string& wantedFor) {
  const Module& m = module();
  if (!m.handle)
    throw badInput(fmt::format("{}: this takes the import module, which cannot be loaded ({}); without it scenes come from bundles (.hlb, made by "
                               "`halflight-cli pack`) and images are .pfm",
                               wantedFor, m.missing));
  void* function = ::dlsym(m.handle, name);
  if (!function) throw badInput(fmt::format("{}: the import module has no {}", wantedFor, name));
  return function;
}

std::string importMissing() { return module().missing; }

}  // namespace hl
