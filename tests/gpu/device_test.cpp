#include "engine/gpu/device.h"

#include <cstdlib>
#include <random>

#include "tests/gpu_fixture.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

using test::errorOf;
using DeviceTest = test::GpuTest;

TEST_F(DeviceTest, SaysWhatItIs) {
  const DeviceInfo& info = device->info();
  EXPECT_FALSE(info.name.empty());
  EXPECT_FALSE(info.driver.empty());
  EXPECT_EQ(info.missing, "");
  EXPECT_GE(device->maxStorageBufferBytes(), 128u << 20);
  const std::vector<DeviceInfo> all = listDevices();
  ASSERT_FALSE(all.empty());
  bool listed = false;
  for (const DeviceInfo& d : all) listed = listed || d.name == info.name;
  EXPECT_TRUE(listed);
}

TEST_F(DeviceTest, IsSelectedByNumberAndByPartOfItsName) {
  const std::string name = listDevices()[0].name;
  DeviceOptions options;
  options.select = "0";
  EXPECT_EQ(Device(options).info().name, name);
  options.select = name.substr(1, 4);
  for (char& c : options.select) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(Device(options).info().name, name);
  for (const char* wrong : {"99", "no such device"}) {
    options.select = wrong;
    const Error e = errorOf([&] { Device d(options); });
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
  }
}

TEST(DeviceWithoutDriver, IsAnErrorThatSaysWhatToInstall) {
  const test::EnvironmentVariable none("VK_DRIVER_FILES", "/nonexistent");
  const test::EnvironmentVariable noneOld("VK_ICD_FILENAMES", "/nonexistent");
  for (const Error& e : {errorOf([] { listDevices(); }), errorOf([] { Device d; })}) {
    EXPECT_EQ(e.kind(), ErrorKind::Device);
    EXPECT_NE(std::string(e.what()).find("mesa-vulkan-drivers"), std::string::npos) << e.what();
  }
}

TEST(DeviceWithoutLayer, IsAnErrorWhereValidationIsAskedFor) {
  const test::EnvironmentVariable none("VK_LAYER_PATH", "/nonexistent");
  DeviceOptions options;
  options.validation = true;
  const Error e = errorOf([&] { Device d(options); });
  EXPECT_EQ(e.kind(), ErrorKind::Device);
  EXPECT_NE(std::string(e.what()).find("vulkan-validationlayers"), std::string::npos) << e.what();
}

TEST(DeviceValidation, IsTurnedOnByTheEnvironment) {
  const test::EnvironmentVariable on("HALFLIGHT_VALIDATION", "1");
  Device device;
  ShaderLibrary shaders(device);
  FrameGraph graph(device, shaders);
  const Buffer a = device.buffer("a", 64), b = device.buffer("b", 64);
  struct {
    uint32_t count = 16, offset = 0;
  } push;
  // A race that only synchronisation validation sees.
  graph.clear("fill", a, 1);
  graph.compute("add", "tests/add.comp")
      .bind("source", a, Access::Read)
      .bind("target", b, Access::Write)
      .push(push)
      .dispatchThreads(16);
  graph.omitBarriersBefore("add");
  graph.execute();
  EXPECT_GT(device.validationMessages(), 0u);
}

/// In both kinds of memory: mapped, and reached through staging.
class CopyTest : public test::GpuTest, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override { open(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Memory, CopyTest, ::testing::Bool(),
                         [](const auto& i) { return i.param ? "Staged" : "AsTheDeviceHasIt"; });

TEST_P(CopyTest, BuffersComeBackAsTheyWent) {
  // Larger than one piece of staging, and odd.
  std::vector<uint32_t> data((20u << 20) / 4 + 13);
  std::mt19937 random(1);
  for (uint32_t& v : data) v = static_cast<uint32_t>(random());
  const Buffer b = device->buffer("data", std::span<const uint32_t>(data));
  EXPECT_EQ(download<uint32_t>(b), data);

  const uint32_t patch[] = {1, 2, 3};
  device->upload(b, patch, sizeof patch, 4 * 1000);
  std::copy(std::begin(patch), std::end(patch), data.begin() + 1000);
  uint32_t part[5];
  device->download(b, part, sizeof part, 4 * 999);
  EXPECT_TRUE(std::equal(std::begin(part), std::end(part), data.begin() + 999));

  const Error e = errorOf([&] { device->upload(b, patch, sizeof patch, b.size() - 4); });
  EXPECT_EQ(e.kind(), ErrorKind::BadInput);
  EXPECT_NE(std::string(e.what()).find("\"data\""), std::string::npos);
}

TEST_P(CopyTest, ImagesComeBackAsTheyWent) {
  for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F}) {
    const int channels = format == Format::R32F ? 1 : format == Format::RG32F ? 2 : 4;
    const GpuImage image = device->image("picture", {37, 19, format});
    std::vector<float> data(37u * 19u * static_cast<size_t>(channels));
    for (size_t i = 0; i < data.size(); ++i) data[i] = static_cast<float>(i % 2048) - 3.0f;  // exact in 16 bits
    device->upload(image, 0, data.data(), data.size() * 4);
    const Image back = device->download(image);
    EXPECT_EQ(back.channels, channels);
    EXPECT_EQ(back.data, data);
  }
  const GpuImage labels = device->image("labels", {5, 3, Format::RG32U});
  const std::vector<uint32_t> ids = test::counting(30, 0xfffffff0u);
  device->upload(labels, 0, ids.data(), 120);
  std::vector<uint32_t> back(30);
  device->download(labels, back.data(), 120);
  EXPECT_EQ(back, ids);
  EXPECT_EQ(errorOf([&] { device->download(labels); }).kind(), ErrorKind::BadInput);
  EXPECT_EQ(errorOf([&] { device->upload(labels, 1, ids.data(), 120); }).kind(), ErrorKind::BadInput);
}

