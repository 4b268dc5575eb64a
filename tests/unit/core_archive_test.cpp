// The container of bundles and caches: what goes in comes out, and nothing else does.
#include <gtest/gtest.h>

#include <optional>

#include "engine/core/archive.h"
#include "engine/core/byte_stream.h"
#include "engine/core/files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

constexpr ArchiveKind kKind{"trial", 3};

class ArchiveTest : public testing::Test {
 protected:
  ArchiveTest() {
    ArchiveWriter w(kKind, 3);
    for (const auto& [name, bytes] : parts) w.add(name, bytes);
    w.write(file);
    whole = readFile(file);
  }
  /// Why an archive of these bytes cannot be read, wherever that shows.
  std::optional<ArchiveError::Reason> reasonOf(const std::string& bytes) {
    writeFileAtomically(file, bytes);
    try {
      const Archive archive(file, kKind);
      for (const auto& [name, content] : parts) EXPECT_EQ(archive.read(name), content) << name;
      return {};
    } catch (const ArchiveError& e) {
      EXPECT_NE(std::string(e.what()).find(file.string()), std::string::npos) << e.what();
      return e.reason();
    }
  }

  test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.trial";
  const std::map<std::string, std::string> parts = {
      {"empty", ""}, {"text", "one line\n"}, {"long", std::string(100000, 'x') + "end"}, {"zeros", std::string(64, '\0')}};
  std::string whole;
};

TEST_F(ArchiveTest, PartsComeBackAndAreCompressed) {
  const Archive archive(file, kKind);
  EXPECT_EQ(archive.parts(), (std::vector<std::string>{"empty", "long", "text", "zeros"}));
  for (const auto& [name, bytes] : parts) EXPECT_EQ(archive.read(name), bytes);
  EXPECT_LT(archive.storedBytes("long"), 1000u);
  EXPECT_FALSE(archive.has("another"));
  EXPECT_THROW(archive.read("another"), ArchiveError);
  ArchiveWriter twice(kKind, 1);
  twice.add("a", "1");
  EXPECT_THROW(twice.add("a", "2"), Error);
}

TEST_F(ArchiveTest, NoBitCanChangeUnseen) {
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    EXPECT_TRUE(reasonOf(flipped).has_value()) << "byte " << at << " of " << whole.size();
  }
}

TEST_F(ArchiveTest, CutOffLongerForeignAndOtherVersionsAreToldApart) {
  using Reason = ArchiveError::Reason;
  for (size_t size = 0; size < whole.size(); size += 7) {
    const auto reason = reasonOf(whole.substr(0, size));
    EXPECT_TRUE(reason == Reason::Damaged || reason == Reason::Foreign) << size;
  }
  EXPECT_EQ(reasonOf(whole + "x"), Reason::Damaged);
  EXPECT_EQ(reasonOf("a text of someone else's, long enough to hold a head of ours and then some"), Reason::Foreign);
  std::string other = whole;
  other[std::string("halflight trial\n").size()] = 9;
  EXPECT_EQ(reasonOf(other), Reason::OtherVersion);
  std::filesystem::remove(file);
  try {
    Archive(file, kKind);
    FAIL();
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.reason(), Reason::Unreadable);
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
  }
}

TEST(ByteStream, ReadsWhatWasWrittenAndNoMore) {
  ByteWriter w;
  w.value(7), w.text("name"), w.array(std::vector<float>{1, 2, 3});
  ByteReader r(w.bytes());
  std::vector<float> values;
  EXPECT_EQ(r.value<int>(), 7);
  EXPECT_EQ(r.text(), "name");
  r.array(values);
  EXPECT_EQ(values, (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(r.atEnd());
  EXPECT_THROW(r.value<char>(), std::out_of_range);
  ByteWriter huge;
  huge.value<uint64_t>(uint64_t{1} << 62);
  ByteReader wrong(huge.bytes());
  EXPECT_THROW(wrong.array(values), std::out_of_range) << "before memory is asked for";
}

}  // namespace
}  // namespace hl
