// Receivers in clusters, the probes that they ask, and finished clusters on disk.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/srp/compressor.h"
#include "engine/techniques/srp/hemisphere_basis.h"
#include "engine/techniques/srp/memory_plan.h"
#include "engine/techniques/srp/store.h"
#include "tests/session_fixture.h"

namespace hl {
namespace {

Progress progress;

/// Lumels on the six faces of a cube of side 2.
Atlas cube(int perFace) {
  Atlas atlas;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < perFace; ++i) {
      const float u = 2 * std::fmod(0.7548777f * static_cast<float>(i), 1.0f) - 1, v = 2 * std::fmod(0.5698403f * static_cast<float>(i), 1.0f) - 1;
      Lumel l;
      const int axis = face / 2;
      const float side = face % 2 == 0 ? -1.0f : 1.0f;
      l.position[axis] = side, l.position[(axis + 1) % 3] = u, l.position[(axis + 2) % 3] = v;
      l.normal[axis] = -side;
      atlas.lumels.push_back(l);
    }
  return atlas;
}

TEST(SrpClusters, EachReceiverIsInOneClusterThatIsSmallEnough) {
  const Atlas atlas = cube(500);
  const std::vector<vec3> probes{{0, 0, 0}, {0.5f, 0.5f, 0.5f}, {-0.5f, 0, 0}};
  for (int32_t clustering : {kClusteringAabb, kClusteringLbg}) {
    SrpParams params;
    params.clustering = clustering, params.cluster_size = 100;
    const ReceiverClusters c = makeClusters(atlas, probes, params, 2, 25, {}, progress);
    std::set<uint32_t> seen(c.lumelOfReceiver.begin(), c.lumelOfReceiver.end());
    EXPECT_EQ(seen.size(), atlas.lumels.size());
    uint32_t next = 0;
    double spread = 0;
    for (const ReceiverCluster& r : c.clusters) {
      EXPECT_EQ(r.firstReceiver, next);
      EXPECT_LE(r.receivers, 100u);
      EXPECT_GT(r.receivers, 0u);
      next += r.receivers;
      vec3 normal(0.0f);
      for (uint32_t i = 0; i < r.receivers; ++i) normal += atlas.lumels[c.lumelOfReceiver[r.firstReceiver + i]].normal / static_cast<float>(r.receivers);
      spread += static_cast<double>((1 - glm::length(normal)) * static_cast<float>(r.receivers));
    }
    EXPECT_EQ(next, atlas.lumels.size());
    spread /= static_cast<double>(atlas.lumels.size());
    std::printf("%s: %zu clusters, normals apart by %.3f\n", clustering == kClusteringAabb ? "aabb" : "lbg", c.clusters.size(), spread);
    EXPECT_LT(spread, clustering == kClusteringLbg ? 0.02 : 1);
  }
}

TEST(SrpClusters, FewReceiversMakeSmallClustersDownToABound) {
  const std::vector<vec3> probes{{0, 0, 0}};
  const auto largest = [&](int lumelsAFace, int32_t least) {
    SrpParams params;
    params.least_clusters = least;
    uint32_t most = 0;
    for (const ReceiverCluster& r : makeClusters(cube(lumelsAFace), probes, params, 2, 1, {}, progress).clusters) most = std::max(most, r.receivers);
    return most;
  };
  EXPECT_LE(largest(1000, 32), 6000u / 32);
  EXPECT_GT(largest(1000, 32), 64u);
  EXPECT_LE(largest(100, 32), 64u);
  EXPECT_GT(largest(100, 32), 600u / 32);
  EXPECT_GT(largest(1000, 1), 512u);
}

TEST(SrpClusters, ManyReceiversInOnePlaceAreStillSplit) {
  Atlas atlas;
  atlas.lumels.resize(1000);
  const std::vector<vec3> probes{{0, 1, 0}};
  for (int32_t clustering : {kClusteringAabb, kClusteringLbg}) {
    SrpParams params;
    params.clustering = clustering, params.cluster_size = 64;
    for (const ReceiverCluster& r : makeClusters(atlas, probes, params, 1, 1, {}, progress).clusters) EXPECT_LE(r.receivers, 64u);
  }
}

TEST(SrpClusters, NearestProbesWithWeightsThatEndAtNothing) {
  Atlas atlas;
  Lumel l;
  l.position = vec3(0.1f, 0, 0), l.normal = vec3(0, 1, 0);
  atlas.lumels.push_back(l);
  std::vector<vec3> probes;
  for (int i = 0; i < 10; ++i) probes.push_back(vec3(static_cast<float>(i), 0, 0));
  SrpParams params;
  params.k = 3;
  const ReceiverClusters near = makeClusters(atlas, probes, params, 9, 4, {}, progress);
  ASSERT_EQ(near.clusters.size(), 1u);
  EXPECT_EQ(near.clusters[0].probes, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(near.clusters[0].slots, 3u);
  // The radius is the distance to the fourth.
  for (uint32_t q = 0; q < 3; ++q) {
    const shared::SrpNear& n = near.clusters[0].near[q];
    EXPECT_EQ(n.column, 4 * q);
    EXPECT_NEAR(n.weight, probeWeight(std::abs(static_cast<float>(q) - 0.1f) / 2.9f), 1e-6f);
  }
  params.support = kSupportProbeRadius, params.radius = 0.5f;  // of 9 m
  EXPECT_EQ(makeClusters(atlas, probes, params, 9, 4, {}, progress).clusters[0].probes.size(), 5u);
  // None within reach: a cluster without columns.
  params.radius = 0.01f;
  atlas.lumels[0].position = vec3(0, 5, 0);
  const ReceiverClusters none = makeClusters(atlas, probes, params, 9, 4, {}, progress);
  EXPECT_TRUE(none.clusters[0].probes.empty());
  EXPECT_EQ(none.clusters[0].near[0].weight, 0.0f);
}

TEST(SrpClusters, ProbesThatAreAllEquallyFarAreAskedAllTheSame) {
  Atlas atlas;
  atlas.lumels.resize(1);
  const std::vector<vec3> probes{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int k : {1, 2, 3}) {
    SrpParams params;
    params.k = k;
    const ReceiverCluster c = makeClusters(atlas, probes, params, 2, 1, {}, progress).clusters[0];
    EXPECT_EQ(c.probes.size(), static_cast<size_t>(k));
    for (const shared::SrpNear& n : c.near) EXPECT_GT(n.weight, 0.0f);
  }
}

TEST(SrpClusters, WeightIsSmoothAndFallsFromOneToNothing) {
  EXPECT_EQ(probeWeight(0), 1.0f);
  EXPECT_EQ(probeWeight(1), 0.0f);
  EXPECT_EQ(probeWeight(2), 0.0f);
  EXPECT_NEAR(probeWeight(0.5f), 0.5f, 1e-6f);
}

class SrpStore : public ::testing::Test {
 protected:
  void SetUp() override { setenv("HALFLIGHT_CACHE", folder.path().c_str(), 1); }
  static ClusterTransport cluster(float value) {
    ClusterTransport t;
    t.receivers = 2, t.columns = 3, t.rank = 1;
    t.basis = {value, 2, 3}, t.weights = {value, 5}, t.valid = {1, 0.5f};
    t.wide = 1, t.rows = 3, t.weights.push_back(7), t.weights.push_back(8);  // two more rows of the first
    t.total = 9, t.discarded = 1;
    return t;
  }
  test::TemporaryFolder folder;
};

TEST_F(SrpStore, GoesOnWhereItStoppedWhateverHappenedToTheFile) {
  size_t number = 0;
  TransportStore store("abc");
  EXPECT_TRUE(store.read(10).empty());
  EXPECT_EQ(store.count(10), 0u);
  for (float v : {1.0f, 2.0f, 3.0f}) store.append(number++, cluster(v));
  auto found = store.read(10);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[1].basis[0], 2.0f);
  EXPECT_EQ(found[1].wide, 1u);
  EXPECT_EQ(found[1].weights, (std::vector<float>{2, 5, 7, 8}));
  EXPECT_EQ(found[2].valid, (std::vector<float>{1, 0.5f}));
  EXPECT_EQ(store.count(10), 3u);
  EXPECT_EQ(store.count(2), 2u);
  EXPECT_EQ(store.read(2).size(), 2u);  // no more than asked; the third stays or is made anew

  // Whoever comes second reads and does not write.
  TransportStore second("abc");
  EXPECT_EQ(second.read(10).size(), 3u);
  second.append(3, cluster(4));
  EXPECT_EQ(store.read(10).size(), 3u);

  std::filesystem::path file;
  {
    TransportStore other("def");
    file = other.file();
    for (size_t i = 0; i < 3; ++i) other.append(i, cluster(static_cast<float>(i)));
  }
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);  // cut off in the third
  {
    TransportStore other("def");
    EXPECT_EQ(other.count(10), 2u);
    ASSERT_EQ(other.read(10).size(), 2u);
    other.append(2, cluster(7));
    found = other.read(10);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[2].basis[0], 7.0f);
    other.append(5, cluster(8));  // one that is not the next
    EXPECT_EQ(other.read(10).size(), 3u);
  }
  // A bit turned in the second: the first alone is whole.
  std::string bytes = readFile(file);
  bytes[bytes.size() / 2] ^= 1;
  writeFileAtomically(file, bytes);
  EXPECT_EQ(TransportStore("def").read(10).size(), 1u);
  // Not ours at all; and empty.
  for (const char* text : {"something else", ""}) {
    writeFileAtomically(file, text);
    TransportStore other("def");
    EXPECT_EQ(other.count(10), 0u);
    EXPECT_TRUE(other.read(10).empty());
    other.append(0, cluster(1));
    EXPECT_EQ(other.read(10).size(), 1u);
  }
}

