// Shaders that change on disk while the program runs, in a home folder of their own.
#include <chrono>
#include <filesystem>

#include "engine/core/files.h"
#include "tests/gpu_fixture.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

class HotReloadTest : public ::testing::Test {
 protected:
  HotReloadTest()
      : home_("HALFLIGHT_HOME", folder_.path().string()),
        compiled_("HALFLIGHT_SHADERS", (folder_ / "compiled").string()) {}
  void SetUp() override {
    write("shaders/lib/value.glsl", "const uint kValue = 7;\n");
    write("shaders/main.comp", source("kValue"));
    // The build's part: the very same text, compiled before.
    fs::create_directories(folder_ / "compiled");
    fs::copy_file(fs::path(builtShaders_) / "tests/number.comp.spv", folder_ / "compiled/main.comp.spv");
    DeviceOptions options;
    options.validation = true;
    device = std::make_unique<Device>(options);
    shaders = std::make_unique<ShaderLibrary>(*device);
    graph = std::make_unique<FrameGraph>(*device, *shaders);
    result = device->buffer("result", 4);
  }
  void TearDown() override {
    graph.reset();
    shaders.reset();
    for (const std::string& message : device->takeValidationMessages()) ADD_FAILURE() << message;
  }
  static std::string source(const std::string& value) {
    return "#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"shaders/lib/value.glsl\"\n"
           "layout(local_size_x = 1) in;\nlayout(binding = 3) writeonly buffer Result { uint result; };\nvoid main() { "
           "result = " +
           value + "; }\n";
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    writeFileAtomically(folder_ / name, text);
  }
  uint32_t run() {
    graph->compute("number", "main.comp").bind("result", result, Access::Write).dispatch(1);
    graph->execute();
    uint32_t value = 0;
    device->download(result, &value, 4);
    return value;
  }

  std::string builtShaders_ = shaderFolder().string();  // before the variables are set
  test::TemporaryFolder folder_;
  test::EnvironmentVariable home_, compiled_;
  std::unique_ptr<Device> device;
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameGraph> graph;
  Buffer result;
};

using Names = std::vector<std::string>;

TEST_F(HotReloadTest, TakesChangesOfTheSourceAndOfWhatItIncludes) {
  EXPECT_EQ(run(), 7u);
  EXPECT_TRUE(shaders->reload().reloaded.empty()) << "nothing has changed";

  write("shaders/main.comp", source("kValue + 1"));
  ReloadReport report = shaders->reload();
  EXPECT_EQ(report.reloaded, Names{"main.comp"});
  EXPECT_TRUE(report.errors.empty());
  EXPECT_EQ(run(), 8u);
  EXPECT_EQ(run(), 8u);

  write("shaders/lib/value.glsl", "const uint kValue = 100;\n");
  EXPECT_EQ(shaders->reload().reloaded, Names{"main.comp"});
  EXPECT_EQ(run(), 101u);
  // Touched, but the same.
  write("shaders/lib/value.glsl", "const uint kValue = 100;\n");
  EXPECT_TRUE(shaders->reload().reloaded.empty());
}

TEST_F(HotReloadTest, ABrokenShaderKeepsTheOldOneAndSaysWhere) {
  EXPECT_EQ(run(), 7u);
  write("shaders/main.comp", source("kValeu"));
  ReloadReport report = shaders->reload();
  EXPECT_TRUE(report.reloaded.empty());
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_NE(report.errors[0].find("shaders/main.comp:6:"), std::string::npos) << report.errors[0];
  EXPECT_NE(report.errors[0].find("kValeu"), std::string::npos) << report.errors[0];
  EXPECT_EQ(run(), 7u);

  write("shaders/main.comp", source("kValue"));
  write("shaders/lib/value.glsl", "const uint kValue = 9 9;\n");
  report = shaders->reload();
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_NE(report.errors[0].find("shaders/lib/value.glsl:1:"), std::string::npos) << report.errors[0];
  EXPECT_EQ(run(), 7u);

  fs::remove(folder_ / "shaders/lib/value.glsl");
  report = shaders->reload();
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_NE(report.errors[0].find("value.glsl"), std::string::npos) << report.errors[0];
  EXPECT_EQ(run(), 7u);

  write("shaders/lib/value.glsl", "const uint kValue = 9;\n");
  EXPECT_EQ(shaders->reload().reloaded, Names{"main.comp"});
  EXPECT_EQ(run(), 9u);
}

TEST_F(HotReloadTest, ABuildOlderThanItsSourceIsCompiledAgain) {
  write("shaders/lib/value.glsl", "const uint kValue = 5;\n");
  const auto built = fs::last_write_time(folder_ / "compiled/main.comp.spv");
  fs::last_write_time(folder_ / "shaders/lib/value.glsl", built + std::chrono::seconds(5));
  EXPECT_EQ(run(), 7u) << "what the build made";
  EXPECT_EQ(shaders->reload().reloaded, Names{"main.comp"});
  EXPECT_EQ(run(), 5u);
}

TEST_F(HotReloadTest, ANewBindingIsAskedForAtOnce) {
  EXPECT_EQ(run(), 7u);
  write("shaders/main.comp",
        "#version 460\nlayout(local_size_x = 1) in;\nbuffer Result { uint outcome; };\nvoid main() { outcome = 1; }\n");
  EXPECT_EQ(shaders->reload().reloaded, Names{"main.comp"});
  const Error e = test::errorOf([&] { run(); });
  EXPECT_NE(std::string(e.what()).find("\"outcome\""), std::string::npos) << e.what();
}

}  // namespace
}  // namespace hl
