#pragma once
// The picture, read back and painted or drawn by the device, and the gestures on it. It shows the newest frame there is, and keeps the last good one.
#include <QElapsedTimer>
#include <QImage>
#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>
#include <set>

#include "engine/session/presenter.h"
#include "engine/session/session.h"
#include "ui/camera_controller.h"
#include "ui/comparison_painter.h"

namespace hl::ui {

class ProbeTool;
class SwapchainView;

class Viewport : public QWidget {
  Q_OBJECT
 public:
  explicit Viewport(QWidget* parent = nullptr);
  ~Viewport() override;

  void showFrame(std::shared_ptr<const FrameResult>);
  /// The camera as it stands, when someone else set it.
  void setCamera(const Camera&, float sceneDiagonal);
  /// Text in the middle, shown while there is no frame ("Loading sponza: 40 %").
  void setWaiting(const QString&);
  /// What went wrong, over the picture, until it is cleared with "".
  void setNotice(const QString&);
  void setPaused(bool);
  /// In place of the frame's own picture, until one of mode Off; Space still shows the reference.
  void setComparison(const ShownComparison&);
  /// Outlines over the picture; {} none.
  void setRegions(const std::vector<Region>&);
  /// Outlines this pixel of the frame; none: no more.
  void setMarkedPixel(std::optional<QPoint>);
  /// Its pictures are drawn into a window of their own from now on, in place of being read back and painted; null: no more. Frames
  /// come without the picture's bytes then, so that one more is needed after a change (EngineLink::renderOnce).
  void usePresenter(std::shared_ptr<Presenter>);
  /// That window, or null. Whether it has been drawn to: SwapchainView::isShown.
  const SwapchainView* swapchainView() const { return swapchain_.get(); }
  ProbeTool& probeTool() { return *probeTool_; }
  bool regionTool() const { return regionTool_; }
  /// Where the picture lies in the widget; side by side, the left one. Zoomed in, it reaches beyond it.
  QRectF pictureRect() const;
  /// The frame's pixel under a point of the widget, if any.
  std::optional<QPoint> pixelAt(QPointF) const;
  QSize sizeHint() const override { return {960, 540}; }
  QSize minimumSizeHint() const override { return {160, 90}; }

 signals:
  void cameraMoved(const hl::Camera& camera);
  void pixelPicked(int x, int y);
  /// A click with the probe tool beside all probes: one is wanted in front of what this pixel shows.
  void probeWanted(int x, int y);
  void probeDeletionWanted();
  void focusWanted(int x, int y);
  void referenceHeld(bool held);
  void bookmarkWanted(int number);
  void bookmarkStored(int number);
  void wipeMoved(double share);
  void inspectWanted(int x, int y);
  /// The presenter's window cannot be drawn to, or no longer: the picture is read back again.
  void presenterFailed(const QString& why);
  /// Drawn with the region tool, or with Ctrl and Shift held: in shares of the picture, on whole pixels.
  void regionDrawn(const QRectF& shares);

 public slots:
  /// What the session found under the pixel that focusWanted() named.
  void focusOn(const hl::vec3& point);
  /// The samples of the picked point go out of sight until the next click.
  void hidePick();
  /// The left button draws regions until it is turned off, or Escape.
  void setRegionTool(bool);
  void zoomIn();
  void zoomOut();
  void zoomToFit();

 protected:
  void paintEvent(QPaintEvent*) override;
  void resizeEvent(QResizeEvent*) override;
  void showEvent(QShowEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;
  void mouseDoubleClickEvent(QMouseEvent*) override;
  void wheelEvent(QWheelEvent*) override;
  void keyPressEvent(QKeyEvent*) override;
  void keyReleaseEvent(QKeyEvent*) override;
  void focusOutEvent(QFocusEvent*) override;

 private:
  void moved();
  void flyOn();
  void paintOver(QPainter&);
  void drawLabels(QPainter&);
  bool overlaid() const;
  PresentView presentView();
  bool onDevice() const;  ///< the presenter's window shows the picture
  void followDock();
  bool comparing() const { return comparison_.hasPicture() && !spaceHeld_; }
  QSize frameSize() const;
  QSizeF pictureSize() const;
  QRectF paneAt(QPointF) const;
  QPointF framePoint(QPointF) const;  ///< in pixels of the frame, which it may lie beside
  void zoomBy(double factor, std::optional<QPointF> anchor = {});
  bool moveWipe(int key, Qt::KeyboardModifiers);
  bool onWipe(QPointF) const;
  QRectF drawnShares() const;  ///< of the rubber band; empty where it is too small to be meant
  void drawOutlines(QPainter&);

  std::shared_ptr<const FrameResult> frame_;
  QImage image_;   // over the frame's own pixels, not a copy; null where it came without
  QString waiting_, notice_;
  CameraController controller_;
  bool cameraKnown_ = false, paused_ = false, spaceHeld_ = false, dragged_ = false;
  bool pickShown_ = false;  // since the last click, until Escape
  QPointF lastPosition_, pressPosition_;
  std::set<int> keys_;
  PictureView view_;
  ShownComparison comparison_;
  std::vector<Region> regions_;
  std::optional<QPoint> marked_;
  std::optional<QPointF> bandStart_;  // the rubber band's, in the widget
  QPointF bandEnd_;
  bool regionTool_ = false;
  bool flickerSecond_ = false, wipeDragged_ = false;
  QTimer flickerTimer_;
  QTimer flyTimer_;
  QElapsedTimer flyClock_;
  QMetaObject::Connection dock_;
  ProbeTool* probeTool_;
  std::unique_ptr<SwapchainView> swapchain_;
};

}  // namespace hl::ui
