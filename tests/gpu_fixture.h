#pragma once
// A device under validation and synchronisation validation, a shader library and a graph; any message fails the test.
#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/log.h"
#include "engine/gpu/frame_graph.h"

namespace hl::test {

class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override { open(); }
  void TearDown() override {
    graph.reset();
    shaders.reset();
    if (device == nullptr) return;
    for (const std::string& message : device->takeValidationMessages()) ADD_FAILURE() << message;
  }
  void open(bool staging = false, bool validation = true) {
    graph.reset();
    shaders.reset();
    DeviceOptions options;
    options.validation = validation;
    options.staging = staging;
    device = std::make_unique<Device>(options);
    shaders = std::make_unique<ShaderLibrary>(*device);
    graph = std::make_unique<FrameGraph>(*device, *shaders);
  }
  template <class T>
  std::vector<T> download(const Buffer& b) {
    std::vector<T> out(b.size() / sizeof(T));
    device->download(b, out.data(), b.size());
    return out;
  }

  std::unique_ptr<Device> device;
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameGraph> graph;
};

/// 0, 1, 2, ...
inline std::vector<uint32_t> counting(size_t n, uint32_t first = 0) {
  std::vector<uint32_t> v(n);
  std::iota(v.begin(), v.end(), first);
  return v;
}

/// The error that `body` throws, for its message and kind.
template <class Body>
Error errorOf(Body body) {
  try {
    body();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorKind::Run, "");
}

}  // namespace hl::test