TEST_F(DeviceTest, MipsAreMeansOfWhatLiesAboveThem) {
  // 4x4 with one white texel in each quarter: the second level is 63.75 everywhere, and so is the third.
  const GpuImage image = device->image("mips", {4, 4, Format::RGBA8, 2, 3});
  std::vector<uint8_t> texels(64, 0);
  for (const size_t t : {0u, 3u, 9u, 14u})
    std::fill_n(texels.begin() + static_cast<std::ptrdiff_t>(t * 4), 4, uint8_t{255});
  device->upload(image, 0, texels.data(), 64);
  device->upload(image, 1, texels.data(), 64);
  device->generateMips(image);
  std::vector<uint8_t> back(64);
  device->download(image, back.data(), 64);
  EXPECT_EQ(back, texels);
  const GpuImage result = device->image("levels", {2, 1, Format::RGBA32F});
  graph->compute("read levels", "tests/levels.comp")
      .sample("layers", image)
      .bind("result", result, Access::Write)
      .dispatch(1);
  graph->execute();
  const Image levels = device->download(result);
  EXPECT_NEAR(levels.pixel(0, 0)[0] * 255, 63.75f, 1.0f);
  EXPECT_NEAR(levels.pixel(1, 0)[0] * 255, 63.75f, 1.0f);
}

TEST_F(DeviceTest, ExhaustedMemoryIsAnErrorThatNamesTheBuffer) {
  const uint64_t before = device->bytesAllocated();
  std::vector<Buffer> hog;
  const Error e = errorOf([&] {
    for (int i = 0; i < 4096; ++i) hog.push_back(device->buffer("hog " + std::to_string(i), 512ull << 20));
  });
  EXPECT_EQ(e.kind(), ErrorKind::TooLarge);
  EXPECT_NE(std::string(e.what()).find("\"hog " + std::to_string(hog.size()) + "\" of 536870912 bytes"),
            std::string::npos)
      << e.what();
  EXPECT_EQ(device->bytesAllocated(), before + (hog.size() * 512ull << 20));
  hog.clear();
  EXPECT_EQ(device->bytesAllocated(), before);
  // What was given back can be had again.
  EXPECT_EQ(download<uint32_t>(device->buffer("after", std::span<const uint32_t>(test::counting(100)))),
            test::counting(100));
}

TEST_F(DeviceTest, BuffersTooLargeToBindNameThemselves) {
  const Buffer small = device->buffer("small", 64);
  Buffer large;
  const auto make = [&] { large = device->buffer("large", device->maxStorageBufferBytes() + 16); };
  try {
    make();
  } catch (const Error&) {
    // A device that binds as much as it allocates in one piece says so here.
    const Error e = errorOf(make);
    EXPECT_EQ(e.kind(), ErrorKind::TooLarge);
    EXPECT_NE(std::string(e.what()).find("\"large\""), std::string::npos) << e.what();
    return;
  }
  struct {
    uint32_t count = 16, offset = 0;
  } push;
  const Error e = errorOf([&] {
    graph->compute("too much", "tests/add.comp")
        .bind("source", large, Access::Read)
        .bind("target", small, Access::Write)
        .push(push)
        .dispatch(1);
  });
  EXPECT_EQ(e.kind(), ErrorKind::TooLarge);
  EXPECT_NE(std::string(e.what()).find("\"large\""), std::string::npos) << e.what();
}

TEST_F(DeviceTest, ResourcesOutliveTheirDevice) {
  Buffer b = device->buffer("late", 1024);
  GpuImage i = device->image("late", {8, 8, Format::RGBA8});
  graph.reset();
  shaders.reset();
  for (const std::string& message : device->takeValidationMessages()) ADD_FAILURE() << message;
  device.reset();
  b = {};
  i = {};
}

}  // namespace
}  // namespace hl
