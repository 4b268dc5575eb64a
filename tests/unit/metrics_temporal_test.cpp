// Flicker and step response of made-up sequences whose answers are known.
#include "engine/metrics/temporal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"

namespace hl {
namespace {

Image constant(float light, int channels = 3, int width = 8, int height = 6) {
  Image out(width, height, channels);
  std::fill(out.data.begin(), out.data.end(), light);
  return out;
}

TEST(Flicker, OfWhatStandsStillIsZero) {
  for (const float light : {0.0f, 0.3f, 1e6f}) {
    FlickerMeter meter;
    for (int i = 0; i < 50; ++i) meter.add(constant(light));
    EXPECT_EQ(meter.result().value, 0) << light;
    EXPECT_EQ(meter.frames(), 50u);
  }
}

// L alternates between m (1 - a) and m (1 + a): the sample's deviation is m a sqrt(n / (n - 1)).
TEST(Flicker, OfAnAlternatingPictureIsItsRelativeDeviation) {
  FlickerMeter meter;
  for (int i = 0; i < 100; ++i) meter.add(constant(i % 2 ? 2.2f : 1.8f));
  const FlickerResult r = meter.result();
  EXPECT_NEAR(r.epsilon, 0.02, 1e-6);
  EXPECT_NEAR(r.value, 0.2 * std::sqrt(100.0 / 99) / 2.02, 1e-6);
}

TEST(Flicker, OfNoiseIsItsDeviationOverItsMeanAndTheMapsMean) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(5, 0.5);
  FlickerMeter meter;
  Mask mask(48, 1);
  for (size_t i = 0; i < 20; ++i) mask[i] = 0;
  for (int frame = 0; frame < 400; ++frame) {
    Image image(8, 6, 1);
    for (float& x : image.data) x = noise(random) + 1000 * static_cast<float>(frame == 0 && &x < image.data.data() + 20);
    meter.add(image);
  }
  const FlickerResult r = meter.result(mask);
  EXPECT_NEAR(r.value, 0.5 / 5.05, 0.05 * 0.1);
  double sum = 0;
  for (const float x : r.map.data) sum += static_cast<double>(x);
  EXPECT_NEAR(sum / 28, r.value, 1e-6);
  EXPECT_EQ(r.map.data[3], 0);
  EXPECT_GT(meter.result().value, 5 * r.value) << "the masked pixels flashed";
}

// Sums of squares lose everything where the level is high and the deviation small.
TEST(Flicker, KeepsItsFiguresAtAHighLevel) {
  FlickerMeter meter;
  for (int i = 0; i < 10000; ++i) meter.add(constant(i % 2 ? 1000001.0f : 1000000.0f, 1));
  EXPECT_NEAR(meter.result().value * 1.01 * 1e6, 0.5, 1e-3);
}

TEST(Flicker, NamesWhatIsWrong) {
  FlickerMeter meter;
  EXPECT_THROW(meter.result(), Error);
  meter.add(constant(1));
  EXPECT_THROW(meter.result(), Error);
  EXPECT_THROW(meter.add(constant(1, 3, 4, 4)), Error);
  EXPECT_THROW(meter.add(constant(1, 2)), Error);
  Image bad = constant(1);
  bad.data[0] = std::numeric_limits<float>::quiet_NaN();
  meter.add(bad);
  EXPECT_TRUE(std::isnan(meter.result().value));
  EXPECT_EQ(meter.result().nonFinite, 1u);
  Mask without(48, 1);
  without[0] = 0;
  EXPECT_EQ(meter.result(without).value, 0);
  EXPECT_THROW(meter.result(Mask(48, 0)), Error);
  EXPECT_THROW(meter.result(Mask(3, 1)), Error);
}

// x_n = after + (before - after) f^n: 5 % are left from n = ln .05 / ln f on (MEASURES.md section 1, Temporal).
TEST(StepResponse, OfAnExponentialAverageIsItsClosedForm) {
  struct Case {
    double feedback;
    uint64_t five, one;
  };
  for (const Case& c : {Case{0.97, 99, 152}, {0.5, 5, 7}, {0.985, 199, 305}}) {
    TransientMeter meter(constant(4), constant(1));
    for (int n = 1; n < 400; ++n) EXPECT_NEAR(meter.add(constant(static_cast<float>(1 + 3 * std::pow(c.feedback, n)))), std::pow(c.feedback, n), 1e-5);
    const StepResponse r = meter.result();
    EXPECT_NEAR(r.size, 3, 1e-6);
    ASSERT_TRUE(r.frames5 && r.frames1);
    EXPECT_EQ(*r.frames5, c.five) << c.feedback;
    EXPECT_EQ(*r.frames1, c.one) << c.feedback;
  }
}

TEST(StepResponse, CountsFromTheLastFrameThatWasTooFarOff) {
  TransientMeter meter(constant(0), constant(1));
  for (const float x : {0.5f, 0.99f, 0.8f, 0.96f, 0.995f, 0.98f, 1.0f}) meter.add(constant(x));
  EXPECT_EQ(*meter.result().frames5, 4u);
  EXPECT_EQ(*meter.result().frames1, 7u);
  meter.add(constant(2));  // an overshoot at the end: it has not settled
  EXPECT_FALSE(meter.result().frames5 || meter.result().frames1);
  EXPECT_FALSE(TransientMeter(constant(0), constant(1)).result().frames5);
}

/// Noise of single pixels stands in the way of the rms and not of the mean.
TEST(StepResponse, NoiseIsToldApartFromTheMean) {
  TransientMeter meter(constant(0), constant(1));
  const auto noisy = [](float level) {
    Image frame = constant(level);
    for (size_t i = 0; i < frame.data.size(); ++i) frame.data[i] += i % 2 ? 0.1f : -0.1f;
    return frame;
  };
  EXPECT_NEAR(meter.leftBy(noisy(1)), 0.1, 1e-6);
  EXPECT_TRUE(meter.result().left.empty()) << "it is not one of the frames that follow";
  for (const float level : {0.5f, 0.96f, 0.995f, 1.0f}) EXPECT_NEAR(meter.add(noisy(level)), std::hypot(1 - level, 0.1f), 1e-5);
  const StepResponse r = meter.result();
  EXPECT_FALSE(r.frames5);
  EXPECT_EQ(*r.meanFrames5, 2u);
  EXPECT_EQ(*r.meanFrames1, 3u);
}

TEST(StepResponse, SeesOnlyWhatCounts) {
  Image before = constant(0), after = constant(1), frame = constant(1);
  frame.pixel(0, 0)[0] = 50;
  Mask mask(48, 1);
  mask[0] = 0;
  TransientMeter masked(before, after, mask), whole(before, after);
  EXPECT_EQ(masked.add(frame), 0);
  EXPECT_GT(whole.add(frame), 1);
  EXPECT_THROW(TransientMeter(before, before), Error);
  EXPECT_THROW(TransientMeter(before, after, Mask(48, 0)), Error);
  EXPECT_THROW(TransientMeter(before, constant(1, 1)), Error);
  EXPECT_THROW(TransientMeter(before, constant(std::numeric_limits<float>::infinity())), Error);
  EXPECT_THROW(whole.add(constant(std::numeric_limits<float>::quiet_NaN())), Error);
}

}  // namespace
}  // namespace hl
