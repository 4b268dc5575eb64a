#include "ui/viewport.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>

#include "ui/pick_overlay.h"

namespace hl::ui {
namespace {

constexpr float kRadiansPerPixel = 0.006f;
constexpr float kWheelNotch = 120;
constexpr int kFlyIntervalMs = 16;
constexpr float kLongestFlyStep = 0.1f;  // s; a stall must not become a leap
const QList<int> kFlyKeys{Qt::Key_W, Qt::Key_A, Qt::Key_S, Qt::Key_D, Qt::Key_PageUp, Qt::Key_PageDown};

}  // namespace

Viewport::Viewport(QWidget* parent) : QWidget(parent) {
  setObjectName(QStringLiteral("viewport"));
  setAccessibleName(tr("Viewport"));
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
  flyTimer_.setInterval(kFlyIntervalMs);
  connect(&flyTimer_, &QTimer::timeout, this, &Viewport::flyOn);
}

void Viewport::showFrame(std::shared_ptr<const FrameResult> frame) {
  if (!frame || frame->display.empty()) return;
  frame_ = std::move(frame);
  image_ = QImage(frame_->display.data(), frame_->width, frame_->height, frame_->width * 4, QImage::Format_RGBX8888);
  update();
}

void Viewport::setCamera(const Camera& camera, float sceneDiagonal) {
  controller_.set(camera);
  controller_.setSceneSize(sceneDiagonal);
  cameraKnown_ = true;
}

void Viewport::setWaiting(const QString& text) {
  if (text == waiting_) return;
  waiting_ = text;
  update();
}

void Viewport::setNotice(const QString& text) {
  if (text == notice_) return;
  notice_ = text;
  update();
}

void Viewport::setPaused(bool paused) {
  paused_ = paused;
  update();
}

void Viewport::hidePick() {
  pickShown_ = false;
  update();
}

QRectF Viewport::pictureRect() const {
  if (image_.isNull()) return rect();
  const QSizeF size = QSizeF(image_.size()).scaled(QSizeF(this->size()), Qt::KeepAspectRatio);
  return QRectF(QPointF((width() - size.width()) / 2, (height() - size.height()) / 2), size);
}

std::optional<QPoint> Viewport::pixelAt(QPointF p) const {
  const QRectF r = pictureRect();
  if (image_.isNull() || !r.contains(p)) return std::nullopt;
  const int x = static_cast<int>((p.x() - r.x()) / r.width() * image_.width());
  const int y = static_cast<int>((p.y() - r.y()) / r.height() * image_.height());
  return QPoint(std::clamp(x, 0, image_.width() - 1), std::clamp(y, 0, image_.height() - 1));
}

void Viewport::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), QColor(38, 38, 38));  // neutral, whatever the theme: it surrounds pictures that are judged
  if (!image_.isNull()) {
    const QRectF r = pictureRect();
    // Pixels are shown as they are when enlarged a good deal, as people judge them; smoothed when they shrink or grow a little.
    const double scale = r.width() * devicePixelRatioF() / image_.width();
    painter.setRenderHint(QPainter::SmoothPixmapTransform, scale < 3 && scale != 1);
    painter.drawImage(r, image_);
  }
  if (pickShown_ && frame_ && cameraKnown_ && !spaceHeld_) drawPickedSamples(painter, *frame_, controller_.camera(), pictureRect());
  drawLabels(painter);
}

void Viewport::drawLabels(QPainter& painter) {
  const int pad = fontMetrics().height() / 2;
  const auto label = [&](const QString& text, Qt::Alignment where, QColor ink, QColor ground) {
    const QRect area = rect().adjusted(pad, pad, -pad, -pad);
    const int flags = static_cast<int>(where) | Qt::TextWordWrap;
    const QRect box = fontMetrics().boundingRect(area.adjusted(pad, pad / 2, -pad, -pad / 2), flags, text);
    painter.setPen(Qt::NoPen);
    painter.setBrush(ground);
    painter.drawRoundedRect(box.adjusted(-pad, -pad / 2, pad, pad / 2), 4, 4);
    painter.setPen(ink);
    painter.drawText(box, flags, text);
  };
  const QColor white(255, 255, 255), shade(0, 0, 0, 170);
  painter.setRenderHint(QPainter::Antialiasing);
  if (!waiting_.isEmpty() && (image_.isNull() || !cameraKnown_)) label(waiting_, Qt::AlignCenter, white, shade);
  QString title;
  if (spaceHeld_) title = frame_ && frame_->view == "reference" ? tr("Reference") : tr("Reference: waiting for the frame");
  if (paused_) title += (title.isEmpty() ? QString() : QStringLiteral("  ")) + tr("Paused");
  if (!title.isEmpty()) label(title, Qt::AlignTop | Qt::AlignLeft, white, shade);
  if (const QString facts = pickShown_ && frame_ ? pickedFacts(*frame_) : QString(); !facts.isEmpty())
    label(facts + '\n' + tr("Esc hides this"), Qt::AlignTop | Qt::AlignRight, white, shade);
  if (!notice_.isEmpty()) label(notice_, Qt::AlignBottom | Qt::AlignHCenter, white, QColor(140, 30, 20, 225));
}

