#include "engine/metrics/block_mean.h"

#include <cmath>
#include <limits>

namespace hl {

namespace {

struct Block {
  double sum = 0, weight = 0;
};

std::vector<Block> blocksOf(const std::vector<double>& values, const std::vector<double>& weights, int width,
                            int height, int edge) {
  const int columns = (width + edge - 1) / edge, rows = (height + edge - 1) / edge;
  std::vector<Block> blocks(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t pixel = static_cast<size_t>(y) * width + x;
      if (weights[pixel] == 0) continue;
      Block& block = blocks[static_cast<size_t>(y / edge) * columns + x / edge];
      block.sum += weights[pixel] * values[pixel];
      block.weight += weights[pixel];
    }
  }
  std::erase_if(blocks, [](const Block& block) { return block.weight == 0; });
  return blocks;
}

}  // namespace

BlockMean blockMean(const std::vector<double>& values, const std::vector<double>& weights, int width, int height) {
  int edge = kBlockEdge;
  std::vector<Block> blocks = blocksOf(values, weights, width, height, edge);
  while (blocks.size() < kFewestBlocks && edge > 1) blocks = blocksOf(values, weights, width, height, edge /= 2);

  double sum = 0, weight = 0;
  for (const Block& block : blocks) sum += block.sum, weight += block.weight;
  BlockMean result;
  result.mean = sum / weight;
  const double count = static_cast<double>(blocks.size());
  double squares = 0;
  for (const Block& block : blocks) {
    const double off = block.sum - result.mean * block.weight;
    squares += off * off;
  }
  result.standardError =
      blocks.size() > 1 ? std::sqrt(squares * count / (count - 1)) / weight : std::numeric_limits<double>::infinity();
  return result;
}

double blockNoise(const std::vector<double>& noise, const std::vector<double>& weights, int width, int height) {
  double squares = 0, weight = 0;
  for (const Block& block : blocksOf(noise, weights, width, height, kBlockEdge)) {
    squares += block.sum * block.sum;
    weight += block.weight;
  }
  return std::sqrt(squares) / weight;
}

}  // namespace hl
