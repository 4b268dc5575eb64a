// Work on the host between passes of the device.
#include "tests/frame_graph_fixture.h"

namespace hl {
namespace {

using test::counting;
using test::errorOf;
using test::FrameGraphTest;

/// Host passes in mapped memory and through staged copies.
class HostPassTest : public FrameGraphTest, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override { open(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Memory, HostPassTest, ::testing::Bool(),
                         [](const auto& i) { return i.param ? "Staged" : "AsTheDeviceHasIt"; });

TEST_P(HostPassTest, RunBetweenDevicePassesInOrder) {
  const Buffer a = device->buffer("a", std::span<const uint32_t>(counting(5000)));
  const Buffer b = device->buffer("b", 20000), c = device->buffer("c", 20000), d = device->buffer("d", 20000);
  for (uint32_t round = 0; round < 3; ++round) {
    add("first", a, b, round);
    graph->host("square").read(b).write(c).run([&](HostAccess& memory) {
      const auto from = memory.span<uint32_t>(b), to = memory.span<uint32_t>(c);
      for (size_t i = 0; i < from.size(); ++i) to[i] = from[i] * from[i];
    });
    graph->host("shift").readWrite(c).run([&](HostAccess& memory) {
      for (uint32_t& v : memory.span<uint32_t>(c)) v += 1;
    });
    add("last", c, d);
    const BatchTimings t = graph->execute();
    ASSERT_EQ(t.passes.size(), 4u);
    EXPECT_TRUE(t.passes[1].host);
    EXPECT_FALSE(t.passes[3].host);
    EXPECT_GT(t.passes[1].ms, 0);
    const auto result = download<uint32_t>(d);
    for (uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(result[i], (i + round) * (i + round) + 1);
  }
}

TEST_P(HostPassTest, AWriteOfAPartLeavesTheRest) {
  const Buffer a = device->buffer("a", std::span<const uint32_t>(counting(100)));
  graph->host("poke").write(a).run([&](HostAccess& memory) { memory.span<uint32_t>(a)[3] = 1000; });
  graph->execute();
  auto expected = counting(100);
  expected[3] = 1000;
  EXPECT_EQ(download<uint32_t>(a), expected);
}

TEST_P(HostPassTest, ExceptionsComeThroughAndTheRestIsDropped) {
  const Buffer a = device->buffer("a", std::span<const uint32_t>(counting(100))), b = device->buffer("b", 400);
  const GpuImage image = device->image("image", {4, 4, Format::RGBA32F});
  graph->clear("zero", b, 0);
  graph->host("stop").read(b).run([](HostAccess&) { throw Error(ErrorKind::Cancelled, "stopped"); });
  add("after", a, b);
  graph->clear("image", image);
  EXPECT_EQ(errorOf([&] { graph->execute(); }).kind(), ErrorKind::Cancelled);
  EXPECT_EQ(download<uint32_t>(b), std::vector<uint32_t>(100, 0));
  EXPECT_TRUE(graph->execute().passes.empty());
  // What was dropped has left no trace in what the graph believes about the resources.
  add("again", a, b, 4);
  graph->clear("image", image);
  graph->execute();
  EXPECT_EQ(download<uint32_t>(b), counting(100, 4));
  EXPECT_EQ(device->download(image).data, std::vector<float>(64, 0));
}

}  // namespace
}  // namespace hl
