// The scene's time in the window: what its controls ask of the engine, and recording a flight.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QPushButton>
#include <QSlider>
#include <QTest>
#include <QToolButton>

#include "tests/ui/fake_link.h"
#include "ui/time_panel.h"

namespace {

using namespace hl;
using namespace hl::ui;

class TimePanelTest : public QObject {
  Q_OBJECT

  FakeLink link_;
  Catalog catalog_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<TimePanel> panel_;

  template <class T>
  T* find(const QString& text) {
    for (T* w : panel_->findChildren<T*>())
      if (w->text() == text) return w;
    return nullptr;
  }
  void publish(double time, bool paths, bool playing = false) {
    auto scene = std::make_shared<Scene>();
    scene->hash = paths ? "paths" : "none";
    scene->cameras.resize(1);
    if (paths) {
      CameraPath p;
      p.name = "walk", p.keys.resize(2), p.keys[1].time = 4;
      scene->cameraPaths = {p};
    }
    auto frame = std::make_shared<FrameResult>();
    frame->scene = scene, frame->time = time, frame->playing = playing;
    frame->preset = document_->preset();
    link_.publish(frame);
    panel_->showFrame(*frame);
  }

 private slots:
  void init() {
    document_ = std::make_unique<Document>(link_, catalog_);
    panel_ = std::make_unique<TimePanel>(*document_);
    link_.takeCalls();
  }
  void cleanup() {
    panel_.reset();
    document_.reset();
    link_.frame.reset();
  }

  void playsFromWhereItIs() {
    publish(1.5, true);
    auto* play = find<QToolButton>("Play");
    QVERIFY(play && play->isEnabled());
    play->click();
    QCOMPARE(link_.takeCalls(), QStringList{"playback on"});
    QCOMPARE(link_.playback.start, 1.5f);
    publish(2.25, true);
    find<QToolButton>("Pause")->click();
    QVERIFY(!link_.playback.play);
    QCOMPARE(link_.playback.start, 2.25f);
    QCOMPARE(document_->preset().animation.start, 2.25f);
  }

  void theSliderGoesRoundWithWhatRepeats() {
    auto* slider = panel_->findChild<QSlider*>();
    publish(5, true, true);
    QCOMPARE(slider->value(), slider->maximum() / 4);
    publish(5, true, false);
    QCOMPARE(slider->value(), slider->maximum());
  }

  void nothingToPlayInAScene() {
    publish(0, false);
    QVERIFY(!find<QToolButton>("Play")->isEnabled());
  }

  void pathsHoldTheCameraUntilItIsMoved() {
    publish(0, true);
    auto* paths = panel_->findChild<QComboBox*>();
    paths->setCurrentIndex(1);
    emit paths->activated(1);
    QCOMPARE(link_.playback.cameraPath, std::string("walk"));
    document_->moveCamera(Camera{});
    QCOMPARE(document_->preset().animation.cameraPath, std::string());
    QCOMPARE(paths->currentIndex(), 0);
  }

  void recordsAFlight() {
    publish(0, false);
    auto* key = find<QPushButton>("Add key");
    auto* keep = find<QPushButton>("Keep flight");
    QVERIFY(!keep->isEnabled());
    Camera c;
    for (int i = 0; i < 3; ++i) {
      c.position.x = static_cast<float>(i);
      document_->moveCamera(c);
      key->click();
    }
    QCOMPARE(panel_->recording().keys.size(), size_t{3});
    keep->click();
    QCOMPARE(link_.paths.size(), size_t{1});
    QCOMPARE(link_.paths[0].name, std::string("flight 1"));
    QCOMPARE(link_.paths[0].keys[2].camera.position.x, 2.0f);
    QCOMPARE(link_.paths[0].keys[2].time, 4.0f);
    QVERIFY(panel_->recording().keys.empty());
  }
};

}  // namespace

QTEST_MAIN(TimePanelTest)
#include "time_panel_test.moc"
