#pragma once
// What tests of the frame graph share: a pass that adds, and a look at the record of barriers.
#include <functional>

#include "tests/gpu_fixture.h"

namespace hl::test {

struct AddPush {
  uint32_t count = 0, offset = 0;
};

class FrameGraphTest : public test::GpuTest {
 protected:
  void add(const char* name, const Buffer& from, const Buffer& to, uint32_t offset = 0, uint32_t factor = 1) {
    const auto count = static_cast<uint32_t>(from.size() / 4);
    graph->compute(name, "tests/add.comp")
        .bind("source", from, Access::Read)
        .bind("target", to, Access::Write)
        .specialize("kFactor", factor)
        .push(AddPush{count, offset})
        .dispatchThreads(count);
  }
  std::vector<std::string> hazards(const std::string& pass, const std::string& resource) const {
    std::vector<std::string> out;
    for (const BarrierRecord& b : graph->barriers()) {
      if (b.pass == pass && b.resource == resource) out.push_back(b.hazard);
    }
    return out;
  }
  std::string messageOf(const std::function<void()>& body) {
    const Error e = errorOf(body);
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    return e.what();
  }
};

}  // namespace hl::test
