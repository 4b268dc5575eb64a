#include "ui/viewport.h"

#include <QDockWidget>
#include <QHash>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "ui/probe_tool.h"
#include "ui/swapchain_view.h"

namespace hl::ui {
namespace {

constexpr float kRadiansPerPixel = 0.006f;
constexpr float kWheelNotch = 120;
constexpr int kFlyIntervalMs = 16;
constexpr float kLongestFlyStep = 0.1f;  // s; a stall must not become a leap
constexpr double kZoomStep = 1.25;
constexpr double kGrip = 6;  // how near the wipe's line a press takes it [px]
const QHash<int, QPointF> kArrows{{Qt::Key_Left, {-1, 0}}, {Qt::Key_Right, {1, 0}}, {Qt::Key_Up, {0, -1}}, {Qt::Key_Down, {0, 1}}};
const QList<int> kFlyKeys{Qt::Key_W, Qt::Key_A, Qt::Key_S, Qt::Key_D, Qt::Key_PageUp, Qt::Key_PageDown};

}  // namespace

Viewport::Viewport(QWidget* parent) : QWidget(parent), probeTool_(new ProbeTool(this)) {
  connect(probeTool_, &ProbeTool::changed, this, qOverload<>(&QWidget::update));
  setObjectName(QStringLiteral("viewport"));
  setAccessibleName(tr("Viewport"));
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
  flyTimer_.setInterval(kFlyIntervalMs);
  connect(&flyTimer_, &QTimer::timeout, this, &Viewport::flyOn);
  connect(&flickerTimer_, &QTimer::timeout, this, [this] {
    flickerSecond_ = !flickerSecond_;
    update();
  });
  setMouseTracking(true);  // the pointer tells where the wipe's line can be taken
}

Viewport::~Viewport() = default;

bool Viewport::onDevice() const { return swapchain_ && swapchain_->isShown(); }

void Viewport::usePresenter(std::shared_ptr<Presenter> presenter) {
  swapchain_.reset();
  if (presenter) {
    swapchain_ = std::make_unique<SwapchainView>(std::move(presenter), this);
    connect(swapchain_.get(), &SwapchainView::shown, this, qOverload<>(&QWidget::update));
    connect(swapchain_.get(), &SwapchainView::refused, this, &Viewport::presenterFailed);
    swapchain_->setView(presentView());
    followDock();
  }
  update();
}

/// Behind another tab nothing is drawn.
void Viewport::followDock() {
  disconnect(dock_);
  if (!swapchain_) return;
  for (QWidget* p = parentWidget(); p; p = p->parentWidget())
    if (auto* dock = qobject_cast<QDockWidget*>(p)) {
      dock_ = connect(dock, &QDockWidget::visibilityChanged, swapchain_.get(), &SwapchainView::setSeen);
      return;
    }
}

void Viewport::resizeEvent(QResizeEvent* event) {
  if (swapchain_) swapchain_->resize(size()), swapchain_->setView(presentView());
  QWidget::resizeEvent(event);
}

void Viewport::showEvent(QShowEvent* event) {
  followDock();
  QWidget::showEvent(event);
}

void Viewport::showFrame(std::shared_ptr<const FrameResult> frame) {
  if (!frame || frame->width < 1 || frame->height < 1) return;
  const bool asBefore = frame_ && QSize(frame_->width, frame_->height) == QSize(frame->width, frame->height);
  frame_ = std::move(frame);
  image_ = frame_->display.empty() ? QImage() : QImage(frame_->display.data(), frame_->width, frame_->height, frame_->width * 4, QImage::Format_RGBX8888);
  // The device has drawn it by itself, where it does that.
  const bool saysMore = pickShown_ || spaceHeld_ || !waiting_.isEmpty();
  if (!onDevice() || !asBefore || saysMore) update();
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
  marked_.reset();
  bandStart_.reset();
  update();
}

void Viewport::setComparison(const ShownComparison& comparison) {
  comparison_ = comparison;
  if (comparison_.mode != CompareMode::Flicker) {
    flickerTimer_.stop();
    flickerSecond_ = false;
  } else if (const int interval = static_cast<int>(1000 / std::max(0.01, comparison_.flickerHz)); !flickerTimer_.isActive() || flickerTimer_.interval() != interval) {
    flickerTimer_.start(interval);
  }
  update();
}

QSizeF Viewport::pictureSize() const { return comparing() ? comparison_.pictures.a.size() : frameSize(); }

QSize Viewport::frameSize() const { return frame_ ? QSize(frame_->width, frame_->height) : QSize(); }

QRectF Viewport::paneAt(QPointF p) const {
  const std::vector<QRectF> panes = comparisonPanes(comparing() ? comparison_.mode : CompareMode::Off, rect());
  for (const QRectF& pane : panes)
    if (pane.contains(p)) return pane;
  return panes.front();
}

void Viewport::setRegions(const std::vector<Region>& regions) {
  regions_ = regions;
  update();
}

void Viewport::setMarkedPixel(std::optional<QPoint> pixel) {
  marked_ = pixel;
  update();
}

void Viewport::setRegionTool(bool on) {
  regionTool_ = on;
  bandStart_.reset();
  on ? setCursor(Qt::CrossCursor) : unsetCursor();
  update();
}

QRectF Viewport::drawnShares() const {
  if (!bandStart_ || !frame_) return {};
  const QRectF r = view_.place(pictureSize(), paneAt(*bandStart_));
  const auto edge = [&](double at, double from, double length, int pixels) { return std::clamp(std::round((at - from) / length * pixels), 0.0, static_cast<double>(pixels)); };
  const double x0 = edge(std::min(bandStart_->x(), bandEnd_.x()), r.x(), r.width(), frame_->width), x1 = edge(std::max(bandStart_->x(), bandEnd_.x()), r.x(), r.width(), frame_->width);
  const double y0 = edge(std::min(bandStart_->y(), bandEnd_.y()), r.y(), r.height(), frame_->height), y1 = edge(std::max(bandStart_->y(), bandEnd_.y()), r.y(), r.height(), frame_->height);
  if (x1 - x0 < 1 || y1 - y0 < 1) return {};
  return {x0 / frame_->width, y0 / frame_->height, (x1 - x0) / frame_->width, (y1 - y0) / frame_->height};
}

QRectF Viewport::pictureRect() const {
  if (pictureSize().isEmpty()) return rect();
  return view_.place(pictureSize(), paneAt({0, 0}));
}

QPointF Viewport::framePoint(QPointF p) const {
  const QRectF r = view_.place(pictureSize(), paneAt(pressPosition_));
  return {(p.x() - r.x()) / r.width() * frameSize().width(), (p.y() - r.y()) / r.height() * frameSize().height()};
}

std::optional<QPoint> Viewport::pixelAt(QPointF p) const {
  const QRectF r = view_.place(pictureSize(), paneAt(p));
  if (!frame_ || !r.contains(p)) return std::nullopt;
  const int x = static_cast<int>((p.x() - r.x()) / r.width() * frame_->width);
  const int y = static_cast<int>((p.y() - r.y()) / r.height() * frame_->height);
  return QPoint(std::clamp(x, 0, frame_->width - 1), std::clamp(y, 0, frame_->height - 1));
}

void Viewport::zoomBy(double factor, std::optional<QPointF> anchor) {
  const QPointF at = anchor.value_or(paneAt({0, 0}).center());
  view_.zoomAt(at, factor, pictureSize(), paneAt(at));
  update();
}

void Viewport::zoomIn() { zoomBy(kZoomStep); }
void Viewport::zoomOut() { zoomBy(1 / kZoomStep); }
void Viewport::zoomToFit() {
  view_.reset();
  update();
}

bool Viewport::onWipe(QPointF p) const {
  if (!comparing()) return false;
  const QLineF line = wipeLine(comparison_, view_, rect());
  if (line.isNull()) return false;
  return std::abs(comparison_.mode == CompareMode::WipeAcross ? p.x() - line.x1() : p.y() - line.y1()) <= kGrip;
}

/// The arrows along its way; with Shift a pixel or so at a time.
bool Viewport::moveWipe(int key, Qt::KeyboardModifiers modifiers) {
  if (!comparing()) return false;
  const bool across = comparison_.mode == CompareMode::WipeAcross, down = comparison_.mode == CompareMode::WipeDown;
  const int direction = (across && key == Qt::Key_Right) || (down && key == Qt::Key_Down) ? 1 : (across && key == Qt::Key_Left) || (down && key == Qt::Key_Up) ? -1 : 0;
  if (direction == 0) return false;
  emit wipeMoved(std::clamp(comparison_.wipe + direction * (modifiers & Qt::ShiftModifier ? 0.002 : 0.02), 0.0, 1.0));
  return true;
}

void Viewport::moved() {
  if (cameraKnown_) emit cameraMoved(controller_.camera());
}

void Viewport::mousePressEvent(QMouseEvent* event) {
  lastPosition_ = pressPosition_ = event->position();
  dragged_ = false;
  const bool band = regionTool_ || (event->modifiers() & (Qt::ControlModifier | Qt::ShiftModifier)) == (Qt::ControlModifier | Qt::ShiftModifier);
  if (band && event->button() == Qt::LeftButton && frame_) {
    bandStart_ = bandEnd_ = event->position();
    return;
  }
  if (event->button() == Qt::LeftButton && frame_ && probeTool_->press(frame_->camera, frameSize(), framePoint(event->position()))) return;
  wipeDragged_ = event->button() == Qt::LeftButton && onWipe(event->position());
}

void Viewport::mouseMoveEvent(QMouseEvent* event) {
  if (bandStart_) {
    bandEnd_ = event->position();
    update();
    return;
  }
  if (probeTool_->dragging()) {
    if (dragged_ || (event->position() - pressPosition_).manhattanLength() >= 4) dragged_ = true, probeTool_->drag(framePoint(event->position()), event->modifiers());
    return;
  }
  if (event->buttons() == Qt::NoButton) {
    if (regionTool_) return;
    if (onWipe(event->position()))
      setCursor(comparison_.mode == CompareMode::WipeAcross ? Qt::SplitHCursor : Qt::SplitVCursor);
    else
      unsetCursor();
    return;
  }
  const QPointF d = event->position() - lastPosition_;
  if (wipeDragged_) {
    dragged_ = true;
    emit wipeMoved(wipeAt(comparison_, view_, rect(), event->position()));
    return;
  }
  if (!dragged_ && (event->position() - pressPosition_).manhattanLength() < 4) return;
  dragged_ = true;
  lastPosition_ = event->position();
  const float x = static_cast<float>(d.x()), y = static_cast<float>(d.y());
  const float height = static_cast<float>(std::max(1.0, pictureRect().height()));
  const bool shift = event->modifiers() & Qt::ShiftModifier;
  if ((event->modifiers() & Qt::ControlModifier) && (event->buttons() & Qt::LeftButton)) {
    view_.panBy(d, pictureSize(), paneAt(pressPosition_));
    update();
    return;
  }
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
  if (bandStart_ && event->button() == Qt::LeftButton) {
    bandEnd_ = event->position();
    const QRectF shares = drawnShares();
    bandStart_.reset();
    update();
    if (!shares.isEmpty()) emit regionDrawn(shares);
    return;
  }
  if (probeTool_->dragging()) {
    if (event->button() != Qt::LeftButton) return;
    const std::optional<QPoint> pixel = pixelAt(event->position());
    if (dragged_) return probeTool_->release();
    probeTool_->cancelDrag();
    if (pixel) emit pixelPicked(pixel->x(), pixel->y());  // what it sees
    return;
  }
  if (std::exchange(wipeDragged_, false) || dragged_ || event->button() == Qt::MiddleButton) return;
  if (const auto pixel = pixelAt(event->position())) {
    if (probeTool_->active() && event->button() == Qt::LeftButton) {
      emit probeWanted(pixel->x(), pixel->y());
      return;
    }
    pickShown_ = true;
    emit pixelPicked(pixel->x(), pixel->y());
    if (event->button() == Qt::RightButton) emit inspectWanted(pixel->x(), pixel->y());
  }
}

void Viewport::mouseDoubleClickEvent(QMouseEvent* event) {
  if (regionTool_ || probeTool_->active() || event->button() != Qt::LeftButton) return;
  if (const auto pixel = pixelAt(event->position())) emit focusWanted(pixel->x(), pixel->y());
}

void Viewport::wheelEvent(QWheelEvent* event) {
  const float notches = static_cast<float>(event->angleDelta().y()) / kWheelNotch;
  if (event->buttons() & Qt::RightButton) {
    controller_.changeSpeed(notches > 0 ? 1.25f : 0.8f);
    return;
  }
  if (event->modifiers() & Qt::ControlModifier) {
    zoomBy(std::pow(kZoomStep, static_cast<double>(notches)), event->position());
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
  } else if (const QPointF way = kArrows.value(key); !way.isNull() && (event->modifiers() & Qt::ControlModifier)) {
    view_.panBy(-way * 40, pictureSize(), paneAt({0, 0}));
    update();
  } else if (probeTool_->active() && (key == Qt::Key_Delete || key == Qt::Key_Backspace)) {
    emit probeDeletionWanted();
  } else if (moveWipe(key, event->modifiers())) {
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
