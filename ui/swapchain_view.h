#pragma once
// The picture drawn by the device: a window of its own, laid over a widget, that a Presenter draws into. It takes no input: mouse and keys reach the widget
// below. Only under xcb; whether it works is known when shown() or refused() comes.
#include <QObject>
#include <QPointer>
#include <QWidget>
#include <QWindow>
#include <memory>

#include "engine/session/presenter.h"

class QVulkanInstance;

namespace hl::ui {

class SwapchainView : public QObject {
  Q_OBJECT
 public:
  /// Covers `under` from now on.
  SwapchainView(std::shared_ptr<Presenter>, QWidget* under);
  /// Waits until the presenter has let go of the window.
  ~SwapchainView() override;

  /// Where it has been drawn to, what it covers need not be painted.
  bool isShown() const { return shown_; }
  void setView(const PresentView&);
  /// As large as the covered widget.
  void resize(QSize);
  /// Behind another tab a window counts as exposed all the same: the dock says when it is not seen.
  void setSeen(bool);
  const Presenter& presenter() const { return *presenter_; }
  QWindow* window() const { return window_; }

 signals:
  void shown();
  void refused(const QString& why);

 private:
  class Window;
  void surfaceMade();
  void surfaceGoes();
  void exposed(bool);

  std::shared_ptr<Presenter> presenter_;  // keeps the instance: below it only what goes first
  std::unique_ptr<QVulkanInstance> vulkan_;
  QPointer<QWidget> container_;
  QPointer<QWindow> window_;
  bool shown_ = false, seen_ = true, exposed_ = false;
};

}  // namespace hl::ui
