#pragma once
// Pixel inspector: what a pixel holds in the technique's picture and in both references, what lies round it, and what the technique says of it.
#include <QWidget>
#include <optional>

#include "ui/document.h"
#include "ui/image_feed.h"

class QBoxLayout;
class QLabel;
class QPushButton;
class QSpinBox;
class QTableWidget;

namespace hl::ui {

/// Pixels round one, enlarged; the middle one framed.
class Neighbourhood : public QWidget {
  Q_OBJECT
 public:
  static constexpr int kRadius = 5;
  explicit Neighbourhood(const QString& name, QWidget* parent = nullptr);
  /// Tone mapped as the viewport is; beyond the picture's edge nothing is drawn. Null: no picture.
  void show(const Image*, QPoint pixel, const hl::Display&);
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 protected:
  void paintEvent(QPaintEvent*) override;

 private:
  QString name_;
  QImage picture_;
};

class InspectorPanel : public QWidget {
  Q_OBJECT
 public:
  InspectorPanel(EngineLink&, Document&, ImageFeed&, QWidget* parent = nullptr);
  void inspect(int x, int y);
  void showFrame(std::shared_ptr<const FrameResult>);
  std::optional<QPoint> pixel() const { return pixel_; }
  /// All that is shown, for a note or a mail.
  QString text() const;

 signals:
  void pixelChanged(int x, int y);
  void referenceNeeded();

 protected:
  void showEvent(QShowEvent*) override;
  void hideEvent(QHideEvent*) override;
  void resizeEvent(QResizeEvent*) override;

 private:
  void draw();
  void wantImages();
  /// Whether the scene has glossy surfaces: then what lobes reflect is shown too.
  bool glossy() const { return frame_ && frame_->features.glossySurfaces; }

  EngineLink& link_;
  Document& document_;
  ImageFeed& feed_;
  QBoxLayout* parts_;
  QSpinBox *x_, *y_;
  QPushButton *copy_, *trace_;
  Neighbourhood *technique_, *matched_, *full_;
  QTableWidget* table_;
  QLabel* facts_;
  std::optional<QPoint> pixel_;
  std::shared_ptr<const FrameResult> frame_;
};

}  // namespace hl::ui
