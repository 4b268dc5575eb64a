#pragma once
// Which of the two ways the picture takes to the screen: read back and painted, or drawn into a window by the device.
#include <QString>
#include <optional>

namespace hl {
class Presenter;
}

namespace hl::ui {

enum class PresenterWish { Auto, Swapchain, ReadBack };

/// "auto", "swapchain" or "readback".
std::optional<PresenterWish> parsePresenterWish(const QString&);
QString presenterWishId(PresenterWish);

struct PresenterChoice {
  bool swapchain = false;
  QString why;  ///< one line for people: "swapchain on ...", "read-back: ..."
};

/// `platform`: Qt's, as in QGuiApplication::platformName(). `presenter`: the engine's, null where it has none. By itself the swapchain is taken on a real GPU: on
/// a CPU both copy the same memory, and read-back cannot fail.
PresenterChoice choosePresenter(PresenterWish, const QString& platform, const Presenter* presenter);

}  // namespace hl::ui
