// How the reference runs: halves, passes, resuming, cancelling, the cache.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include <unistd.h>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/reference/receivers.h"
#include "engine/reference/reference_state.h"
#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

/// A room with a lamp, and a cache folder of its own.
class ReferenceRun : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("halflight-reference-test-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    setenv("HALFLIGHT_CACHE", folder.c_str(), 1);
    addRoom(scene, vec3(-1.0f), vec3(1.0f), addMaterial(scene, vec3(0.6f, 0.5f, 0.4f)));
    addQuad(scene, vec3(-0.3f, 0.9f, -0.3f), vec3(0.6f, 0, 0), vec3(0, 0, 0.6f), addMaterial(scene, vec3(0.5f), vec3(3), true));
    embree = std::make_shared<EmbreeScene>(scene);
    settings.samplesPerPixel = 64, settings.directSamples = 96;
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::vector<Receiver> grid(int n) const {
    std::vector<Receiver> receivers;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const float x = 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(n) - 1;
        receivers.push_back(receiverAt(vec3(x, -1, 2 * (static_cast<float>(j) + 0.5f) / static_cast<float>(n) - 1), vec3(0, 1, 0)));
      }
    return receivers;
  }
  std::unique_ptr<ReferenceTracer> tracer(int n, const ReferenceSettings& s, TaskPool& pool = sharedPool()) const {
    return std::make_unique<ReferenceTracer>(embree, grid(n), n, n, s, pool);
  }
  static void expectSame(const ReferenceResult& a, const ReferenceResult& b) {
    EXPECT_EQ(a.samplesPerPixel, b.samplesPerPixel);
    EXPECT_EQ(a.paths, b.paths);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.backFaceHits, b.backFaceHits);
    for (int half = 0; half < 2; ++half) {
      EXPECT_TRUE(a.direct[half].data == b.direct[half].data);
      for (size_t k = 0; k < kBounceBuckets; ++k)
        EXPECT_TRUE(a.indirect[half][k].data == b.indirect[half][k].data) << "bucket " << k;
    }
  }
  std::filesystem::path onlyFile() const {
    std::vector<std::filesystem::path> files;
    for (const auto& e : std::filesystem::directory_iterator(folder / "references")) files.push_back(e.path());
    EXPECT_EQ(files.size(), 1u);
    return files.empty() ? std::filesystem::path() : files.front();
  }

  std::filesystem::path folder;
  Scene scene;
  std::shared_ptr<const EmbreeScene> embree;
  ReferenceSettings settings;
};

TEST_F(ReferenceRun, ResultDoesNotDependOnThreadsOrSlices) {
  TaskPool one(1), three(3);
  const auto a = traceAll(*tracer(32, settings, one));
  const auto b = traceAll(*tracer(32, settings, three));
  expectSame(*a, *b);
  // Cancelled again and again from another thread, in the middle of units.
  const auto slow = tracer(32, settings, three);
  int cancelled = 0;
  while (!slow->settled()) {
    Progress progress;
    std::thread stop([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(cancelled < 20 ? 2000 : 2000000));
      progress.cancel();
    });
    try {
      while (!slow->settled()) slow->advance(progress);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::Cancelled);
      ++cancelled;
    }
    stop.join();
  }
  EXPECT_GT(cancelled, 3);
  expectSame(*a, *slow->result());
}

TEST_F(ReferenceRun, CancelsAtOnce) {
  settings.samplesPerPixel = 1 << 20;
  for (const int n : {1, 100}) {
    const auto t = tracer(n, settings);
    Progress progress;
    std::chrono::steady_clock::time_point asked;
    std::thread stop([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      asked = std::chrono::steady_clock::now();
      progress.cancel();
    });
    EXPECT_THROW(while (true) t->advance(progress), Error);
    const auto now = std::chrono::steady_clock::now();
    stop.join();
    EXPECT_LT(std::chrono::duration<double>(now - asked).count(), 0.5) << n;
  }
}

TEST_F(ReferenceRun, ResumesFromTheCacheAsIfInOneGo) {
  const auto whole = traceAll(*tracer(24, settings));
  ReferenceSettings less = settings;
  less.samplesPerPixel = 16;
  const auto first = tracer(24, less);
  traceAll(*first);
  first->store();
  const auto second = tracer(24, settings);
  second->resume();
  ASSERT_TRUE(second->result());
  EXPECT_EQ(second->result()->samplesPerPixel, 16);
  EXPECT_FALSE(second->settled());
  EXPECT_GT(second->done(), 0.2);
  expectSame(*whole, *traceAll(*second));
  second->store();
  // The longer one does not serve a shorter run, and the shorter one is still there.
  const auto third = tracer(24, less);
  third->resume();
  EXPECT_TRUE(third->settled());
  expectSame(*first->result(), *third->result());
}

