// Errors, files, hashes and the log.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

namespace fs = std::filesystem;
using test::EnvironmentVariable;
using test::TemporaryFolder;

size_t entries(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

template <class Act>
Error errorOf(Act act) {
  try {
    act();
  } catch (const Error& error) {
    return error;
  }
  throw std::logic_error("no error was thrown");
}

TEST(Error, ExitCodesFollowTheKind) {
  EXPECT_EQ(Error(ErrorKind::Run, "").exitCode(), 1);
  EXPECT_EQ(badInput("").exitCode(), 2);
  EXPECT_EQ(Error(ErrorKind::Device, "").exitCode(), 3);
  EXPECT_EQ(Error(ErrorKind::Cancelled, "").exitCode(), 130);
}

TEST(Nearest, FindsWhatWasMeant) {
  const std::vector<std::string> keys{"radiosity.samples", "radiosity.estimator", "lightmap.resolution",
                                      "direct.samples"};
  EXPECT_EQ(nearest("radiosity.sampels", keys), "radiosity.samples");
  EXPECT_EQ(nearest("RADIOSITY.SAMPLES", keys), "radiosity.samples");
  EXPECT_EQ(nearest("resolutoin", keys), "lightmap.resolution");
  EXPECT_EQ(nearest("x", keys), "");
  EXPECT_EQ(nearest("", keys), "");
  EXPECT_EQ(nearest("bloom.threshold", keys), "");
  EXPECT_EQ(nearest("mse", {}), "");
  EXPECT_EQ(nearest("ms", {"mae", "mse"}), "mse");
}

TEST(Files, WriteReplacesWholeFiles) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\nc", 5);
  writeFileAtomically(folder / "f.json", "first");
  writeFileAtomically(folder / "f.json", bytes);
  EXPECT_EQ(readFile(folder / "f.json"), bytes);
  writeFileAtomically(folder / "empty", "");
  EXPECT_EQ(readFile(folder / "empty"), "");
  EXPECT_EQ(entries(folder.path()), 2u) << "a temporary file was left behind";
}

TEST(Files, ErrorsNameTheFileAndTheReason) {
  const TemporaryFolder folder;
  const Error missing = errorOf([&] { readFile(folder / "missing.json"); });
  EXPECT_EQ(missing.kind(), ErrorKind::BadInput);
  EXPECT_NE(std::string(missing.what()).find("missing.json"), std::string::npos);
  EXPECT_NE(std::string(missing.what()).find("No such file"), std::string::npos);
  EXPECT_EQ(errorOf([&] { readFile(folder.path()); }).kind(), ErrorKind::BadInput);
  const Error unwritable = errorOf([&] { writeFileAtomically(folder / "no/such/folder", "x"); });
  EXPECT_EQ(unwritable.kind(), ErrorKind::Run);
  // The name of a folder cannot be taken by a file; what was written beside it must go again.
  fs::create_directory(folder / "taken");
  fs::create_directory(folder / "taken/inside");
  EXPECT_EQ(errorOf([&] { writeFileAtomically(folder / "taken", "x"); }).kind(), ErrorKind::Run);
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(Files, ManyWritersLeaveOneWholeFile) {
  const TemporaryFolder folder;
  std::vector<std::thread> writers;
  for (char c = 'a'; c < 'e'; ++c)
    writers.emplace_back([&folder, c] {
      for (int i = 0; i < 20; ++i) writeFileAtomically(folder / "shared", std::string(10'000, c));
    });
  for (std::thread& writer : writers) writer.join();
  const std::string bytes = readFile(folder / "shared");
  EXPECT_EQ(bytes, std::string(10'000, bytes.at(0)));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(Files, FoldersFollowTheEnvironment) {
  const TemporaryFolder folder;
  {
    const EnvironmentVariable cache("HALFLIGHT_CACHE", folder / "deep/cache");
    EXPECT_EQ(cacheFolder(), folder / "deep/cache");
    EXPECT_TRUE(fs::is_directory(folder / "deep/cache"));
  }
  {
    const EnvironmentVariable none("HALFLIGHT_CACHE", ""), xdg("XDG_CACHE_HOME", folder / "xdg");
    EXPECT_EQ(cacheFolder(), folder / "xdg/halflight");
  }
  writeFileAtomically(folder / "file", "");
  const EnvironmentVariable blocked("HALFLIGHT_CACHE", folder / "file/cache");
  EXPECT_EQ(errorOf([] { cacheFolder(); }).kind(), ErrorKind::Run);
}

TEST(Files, ProgramsFolderHoldsTheShaders) { EXPECT_TRUE(fs::is_directory(homeFolder() / "shaders")); }

TEST(Files, ScenesAreLookedForInOrder) {
  const EnvironmentVariable home("HALFLIGHT_HOME", "/home"), scenes("HALFLIGHT_SCENES", "/one:/two::");
  EXPECT_EQ(scenePath("/beside"), (std::vector<fs::path>{"/beside", "/one", "/two", "/home/scenes"}));
  EXPECT_EQ(scenePath(), (std::vector<fs::path>{"/one", "/two", "/home/scenes"}));
}

// Published test vector of XXH3's 128-bit variant for empty input with seed 0.
TEST(Hash, AgreesWithThePublishedVector) { EXPECT_EQ(hashOf(""), "99aa06d3014798d86001c324468d497f"); }

TEST(Hash, StreamsLikeOnePiece) {
  const std::string text(100'000, 'x');
  Hasher hasher;
  for (size_t i = 0; i < text.size(); i += 1000) hasher.bytes(text.data() + i, 1000);
  EXPECT_EQ(hasher.hex(), hashOf(text));
  EXPECT_EQ(hasher.hex().size(), 32u);
}

TEST(Hash, TextsDoNotRunTogether) {
  Hasher one, other;
  one.text("ab").text("c");
  other.text("a").text("bc");
  EXPECT_NE(one.hex(), other.hex());
  Hasher empty, zero;
  empty.array(std::vector<int>{});
  zero.array(std::vector<int>{0});
  EXPECT_NE(empty.hex(), zero.hex());
}

TEST(Log, ReachesTheReceiverUntilItIsRemoved) {
  std::mutex mutex;
  std::vector<std::string> seen;
  setLogSink([&](LogLevel level, std::string_view message) {
    std::lock_guard lock(mutex);
    seen.push_back(std::to_string(static_cast<int>(level)) + std::string(message));
    log(LogLevel::Debug, "from inside");  // must not wait for itself
  });
  std::thread other([] { logWarning("with {} braces"); });
  other.join();
  logInfo("here");
  setLogSink({});
  logInfo("nobody hears this");
  EXPECT_EQ(seen, (std::vector<std::string>{"2with {} braces", "1here"}));
}

TEST(Log, NeverWritesToStdout) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  logError("to stderr");
  setLogLevel(LogLevel::Error);
  logWarning("below the level");
  setLogLevel(LogLevel::Info);
  const std::string err = testing::internal::GetCapturedStderr();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_NE(err.find("to stderr"), std::string::npos);
  EXPECT_EQ(err.find("below the level"), std::string::npos);
}

}  // namespace
}  // namespace hl