TEST_F(SrpStore, AFolderThatCannotBeWrittenIsAWarning) {
  writeFileAtomically(folder / "transport", "a file where the folder should be");
  SrpParams params;
  params.compression = kCompressionNone;
  Compressor compressor(params, 1, 0, std::make_shared<TransportStore>("abc"), {});
  for (int i = 0; i < 2; ++i) {
    ClusterSums sums;
    sums.receivers = 1, sums.columns = 2, sums.matrix = {1, 2}, sums.valid = {4};
    compressor.add(std::move(sums));
  }
  EXPECT_EQ(compressor.finished().size(), 2u);
}

TEST(SrpCompressor, RowsBeyondTheFirstAreThoseOfWideReceivers) {
  SrpParams params;
  params.compression = kCompressionNone, params.receivers = kReceiversRadiance, params.glossy_order = 0;
  params.receiver_rays = 8, params.sample_weight = kSampleWeightValid;
  ClusterSums sums;
  sums.receivers = 2, sums.wide = 1, sums.rows = 2, sums.columns = 2;
  sums.matrix = {1, 2, 3, 4, 5, 6};  // irradiance of both, radiance of the first
  sums.valid = {4, 2};
  sums.moments = {4 * shared::hemisphereMeanFactor(0)};  // as it ought to be
  const ClusterTransport even = compressCluster(sums, params, 1);
  ASSERT_EQ(even.allRows(), 3u);
  const float scales[] = {kPi / 4, kPi / 2, kPi / 4};
  for (size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(even.weights[i], scales[i / 2] * sums.matrix[i]) << i;
  // Samples whose factors come to less: the row takes what is missing from irradiance's.
  sums.moments[0] *= 0.9f;
  const ClusterTransport uneven = compressCluster(sums, params, 1);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(uneven.weights[i], even.weights[i]);
  for (size_t i = 0; i < 2; ++i) EXPECT_NEAR(uneven.weights[4 + i], even.weights[4 + i] + 0.1f * shared::hemisphereMeanFactor(0) * even.weights[i], 1e-5f);
}

TEST(SrpCompressor, KeepsTheOrderWhateverIsDoneFirst) {
  SrpParams params;
  params.compression = kCompressionNone;
  for (size_t most : {0u, 1u, 4u}) {
    Compressor compressor(params, 1, most, nullptr, {});
    for (uint32_t i = 0; i < 20; ++i) {
      ClusterSums sums;
      sums.receivers = 1, sums.columns = 1 + i, sums.matrix.assign(1 + i, 1.0f), sums.valid = {1};
      compressor.add(std::move(sums));
    }
    compressor.drain();
    ASSERT_EQ(compressor.finished().size(), 20u);
    for (uint32_t i = 0; i < 20; ++i) EXPECT_EQ(compressor.finished()[i].columns, 1 + i);
  }
}

/// What a plan says of one cluster's receivers, all of them on glossy surfaces.
class SrpMemory : public ::testing::Test {
 protected:
  SrpMemory() {
    clusters.lumelOfReceiver.resize(64);
    ReceiverCluster c;
    c.receivers = c.wide = 64, c.slots = 2, c.probes = {0, 1};
    c.near.resize(128);
    clusters.clusters.push_back(c);
    params.sh_order = 8, params.compression = kCompressionNone;
  }
  uint64_t bytes(uint64_t probes) const { return planWorkingMemory(clusters, params, probes, limits).bytes(); }

  ReceiverClusters clusters;
  SrpParams params;
  MemoryLimits limits{uint64_t{128} << 20, true, 2};
};

TEST_F(SrpMemory, TheTableOfSurfacesIsCountedAndRefusedWhereItDoesNotFit) {
  const uint64_t with = bytes(1000);
  params.surface_share = false;
  EXPECT_EQ(with - bytes(1000), 4u * (81 * 1000 - 1));
  params.surface_share = true;
  params.precompute_memory_mb = 16;
  EXPECT_LE(bytes(10'000), uint64_t{16} << 20);
  params.surface_share = false;
  EXPECT_NO_THROW(bytes(100'000));
  params.surface_share = true;
  try {
    bytes(100'000);
    FAIL() << "a table of 31 MiB was taken for one of 16";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    for (const char* part : {"precompute_memory_mb is 16", "100000 probes", "srp.surface_share"}) EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST_F(SrpMemory, RadianceReceiversAreCountedAndRefusedWhereFramesCannotHoldThem) {
  const uint64_t irradiance = bytes(8);
  EXPECT_EQ(incidentBytes(clusters, params), 0u);
  params.receivers = kReceiversRadiance, params.glossy_order = 4;
  EXPECT_EQ(bytes(8) - irradiance, 4u * (64 * 15 * 2 * 81 + 64 * 15 - 1)) << "rows, and sums of factors";
  EXPECT_EQ(incidentBytes(clusters, params), 12u * 64 * 15);
  EXPECT_NO_THROW(checkFrameMemory(clusters, params, limits));
  limits.largestBuffer = 12 * 64 * 15 - 1;
  try {
    checkFrameMemory(clusters, params, limits);
    FAIL() << "a buffer larger than the device's largest was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::TooLarge);
    EXPECT_NE(std::string(e.what()).find("srp.glossy_order"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace hl
