// Direct light only: the baseline against which every technique's share of the picture and of the frame time is seen.
#include "engine/techniques/technique.h"

namespace hl {
namespace {

class None final : public Technique {
 public:
  ParamView params() override { return {}; }
  Transport transport() const override {
    Transport t;
    t.bounces = 0;
    return t;
  }
  void rebuild(Gpu&, const SceneView&, Progress&) override {}
  bool follows(Change) const override { return true; }
  IndirectLight record(FrameGraph& graph, const FrameInputs&) override {
    graph.skip("none: indirect light", "direct light only");
    return {};
  }
};

}  // namespace

TechniqueInfo noneTechniqueInfo() {
  return {"none", "Direct only", "Direct light alone, no bounce: the baseline for picture, error and time.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<None>(); }};
}

}  // namespace hl