TEST_F(ReferenceRun, StoredInTheMiddleOfAPass) {
  settings.samplesPerPixel = 4, settings.directSamples = 4;  // 6400 receivers: 7 units a pass
  const auto whole = traceAll(*tracer(80, settings));
  const auto first = tracer(80, settings);
  Progress progress;
  for (int i = 0; i < 9; ++i) first->advance(progress);
  EXPECT_GT(first->done(), 0);
  first->store();
  const auto second = tracer(80, settings);
  second->resume();
  expectSame(*whole, *traceAll(*second));
}

TEST_F(ReferenceRun, OtherSettingsAreOtherReferences) {
  const auto keyOf = [&](const ReferenceSettings& s) {
    ReferenceSettings two = s;
    two.samplesPerPixel = 2;
    return traceAll(*tracer(4, two))->key;
  };
  std::vector<std::string> keys = {keyOf(settings)};
  ReferenceSettings s = settings;
  s.seed = 2, keys.push_back(keyOf(s)), s = settings;
  s.maxBounces = 3, keys.push_back(keyOf(s)), s = settings;
  s.frontFacesOnly = true, keys.push_back(keyOf(s)), s = settings;
  s.receiver = ReceiverNormal::Geometric, keys.push_back(keyOf(s)), s = settings;
  scene.materials[0].albedo.x = 0.61f, keys.push_back(keyOf(s));
  PointLight light;
  scene.pointLights.push_back(light), keys.push_back(keyOf(s));
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::unique(keys.begin(), keys.end()), keys.end());
}

TEST_F(ReferenceRun, DamagedCacheIsPassedOverWithAWarning) {
  settings.samplesPerPixel = 4;
  const auto first = tracer(8, settings);
  const auto good = traceAll(*first);
  first->store();
  const std::filesystem::path file = onlyFile();
  const std::string bytes = readFile(file);
  int warnings = 0;
  setLogSink([&](LogLevel level, std::string_view) { warnings += level == LogLevel::Warning; });
  const auto resumed = [&](std::string content) {
    writeFileAtomically(file, content);
    auto t = tracer(8, settings);
    t->resume();
    return t;
  };
  EXPECT_TRUE(resumed(bytes)->settled());
  EXPECT_EQ(warnings, 0);
  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 1);
  int expected = 0;
  for (const std::string& bad : {flipped, bytes.substr(0, bytes.size() - 1), bytes.substr(0, 5), std::string(), bytes + "x"}) {
    const auto t = resumed(bad);
    EXPECT_FALSE(t->settled());
    EXPECT_FALSE(t->result());
    EXPECT_EQ(warnings, ++expected);
    expectSame(*good, *traceAll(*t));
  }
  setLogSink({});
}

// The halves' errors about the truth (a long run's mean) are uncorrelated, and neighbours' too.
TEST_F(ReferenceRun, HalvesAreIndependent) {
  ReferenceSettings converged = settings;
  converged.samplesPerPixel = 512, converged.seed = 99, converged.directSamples = 512;
  settings.samplesPerPixel = 16, settings.directSamples = 16;
  constexpr int kSide = 32;
  const auto truth = traceAll(*tracer(kSide, converged));
  const auto r = traceAll(*tracer(kSide, settings));
  const auto check = [&](const ReferenceImage& v, const ReferenceImage& t, const char* what) {
    double ab = 0, aa = 0, bb = 0, neighbours = 0;
    const size_t n = v.mean.pixels();
    double before = 0;
    for (size_t i = 0; i < n; ++i) {
      const double a = static_cast<double>(v.halfA.data[3 * i + 1] - t.mean.data[3 * i + 1]);
      const double b = static_cast<double>(v.halfB.data[3 * i + 1] - t.mean.data[3 * i + 1]);
      ab += a * b, aa += a * a, bb += b * b, neighbours += a * before, before = a;
    }
    const double limit = 4 / std::sqrt(static_cast<double>(n));
    EXPECT_GT(aa, 0) << what;
    EXPECT_LT(std::abs(ab) / std::sqrt(aa * bb), limit) << what << ": halves";
    EXPECT_LT(std::abs(neighbours) / aa, limit) << what << ": neighbours";
    EXPECT_NEAR(aa / bb, 1, 0.25) << what << ": equal variance";
  };
  check(r->indirectImage(kAllBounces), truth->indirectImage(kAllBounces), "indirect");
  check(r->indirectImage(1), truth->indirectImage(1), "first bounce");
  check(r->directImage(), truth->directImage(), "direct");
}

