// Every group of parameters has the layout in GLSL that it has in C++, and the same enum constants: list files are
// compiled and reflected.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/core/files.h"
#include "engine/gpu/reflection.h"
#include "engine/gpu/shader_compiler.h"
#include "engine/params/groups.h"
#include "engine/techniques/technique.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

/// The list files of the shared groups and of every technique folder, relative to the source tree.
std::vector<std::string> listFiles() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(homeFolder() / "engine/params"))
    if (entry.path().extension() == ".inl") out.push_back(fs::relative(entry.path(), homeFolder()).generic_string());
  for (const auto& entry : fs::directory_iterator(homeFolder() / "engine/techniques"))
    if (const fs::path list = entry.path() / "params.inl"; fs::exists(list))
      out.push_back(fs::relative(list, homeFolder()).generic_string());
  return out;
}

std::vector<std::span<const ParamInfo>> allGroups() {
  std::vector<std::span<const ParamInfo>> out = sharedParamGroups();
  for (const TechniqueInfo& t : techniqueInfos())
    if (const auto infos = t.create()->params().infos(); !infos.empty()) out.push_back(infos);
  return out;
}

ShaderReflection reflected(const std::string& statements) {
  const test::TemporaryFolder folder;
  const fs::path source = folder.path() / "params.comp";
  std::ofstream text(source);
  text << "#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"shaders/shared/params.glsl\"\n";
  for (const std::string& file : listFiles()) text << "#include \"" << file << "\"\n";
  text << "layout(local_size_x = 1) in;\nlayout(scalar) buffer Out { float sum[]; };\nvoid main() {\n"
       << statements << "}\n";
  text.close();
  CompiledShader compiled = compileShader(source, homeFolder());
  EXPECT_EQ(compiled.error, "");
  return compiled.words.empty() ? ShaderReflection() : reflectAndRenumber("params.comp", compiled.words, 0);
}

TEST(ParamsLayout, EveryGroupMatchesItsShaderBlock) {
  std::string statements;
  for (const auto& group : allGroups())
    for (const ParamInfo& p : group)
      statements += "  sum[0] += float(" + std::string(p.group) + "." + std::string(p.name) + ");\n";
  const ShaderReflection shader = reflected(statements);
  ASSERT_GE(allGroups().size(), 3u);
  for (const auto& group : allGroups()) {
    const std::string name(group.front().group);
    ASSERT_TRUE(shader.blocks.count(name)) << name;
    const std::vector<BlockMember>& members = shader.blocks.at(name);
    ASSERT_EQ(members.size(), group.size()) << name;
    for (size_t i = 0; i < group.size(); ++i) {
      EXPECT_EQ(members[i].name, group[i].name) << name;
      EXPECT_EQ(members[i].offset, group[i].offset) << group[i].key();
      EXPECT_EQ(members[i].size, 4u) << group[i].key();
    }
  }
}

/// An array length must be a constant, and must be positive: a wrong number does not compile.
TEST(ParamsLayout, EnumConstantsAreThoseOfTheTable) {
  std::string checks;
  size_t values = 0;
  for (const std::string& file : listFiles()) {
    const std::string text = readFile(homeFolder() / file);
    size_t at = 0, number = 0;
    const std::string begin = "PARAM_ENUM_BEGIN(", value = "PARAM_ENUM_VALUE(";
    while (at < text.size()) {
      const size_t line = text.find("PARAM_ENUM_", at);
      if (line == std::string::npos) break;
      at = line + 1;
      if (text.compare(line, begin.size(), begin) == 0) number = 0;
      if (text.compare(line, value.size(), value) != 0) continue;
      const std::string constant = text.substr(line + value.size(), text.find(',', line) - line - value.size());
      const std::string check =
          "  { float a[" + constant + " == " + std::to_string(number) + " ? 1 : -1]; a[0] = 1; }\n";
      checks += check;
      ++number, ++values;
    }
  }
  ASSERT_GT(values, 0u);
  reflected(checks);
}

}  // namespace
}  // namespace hl
