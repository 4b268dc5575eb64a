#include "engine/gpu/shader_library.h"

#include <fmt/core.h>

#include <cstring>

#include "engine/core/files.h"
#include "engine/gpu/shader_compiler.h"
#include "engine/gpu/shader_impl.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

fs::path sourceOf(const std::string& name) {
  std::vector<fs::path> candidates{fs::path("shaders") / name, fs::path("engine/techniques") / name};
  if (name.starts_with("tests/")) candidates.push_back(fs::path("tests/shaders") / name.substr(6));
  for (const fs::path& candidate : candidates) {
    std::error_code ignored;
    const fs::path source = homeFolder() / candidate;
    if (fs::is_regular_file(source, ignored)) return source;
  }
  return {};
}

std::vector<std::string> compiledNames() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& file : fs::recursive_directory_iterator(shaderFolder(), ignored)) {
    if (file.path().extension() == ".spv") {
      names.push_back(fs::relative(file.path(), shaderFolder()).replace_extension().generic_string());
    }
  }
  return names;
}

/// The stages of one pipeline number their bindings apart, each in a set of its own.
struct StageOfName {
  VkShaderStageFlagBits stage;
  uint32_t set;
};
StageOfName stageOf(const std::string& name) {
  if (name.ends_with(".vert")) return {VK_SHADER_STAGE_VERTEX_BIT, 0};
  if (name.ends_with(".frag")) return {VK_SHADER_STAGE_FRAGMENT_BIT, 1};
  if (name.ends_with(".rgen")) return {VK_SHADER_STAGE_RAYGEN_BIT_KHR, 0};
  if (name.ends_with(".rmiss")) return {VK_SHADER_STAGE_MISS_BIT_KHR, 1};
  if (name.ends_with(".rchit")) return {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, 2};
  if (name.ends_with(".rahit")) return {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, 3};
  return {VK_SHADER_STAGE_COMPUTE_BIT, 0};
}

std::vector<uint32_t> loadWords(const std::string& name) {
  const fs::path file = shaderFolder() / (name + ".spv");
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    const std::string near = nearest(name, compiledNames());
    throw badInput(fmt::format("shader {}: not found in {}{}", name, shaderFolder().string(),
                               near.empty() ? "" : "; is it " + near + "?"));
  }
  const std::string bytes = readFile(file);
  if (bytes.empty() || bytes.size() % 4 != 0)
    throw badInput(fmt::format("shader {}: {} is cut off", name, file.string()));
  std::vector<uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

}  // namespace

Shader::~Shader() {
  if (module != VK_NULL_HANDLE) vkDestroyShaderModule(device->device, module, nullptr);
}

std::shared_ptr<const Shader> ShaderLibrary::Impl::make(const std::string& name, std::vector<uint32_t> words) {
  auto shader = std::make_shared<Shader>();
  shader->device = device;
  shader->name = name;
  shader->version = ++versions;
  const StageOfName stage = stageOf(name);
  shader->stage = stage.stage;
  shader->reflection = reflectAndRenumber(name, words, stage.set);
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = words.size() * 4;
  info.pCode = words.data();
  check(vkCreateShaderModule(device->device, &info, nullptr, &shader->module), "shader " + name);
  device->name(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<uint64_t>(shader->module), name);
  return shader;
}

std::shared_ptr<const Shader> ShaderLibrary::Impl::find(const std::string& name) {
  if (const auto it = entries.find(name); it != entries.end()) return it->second.shader;
  Entry entry;
  entry.shader = make(name, loadWords(name));
  entry.source = sourceOf(name);
  if (!entry.source.empty()) {
    entry.dependencies = shaderDependencies(entry.source, homeFolder());
    std::error_code ignored;
    const auto built = fs::last_write_time(shaderFolder() / (name + ".spv"), ignored);
    for (const auto& [file, hash] : entry.dependencies) {
      if (fs::last_write_time(file, ignored) > built) entry.stale = true;
    }
  }
  return entries.emplace(name, std::move(entry)).first->second.shader;
}

ShaderLibrary::ShaderLibrary(Device& device) : impl_(std::make_unique<Impl>(device)) {}
ShaderLibrary::~ShaderLibrary() = default;

ReloadReport ShaderLibrary::reload() {
  ReloadReport report;
  for (auto& [name, entry] : impl_->entries) {
    if (entry.source.empty()) continue;
    try {
      auto now = shaderDependencies(entry.source, homeFolder());
      if (now.empty() || (now == entry.dependencies && !entry.stale)) continue;
      CompiledShader compiled = compileShader(entry.source, homeFolder());
      if (compiled.words.empty()) {
        report.errors.push_back(compiled.error);
        continue;
      }
      entry.shader = impl_->make(name, std::move(compiled.words));
      entry.dependencies = std::move(now);
      entry.stale = false;
      report.reloaded.push_back(name);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::Device) throw;
      report.errors.emplace_back(e.what());
    }
  }
  return report;
}

std::vector<BlockMember> ShaderLibrary::reflectBlock(const std::string& shader, const std::string& block) {
  const auto found = impl_->find(shader);
  const auto& blocks = found->reflection.blocks;
  if (const auto it = blocks.find(block); it != blocks.end()) return it->second;
  std::vector<std::string> names;
  for (const auto& [name, members] : blocks) names.push_back(name);
  const std::string near = nearest(block, names);
  throw badInput(
      fmt::format("shader {}: no block \"{}\"{}", shader, block, near.empty() ? "" : "; is it \"" + near + "\"?"));
}

}  // namespace hl
