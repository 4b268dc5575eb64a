#include "ui/probe_tool.h"

#include <algorithm>
#include <cmath>

#include "engine/session/probe_views.h"

namespace hl::ui {
namespace {

constexpr double kLeastRadius = 4;      // of a probe in the window [px], so that far ones can be seen and taken
constexpr float kLeastGrip = 5;         // how near the pointer must come to a far one [frame pixels]
constexpr float kAlongSight = 0.05f;    // sine of the angle between sight and axis below which a drag says nothing

CameraBasis basisOf(const Camera& camera, QSize frame) { return cameraBasis(camera, static_cast<float>(frame.width()) / static_cast<float>(std::max(1, frame.height()))); }

vec3 directionOf(const CameraBasis& basis, QSize frame, QPointF pixel) {
  return pixelDirection(basis, static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), frame.width(), frame.height());
}

/// In pixels of the frame; none where it lies behind the camera. `scale`: pixels a metre there.
std::optional<QPointF> project(const CameraBasis& b, QSize frame, vec3 p, float& scale) {
  const vec3 to = p - b.origin;
  const float ahead = glm::dot(to, b.forward);
  if (!(ahead > 0)) return std::nullopt;
  const float x = glm::dot(to, b.right) / glm::dot(b.right, b.right) / ahead, y = glm::dot(to, b.down) / glm::dot(b.down, b.down) / ahead;
  scale = 0.5f * static_cast<float>(frame.height()) / glm::length(b.down) / ahead;
  return QPointF(0.5 * (static_cast<double>(x) + 1) * frame.width(), 0.5 * (static_cast<double>(y) + 1) * frame.height());
}

/// Where on the line through `from` along the unit `axis` the ray passes it closest; `from` where they run alongside.
vec3 alongAxis(vec3 origin, vec3 direction, vec3 from, vec3 axis) {
  const vec3 d = glm::normalize(direction);
  const float c = glm::dot(d, axis), sine2 = 1 - c * c;
  if (sine2 < kAlongSight * kAlongSight) return from;
  const vec3 w = from - origin;
  return from + axis * ((c * glm::dot(w, d) - glm::dot(w, axis)) / sine2);
}

}  // namespace

void ProbeTool::setActive(bool on) {
  if (on == active_) return;
  active_ = on;
  cancelDrag();
  emit changed();
}

void ProbeTool::setProbes(const std::vector<vec3>& probes, const std::vector<uint8_t>& inside, float radius) {
  if (probes == probes_ && inside == inside_ && radius == radius_) return;
  if (probes != probes_) grabbed_.reset();
  probes_ = probes, inside_ = inside, radius_ = radius;
  if (selected_ && *selected_ >= probes_.size()) select(std::nullopt);
  emit changed();
}

void ProbeTool::select(std::optional<size_t> probe) {
  if (probe == selected_) return;
  selected_ = probe;
  emit selectionChanged();
  emit changed();
}

bool ProbeTool::press(const Camera& camera, QSize frame, QPointF pixel) {
  if (!active_) return false;
  camera_ = basisOf(camera, frame), frame_ = frame;
  const vec3 direction = directionOf(camera_, frame_, pixel);
  std::optional<size_t> hit;
  if (const auto on = probeOnRay(probes_, camera_, direction, radius_)) hit = *on;
  if (!hit) {
    // Far ones are smaller than a pointer can aim.
    float nearest = kLeastGrip;
    for (size_t i = 0; i < probes_.size(); ++i) {
      float scale = 0;
      const auto at = project(camera_, frame_, probes_[i], scale);
      if (!at) continue;
      const auto off = static_cast<float>(std::hypot(at->x() - pixel.x(), at->y() - pixel.y()));
      if (off < nearest) nearest = off, hit = i;
    }
  }
  if (!hit) return false;
  select(hit);
  grabbed_ = hit;
  start_ = now_ = probes_[*hit];
  const float ahead = glm::dot(start_ - camera_.origin, camera_.forward);
  grip_ = camera_.origin + direction * (ahead / glm::dot(direction, camera_.forward)) - start_;
  return true;
}

void ProbeTool::drag(QPointF pixel, Qt::KeyboardModifiers modifiers) {
  if (!grabbed_) return;
  const vec3 direction = directionOf(camera_, frame_, pixel);
  const vec3 held = start_ + grip_;
  if (modifiers & (Qt::ShiftModifier | Qt::ControlModifier | Qt::AltModifier)) {
    const vec3 axis = modifiers & Qt::ShiftModifier ? vec3(0, 1, 0) : modifiers & Qt::ControlModifier ? vec3(1, 0, 0) : vec3(0, 0, 1);
    now_ = alongAxis(camera_.origin, direction, held, axis) - grip_;
  } else {
    const float ahead = glm::dot(held - camera_.origin, camera_.forward), along = glm::dot(direction, camera_.forward);
    now_ = camera_.origin + direction * (ahead / along) - grip_;
  }
  emit changed();
}

void ProbeTool::release() {
  if (!grabbed_) return;
  const size_t probe = *grabbed_;
  grabbed_.reset();
  if (now_ != start_) emit moved(probe, now_);
  emit changed();
}

void ProbeTool::cancelDrag() {
  if (!grabbed_) return;
  grabbed_.reset();
  emit changed();
}

void ProbeTool::paint(QPainter& painter, const Camera& camera, QSize frame, const QRectF& place) const {
  if (!active_ || frame.isEmpty()) return;
  const CameraBasis basis = basisOf(camera, frame);
  const double zoom = place.height() / frame.height();
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setClipRect(place);
  const auto inWindow = [&](QPointF p) { return QPointF(place.x() + p.x() * place.width() / frame.width(), place.y() + p.y() * place.height() / frame.height()); };
  for (size_t i = 0; i < probes_.size(); ++i) {
    const bool held = grabbed_ && *grabbed_ == i, chosen = selected_ && *selected_ == i;
    float scale = 0;
    const auto at = project(basis, frame, held ? now_ : probes_[i], scale);
    if (!at) continue;
    const double radius = std::max(kLeastRadius, static_cast<double>(radius_ * scale) * zoom);
    const bool buried = i < inside_.size() && inside_[i];
    const QColor ink = chosen ? QColor(255, 205, 40) : buried ? QColor(230, 50, 40) : QColor(236, 236, 236);
    if (held) {
      float unused = 0;
      if (const auto from = project(basis, frame, start_, unused)) {
        painter.setPen(QPen(ink, 1, Qt::DashLine));
        painter.drawLine(inWindow(*from), inWindow(*at));
      }
    }
    painter.setPen(QPen(Qt::black, 3));
    painter.setBrush(Qt::NoBrush);
    painter.drawEllipse(inWindow(*at), radius, radius);
    painter.setPen(QPen(ink, 1.5));
    painter.setBrush(QColor(ink.red(), ink.green(), ink.blue(), 90));
    painter.drawEllipse(inWindow(*at), radius, radius);
    if (!chosen) continue;
    const QString number = QString::number(i + 1);
    const QPointF text = inWindow(*at) + QPointF(radius + 3, -radius);
    painter.setPen(Qt::black);
    painter.drawText(text + QPointF(1, 1), number);
    painter.setPen(ink);
    painter.drawText(text, number);
  }
  painter.restore();
}

}  // namespace hl::ui
