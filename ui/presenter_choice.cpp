#include "ui/presenter_choice.h"

#include <QCoreApplication>

#include "engine/session/presenter.h"

namespace hl::ui {
namespace {

QString say(const char* text) { return QCoreApplication::translate("hl::ui::PresenterChoice", text); }

PresenterChoice readBack(const QString& why) { return {false, say("read-back: %1").arg(why)}; }

}  // namespace

std::optional<PresenterWish> parsePresenterWish(const QString& text) {
  for (const PresenterWish w : {PresenterWish::Auto, PresenterWish::Swapchain, PresenterWish::ReadBack})
    if (text == presenterWishId(w)) return w;
  return std::nullopt;
}

QString presenterWishId(PresenterWish wish) {
  switch (wish) {
    case PresenterWish::Auto:
      return QStringLiteral("auto");
    case PresenterWish::Swapchain:
      return QStringLiteral("swapchain");
    case PresenterWish::ReadBack:
      return QStringLiteral("readback");
  }
  return {};
}

PresenterChoice choosePresenter(PresenterWish wish, const QString& platform, const Presenter* presenter) {
  if (wish == PresenterWish::ReadBack) return readBack(say("as asked for"));
  if (platform != QLatin1String("xcb")) return readBack(say("swapchains are drawn under Qt's platform xcb, and this is %1").arg(platform));
  if (!presenter) return readBack(say("the engine shows no pictures itself"));
  if (!presenter->noPresentation().empty()) return readBack(QString::fromStdString(presenter->noPresentation()));
  const QString device = QString::fromStdString(presenter->deviceName());
  if (wish == PresenterWish::Auto && presenter->ofCpu()) return readBack(say("%1 is the CPU").arg(device));
  return {true, say("swapchain on %1").arg(device)};
}

}  // namespace hl::ui
