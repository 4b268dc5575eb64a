#pragma once
// A window over a fake engine, for tests of what it asks and shows.
#include <QFile>
#include <QTemporaryDir>
#include <QTest>
#include <memory>

#include "fake_link.h"
#include "ui/main_window.h"
#include "ui/settings.h"

namespace hl::ui {

class FakeWindowTest : public QObject {
 protected:
  /// A fresh one, with settings as on the first start.
  void openWindow() {
    QFile::remove(folder_.filePath("settings.ini"));
    link_ = std::make_unique<FakeLink>();
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    window_ = std::make_unique<MainWindow>(*link_, *settings_, QString());
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
  }
  void closeWindow() { window_.reset(), settings_.reset(), link_.reset(); }

  QTemporaryDir folder_;
  std::unique_ptr<FakeLink> link_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<MainWindow> window_;
};

}  // namespace hl::ui
