#pragma once
// Probes moved by hand in the viewport: which one the pointer takes hold of, and where a drag brings it. The viewport owns one, and hands it gestures in pixels of the frame.
#include <QObject>
#include <QPainter>
#include <optional>
#include <vector>

#include "engine/passes/gbuffer.h"
#include "engine/scene/scene.h"

namespace hl::ui {

class ProbeTool : public QObject {
  Q_OBJECT
 public:
  using QObject::QObject;

  void setActive(bool);
  bool active() const { return active_; }
  /// As the document has them, in metres; `inside`: those that stand inside geometry, as far as that is known. `radius` [m] of the balls they are shown as.
  void setProbes(const std::vector<vec3>&, const std::vector<uint8_t>& inside, float radius);
  const std::vector<vec3>& probes() const { return probes_; }
  std::optional<size_t> selected() const { return selected_; }
  void select(std::optional<size_t>);

  /// Takes hold of the probe there; false: there is none.
  bool press(const Camera&, QSize frame, QPointF pixel);
  /// Without modifiers parallel to the picture; with Shift up and down (y), with Control along x, with Alt along z.
  void drag(QPointF pixel, Qt::KeyboardModifiers);
  /// Emits moved() where it is elsewhere now.
  void release();
  /// Back where it was.
  void cancelDrag();
  bool dragging() const { return grabbed_.has_value(); }

  /// `place`: where the frame's picture lies.
  void paint(QPainter&, const Camera&, QSize frame, const QRectF& place) const;

 signals:
  void moved(size_t probe, const hl::vec3& to);
  void selectionChanged();
  void changed();  ///< something to paint anew

 private:
  bool active_ = false;
  std::vector<vec3> probes_;
  std::vector<uint8_t> inside_;
  float radius_ = 0;
  std::optional<size_t> selected_, grabbed_;
  vec3 start_{0.0f}, now_{0.0f}, grip_{0.0f};  ///< of the probe; grip: where it was taken hold of, beside its middle
  CameraBasis camera_;
  QSize frame_;
};

}  // namespace hl::ui
