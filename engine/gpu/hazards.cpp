#include "engine/gpu/hazards.h"

namespace hl {

Dependency nextUse(ResourceHistory& history, const ResourceUse& use) {
  const bool relayout = use.layout != history.layout;
  const bool writes = use.writes != 0;
  const bool written = history.writeStages != 0;
  const bool read = history.readStages != 0;

  Dependency d;
  if (writes && read) {
    d.hazard = "WAR";
  } else if (writes && written) {
    d.hazard = use.reads != 0 ? "RAW" : "WAW";
  } else if (!writes && written && (use.stages & ~history.visibleStages) != 0) {
    d.hazard = "RAW";
  }
  if (relayout && d.hazard == nullptr) d.hazard = "layout";
  if (d.hazard != nullptr) {
    d.sourceStages = history.writeStages | history.readStages;
    d.sourceAccess = history.writeAccess;
    d.destinationStages = use.stages;
    d.destinationAccess = use.reads | use.writes;
    d.oldLayout = history.layout;
    d.newLayout = use.layout;
  }

  if (writes) {
    history = {use.stages, use.writes, 0, 0, use.layout};
  } else if (relayout) {
    // The change of layout is a write of its own, made available by the barrier and visible to this use.
    history = {use.stages, 0, use.stages, use.stages, use.layout};
  } else {
    history.readStages |= use.stages;
    history.visibleStages |= use.stages;
  }
  return d;
}

}  // namespace hl
