#include "ui/pick_overlay.h"

#include <QCoreApplication>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/passes/gbuffer.h"

namespace hl::ui {
namespace {

/// Up to so many samples are caches that were asked, each worth a mark where it stands; more are rays.
constexpr size_t kMarkedSamples = 64;
constexpr double kWholeRadius = 12;  // [pixels] of a mark that has the whole weight

/// World to the widget, through the frame's camera.
class Projection {
 public:
  Projection(const Camera& camera, const QRectF& picture)
      : basis_(cameraBasis(camera, static_cast<float>(picture.width() / picture.height()))), picture_(picture) {}

  /// The segment's part in front of the camera; none where there is none.
  std::optional<QLineF> line(vec3 from, vec3 to) const {
    float a = depth(from), b = depth(to);
    const float near = std::max(basis_.nearPlane, 1e-3f * std::max(a, b));
    if (a < near && b < near) return std::nullopt;
    if (a < near) from = from + (to - from) * ((near - a) / (b - a));
    if (b < near) to = from + (to - from) * ((near - a) / (b - a));
    return QLineF(point(from), point(to));
  }

 private:
  float depth(vec3 p) const { return glm::dot(p - basis_.origin, basis_.forward); }
  QPointF point(vec3 p) const {
    const vec3 v = p - basis_.origin;
    const float d = glm::dot(v, basis_.forward);
    const float x = glm::dot(v, basis_.right) / (glm::dot(basis_.right, basis_.right) * d);
    const float y = glm::dot(v, basis_.down) / (glm::dot(basis_.down, basis_.down) * d);
    return {picture_.x() + picture_.width() * 0.5 * (1 + static_cast<double>(x)), picture_.y() + picture_.height() * 0.5 * (1 + static_cast<double>(y))};
  }

  CameraBasis basis_;
  QRectF picture_;
};

}  // namespace

void drawPickedSamples(QPainter& painter, const FrameResult& frame, const Camera& camera, const QRectF& picture) {
  const std::vector<PickSample>& samples = frame.pick.samples;
  if (samples.empty() || picture.isEmpty()) return;
  const Projection projection(camera, picture);
  float brightest = 0;
  for (const PickSample& s : samples) brightest = std::max({brightest, s.radiance.x, s.radiance.y, s.radiance.z});
  painter.save();
  painter.setClipRect(picture);
  painter.setRenderHint(QPainter::Antialiasing, false);
  const size_t step = std::max<size_t>(1, (samples.size() + kDrawnSamples - 1) / kDrawnSamples);
  for (size_t i = 0; i < samples.size(); i += step) {
    const PickSample& s = samples[i];
    const std::optional<QLineF> line = projection.line(s.from, s.to);
    if (!line) continue;
    const auto channel = [&](float v) { return brightest > 0 ? static_cast<int>(255 * std::sqrt(std::clamp(v / brightest, 0.0f, 1.0f))) : 0; };
    const bool dark = !(brightest > 0) || s.radiance == vec3(0.0f);
    painter.setPen(QPen(dark ? QColor(128, 128, 128, 60) : QColor(channel(s.radiance.x), channel(s.radiance.y), channel(s.radiance.z), 150), 1));
    painter.drawLine(*line);
    if (samples.size() > kMarkedSamples) continue;
    // The end itself, if it is in front of the camera: an area by its share.
    const std::optional<QLineF> end = projection.line(s.to, s.to);
    if (!end) continue;
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QPen(Qt::white, 1));
    painter.setBrush(QColor(channel(s.radiance.x), channel(s.radiance.y), channel(s.radiance.z)));
    const double radius = std::max(1.0, kWholeRadius * std::sqrt(static_cast<double>(std::clamp(s.weight, 0.0f, 1.0f))));
    painter.drawEllipse(end->p1(), radius, radius);
    painter.setRenderHint(QPainter::Antialiasing, false);
  }
  if (const auto at = projection.line(samples[0].from, samples[0].from)) {
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QPen(Qt::white, 2));
    painter.setBrush(Qt::black);
    painter.drawEllipse(at->p1(), 4, 4);
  }
  painter.restore();
}

QString pickedFacts(const FrameResult& frame) {
  QStringList lines;
  for (const auto& [name, value] : frame.pick.facts) lines << QStringLiteral("%1: %2").arg(QString::fromStdString(name), QString::fromStdString(value));
  if (frame.pick.samples.size() > kDrawnSamples)
    lines << QCoreApplication::translate("hl::ui::Viewport", "%1 of %2 rays are drawn").arg(kDrawnSamples).arg(frame.pick.samples.size());
  return lines.join('\n');
}

}  // namespace hl::ui
