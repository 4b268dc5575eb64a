#include "ui/swapchain_view.h"

#include <QExposeEvent>
#include <QMetaObject>
#include <QPlatformSurfaceEvent>
#include <QVulkanInstance>
#include <utility>

namespace hl::ui {

class SwapchainView::Window : public QWindow {
 public:
  explicit Window(SwapchainView& view) : view_(&view) {
    setObjectName(QStringLiteral("viewportWindow"));
    setSurfaceType(QSurface::VulkanSurface);
  }

 protected:
  bool event(QEvent* event) override {
    if (event->type() == QEvent::PlatformSurface && view_) {
      const auto type = static_cast<QPlatformSurfaceEvent*>(event)->surfaceEventType();
      if (type == QPlatformSurfaceEvent::SurfaceCreated) view_->surfaceMade();
      // Qt destroys the surface next: the swapchain has to be gone.
      if (type == QPlatformSurfaceEvent::SurfaceAboutToBeDestroyed) view_->surfaceGoes();
    }
    return QWindow::event(event);
  }
  void exposeEvent(QExposeEvent*) override {
    if (view_) view_->exposed(isExposed());
  }

 private:
  QPointer<SwapchainView> view_;
};

SwapchainView::SwapchainView(std::shared_ptr<Presenter> presenter, QWidget* under) : QObject(under), presenter_(std::move(presenter)), vulkan_(std::make_unique<QVulkanInstance>()) {
  vulkan_->setVkInstance(static_cast<VkInstance>(presenter_->vulkanInstance()));
  vulkan_->setFlags(QVulkanInstance::NoDebugOutputRedirect);  // the engine listens already
  auto* window = new Window(*this);
  window_ = window;
  container_ = QWidget::createWindowContainer(window, under);
  container_->setFocusPolicy(Qt::NoFocus);
  container_->setAttribute(Qt::WA_TransparentForMouseEvents);
  window->setFlag(Qt::WindowTransparentForInput);
  window->setFlag(Qt::WindowDoesNotAcceptFocus);
  if (!vulkan_->create()) {
    const int code = vulkan_->errorCode();
    QMetaObject::invokeMethod(this, [this, code] { emit refused(tr("Qt cannot use the engine's Vulkan instance (error %1)").arg(code)); }, Qt::QueuedConnection);
    return;
  }
  window->setVulkanInstance(vulkan_.get());
  resize(under->size());
  container_->show();
}

SwapchainView::~SwapchainView() {
  presenter_->detach();
  delete container_;  // and the window with it, and its surface, while the instance is there
}

void SwapchainView::resize(QSize size) {
  if (container_) container_->setGeometry(QRect(QPoint(), size));
}

void SwapchainView::surfaceMade() {
  if (!window_->vulkanInstance()) return;
  const VkSurfaceKHR surface = QVulkanInstance::surfaceForWindow(window_);
  if (surface == VK_NULL_HANDLE) {
    QMetaObject::invokeMethod(this, [this] { emit refused(tr("Qt made no Vulkan surface for the window")); }, Qt::QueuedConnection);
    return;
  }
  presenter_->attach(reinterpret_cast<uint64_t>(surface), [view = QPointer<SwapchainView>(this)](const std::string& why) {
    // On the presenter's thread, and never after detach(): the view is there.
    QMetaObject::invokeMethod(
        view,
        [view, why] {
          if (!view) return;
          if (!why.empty()) {
            view->shown_ = false;
            emit view->refused(QString::fromStdString(why));
          } else if (!std::exchange(view->shown_, true)) {
            emit view->shown();
          }
        },
        Qt::QueuedConnection);
  });
}

void SwapchainView::surfaceGoes() {
  presenter_->detach();
  shown_ = false;
}

void SwapchainView::setView(const PresentView& view) { presenter_->setView(view); }

void SwapchainView::exposed(bool on) {
  exposed_ = on;
  presenter_->setVisible(exposed_ && seen_);
}

void SwapchainView::setSeen(bool seen) {
  seen_ = seen;
  presenter_->setVisible(exposed_ && seen_);
}

}  // namespace hl::ui