TEST_F(ReferenceRun, BucketsDoNotDependOnTheBounceLimit) {
  settings.samplesPerPixel = 32;
  const auto all = traceAll(*tracer(12, settings));
  settings.maxBounces = 3;
  const auto limited = traceAll(*tracer(12, settings));
  for (int half = 0; half < 2; ++half)
    for (size_t b = 0; b < kBounceBuckets; ++b) {
      if (b < 3)
        EXPECT_EQ(all->indirect[half][b].data, limited->indirect[half][b].data) << b;
      else
        for (const float v : limited->indirect[half][b].data) ASSERT_EQ(v, 0);
    }
  EXPECT_EQ(all->indirectImage(3).mean.data, limited->indirectImage(kAllBounces).mean.data);
  EXPECT_EQ(all->indirectImage(0).mean.data, std::vector<float>(3 * 144, 0.0f));
}

TEST_F(ReferenceRun, SamplesAreCountedAndProgressGrows) {
  settings.samplesPerPixel = 10, settings.directSamples = 100;
  const auto t = tracer(16, settings);
  EXPECT_EQ(t->done(), 0);
  EXPECT_FALSE(t->result());
  Progress progress;
  double before = 0;
  while (!t->settled()) {
    t->advance(progress);
    EXPECT_GE(t->done(), before);
    before = t->done();
  }
  EXPECT_EQ(t->done(), 1);
  EXPECT_EQ(t->result()->samplesPerPixel, 10);
  EXPECT_EQ(t->result()->paths, 10u * 256u);
}

TEST_F(ReferenceRun, ReceiversFromImages) {
  Image position(2, 2, 4), normal(2, 2, 4), geometric(2, 2, 4);
  const auto set = [](Image& i, size_t p, vec4 v) { std::memcpy(i.data.data() + 4 * p, &v, sizeof v); };
  set(position, 0, vec4(1, 2, 3, 1)), set(normal, 0, vec4(0.6f, 0.8f, 0, 0.3f)), set(geometric, 0, vec4(0, 1, 0, 0.4f));
  for (const size_t p : {size_t{2}, size_t{3}})
    set(position, p, vec4(4, 5, 6, -1)), set(normal, p, vec4(0, 0, 1, 0)), set(geometric, p, vec4(0, 0, 1, 0));
  const std::vector<uint32_t> ids = {1, 0, 0, 0, 2, 0, 3, 1};  // materials 0 (one-sided) and 1 (two-sided)
  const std::vector<Receiver> r = receiversFromGBuffer(position, normal, geometric, ids, &scene);
  ASSERT_EQ(r.size(), 4u);
  EXPECT_EQ(r[0].position, vec3(1, 2, 3));
  EXPECT_LT(glm::length(r[0].mappedNormal - vec3(0.6f, 0.8f, 0)), 1e-6f);
  EXPECT_EQ(r[0].geometricNormal, vec3(0, 1, 0));
  EXPECT_FALSE(r[0].backFace);
  EXPECT_EQ(r[1].geometricNormal, vec3(0.0f)) << "no surface";
  EXPECT_TRUE(r[2].backFace && !r[2].twoSided);
  EXPECT_TRUE(r[3].backFace && r[3].twoSided);
  EXPECT_TRUE(receiversFromGBuffer(position, normal, geometric)[2].twoSided) << "unknown: taken as two-sided";
  EXPECT_THROW(receiversFromGBuffer(position, Image(3, 2, 4), geometric), Error);
  EXPECT_THROW(receiversFromGBuffer(position, normal, geometric, std::vector<uint32_t>{1, 2}, &scene), Error);
  Lumel l;
  l.position = vec3(7, 8, 9), l.normal = vec3(0, 0, -1);
  const std::vector<Receiver> lumels = receiversFromLumels({l});
  EXPECT_EQ(lumels[0].position, l.position);
  EXPECT_EQ(lumels[0].geometricNormal, l.normal);
  EXPECT_EQ(lumels[0].mappedNormal, l.normal);
}

}  // namespace
}  // namespace hl
