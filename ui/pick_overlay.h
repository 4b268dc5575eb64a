#pragma once
// What the technique says of a picked point, over the picture: where its samples went and what they brought back.
#include <QRectF>

#include "engine/session/session.h"

class QPainter;

namespace hl::ui {

/// At most this many samples are drawn, evenly out of all there are.
inline constexpr size_t kDrawnSamples = 512;

/// A line for each sample, in the colour of its radiance (scaled so that the brightest shows full; black ones as thin grey), and the point itself. Where
/// samples are few, a disc at each one's end, whose area goes by its share. `picture`: where the frame lies in the widget, seen through `camera`.
void drawPickedSamples(QPainter&, const FrameResult&, const Camera& camera, const QRectF& picture);

/// The report's facts, one a line; empty where nothing was picked or the technique has nothing to say.
QString pickedFacts(const FrameResult&);

}  // namespace hl::ui
