// The only file that sees the generated commit header: a new commit recompiles this one alone.
#include "commit.h"
#include "engine/session/session_impl.h"

namespace hl {

Provenance Session::provenance() const {
  const Impl& s = *impl_;
  Provenance p;
  p.commit = HALFLIGHT_COMMIT;
  p.dirty = HALFLIGHT_DIRTY;
  p.presetHash = presetHash(preset());
  p.sceneHash = s.scene ? s.scene->hash : "";
  p.seed = s.preset.seed;
  p.device = s.device.info().name;
  p.driver = s.device.info().driver;
  p.api = s.device.info().api;
  p.tracer = s.tracer ? s.tracer->id() : "";
  p.timing = s.serialisedTiming ? "serialised" : "concurrent";
  return p;
}

}  // namespace hl
