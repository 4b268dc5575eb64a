#include "engine/gpu/shader_compiler.h"

#include <fmt/core.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <mutex>
#include <set>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

class Includer : public glslang::TShader::Includer {
 public:
  explicit Includer(fs::path root) : root_(std::move(root)) {}
  IncludeResult* includeLocal(const char* name, const char*, size_t) override { return open(name); }
  IncludeResult* includeSystem(const char* name, const char*, size_t) override { return open(name); }
  void releaseInclude(IncludeResult* r) override {
    if (r == nullptr) return;
    delete static_cast<std::string*>(r->userData);
    delete r;
  }

 private:
  IncludeResult* open(const char* name) const {
    std::error_code ignored;
    if (!fs::is_regular_file(root_ / name, ignored)) return nullptr;
    auto text = std::make_unique<std::string>(readFile(root_ / name));
    const char* data = text->data();
    const size_t size = text->size();
    return new IncludeResult(name, data, size, text.release());
  }
  fs::path root_;
};

/// glslang's "ERROR: file:line: message" lines without what does not help: the tally at the end, and the word ERROR.
std::string readable(const std::string& log, const std::string& file) {
  std::istringstream lines(log);
  std::string line, out;
  while (std::getline(lines, line)) {
    const std::string prefix = "ERROR: ";
    if (line.starts_with(prefix)) line = line.substr(prefix.size());
    if (line.empty() || line.find("compilation errors") != std::string::npos || line == file) continue;
    out += (out.empty() ? "" : "\n") + line;
  }
  return out.empty() ? file + ": does not compile" : out;
}

EShLanguage stageOf(const fs::path& source) {
  const std::string extension = source.extension().string();
  if (extension == ".vert") return EShLangVertex;
  if (extension == ".frag") return EShLangFragment;
  if (extension == ".rgen") return EShLangRayGen;
  if (extension == ".rmiss") return EShLangMiss;
  if (extension == ".rchit") return EShLangClosestHit;
  if (extension == ".rahit") return EShLangAnyHit;
  return EShLangCompute;
}

}  // namespace

CompiledShader compileShader(const fs::path& source, const fs::path& root) {
  // glslang keeps process-wide state; one compilation at a time.
  static std::mutex mutex;
  std::lock_guard lock(mutex);
  static const bool started = glslang::InitializeProcess();
  if (!started) throw Error(ErrorKind::Run, "cannot start the shader compiler");

  const std::string text = readFile(source), file = fs::relative(source, root).generic_string();
  const char* strings[] = {text.c_str()};
  const int lengths[] = {static_cast<int>(text.size())};
  const char* names[] = {file.c_str()};
  const EShLanguage stage = stageOf(source);
  const auto rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);

  glslang::TShader shader(stage);
  shader.setStringsWithLengthsAndNames(strings, lengths, names, 1);
  shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
  shader.setAutoMapBindings(true);
  Includer includer(root);
  if (!shader.parse(GetDefaultResources(), 460, false, rules, includer))
    return {{}, readable(shader.getInfoLog(), file)};

  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(rules) || !program.mapIO()) return {{}, readable(program.getInfoLog(), file)};
  CompiledShader out;
  glslang::GlslangToSpv(*program.getIntermediate(stage), out.words);
  return out;
}

std::vector<std::pair<fs::path, std::string>> shaderDependencies(const fs::path& source, const fs::path& root) {
  std::vector<std::pair<fs::path, std::string>> found;
  std::set<fs::path> seen;
  std::vector<fs::path> open{source};
  while (!open.empty()) {
    const fs::path file = open.back();
    open.pop_back();
    std::error_code ignored;
    if (!seen.insert(file).second || !fs::is_regular_file(file, ignored)) continue;
    const std::string text = readFile(file);
    found.emplace_back(file, hashOf(text));
    // Every line that looks like an include counts, switched off or not: at worst a shader is compiled once too often.
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      const size_t hash = line.find_first_not_of(" \t");
      if (hash == std::string::npos || line.compare(hash, 1, "#") != 0) continue;
      const size_t word = line.find("include", hash), begin = line.find('"', hash);
      if (word == std::string::npos || begin == std::string::npos) continue;
      const size_t end = line.find('"', begin + 1);
      if (end != std::string::npos) open.push_back(root / line.substr(begin + 1, end - begin - 1));
    }
  }
  return found;
}

}  // namespace hl
