// Ours against other people's metrics: NVIDIA's FLIP and scikit-image's SSIM and PSNR, whose answers tests/peers/metric_goldens.py has written down.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/task_pool.h"
#include "engine/metrics/metrics.h"
#include "tests/peers/image_pairs.h"

namespace hl {
namespace {

constexpr double kTolerance = 1e-3;
const std::filesystem::path kData = HALFLIGHT_PEER_DATA;

nlohmann::json goldens() {
  std::ifstream file(kData / "metric_goldens.json");
  return nlohmann::json::parse(file);
}

TEST(Peers, AgreeOnEveryPair) {
  const nlohmann::json file = goldens();
  const auto pairs = peers::imagePairs(kData);
  ASSERT_EQ(pairs.size(), file["pairs"].size());
  ASSERT_NEAR(file["pixels_per_degree"].get<double>(), static_cast<double>(kPixelsPerDegree), 1e-4);
  int compared = 0;
  TaskPool pool(2);
  for (const peers::ImagePair& pair : pairs) {
    ASSERT_TRUE(file["pairs"].contains(pair.id)) << pair.id;
    const nlohmann::json& told = file["pairs"][pair.id];
    ASSERT_EQ(pair.value.width, told["width"].get<int>());
    ASSERT_EQ(pair.value.height, told["height"].get<int>());
    MeasureOptions options;
    options.wantMap = true, options.appearance = pair.appearance, options.pool = &pool;
    for (const auto& [metric, golden] : told["metrics"].items()) {
      const MetricResult ours = measure(metric, pair.value, {pair.reference, {}, {}}, options);
      EXPECT_NEAR(ours.value, golden["value"].get<double>(), kTolerance) << pair.id << " " << metric;
      std::printf("%-10s %-8s ours %.6f theirs %.6f\n", pair.id.c_str(), metric.c_str(), ours.value, golden["value"].get<double>());
      ++compared;
      if (!golden.contains("map")) continue;
      for (size_t i = 0; i < told["places"].size(); ++i) {
        const int x = told["places"][i][0], y = told["places"][i][1];
        EXPECT_NEAR(static_cast<double>(*ours.map.pixel(x, y)), golden["map"][i].get<double>(), kTolerance) << pair.id << " " << metric << " at " << x << ", " << y;
      }
    }
  }
  EXPECT_GE(compared, 20);
}

// So that the comparison above can fail: each value is farther from what no difference would give than five tolerances.
TEST(Peers, WereAskedAboutPicturesThatDiffer) {
  const nlohmann::json file = goldens();
  for (const auto& [id, pair] : file["pairs"].items())
    for (const auto& [metric, golden] : pair["metrics"].items()) {
      const double value = golden["value"];
      const double off = metric == "psnr" ? (100 - value) / 100 : metric == "ssim" ? 1 - value : value;
      EXPECT_GT(off, 5 * kTolerance) << id << " " << metric;
    }
}

}  // namespace
}  // namespace hl