void Viewport::moved() {
  if (cameraKnown_) emit cameraMoved(controller_.camera());
}

void Viewport::mousePressEvent(QMouseEvent* event) {
  lastPosition_ = pressPosition_ = event->position();
  dragged_ = false;
}

void Viewport::mouseMoveEvent(QMouseEvent* event) {
  const QPointF d = event->position() - lastPosition_;
  if (!dragged_ && (event->position() - pressPosition_).manhattanLength() < 4) return;
  dragged_ = true;
  lastPosition_ = event->position();
  const float x = static_cast<float>(d.x()), y = static_cast<float>(d.y());
  const float height = static_cast<float>(std::max(1.0, pictureRect().height()));
  const bool shift = event->modifiers() & Qt::ShiftModifier;
  if ((event->buttons() & Qt::MiddleButton) || ((event->buttons() & Qt::LeftButton) && shift))
    controller_.pan(-x / height, y / height);
  else if (event->buttons() & Qt::LeftButton)
    controller_.orbit(-x * kRadiansPerPixel, y * kRadiansPerPixel);
  else if (event->buttons() & Qt::RightButton)
    controller_.look(-x * kRadiansPerPixel, -y * kRadiansPerPixel);
  else
    return;
  moved();
}

void Viewport::mouseReleaseEvent(QMouseEvent* event) {
  if (dragged_ || event->button() == Qt::MiddleButton) return;
  if (const auto pixel = pixelAt(event->position())) {
    pickShown_ = true;
    emit pixelPicked(pixel->x(), pixel->y());
  }
}

void Viewport::mouseDoubleClickEvent(QMouseEvent* event) {
  if (const auto pixel = pixelAt(event->position())) emit focusWanted(pixel->x(), pixel->y());
}

void Viewport::wheelEvent(QWheelEvent* event) {
  const float notches = static_cast<float>(event->angleDelta().y()) / kWheelNotch;
  if (event->buttons() & Qt::RightButton) {
    controller_.changeSpeed(notches > 0 ? 1.25f : 0.8f);
    return;
  }
  controller_.dolly(notches);
  moved();
}

void Viewport::focusOn(const vec3& point) {
  controller_.focus(point);
  moved();
}

void Viewport::keyPressEvent(QKeyEvent* event) {
  const int key = event->key();
  if (key == Qt::Key_Space) {
    if (!event->isAutoRepeat() && !spaceHeld_) {
      spaceHeld_ = true;
      emit referenceHeld(true);
      update();
    }
  } else if (kFlyKeys.contains(key) && !(event->modifiers() & (Qt::ControlModifier | Qt::AltModifier))) {
    keys_.insert(key);
    if (!flyTimer_.isActive()) flyClock_.start(), flyTimer_.start();
  } else if (key >= Qt::Key_1 && key <= Qt::Key_9) {
    if (event->modifiers() & Qt::ControlModifier)
      emit bookmarkStored(key - Qt::Key_0);
    else
      emit bookmarkWanted(key - Qt::Key_0);
  } else {
    QWidget::keyPressEvent(event);
  }
}

void Viewport::keyReleaseEvent(QKeyEvent* event) {
  if (event->isAutoRepeat()) return;
  keys_.erase(event->key());
  if (keys_.empty()) flyTimer_.stop();
  if (event->key() == Qt::Key_Space && spaceHeld_) {
    spaceHeld_ = false;
    emit referenceHeld(false);
    update();
  } else {
    QWidget::keyReleaseEvent(event);
  }
}

void Viewport::focusOutEvent(QFocusEvent* event) {
  // The key's release will go elsewhere.
  keys_.clear();
  flyTimer_.stop();
  if (spaceHeld_) {
    spaceHeld_ = false;
    emit referenceHeld(false);
  }
  QWidget::focusOutEvent(event);
}

void Viewport::flyOn() {
  const float seconds = std::min(static_cast<float>(flyClock_.restart()) / 1000, kLongestFlyStep);
  const auto down = [&](int key) { return keys_.count(key) ? 1.0f : 0.0f; };
  const vec3 d(down(Qt::Key_D) - down(Qt::Key_A), down(Qt::Key_PageUp) - down(Qt::Key_PageDown),
               down(Qt::Key_W) - down(Qt::Key_S));
  controller_.fly(d, seconds);
  moved();
}

}  // namespace hl::ui
