#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

Image gradient(int width, int height, int channels, float scale) {
  Image image(width, height, channels);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = scale * static_cast<float>(i * 7919 % 1009) / 1009.0f;
  return image;
}

std::string messageOf(const fs::path& file) {
  try {
    readImage(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BadInput);
    return error.what();
  }
  ADD_FAILURE() << file << " was read";
  return "";
}

/// Cut to half its length.
fs::path half(const fs::path& file, const fs::path& to) {
  const std::string bytes = readFile(file);
  writeFileAtomically(to, std::string_view(bytes).substr(0, bytes.size() / 2));
  return to;
}

void writeJpeg(const fs::path& file, const Image& image) {
  const auto out = OIIO::ImageOutput::create(file.string());
  ASSERT_TRUE(out);
  ASSERT_TRUE(
      out->open(file.string(), OIIO::ImageSpec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, image.data.data()));
  ASSERT_TRUE(out->close());
}

class Lossless : public testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(Lossless, KeepsEveryBit) {
  const TemporaryFolder folder;
  const auto [extension, channels] = GetParam();
  Image image = gradient(19, 7, channels, 1000);
  image.data[0] = std::numeric_limits<float>::quiet_NaN();
  image.data[1] = std::numeric_limits<float>::infinity();
  image.data[2] = -1e-30f;
  const fs::path file = folder / (std::string("image") + extension);
  writeImage(file, image);
  writeImage(file, image);  // over the old one
  const Image back = readImage(file);
  ASSERT_EQ(back.width, 19);
  ASSERT_EQ(back.height, 7);
  ASSERT_EQ(back.channels, channels);
  for (size_t i = 0; i < image.data.size(); ++i)
    EXPECT_EQ(std::bit_cast<uint32_t>(back.data[i]), std::bit_cast<uint32_t>(image.data[i])) << i;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

INSTANTIATE_TEST_SUITE_P(Formats, Lossless,
                         testing::Values(std::pair{".exr", 1}, std::pair{".exr", 3}, std::pair{".exr", 4},
                                         std::pair{".pfm", 1}, std::pair{".pfm", 3}, std::pair{".EXR", 3},
                                         std::pair{".PFM", 3}));

TEST(Pfm, RowsAreStoredFromTheBottom) {
  const TemporaryFolder folder;
  // 1 x 2 pixels, big endian, scale 2: the first stored row is the lower one.
  const std::string bytes("Pf\n1 2\n2.0\n\x3f\x80\x00\x00\x40\x00\x00\x00", 19);
  writeFileAtomically(folder / "a.pfm", bytes);
  const Image image = readImage(folder / "a.pfm");
  EXPECT_EQ(image.data, (std::vector<float>{4, 2}));
}

TEST(Pfm, DamageIsBadInput) {
  const TemporaryFolder folder;
  for (const char* bytes :
       {"", "PF", "P6\n1 1\n255\nabc", "PF\n1 1\n0\n", "PF\n-1 1\n-1\n", "PF\n2 2\n-1.0\nshort", "PF\nx y\n-1\n",
        "PF\n2000000000 2000000000\n-1.0\n", "PF\n99999999999 1\n-1.0\n", "Pf\n1 1\nnan\n1234"}) {
    writeFileAtomically(folder / "bad.pfm", bytes);
    EXPECT_NE(messageOf(folder / "bad.pfm").find("bad.pfm"), std::string::npos) << bytes;
  }
  EXPECT_THROW(writeImage(folder / "four.pfm", Image(1, 1, 4)), Error);
}

TEST(Png, EightBitsRoundTripWithAlphaUntouched) {
  const TemporaryFolder folder;
  Image image(256, 2, 4);
  for (int x = 0; x < 256; ++x)
    for (int c = 0; c < 4; ++c)
      for (int y = 0; y < 2; ++y) image.pixel(x, y)[c] = static_cast<float>((x * (c + 1) + y) % 256) / 255.0f;
  writeImage(folder / "a.png", image);
  const Image back = readImage(folder / "a.png");
  ASSERT_EQ(back.channels, 4);
  for (size_t i = 0; i < image.data.size(); ++i) ASSERT_NEAR(back.data[i], image.data[i], 1e-6) << i;

  const Image linear = readImage(folder / "a.png", true);
  EXPECT_NEAR(linear.pixel(188, 0)[0], 0.502886, 1e-5);  // ((188/255 + 0.055)/1.055)^2.4
  EXPECT_NEAR(linear.pixel(10, 0)[0], 10.0 / 255 / 12.92, 1e-6);
  EXPECT_NEAR(linear.pixel(188, 0)[3], back.pixel(188, 0)[3], 0);
}

TEST(Png, FloatsAreNotDecoded) {
  const TemporaryFolder folder;
  const Image image = gradient(4, 4, 3, 1);
  writeImage(folder / "a.exr", image);
  EXPECT_EQ(readImage(folder / "a.exr", true).data, image.data);
}

class Metadata : public testing::TestWithParam<const char*> {};

TEST_P(Metadata, RoundTrips) {
  const TemporaryFolder folder;
  std::string preset = "{\n  \"version\": 1,\t\"text\": \"quotes \\\" and : ; = signs\",\n  \"numbers\": [";
  while (preset.size() < 27'000) preset += "0.123456789, ";
  preset += "0]\n}\n";
  Image image = gradient(8, 8, 3, 1);
  image.metadata = {{"halflight:preset", preset}, {"halflight:commit", "0123abcd"}, {"Software", "Halflight 0.1.0"}};
  const fs::path file = folder / (std::string("shot") + GetParam());
  writeImage(file, image);
  const Image back = readImage(file);
  for (const auto& [key, text] : image.metadata) {
    ASSERT_TRUE(back.metadata.contains(key)) << key;
    EXPECT_EQ(back.metadata.at(key), text) << key;
  }
}

TEST_P(Metadata, OtherThanAsciiIsReplacedAndSaid) {
  const TemporaryFolder folder;
  Image image = gradient(8, 8, 3, 1);
  image.metadata = {{"halflight:device", "caf\xc3\xa9"}};
  const fs::path file = folder / (std::string("shot") + GetParam());
  testing::internal::CaptureStderr();
  writeImage(file, image);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("halflight:device"), std::string::npos);
  EXPECT_EQ(readImage(file).metadata.at("halflight:device"), "caf??");
}

INSTANTIATE_TEST_SUITE_P(Formats, Metadata, testing::Values(".png", ".exr"));

TEST(ImageIo, WhatIsNoImageIsBadInput) {
  const TemporaryFolder folder;
  EXPECT_NE(messageOf(folder / "missing.png").find("no such image"), std::string::npos);
  EXPECT_NE(messageOf(folder.path()).find("not an image"), std::string::npos);
  for (const char* name : {"text.png", "text.jpg", "text.exr", "text.tga", "text.xyz", "text"}) {
    writeFileAtomically(folder / name, "this is a text, whatever its name says\n");
    EXPECT_NE(messageOf(folder / name).find(name), std::string::npos);
    writeFileAtomically(folder / name, "");
    EXPECT_NE(messageOf(folder / name).find(name), std::string::npos);
  }
}

TEST(ImageIo, WhatIsCutOffIsBadInput) {
  const TemporaryFolder folder;
  const Image image = gradient(64, 64, 3, 1);
  writeImage(folder / "whole.png", image);
  writeImage(folder / "whole.exr", image);
  writeJpeg(folder / "whole.jpg", image);
  EXPECT_EQ(readImage(folder / "whole.jpg").pixels(), image.pixels());
  for (const char* extension : {".png", ".exr", ".jpg"}) {
    const fs::path cut = half(folder / (std::string("whole") + extension), folder / (std::string("cut") + extension));
    const std::string message = messageOf(cut);
    EXPECT_NE(message.find("cut"), std::string::npos);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(ImageIo, AGiganticHeaderIsRefusedBeforeMemoryIsTaken) {
  const TemporaryFolder folder;
  writeFileAtomically(folder / "huge.ppm", "P6\n65535 65535\n255\nabc");
  EXPECT_NE(messageOf(folder / "huge.ppm").find("65535 x 65535"), std::string::npos);
}

TEST(ImageIo, UnwritableImagesLeaveNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(writeImage(folder / "a.gif", Image(1, 1, 3)), Error);
  EXPECT_THROW(writeImage(folder / "a.exr", Image()), Error);
  EXPECT_THROW(writeImage(folder / "a.png", Image(2, 2, 5)), Error);
  Image short_(2, 2, 3);
  short_.data.pop_back();
  EXPECT_THROW(writeImage(folder / "a.exr", short_), Error);
  EXPECT_THROW(writeImage(folder / "no/such/a.exr", Image(1, 1, 3)), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace hl
