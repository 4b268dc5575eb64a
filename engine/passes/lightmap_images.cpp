#include "engine/passes/lightmap_images.h"

#include <algorithm>

#include "engine/core/error.h"

namespace hl {
namespace {

uint32_t chartColour(uint32_t chart) {
  const uint32_t h = (chart + 1) * 2654435761u;
  return 0xff000000u | (0x404040u + (h & 0x7f7f7fu));
}

uint32_t stateColour(uint8_t state) {
  switch (state) {
    case TexelValid: return 0xff50b050u;
    case TexelInside: return 0xff3030d0u;
    case TexelOverlap: return 0xff20b0e0u;
    default: return 0xff202020u;
  }
}

}  // namespace

LightmapImages::LightmapImages(Device& device, std::string prefix, const Atlas& atlas, const LightmapTables& tables, int dilation)
    : device_(device), prefix_(std::move(prefix)), side_(atlas.resolution), dilation_(dilation) {
  const uint64_t bytes = uint64_t{4} * tables.lumelOfTexel.size();
  if (bytes > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, prefix_ + ": lumel of texel: " + std::to_string(bytes) + " bytes are more than a buffer of this device holds (" +
                                       std::to_string(device.maxStorageBufferBytes()) + "); lower lightmap.resolution");
  lumelOfTexel_ = device.buffer(prefix_ + ": lumel of texel", std::span<const uint32_t>(tables.lumelOfTexel));
  chartOfTexel_ = device.buffer(prefix_ + ": chart of texel", std::span<const uint32_t>(tables.chartOfTexel));
  chartOfTriangle_ = device.buffer(prefix_ + ": chart of triangle", std::span<const uint32_t>(atlas.charts));
  pixelCounters_ = device.buffer(prefix_ + ": pixel counters", sizeof(uint32_t));
  lightmap_ = image("lightmap");
  if (dilation_ > 0) spare_ = image("dilated lightmap");
  dilated_ = dilation_ % 2 == 1 ? spare_ : lightmap_;
  uploadViews(atlas);
}

GpuImage LightmapImages::image(const char* name) const { return device_.image(prefix_ + ": " + name, {side_, side_, Format::RGBA32F}); }

void LightmapImages::uploadViews(const Atlas& atlas) {
  const ImageDesc desc{side_, side_, Format::RGBA8};
  std::vector<uint32_t> colours(atlas.texelState.size());
  for (size_t i = 0; i < colours.size(); ++i) colours[i] = stateColour(atlas.texelState[i]);
  validity_ = device_.image(prefix_ + ": validity", desc);
  device_.upload(validity_, 0, colours.data(), 4 * colours.size());
  std::fill(colours.begin(), colours.end(), stateColour(TexelEmpty));
  for (const Lumel& l : atlas.lumels) colours[l.texel] = chartColour(atlas.charts[l.triangle]);
  charts_ = device_.image(prefix_ + ": charts", desc);
  device_.upload(charts_, 0, colours.data(), 4 * colours.size());
}

void LightmapImages::recordMeans(FrameGraph& graph, const char* what, const Buffer& sums, const GpuImage& to) const {
  graph.compute(prefix_ + ": write " + what, "passes/lightmap_write.comp")
      .bind("lumelOfTexel", lumelOfTexel_, Access::Read)
      .bind("values", sums, Access::Read)
      .bind("lightmap", to, Access::Write)
      .specialize("kSums", 1)
      .dispatchThreads(static_cast<uint32_t>(side_), static_cast<uint32_t>(side_));
}

void LightmapImages::write(FrameGraph& graph, const Buffer& values, uint32_t channel, const GpuImage& to) const {
  graph.compute(prefix_ + ": write lightmap", "passes/lightmap_write.comp")
      .bind("lumelOfTexel", lumelOfTexel_, Access::Read)
      .bind("values", values, Access::Read)
      .bind("lightmap", to, Access::Write)
      .specialize("kSums", 0)
      .specialize("kChannel", channel)
      .dispatchThreads(static_cast<uint32_t>(side_), static_cast<uint32_t>(side_));
}

void LightmapImages::dilate(FrameGraph& graph, const GpuImage& from, const GpuImage& to, bool firstRing, bool belowZero) const {
  graph.compute(prefix_ + ": dilate", "passes/lightmap_dilate.comp")
      .bind("chartOfTexel", chartOfTexel_, Access::Read)
      .bind("from", from, Access::Read)
      .bind("to", to, Access::Write)
      .specialize("kFirstRing", firstRing)
      .specialize("kBelowZero", belowZero)
      .dispatchThreads(static_cast<uint32_t>(side_), static_cast<uint32_t>(side_));
}

void LightmapImages::record(FrameGraph& graph, const Buffer& values) {
  write(graph, values, 0, lightmap_);
  if (dilation_ == 0) graph.skip(prefix_ + ": dilate", "lightmap.dilation is 0");
  for (int ring = 0; ring < dilation_; ++ring) dilate(graph, ring % 2 == 0 ? lightmap_ : spare_, ring % 2 == 0 ? spare_ : lightmap_, ring == 0, false);
}

void LightmapImages::recordLinear(FrameGraph& graph, const Buffer& slopes) {
  if (!linear_[0]) {
    const char* names[] = {"slopes of red", "slopes of green", "slopes of blue", "constants beside slopes"};
    for (size_t i = 0; i < 4; ++i) linear_[i] = image(names[i]);
    if (dilation_ > 0) linearSpare_ = image("dilated slopes");
  }
  for (uint32_t channel = 0; channel < 4; ++channel) {
    // Begun so that the last ring ends in the channel's own image, and one spare serves all.
    const auto target = [&](int ring) { return (dilation_ - ring) % 2 == 0 ? linear_[channel] : linearSpare_; };
    write(graph, slopes, channel, target(0));
    for (int ring = 0; ring < dilation_; ++ring) dilate(graph, target(ring), target(ring + 1), ring == 0, true);
  }
}

void LightmapImages::skip(FrameGraph& graph, const char* reason) const {
  graph.skip(prefix_ + ": write lightmap", reason);
  graph.skip(prefix_ + ": dilate", reason);
}

void LightmapImages::recordPixels(FrameGraph& graph, const std::string& pass, const GBuffer& g, const GpuImage& to, bool nearest, bool checker,
                                  bool mapped, bool clampNegative) {
  if (!checker) {
    graph.clear(prefix_ + ": clear pixel counters", pixelCounters_);
    counted_ = true;
  }
  graph.compute(pass, "passes/lightmap_apply.comp")
      .bind("position", g.position, Access::Read)
      .bind("normal", g.normal, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("ids", g.ids, Access::Read)
      .bind("chartOfTriangle", chartOfTriangle_, Access::Read)
      .bind("chartOfTexel", chartOfTexel_, Access::Read)
      .bind("lightmap", mapped ? linear_[3] : dilated_, Access::Read)
      .bind("slopesRed", mapped ? linear_[0] : dilated_, Access::Read)
      .bind("slopesGreen", mapped ? linear_[1] : dilated_, Access::Read)
      .bind("slopesBlue", mapped ? linear_[2] : dilated_, Access::Read)
      .bind("result", to, Access::Write)
      .bind("pixelCounters", pixelCounters_, Access::ReadWrite)
      .specialize("kNearest", nearest)
      .specialize("kChecker", checker)
      .specialize("kMapped", mapped)
      .specialize("kClampNegative", clampNegative)
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
}

uint32_t LightmapImages::pixelsWithoutTexel() const {
  uint32_t pixels = 0;
  if (counted_) device_.download(pixelCounters_, &pixels, sizeof pixels);
  return pixels;
}

std::vector<std::pair<std::string, uint64_t>> LightmapImages::memory() const {
  uint64_t tables = 0, images = 0;
  for (const Buffer* b : {&lumelOfTexel_, &chartOfTexel_, &chartOfTriangle_}) tables += b->size();
  const uint64_t texels = static_cast<uint64_t>(side_) * static_cast<uint64_t>(side_);
  images = 16 * texels * ((spare_ ? 2 : 1) + (linear_[0] ? 4 : 0) + (linearSpare_ ? 1 : 0));
  return {{"texel tables", tables}, {"lightmap", images}, {"atlas views", 8 * texels}};
}

}  // namespace hl
